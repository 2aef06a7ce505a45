"""The scale of an axis of stored values: logarithmic or linear, the edges of their cells, ticks at 1, 2 and 5."""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from math import ceil, floor, log10

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.ticker import Formatter, MaxNLocator, NullLocator
from numpy.typing import NDArray

from ..data import labels
from . import style

Values = NDArray[np.float64]

WIDE = 3.0  # times the smallest value: a narrower range has a linear scale
EVEN = 1e-6  # share by which the steps of a geometric axis may differ
MOST, APART = 8, 0.16  # ticks of an axis; inches between two numbers, one above the other
ROUNDING = 1e-9  # share of the range by which a tick may lie outside it
FEW, SUBS = 3, ((1, 2, 5), (1,))  # ticks that a logarithmic axis has at least; their digits


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
    """The scale of one axis. values: (n,) rising, in the unit of the label; edges: of their cells, (n + 1,)."""

    values: Values
    edges: Values
    logarithmic: bool

    def share(self, value: float) -> float:
        """Where a value lies on the axis: 0 at its low end, 1 at its high end."""
        low, here, high = (np.log(v) if self.logarithmic else v for v in (self.edges[0], value, self.edges[-1]))
        return float((here - low) / (high - low))

    def cell(self, share: float) -> int:
        """The index of the value whose cell lies there."""
        shares = [self.share(float(edge)) for edge in self.edges[1:-1]]
        return int(np.searchsorted(shares, share, side="right"))

    def put(self, ax: Axes, which: str, inches: float) -> None:
        """Give the axis `x` or `y` of a panel this scale, with as many ticks as have room in so many inches."""
        axis = ax.xaxis if which == "x" else ax.yaxis
        if self.logarithmic:
            (ax.set_xscale if which == "x" else ax.set_yscale)("log")
        (ax.set_xlim if which == "x" else ax.set_ylim)(self.edges[0], self.edges[-1])
        low, high = float(self.edges[0]), float(self.edges[-1])
        found = fitting(low, high, self.logarithmic, inches, upward=which == "y")
        axis.set_minor_locator(NullLocator())
        axis.set_ticks(found, [written(value) for value in found])


def scale_of(axis: xr.DataArray) -> Scale:
    """The scale of the values of an axis, in any order."""
    values = np.sort(labels.in_label_unit(axis, axis.values))
    logarithmic = is_geometric(values)
    points = np.log(values) if logarithmic else values
    if points.size == 1:
        edges = points + np.array([-0.5, 0.5]) * (abs(points[0]) or 1.0)
    else:
        between = (points[1:] + points[:-1]) / 2
        edges = np.concatenate([[2 * points[0] - between[0]], between, [2 * points[-1] - between[-1]]])
    return Scale(values, np.exp(edges) if logarithmic else edges, logarithmic)


def fitting(low: float, high: float, logarithmic: bool, inches: float, upward: bool = False) -> list[float]:
    """As many `ticks` as have room on an axis of so many inches, so that no two of their numbers meet."""
    change = log10 if logarithmic else float
    found: list[float] = []
    for most in range(MOST, 1, -1):
        found = ticks(low, high, logarithmic, most)
        places = [inches * (change(value) - change(low)) / (change(high) - change(low)) for value in found]
        sizes = [style.small() / 72 if upward else style.width_of(written(value), style.small()) for value in found]
        gaps = [b - a - (left + right) / 2
                for (a, b), (left, right) in zip(pairwise(places), pairwise(sizes), strict=True)]  # fmt: skip
        if min(gaps, default=0.0) >= (APART if upward else style.width_of("0", style.small())):
            return found
    return found[:1] + found[-1:] if len(found) > 2 else found


def written(value: float) -> str:
    return labels.minus_signs(labels.powers_of_ten(labels.number(value)))


def ticks(low: float, high: float, logarithmic: bool, most: int) -> list[float]:
    """At most so many round numbers from low to high: on a logarithmic axis at 1, 2 and 5 times powers of ten, or over
    several decades at powers of ten alone; evenly spaced ones where `FEW` such numbers do not lie in the range."""
    low, high = low - (high - low) * ROUNDING, high + (high - low) * ROUNDING
    if logarithmic:
        powers = range(floor(log10(low)), ceil(log10(high)) + 1)
        found = [[digit * 10.0**power for power in powers for digit in digits] for digits in SUBS]
        many, some = ([value for value in row if low <= value <= high] for row in found)
        if len(many) > most and len(some) >= FEW:
            many = some
        if len(many) >= FEW:
            return many[:: ceil(len(many) / most)]
    even = MaxNLocator(nbins=min(most, 6), steps=[1, 2, 5, 10]).tick_values(low, high)
    return [float(value) for value in even if low <= value <= high]
