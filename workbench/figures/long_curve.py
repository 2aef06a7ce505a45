"""The unrolled view of a long rod in lines, as text is: z to the right, rho alpha down, both at one scale.

Each line continues the one above it and shows the whole unrolled cylinder, or as much of its width as the rod needs. A
rod that leaves a line below comes back above, as it goes about the axis.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.transforms import Affine2D
from numpy.typing import NDArray

from ..geometry import lines
from ..words import cautions, labels
from . import colours, fonts, push_scale
from .drawn_rods import DrawnRod

THINNEST = 0.07  # inches of a line; below, nothing of its curve is seen
TALLEST = 0.5, 2.8  # height of all lines as a share of the width, and inches at least
LABELS = 1.0  # inches beside the lines
HAIR = 0.3  # inches: a rod less wide is a hair
ROOM = 0.97  # of the width is for the rod, as its bends at the cuts are not known before
MOST_WIDE = 1.15  # of the width that the rod needs is that of a line

Values = NDArray[np.float64]


@dataclass(frozen=True)
class Lines:
    """The lines of a curve.

    count: their number. each: the arc on each [length]. every: the arc from the start of one to that of the next. wide:
    the width of a line [length]. low: rho alpha at its upper edge. turn: what is taken off at each turn about the axis,
    0 where the rod stays in a line. scale: inches per length.
    """

    count: int
    each: float
    every: float
    wide: float
    low: float
    turn: float
    scale: float

    @property
    def height(self) -> float:
        """Inches of all lines."""
        return self.count * lines.PITCH * self.wide * self.scale


def lines_for(rod: DrawnRod, room: tuple[float, float]) -> Lines | None:
    """The lines in which a rod is largest in a room of inches; None where it needs none: in one piece it is no hair."""
    z, across = rod.plane_points()
    s, tall, spread = rod["s"], float(np.ptp(z)), float(np.ptp(across))
    if not lines.is_long(tall, rod.rho + rod.a) or spread * room[0] >= HAIR * tall:
        return None
    turn = 2 * np.pi * rod.rho
    around = spread > turn
    wide = turn if around else max(MOST_WIDE * spread, 0.25 * turn)
    low = -turn / 2 if around else float(across.min() + across.max() - wide) / 2
    count, scale = lines.largest(tall / ROOM, wide, 0.0, room)
    length = float(s[-1] - s[0])
    if scale * wide >= THINNEST:
        each = every = length / count
    else:
        count, scale = max(int(room[1] / (lines.PITCH * THINNEST)), 1), THINNEST / wide
        each = min(ROOM * room[0] / scale * length / tall, length / count)
        every = (length - each) / max(count - 1, 1)
    return Lines(count, each, every, wide, low, turn * around, scale)


def room(width: float) -> tuple[float, float]:
    """Inches for the lines on a figure of that width."""
    return width - LABELS, max(TALLEST[0] * width, TALLEST[1])


def draw(
    ax: Axes, rod: DrawnRod, found: Lines, unit: str, dots: bool = False, coloured: bool = True
) -> tuple[LineCollection | None, list[str]]:
    """Draw a rod in its lines; returns a line in the colours of the push, and what is to be said of the lines.

    dots: whether the stations miss bends. coloured: whether the lines have the colours of the push.
    """
    norm = push_scale.scale([rod["push"]]) if coloured and not dots else None
    s, (z, across) = rod["s"], rod.plane_points()
    starts = s[0] + found.every * np.arange(found.count)
    ends: list[float] = []
    last: LineCollection | None = None
    for k, start in enumerate(starts):
        top = k * lines.PITCH * found.wide - found.low
        left = float(np.interp(start, s, z))
        ax.axhspan(top + found.low, top + found.low + found.wide, color=colours.BAND, linewidth=0, zorder=0)
        for places, turn in _pieces(s, across, found, float(start)):
            x, y = np.interp(places, s, z), np.interp(places, s, across) - turn
            where = Affine2D().translate(-left, top) + ax.transData
            ends += [float(x.min()) - left, float(x.max()) - left]
            if norm is not None:
                push = np.interp(places, s, rod["push"])
                last = push_scale.line(ax, x, y, push, norm, 1.6, rod.name, where, 3.0)
            else:
                look: dict[str, Any] = {"linestyle": "none", "marker": ".", "markersize": 2.5} if dots else {}
                ax.plot(x, y, color=colours.DATA, transform=where, zorder=3, label=rod.name, **look)
    ax.plot(0, -found.low + across[0], "o", color=colours.INK, markersize=4, label="s = 0", zorder=4)
    size = max(ends) - min(ends)
    ax.set_xlim(min(ends) - 0.01 * size, max(ends) + 0.01 * size)
    ax.set_ylim((found.count - 1) * lines.PITCH * found.wide + 1.1 * found.wide, -0.1 * found.wide)
    ax.set_aspect("equal", anchor="NW")
    every = -(-found.count // lines.LABELLED)
    middles = (np.arange(found.count) * lines.PITCH + 0.5) * found.wide
    ax.set_yticks(middles[::every], [labels.number(float(start)) for start in starts[::every]])
    ax.tick_params(length=2, pad=2)
    ax.tick_params(axis="y", length=0)
    ax.spines[:].set_visible(False)
    ax.set_ylabel(f"line from s [{unit}]")
    ax.set_xlabel(f"z from the start of a line [{unit}]")
    return last, said(found, s, unit, "overlaps" in cautions.keys(rod.caution))


def said(found: Lines, s: Values, unit: str, overlaps: bool = False) -> list[str]:
    """How the lines are read, and which parts are left out; overlaps: whether the rod passes through itself."""
    told = [f"{found.count} lines, one after the other, at one scale; each is {labels.number(found.wide)} {unit} wide."]
    if found.every > found.each * (1 + 1e-9):
        size, whole = labels.number(found.each), labels.number(float(np.ptp(s)))
        told = [f"Only {found.count} pieces of {size} {unit} each are shown, spread over {whole} {unit}, at one scale."]
    told = [f"Unrolled view, seen from outside: {fonts.WAYS}; dot: s = 0.", *told]
    if found.turn:
        told.append("A line is the whole unrolled cylinder: the rod leaves it below and comes back above.")
    if overlaps:
        told.append("The rod passes through itself; the places are not marked in lines.")
    return told


def _pieces(s_of: Values, across_of: Values, found: Lines, start: float) -> Iterator[tuple[Values, float]]:
    """The arcs of a line that lie on one turn about the axis, and what is taken off there from rho alpha."""
    stop = min(start + found.each, float(s_of[-1]))
    s = np.concatenate([[start], s_of[(s_of > start) & (s_of < stop)], [stop]])
    if not found.turn:
        yield s, 0.0
        return
    across = np.interp(s, s_of, across_of)
    turns = np.floor((across - found.low) / found.turn)
    cuts = []
    for i in np.flatnonzero(np.diff(turns)):
        between = np.arange(min(turns[i], turns[i + 1]) + 1, max(turns[i], turns[i + 1]) + 1)
        shares = (between * found.turn + found.low - across[i]) / (across[i + 1] - across[i])
        cuts += [float(s[i] + share * (s[i + 1] - s[i])) for share in np.sort(shares)]
    for a, b in pairwise([start, *cuts, stop]):
        if b > a:
            middle = np.interp((a + b) / 2, s_of, across_of)
            turn = float(np.floor((middle - found.low) / found.turn)) * found.turn
            yield np.concatenate([[a], s[(s > a) & (s < b)], [b]]), turn
