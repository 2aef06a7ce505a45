"""The numbers of a law in its panel: the curve of its formula, its bounds, its power, or the place of its boundary."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from studies.law import Law
from studies.law_kinds import MONOTONE

from ..data import labels, law_numbers, selection
from . import law_words, style

DASHED = (0, (4, 2))
SEEN = 4.0  # points across, from which a band is seen beside a line


def curve(ds: xr.Dataset, ax: Axes, row: Mapping[str, Any]) -> None:
    """Draw what a law (a row of `law_verdicts.verdicts`) compares its observable with, on the line that decides."""
    if row["kind"] == MONOTONE:
        return
    law = Law.model_validate({key: row[key] for key in ("claim", "kind", "observable", "axis", "source")} | row["rule"])
    places = selection.line(ds, law.axis, row["at"])
    along = labels.in_label_unit(ds[law.axis], ds[law.axis].values[[place[law.axis] for place in places]])
    numbers = {
        key: values if key == "x" else labels.in_label_unit(ds[law.observable], values)
        for key, values in law_numbers.of_line(ds, law, places).items()
    }
    {"equals": _equals, "bounded": _bound, "scales": _scales, "boundary": _boundary}[law.kind](
        ax, ds, along, numbers, law, row
    )


def _equals(ax: Axes, ds: xr.Dataset, along: Any, numbers: Any, law: Law, row: Any) -> None:
    formula = numbers["formula"]
    array = ds[law.observable]
    half = labels.in_label_unit(array, law.absolute) if law.relative is None else law.relative * np.abs(formula)
    _line(ax, along, formula, law_words.formula(ds, law.formula, array))
    thin = 2 * np.median(half) * style.inches(ax)[1] * 72 < SEEN * np.ptp(ax.get_ylim())
    ax.fill_between(along, formula - half, formula + half, color=style.INK, alpha=0.12, linewidth=0, zorder=0,
                    label=f"what the law allows{' (hardly wider than the line)' if thin else ''}")  # fmt: skip


def _bound(ax: Axes, ds: xr.Dataset, along: Any, numbers: Any, law: Law, row: Any) -> None:
    for key, word in (("least", "at least"), ("most", "at most")):
        if key in numbers:
            _line(ax, along, numbers[key], f"{word} {law_words.formula(ds, getattr(law, key), ds[law.observable])}")


def _scales(ax: Axes, ds: xr.Dataset, along: Any, numbers: Any, law: Law, row: Any) -> None:
    found = row["numbers"]
    if not found:
        return
    stored = np.abs(np.radians(along) if labels.is_angle(ds[law.axis]) else along)
    fitted = labels.in_label_unit(ds[law.observable], found["factor"] * stored ** found["exponent"])
    _line(ax, along, fitted, labels.typeset(f"fit: {row['found']}"))


def _boundary(ax: Axes, ds: xr.Dataset, along: Any, numbers: Any, law: Law, row: Any) -> None:
    axis = ds[law.axis]
    places = np.unique(labels.in_label_unit(axis, numbers["x"]))
    half = float(labels.in_label_unit(axis, law.within))
    _line(ax, along, numbers["passes"], f"the value {law_words.formula(ds, law.passes, ds[law.observable])}")
    if places.size == 1 and np.isfinite(places[0]):
        ax.axvspan(places[0] - half, places[0] + half, color=style.INK, alpha=0.12, linewidth=0, zorder=0,
                   label="where the law expects it")  # fmt: skip


def _line(ax: Axes, along: Any, values: Any, label: str) -> None:
    ax.plot(along, values, color=style.INK, linewidth=1.3, linestyle=DASHED, zorder=3, label=labels.minus_signs(label))
