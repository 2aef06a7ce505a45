"""The developed curve of a long rod in lines, as text is: z to the right, rho alpha down, both at one scale.

Each line continues the one above it and shows the whole unrolled cylinder, or as much of its width as the rod needs. A
rod that leaves a line below comes back above, as it goes about the axis.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import Affine2D
from numpy.typing import NDArray

from ..data import labels
from ..geometry import lines
from . import developed, push_scale, style
from .scales import Ticks

THINNEST = 0.07  # inches of a line; below, nothing of its curve is seen
TALLEST = 0.5, 2.8  # height of all lines as a share of the width, and inches at least
LABELS = 1.0  # inches beside the lines
ROOM = 0.97  # of the width is for the rod, as its bends at the cuts are not known before
MOST_WIDE = 1.15  # of the width that the rod needs is that of a line

Values = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Curve:
    """The developed curve of one rod: s, z, rho (alpha - alpha(0)) and the push where it is known, (n,) each. rho,
    radius: of the centreline and of all that is seen."""

    s: Values
    z: Values
    across: Values
    push: Values | None
    rho: float
    radius: float


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


def lines_for(curve: Curve, room: tuple[float, float]) -> Lines | None:
    """The lines in which a rod is largest in a room of inches; None where it needs none: in one piece it is no hair."""
    tall, spread = float(np.ptp(curve.z)), float(np.ptp(curve.across))
    if not lines.is_long(tall, curve.radius) or developed.stretch(tall, spread, room) == 1.0:
        return None
    turn = 2 * np.pi * curve.rho
    around = spread > turn
    wide = turn if around else max(MOST_WIDE * spread, 0.25 * turn)
    low = -turn / 2 if around else float(curve.across.min() + curve.across.max() - wide) / 2
    count, scale = lines.largest(tall / ROOM, wide, 0.0, room)
    length = float(curve.s[-1] - curve.s[0])
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


def draw(ax: Axes, curve: Curve, found: Lines, unit: str, dots: bool = False, name: str = "") -> list[str]:
    """Draw a rod in its lines; returns what is to be said of them.

    dots: whether the stations miss bends. name: of the rod, in tables of what is drawn.
    """
    norm = push_scale.scale([curve.push]) if curve.push is not None else None
    starts = curve.s[0] + found.every * np.arange(found.count)
    ends: list[float] = []
    for k, start in enumerate(starts):
        top = k * lines.PITCH * found.wide - found.low
        left = float(np.interp(start, curve.s, curve.z))
        ax.axhspan(top + found.low, top + found.low + found.wide, color=style.BAND, linewidth=0, zorder=0)
        for s, turn in _pieces(curve, found, float(start)):
            z, across = np.interp(s, curve.s, curve.z), np.interp(s, curve.s, curve.across) - turn
            ends += [float(z.min()) - left, float(z.max()) - left]
            _piece(ax, curve, (s, z, across), (left, top), norm, dots, name)
    ax.plot(0, -found.low + curve.across[0], "o", color=style.INK, markersize=4, label="s = 0", zorder=4)
    size = max(ends) - min(ends)
    ax.set_xlim(min(ends) - 0.01 * size, max(ends) + 0.01 * size)
    ax.set_ylim((found.count - 1) * lines.PITCH * found.wide + 1.1 * found.wide, -0.1 * found.wide)
    ax.set_aspect("equal", anchor="NW")
    every = -(-found.count // lines.LABELLED)
    middles = (np.arange(found.count) * lines.PITCH + 0.5) * found.wide
    ax.set_yticks(middles[::every], [labels.number(float(start)) for start in starts[::every]])
    ax.tick_params(axis="y", length=0)
    ax.spines["left"].set_visible(False)
    ax.set_ylabel(f"line from s [{unit}]")
    ax.set_xlabel(f"z from the start of a line [{unit}]; distance around the cylinder down")
    ax.xaxis.set_major_locator(MaxNLocator(nbins=8, steps=[1, 2, 5, 10]))
    ax.xaxis.set_major_formatter(Ticks())
    ax.grid(axis="x", color=style.FAINT, linewidth=0.6)
    ax.set_axisbelow(True)
    return said(found, curve, unit)


def said(found: Lines, curve: Curve, unit: str) -> list[str]:
    """How the lines are read, and which parts are left out."""
    told = [f"{found.count} lines, one after the other, at one scale; each is {labels.number(found.wide)} {unit} wide."]
    if found.every > found.each * (1 + 1e-9):
        size, whole = labels.number(found.each), labels.number(float(np.ptp(curve.s)))
        told = [f"Only {found.count} pieces of {size} {unit} each are shown, spread over {whole} {unit}, at one scale."]
    if found.turn:
        told.append("A line is the whole unrolled cylinder: the rod leaves it below and comes back above.")
    return told


def _pieces(curve: Curve, found: Lines, start: float) -> Iterator[tuple[Values, float]]:
    """The arcs of a line that lie on one turn about the axis, and what is taken off there from rho alpha."""
    stop = min(start + found.each, float(curve.s[-1]))
    s = np.concatenate([[start], curve.s[(curve.s > start) & (curve.s < stop)], [stop]])
    if not found.turn:
        yield s, 0.0
        return
    across = np.interp(s, curve.s, curve.across)
    turns = np.floor((across - found.low) / found.turn)
    cuts = []
    for i in np.flatnonzero(np.diff(turns)):
        between = np.arange(min(turns[i], turns[i + 1]) + 1, max(turns[i], turns[i + 1]) + 1)
        shares = (between * found.turn + found.low - across[i]) / (across[i + 1] - across[i])
        cuts += [float(s[i] + share * (s[i + 1] - s[i])) for share in np.sort(shares)]
    edges = [start, *cuts, stop]
    for a, b in pairwise(edges):
        if b > a:
            middle = np.interp((a + b) / 2, curve.s, curve.across)
            turn = float(np.floor((middle - found.low) / found.turn)) * found.turn
            yield np.concatenate([[a], s[(s > a) & (s < b)], [b]]), turn


def _piece(ax: Axes, curve: Curve, points: Any, offset: tuple[float, float], norm: Any, dots: bool, name: str) -> None:
    """One unbroken piece of a line: its s, z and rho alpha, drawn so much further left and down."""
    s, z, across = points
    where = Affine2D().translate(-offset[0], offset[1]) + ax.transData
    look: dict[str, Any] = {"color": style.PUSHED, "transform": where, "zorder": 3, "label": name or "_rod"}
    if dots:
        ax.plot(z, across, linestyle="none", marker=".", markersize=2.5, **look)
    elif curve.push is not None:
        push = np.interp(s, curve.s, curve.push)
        push_scale.line(ax, z, across, push, norm, 1.6, name, offset[1], 3.0, offset[0])
    else:
        ax.plot(z, across, linewidth=1.6, **look)
