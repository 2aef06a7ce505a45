"""The scale of an axis of stored values: logarithmic or linear, the edges of their cells, ticks at 1, 2 and 5."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import floor, log10
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import XAxis, YAxis
from matplotlib.ticker import Formatter, Locator, LogLocator, MaxNLocator, MultipleLocator, NullLocator
from numpy.typing import NDArray

from ..stored.stored_study import StoredStudy
from ..words import labels
from . import fonts

Values = NDArray[np.float64]

MOST, GAP = 8, 0.08  # ticks of an axis; inches between two numbers
ROUNDING = 1e-9  # share of the range by which a tick may lie outside it
SPARE = 0.04  # share of a span that stays free at either end
FEW = 3  # ticks of an axis at least, where so many have room
ANGLES = (1, 2, 5, 10, 15, 30, 45, 90, 180, 360, 720, 1800, 3600, 7200, 18000)  # degrees between two ticks
NARROW, WHOLE = 5.0, 135.0  # degrees: a narrower axis has ticks as of numbers; a wider one ticks at right angles


class RoomLocator(Locator):
    """Round numbers of Matplotlib's locators, as many as have room on the axis when it is drawn.

    On a logarithmic axis at 1, 2 and 5 times powers of ten, within a decade at 4 times too, or at the powers alone.
    Where `FEW` of these do not lie on the axis, they are evenly spaced, unless more stays free below the first than
    between the first two; else at 1, 3 and 6 times. Where no such numbers fit, as many as have room; on a linear axis
    these are the first and the last. of: ``counts`` are whole; ``angles`` over more than `NARROW` degrees are parts and
    multiples of a right angle.
    """

    def __init__(self, of: str = "numbers") -> None:
        self.of, self.letters = of, fonts.small()

    def __call__(self) -> list[float]:
        """The ticks between the ends of the axis."""
        assert self.axis is not None
        return self.tick_values(*sorted(self.axis.get_view_interval()))

    def tick_values(self, vmin: float, vmax: float) -> list[float]:
        """The ticks between two ends."""
        axis: Any = self.axis
        logarithmic, upward = axis.get_scale() == "log", axis.axis_name == "y"
        box, change = axis.axes.get_window_extent(), log10 if logarithmic else float
        inches = (box.height if upward else box.width) / axis.axes.get_figure(root=True).dpi
        per_unit = inches / ((change(vmax) - change(vmin)) or 1.0)
        low, high = vmin - ROUNDING * abs(vmin), vmax + ROUNDING * abs(vmax)

        def fits(ticks: list[float]) -> bool:
            written = axis.get_major_formatter()
            texts = (written if isinstance(written, Ticks) else Ticks()).format_ticks(ticks)
            sizes = [self.letters / 72 if upward else fonts.width_of(text, self.letters) for text in texts]
            gaps = [
                per_unit * (change(b) - change(a)) - (left + right) / 2
                for (a, left), (b, right) in pairwise(zip(ticks, sizes, strict=True))
            ]
            return min(gaps, default=GAP) >= GAP

        def few_of(ticks: list[float]) -> list[float]:
            kept = ticks[:1]
            for tick in [*ticks[-1:], *(ticks[1:-1] if logarithmic else ())]:
                kept = more if fits(more := sorted([*kept, tick])) else kept
            return kept

        def is_late(ticks: list[float]) -> bool:
            return ticks[0] ** 2 > low * ticks[1]

        fewer, crowded = list[list[float]](), list[list[float]]()
        for locator, least in self._candidates(vmax - vmin, logarithmic, within=vmax < 10 * vmin):
            inside = [float(value) for value in locator.tick_values(low, high) if low <= value <= high]
            if not fits(inside):
                crowded.append(few_of(inside))
            elif len(inside) >= least and not (logarithmic and isinstance(locator, MaxNLocator) and is_late(inside)):
                return inside
            else:
                fewer.append(inside)
        return max([*fewer, *crowded], key=len)

    def _candidates(self, span: float, logarithmic: bool, within: bool) -> Iterator[tuple[Locator, int]]:
        """Matplotlib's locators, from that of most ticks to that of one, each with the ticks that it has at least;
        within: a decade."""
        if logarithmic:
            if within:
                yield LogLocator(subs=(1, 2, 4, 5), numticks=MOST), FEW + 1
            yield LogLocator(subs=(1, 2, 5), numticks=MOST), FEW
            yield from ((LogLocator(numticks=count), FEW) for count in range(MOST, 2, -1))
        if self.of == "angles" and span > NARROW:
            steps = ANGLES if span < WHOLE else [step for step in ANGLES if step >= 90]
            yield from ((MultipleLocator(step), 2) for step in steps if span <= MOST * step)
        counts = self.of == "counts"
        for count in range(MOST + counts, 0, -1):  # half a count more lies at either end of a bar of their colours
            yield MaxNLocator(count, steps=[1, 2, 5, 10], integer=counts, min_n_ticks=1), FEW
        if logarithmic:
            yield LogLocator(subs=(1, 3, 6), numticks=MOST), FEW
        for count in (3, 2):  # at 3, 4, 6 and 8 too, where so few at 1, 2 and 5 do not lie on it
            yield MaxNLocator(count, steps=[1, 2, 3, 4, 5, 6, 8, 10], integer=counts, min_n_ticks=1), FEW


EDGE = 1e-9  # of an axis: a place so near to an edge of a cell lies on it


class Ticks(Formatter):
    """The numbers of the ticks of an axis, with the same number of decimals; in full, or with one power of ten.

    unit: what a label of the axis says of all its numbers, such as 10³.
    """

    def __init__(self, unit: float = 1.0) -> None:
        self.unit = unit

    def format_ticks(self, values: Iterable[float]) -> list[str]:
        """The numbers of all ticks."""
        values = [float(value) / self.unit for value in values]
        texts = [f"{value:.10g}" for value in values]
        decades = len(values) > 1 and min(values) > 0 and max(values) >= 100 * min(values)
        if decades:
            return [labels.tick(value) for value in values]
        factor = floor(log10(max(map(abs, values)))) if any("e" in text for text in texts) else 0
        texts = [f"{value / 10.0**factor:.10g}" for value in values]
        decimals = max((len(text.partition(".")[2]) for text in texts), default=0)
        texts = [f"{float(text) or 0.0:.{decimals}f}" for text in texts]
        if factor:
            texts = [labels.powers_of_ten(f"{text}e{factor}") if float(text) else "0" for text in texts]
        return [labels.minus_signs(text) for text in texts]

    def __call__(self, value: float, pos: int | None = None) -> str:
        """The number of one tick by itself."""
        return labels.tick(value / self.unit)


@dataclass(frozen=True, eq=False)
class Scale:
    """The scale of one axis. values: (n,) rising, in the unit of the label; edges: of their cells, (n + 1,), from the
    first value to the last."""

    values: Values
    edges: Values
    logarithmic: bool

    def share(self, value: float) -> float:
        """Where a value lies on the axis: 0 at its low end, 1 at its high end."""
        low, at, high = (np.log(v) if self.logarithmic else v for v in (self.edges[0], value, self.edges[-1]))
        return float((at - low) / (high - low))

    def cell(self, share: float) -> int:
        """The index of the value whose cell lies there; on an edge, within rounding, that of the upper cell."""
        shares = [self.share(float(edge)) - EDGE for edge in self.edges[1:-1]]
        return int(np.searchsorted(shares, share, side="right"))

    def apply(self, ax: Axes, which: str) -> None:
        """Give the axis `x` or `y` of a panel this scale."""
        set_scale(ax.xaxis if which == "x" else ax.yaxis, (self.edges[0], self.edges[-1]), self.logarithmic)


def set_scale(axis: XAxis | YAxis, ends: tuple[float, float], logarithmic: bool, spare: float = 0.0) -> None:
    """Give an axis its ends and its scale; spare: the share of it that stays free beyond either end."""
    change, back = (np.log, np.exp) if logarithmic else (np.asarray, np.asarray)
    low, high = change(ends)
    limits = back(np.array([low, high]) + spare * (high - low) * np.array([-1, 1])) if spare else ends
    scale, name = "log" if logarithmic else "linear", axis.axis_name
    axis.axes.set(**{f"{name}scale": scale, f"{name}lim": tuple(limits)})
    axis.set_minor_locator(NullLocator())
    axis.set_major_locator(RoomLocator())
    axis.set_major_formatter(Ticks())


def round_below(value: float) -> float:
    """The largest of 1, 2 and 5 times a power of ten that is not above a positive value."""
    power = 10.0 ** floor(log10(value) + 1e-9)
    return max(digit * power for digit in (1, 2, 5) if digit * power <= value * (1 + 1e-9))


def scale_of(stored: StoredStudy, name: str) -> Scale:
    """The scale of the values of an axis, in any order: from the first to the last, or between its `ends`."""
    axis, logarithmic = stored[name], stored.is_logarithmic(name)
    values = np.sort(labels.in_label_unit(axis, axis.values))
    points = np.log(values) if logarithmic else values
    if points.size == 1:
        edges = points + np.array([-0.5, 0.5]) * (abs(points[0]) or 1.0)
    else:
        between = (points[1:] + points[:-1]) / 2
        ends = labels.in_label_unit(axis, np.asarray(axis.attrs["ends"])) if "ends" in axis.attrs else values[[0, -1]]
        low, high = np.log(ends) if logarithmic else ends
        edges = np.concatenate([[low], between, [high]])
    return Scale(values, np.exp(edges) if logarithmic else edges, logarithmic)
