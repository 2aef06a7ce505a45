"""The scale of an axis of stored values: logarithmic or linear, the edges of their cells, ticks at 1, 2 and 5."""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from math import floor, log10

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.axis import XAxis, YAxis
from matplotlib.ticker import FixedLocator, Formatter, LogLocator, MaxNLocator, MultipleLocator, NullLocator
from numpy.typing import NDArray

from ..words import labels
from . import fonts

Values = NDArray[np.float64]

WIDE = 3.0  # times the smallest value: a narrower range has a linear scale
EVEN = 1e-6  # share by which the steps of a geometric axis may differ
MOST, GAP = 8, 0.09  # ticks of an axis; inches between two numbers
ROUNDING = 1e-9  # share of the range by which a tick may lie outside it
SPARE = 0.04  # share of a span that stays free at either end
FEW = 3  # ticks that a logarithmic axis has at least
CLOSE = 0.7  # of two heights of a letter, which Matplotlib leaves from one number to the next


class RoomLocator(MaxNLocator):
    """Ticks of Matplotlib between two values, at most so many, and no more than the drawn axis has room for."""

    def __init__(self, low: float, high: float, most: int, integer: bool) -> None:
        super().__init__(most, integer=integer)
        self.low, self.high, self.most = low, high, most

    def __call__(self) -> list[float]:
        """The ticks; the layout may have made the axis shorter than it was planned."""
        assert self.axis is not None
        room = int(self.axis.get_tick_space() / CLOSE)
        self.set_params(nbins=max(min(self.most, room), 1))
        return [
            value
            for value in np.asarray(self.tick_values(self.low, self.high)).tolist()
            if self.low <= value <= self.high
        ]


def is_geometric(values: Values) -> bool:
    """Whether rising values have equal ratios over a wide range: such an axis is logarithmic."""
    if values.size < 3 or values.min() <= 0:
        return False
    steps = np.diff(np.log(values))
    return bool(np.ptp(steps) < EVEN * steps.mean() and values[-1] / values[0] > WIDE)


class Ticks(Formatter):
    """The numbers of the ticks of an axis in full, all with the same number of decimals."""

    def format_ticks(self, values: Iterable[float]) -> list[str]:
        """The numbers of all ticks."""
        values = [float(value) for value in values]
        texts = [f"{value:.10g}" for value in values]
        decades = len(values) > 1 and min(values) > 0 and max(values) >= 100 * min(values)
        if decades or any("e" in text for text in texts):
            return [self(value) for value in values]
        decimals = max((len(text.partition(".")[2]) for text in texts), default=0)
        return [labels.minus_signs(f"{value or 0.0:.{decimals}f}") for value in values]

    def __call__(self, value: float, pos: int | None = None) -> str:
        """The number of one tick by itself."""
        return labels.tick(value)


@dataclass(frozen=True, eq=False)
class Scale:
    """The scale of one axis. values: (n,) rising, in the unit of the label; edges: of their cells, (n + 1,), from the
    first value to the last."""

    values: Values
    edges: Values
    logarithmic: bool

    def share(self, value: float) -> float:
        """Where a value lies on the axis: 0 at its low end, 1 at its high end."""
        low, here, high = (np.log(v) if self.logarithmic else v for v in (self.edges[0], value, self.edges[-1]))
        return float((here - low) / (high - low))

    def between(self, place: float) -> float:
        """The value at a place, where the cell of value i lasts from i to i + 1."""
        edges = np.log(self.edges) if self.logarithmic else self.edges
        found = float(np.interp(place, np.arange(edges.size), edges))
        return float(np.exp(found)) if self.logarithmic else found

    def cell(self, share: float) -> int:
        """The index of the value whose cell lies there."""
        shares = [self.share(float(edge)) for edge in self.edges[1:-1]]
        return int(np.searchsorted(shares, share, side="right"))

    def apply(self, ax: Axes, which: str, inches: float) -> None:
        """Give the axis `x` or `y` of a panel, so many inches long, this scale."""
        set_scale(ax.xaxis if which == "x" else ax.yaxis, (self.edges[0], self.edges[-1]), self.logarithmic, inches)


