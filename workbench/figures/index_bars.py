"""The Sobol' indices of a sampled study as bars with intervals: of first order, and total."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from . import bars, legend, style
from .scales import Ticks
from .sheet import SCREEN, Sheet

FIRST, TOTAL = style.PAIR


def figure(ds: xr.Dataset, sheet: Sheet | None = None) -> Figure:
    """Draw a dataset of `influence.sobol`; sheet: as of `bars.figure`."""
    names = [str(name) for name in ds["observable"].values]
    share = f"{100 * ds.attrs['confidence']:g} %"
    limits = _limits(ds)

    def below(fig: Figure) -> None:
        entries = [
            Patch(color=FIRST, label="first order: the field alone"),
            Patch(color=TOTAL, label="total: with interactions"),
        ]
        notes = [f"Shares of the variance; lines: {share} intervals.", *_estimated(ds)]
        legend.below(fig, entries, notes, sheet or SCREEN)

    return bars.figure(ds, names, 2 * ds.sizes["field"], lambda ax, name: panel(ds, ax, name, limits), below, sheet)


def panel(ds: xr.Dataset, ax: Axes, name: str, limits: tuple[float, float]) -> Axes:
    """The indices of one observable, the field of the largest total on top."""
    row = ds.sel(observable=name)
    ax.set_title(str(row["symbol"].values), loc="left", pad=4)
    if not np.isfinite(row["total"].values).any():
        ax.text(0.5, 0.5, "one value on all samples", transform=ax.transAxes, ha="center", color=style.SOFT)
        ax.set(xticks=[], yticks=[])
        return ax
    order = np.argsort(-row["total"].values)
    at = np.arange(order.size)
    for key, color, offset in (("first", FIRST, -0.19), ("total", TOTAL, 0.19)):
        values = row[key].values[order]
        ax.barh(at + offset, values, 0.36, color=color, zorder=3)
        looks: list[dict[str, Any]] = [
            {"ecolor": "white", "elinewidth": 2.4},
            {"ecolor": style.INK, "elinewidth": 1, "capsize": 2},
        ]
        for look in looks:
            ax.errorbar(values, at + offset, xerr=row[f"{key}_conf"].values[order], linestyle="none", zorder=4, **look)
    bars.look(ax, [str(ds["field_symbol"].values[i]) for i in order])
    ax.axvline(0, color=style.SOFT, linewidth=0.8, zorder=4)
    ax.set_xlim(*limits)
    ax.xaxis.set_major_formatter(Ticks())
    if row["lost"] > 0:
        lost = f"{100 * float(row['lost']):.2g} % of the blocks left out"
        ax.set_title(lost, loc="right", pad=4, size=style.small(), color=style.SOFT)
    return ax


def _estimated(ds: xr.Dataset) -> list[str]:
    """Why an index is negative, or a total index is less than that of first order, where this is so."""
    found = {
        "an index can be below 0": bool((ds["first"] < 0).any() or (ds["total"] < 0).any()),
        "a total index can be below that of first order": bool((ds["total"] < ds["first"]).any()),
    }
    said = " and ".join(words for words, is_so in found.items() if is_so)
    return [f"The samples give estimates: by their sampling error {said}."] if said else []


def _limits(ds: xr.Dataset) -> tuple[float, float]:
    """The ends of the axis of every panel: 0 and 1, and beyond them what the intervals need."""
    low = min(float((ds[key] - ds[f"{key}_conf"]).min()) for key in ("first", "total"))
    high = max(float((ds[key] + ds[f"{key}_conf"]).max()) for key in ("first", "total"))
    return min(np.nan_to_num(low), 0.0) - 0.03, max(np.nan_to_num(high), 1.0) + 0.03
