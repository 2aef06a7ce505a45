"""An observable of a stored study against one of its axes."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from solver.problem.errors import no_such
from studies.laws.line_verdicts import FAILS

from ..store import selection
from ..words import labels
from . import colours, fonts
from .scales import SPARE, WIDE, RoomLocator, is_geometric, set_scale

MOST_DOTS = 50  # values of a line, beyond which it has no dots


def trend(ds: xr.Dataset, ax: Axes, observable: str, axis: str, at: dict[str, float] | None = None) -> Axes:
    """An observable against an axis; on a grid the line at `at` stands out and the others are faint.

    Raises `InputError` for an observable or axis that is not stored.
    """
    if observable not in ds:
        raise no_such("observable", observable, [str(name) for name in ds.data_vars])
    order = selection.line(ds, axis, at)
    along = labels.in_label_unit(ds[axis], ds[axis].values[[where[axis] for where in order]])
    lines = ds[observable].transpose(..., axis).isel({axis: [where[axis] for where in order]})
    lines = lines.copy(data=labels.in_label_unit(ds[observable], lines.values))
    others = {name: i for name, i in order[0].items() if name != axis}
    values = lines.isel(others).values.astype(float)
    look: dict[str, Any] = {"drawstyle": "steps-mid"} if selection.is_count(ds, observable) else {}
    for line in lines.values.reshape(-1, along.size) if lines.ndim > 1 else ():
        ax.plot(along, line, color=colours.FAINT, linewidth=1, zorder=1, **look)
    ax.plot(*_broken(along, values, _branches(ds, order)), color=colours.DATA, linewidth=1.2, zorder=2, **look)
    if along.size <= MOST_DOTS:
        ax.scatter(along, values, color=colours.DATA, s=15, zorder=4, edgecolors="white", linewidths=0.7)
    unsolved = ~np.isfinite(values)
    if unsolved.any():
        ax.plot(along[unsolved], np.zeros(unsolved.sum()), "x", color=colours.VERDICTS[FAILS], clip_on=False,
                transform=ax.get_xaxis_transform(), label="unsolved")  # fmt: skip
    _scale(ax, ds, axis, along)
    if "fold" in ds and axis == ds.attrs.get("followed") and np.isfinite(ds["fold"]):
        ax.axvline(float(np.degrees(ds["fold"])), color=colours.INK, linewidth=1, linestyle=(0, (4, 3)), label="fold")
    words = [axis_label(ds, axis, others, long) for long in (True, False)]
    ax.set_xlabel(fonts.wrap(fonts.shorter(words, fonts.inches(ax)[0]), ax))
    ax.set_ylabel(fonts.shorter([labels.label(ds[observable], long) for long in (True, False)], fonts.inches(ax)[1]))
    ax.margins(y=0.1)
    drawn = lines.values[np.isfinite(lines.values)]
    if selection.is_count(ds, observable):
        ax.yaxis.set_major_locator(RoomLocator("counts"))
        if drawn.size and np.ptp(drawn) < 2:
            count = round(float(drawn.mean()))
            ax.set_ylim(max(count - 2, min(count, 0) - 0.5), count + 2)
    elif (
        drawn.size and np.ptp(drawn) and selection.is_level(ds, observable)
    ):  # what rounding and errors allow is no news
        middle = float(drawn.mean())
        half = max(0.1 * abs(middle), 10 * np.ptp(drawn))
        ax.set_ylim(middle - half, middle + half)
    return ax


def axis_label(ds: xr.Dataset, axis: str, where: dict[str, int], long: bool = True) -> str:
    """The axis with its unit, and the values at which the other axes are held."""
    held = labels.equations(ds, {name: i for name, i in where.items() if name != axis})
    return labels.axis_label(axis, ds[axis], long) + (f", at {held}" if held else "")


def _branches(ds: xr.Dataset, order: Sequence[dict[str, int]]) -> Any:
    """The number of the branch of each case; None where the dataset has none."""
    if "branch" not in ds or set(ds["branch"].dims) != set(order[0]):
        return None
    return np.array([int(ds["branch"].isel(where)) for where in order])


def _broken(along: Any, values: Any, branches: Any) -> tuple[Any, Any]:
    """The points of a line with a gap wherever the branch changes."""
    at = np.flatnonzero(np.diff(branches)) + 1 if branches is not None else np.empty(0, dtype=int)
    return np.insert(along, at, np.nan), np.insert(values, at, np.nan)


def _scale(ax: Axes, ds: xr.Dataset, axis: str, along: Any) -> None:
    """A logarithmic axis where the values are spaced so or were refined so, with ticks at 1, 2 and 5."""
    low, high = float(along.min()), float(along.max())
    refined_so = ds[axis].attrs.get("spacing") == "geometric" and low > 0 and high > WIDE * low
    set_scale(ax.xaxis, (low, high), refined_so or is_geometric(along), SPARE)