def set_scale(axis: XAxis | YAxis, ends: tuple[float, float], logarithmic: bool, inches: float) -> None:
    """Give an axis of so many inches its ends, its scale, and round ticks that have room."""
    axis.axes.set(**{f"{axis.axis_name}scale": "log" if logarithmic else "linear", f"{axis.axis_name}lim": ends})
    axis.set_minor_locator(NullLocator())
    axis.set_major_locator(FixedLocator(ticks(ends, logarithmic, inches, axis.axis_name == "y")))
    axis.set_major_formatter(Ticks())


def set_span(axis: XAxis | YAxis, low: float, high: float, logarithmic: bool, inches: float) -> None:
    """Give an axis of so many inches a scale from a little below one value to a little beyond another."""
    change, back = (np.log, np.exp) if logarithmic else (np.asarray, np.asarray)
    ends = np.array([change(low), change(high)])
    ends = back(ends + SPARE * np.ptp(ends) * np.array([-1, 1]))
    set_scale(axis, (float(ends[0]), float(ends[1])), logarithmic, inches)


def ticks(ends: tuple[float, float], logarithmic: bool, inches: float, upward: bool = False) -> list[float]:
    """As many round numbers of Matplotlib's locators as have room on an axis: at 1, 2 and 5 times powers of ten on a
    logarithmic one, or at the powers alone; evenly spaced ones where `FEW` such numbers do not lie between the ends."""
    change = log10 if logarithmic else float
    per_unit = inches / (change(ends[1]) - change(ends[0]))
    low, high = ends[0] - ROUNDING * abs(ends[0]), ends[1] + ROUNDING * abs(ends[1])
    counts = range(MOST, 0, -1)
    decades = [LogLocator(subs=(1, 2, 5), numticks=MOST), *(LogLocator(numticks=count) for count in counts[:-2])]
    even = [MaxNLocator(count, steps=[1, 2, 5, 10], min_n_ticks=1) for count in counts]
    chosen: list[float] = []
    for locator in (*decades, *even) if logarithmic else even:
        inside = [float(value) for value in locator.tick_values(low, high) if low <= value <= high]
        chosen = inside if len(inside) >= (FEW if isinstance(locator, LogLocator) else 1) else chosen
        wide = [fonts.small() / 72 if upward else fonts.width_of(labels.tick(value), fonts.small()) for value in chosen]
        gaps = [per_unit * (change(b) - change(a)) - (left + right) / 2
                for (a, left), (b, right) in pairwise(zip(chosen, wide, strict=True))]  # fmt: skip
        if chosen is inside and min(gaps, default=GAP) >= GAP:
            return chosen
    return chosen[-1:]


def round_below(value: float) -> float:
    """The largest of 1, 2 and 5 times a power of ten that is not above a positive value."""
    power = 10.0 ** floor(log10(value) + 1e-9)
    return max(digit * power for digit in (1, 2, 5) if digit * power <= value * (1 + 1e-9))


def angle_locator(span: float, inches: float) -> MultipleLocator:
    """Ticks of an axis of so many inches over a span of degrees: each 90 degrees, or a part or a multiple of it."""
    steps = (0.5, 1, 2, 5, 10, 15, 30, 45, 90, 180, 360, 720, 1800, 3600)
    least = 90 if 135 < span < 1000 * inches else 0
    return MultipleLocator(next((step for step in steps if step >= least and span <= step * inches / 0.45), steps[-1]))


def scale_of(axis: xr.DataArray) -> Scale:
    """The scale of the values of an axis, in any order: from the first to the last, or between its `ends`."""
    values = np.sort(labels.in_label_unit(axis, axis.values))
    logarithmic = is_geometric(values)
    points = np.log(values) if logarithmic else values
    if points.size == 1:
        edges = points + np.array([-0.5, 0.5]) * (abs(points[0]) or 1.0)
    else:
        between = (points[1:] + points[:-1]) / 2
        ends = labels.in_label_unit(axis, np.asarray(axis.attrs["ends"])) if "ends" in axis.attrs else values[[0, -1]]
        low, high = np.log(ends) if logarithmic else ends
        edges = np.concatenate([[low], between, [high]])
    return Scale(values, np.exp(edges) if logarithmic else edges, logarithmic)
