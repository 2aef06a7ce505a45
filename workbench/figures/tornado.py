"""The tornado diagrams of one case: how each observable answers each field, the strongest on top."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from solver.problem.errors import InputError
from solver.problem.quantities import quantity

from ..data import labels
from . import bars, legend, style
from .scales import Ticks
from .sheet import SCREEN, Sheet

MOST = 12  # bars of a panel
ROOM = 0.34  # share of the width that is kept for the numbers on either side


def figure(ds: xr.Dataset, sheet: Sheet | None = None) -> Figure:
    """Draw a dataset of `influence.local` with its title; sheet: as of `bars.figure`.

    Raises `InputError` where no field has an effect.
    """
    names = [str(name) for name in ds["observable"].values if _effects(ds, str(name))]
    if not names:
        raise InputError("no diagram: no observable depends on these fields, or none has a derivative")
    most = max(len(_effects(ds, name)[:MOST]) for name in names)

    def below(fig: Figure) -> None:
        _caption(fig, sheet or SCREEN)

    return bars.figure(_titled(ds), names, most, lambda ax, name: panel(ds, ax, name), below, sheet)


def _titled(ds: xr.Dataset) -> xr.Dataset:
    """The dataset with a title that names the case of a study; ds may have the attribute varied, the fields of its
    axes."""
    varied = [name for name in str(ds.attrs.get("varied", "")).split() if name in ds["field"].values]
    told = [f"{quantity(name).symbol} = {_value(ds.sel(field=name))}" for name in varied]
    return ds.assign_attrs(title=", ".join([str(ds.attrs["title"]), *told]))


def panel(ds: xr.Dataset, ax: Axes, name: str) -> Axes:
    """The diagram of one observable."""
    row = ds.sel(observable=name)
    found = _effects(ds, name)
    shown, rest = found[:MOST], found[MOST:]
    sizes = np.array([effect for _, effect in shown])
    ax.barh(range(sizes.size), sizes, 0.66, color=[style.PAIR[int(size > 0)] for size in sizes], zorder=3)
    ax.axvline(0, color=style.SOFT, linewidth=0.8, zorder=4)
    for i, size in enumerate(sizes):
        ax.annotate(_signed(size), (size, i), (3 if size > 0 else -3, 0), textcoords="offset points",
                    ha="left" if size > 0 else "right", va="center", color=style.INK,
                    size=style.small())  # fmt: skip
    bars.look(ax, [_tick(ds, field) for field, _ in shown])
    low, high = min(sizes.min(), 0.0), max(sizes.max(), 0.0)
    room = ROOM * (high - low)
    ax.set_xlim(low - (room if low < 0 else room / 6), high + (room if high > 0 else room / 6))
    ax.xaxis.set_major_locator(MaxNLocator(nbins=4))
    ax.xaxis.set_major_formatter(Ticks())
    value = _in_unit(float(row["value"]), str(row["unit"].values))
    own = str(row["effect_unit"].values)
    ax.set_title(f"{quantity(name).symbol} = {value}", loc="left", pad=4)
    change = f"change [{labels.unit(own)}]" if own != "1" else "change"
    ax.set_title(change, loc="right", pad=4, size=style.small(), color=style.SOFT)
    if rest:
        more = f"{len(rest)} fields of less than {abs(shown[-1][1]):.1g}"
        ax.set_xlabel(more, size=style.small(), color=style.SOFT)
    return ax


def _effects(ds: xr.Dataset, name: str) -> list[tuple[str, float]]:
    """The fields that have an effect on an observable, and the effects, the largest first."""
    row = ds["effect"].sel(observable=name).values
    found = [(str(f), float(v)) for f, v in zip(ds["field"].values, row, strict=True) if np.isfinite(v) and v != 0]
    return sorted(found, key=lambda pair: -abs(pair[1]))


def _signed(value: float) -> str:
    return f"{'+' if value > 0 else '−'}{labels.number(abs(value), 2)}"


def _tick(ds: xr.Dataset, field: str) -> str:
    """``E``, or with another amount than 1 % ``β₀, 1°``."""
    amount = str(ds["amount"].sel(field=field).values)
    told = amount.replace(" deg", "°")
    return quantity(field).symbol if amount == "1 %" else f"{quantity(field).symbol}, {labels.unit(told)}"


def _caption(fig: Figure, sheet: Sheet) -> None:
    """What the bars are."""
    notes = ["The change of each observable if a field rises by 1 %, or by the amount beside it."]
    legend.below(
        fig, [Patch(color=style.PAIR[k], label=word) for k, word in ((1, "rises"), (0, "falls"))], notes, sheet
    )


def _value(field: xr.Dataset) -> str:
    return _in_unit(float(field["at"]), str(field["field_unit"].values))


def _in_unit(number: float, unit: str) -> str:
    """A number with its unit, an angle in degrees."""
    text = f"{labels.number(np.degrees(number))}°" if unit == "rad" else f"{labels.number(number)} {labels.unit(unit)}"
    return text.strip().replace("-", "−")
