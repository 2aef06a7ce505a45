"""Unrolled views: the cylinder is cut open and laid flat, and the rods lie on it in strips, all at one scale.

z is to the right and the distance around the cylinder down, as one sees it from outside. A rod a thousand times as long
as it is wide is a hair at one scale: one such rod is set in lines (`long_curve`), several have one direction drawn
larger.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import ceil, floor, log10
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import Affine2D

from solver.mechanics import frames
from solver.problem.errors import no_such

from ..geometry import self_contact
from ..words import cautions, labels
from . import canvas, colours, drawn_rods, legend, long_curve, push_scale, style
from .drawn_rods import DrawnRod, DrawnRods
from .scales import Ticks
from .sheet import SCREEN, Sheet

NAMES = ("alpha", "z", "push")
MOST = 60
TALLEST = 0.78  # the height of all strips of a figure as a share of its width
BESIDE, BELOW = 0.65, 0.45  # inches of the labels beside the strips, and below them
BAR = 0.5  # inches of the bar of colours below them
GAP, HEAD = 0.12, 0.2  # inches between two strips side by side, and for the name above each
MARGIN = 0.05  # of the extent around the curves
LEAST = 0.12  # inches of a strip, below which one direction is drawn larger
STRAIGHT = 1e-9  # of the other extent: less is rounding, which no scale shows
SHORT = 0.9  # of the arc: a shorter chord has turned by a right angle or more in between
RING = 3.5, 5.5  # points across at least, in the smallest and in the largest strips
NEAR = 3.0  # radii of the rod on the unrolled cylinder: two places that are nearer have one ring between them
THROUGH = "the rod passes through itself at its true thickness"
TOO_LONG = "is too long to search for the places where it passes through itself"


@dataclass(frozen=True)
class Strips:
    """How the curves stand.

    columns, rows: their number. low, size: where each strip begins, to the right and down, and its extent [length].
    scale: inches per length to the right. factor: how many times larger than that the other direction is drawn.
    """

    columns: int
    rows: int
    low: tuple[float, float]
    size: tuple[float, float]
    scale: float
    factor: float

    @property
    def pitch(self) -> tuple[float, float]:
        """From one strip to the next, to the right and to the row below [length]."""
        return self.size[0] + GAP / self.scale, self.size[1] + HEAD / (self.scale * self.factor)

    @property
    def height(self) -> float:
        """Inches of all strips with their names."""
        return self.rows * self.pitch[1] * self.scale * self.factor

    def shift(self, k: int) -> tuple[float, float]:
        """How far the k-th curve is drawn to the right and down [length]."""
        row, column = divmod(k, self.columns)
        return column * self.pitch[0], row * self.pitch[1]


def strips(rods: Sequence[DrawnRod], room: tuple[float, float]) -> Strips:
    """The strips in which rods are drawn largest in so many inches to the right and down."""
    curves = [rod.plane_points() for rod in rods if rod.arrays is not None]
    ends = [(min(v.min() for v in values), max(v.max() for v in values)) for values in zip(*curves, strict=True)]
    whole = max(high - low for low, high in ends) or 1.0
    spare = [MARGIN * max(high - low, 0.4 * whole * (high - low <= STRAIGHT * whole)) for low, high in ends]
    ends = [(float(low - more), float(high + more)) for (low, high), more in zip(ends, spare, strict=True)]
    (left, right), (low, high) = ends
    wide, tall = right - left, high - low
    best: tuple[Any, Any] = ((False, 0.0), None)
    for columns in range(1, len(rods) + 1):
        rows = ceil(len(rods) / columns)
        cell = room[0] / columns - GAP, room[1] / rows - HEAD
        fits = min(cell) >= LEAST
        cell = max(cell[0], LEAST), max(cell[1], LEAST)
        factor = stretch(wide, tall, cell)
        scale = min(cell[0] / wide, cell[1] / (tall * factor))
        size = fits, round(scale * min(factor, 1.0) * wide, 6)
        if size > best[0]:
            best = size, (columns, rows, (left, low), (wide, tall), scale, factor)
    return Strips(*best[1])


def stretch(wide: float, tall: float, room: tuple[float, float]) -> float:
    """How many times larger than the width the height of a curve is drawn in so many inches: 1, unless it is a hair."""
    if min(wide, tall) <= STRAIGHT * max(wide, tall):
        return 1.0
    across, up = room[0] / wide, room[1] / tall  # inches per length that would fill the room
    if tall * across < LEAST and up > across:
        return _one_digit(up / across)
    if wide * up < LEAST and across > up:
        return 1 / _one_digit(across / up)
    return 1.0


def _one_digit(ratio: float) -> float:
    """The ratio cut to one digit."""
    power = 10.0 ** floor(log10(ratio * (1 + 1e-9)))
    return float(floor(ratio / power * (1 + 1e-9)) * power)


def larger(factor: float, name: str = "") -> str:
    """The end of an axis label where a direction is enlarged: ``, drawn 50 times larger``; else nothing."""
    return f", {name} drawn {factor:g} times larger".replace("  ", " ") if factor > 1 else ""


def has_curve(ds: xr.Dataset) -> bool:
    """Whether the dataset stores what the unrolled view is made of."""
    return all(name in ds.data_vars for name in ("alpha", "z", "rho"))


def is_coarse(rod: DrawnRod) -> bool:
    """Whether the stations of a rod miss a bend: some chord is much shorter than the arc between its ends."""
    x, y = rod.plane_points()
    return bool((np.hypot(np.diff(x), np.diff(y)) < SHORT * np.diff(rod["s"])).any())


def figure(
    ds: xr.Dataset, x: str | None = None, at: Mapping[str, float] | None = None, sheet: Sheet = SCREEN
) -> Figure:
    """Draw the unrolled views of the rods along an axis, or of one rod, in the colours of the push.

    A ring marks where a rod passes through itself. On the unrolled cylinder such a place has two rings where the rod
    comes back to it after a turn about the axis.

    Parameters
    ----------
    ds : xr.Dataset
    x, at
        As `axis` and `at` of `drawn_rods.choose`.
    sheet : Sheet
        What the figure is drawn for; its only panel is called ``curves``.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        As of `drawn_rods.choose`, and for an unknown panel.
    """
    if sheet.panel not in (None, "curves"):
        raise no_such("panel", str(sheet.panel), ["curves"])
    rods = drawn_rods.choose(ds, NAMES, x, at, MOST)
    form = plan(rods, sheet.width, TALLEST * sheet.width)

    def draw_on(fig: Figure) -> None:
        ax = fig.add_subplot()
        coloured, notes = draw(ax, rods, form)
        if coloured is not None:
            push_scale.bar(fig, coloured, [ax], push_scale.unit(rods.source), sheet.width - 0.3, below=True)
        legend.below(fig, ring_entries(ax), [*notes, *rods.said(), *rods.notes], sheet)

    return canvas.figure((sheet.width, form.height + BELOW + BAR + 0.25), draw_on, rods.source, sheet=sheet)


def plan(rods: DrawnRods, width: float, tallest: float) -> "Strips | long_curve.Lines":
    """How rods stand on so many inches: in strips, or one long rod in lines."""
    room = width - BESIDE, tallest
    lines = long_curve.lines_for(rods.solved[0], long_curve.room(width)) if len(rods.rods) == 1 else None
    return lines or strips(rods.rods, room)


def draw(
    ax: Axes, rods: DrawnRods, form: "Strips | long_curve.Lines", coloured: bool = True
) -> tuple[LineCollection | None, list[str]]:
    """Draw the rods; returns a line in the colours of the push, and what is to be said.

    coloured: whether the lines have the colours of the push.
    """
    unit = labels.unit(str(rods.source.attrs["length_unit"]))
    if isinstance(form, long_curve.Lines):
        return long_curve.draw(ax, rods.rods[0], form, unit, is_coarse(rods.rods[0]), coloured)
    norm = push_scale.scale([rod["push"] for rod in rods.solved]) if coloured else None
    narrowest = min(float(np.ptp(rod.plane_points()[1])) for rod in rods.solved) * form.scale * form.factor
    width = float(np.clip((2.0 if coloured else 1.4) * narrowest**0.5, 0.8, 2.0 if coloured else 1.2))
    last, notes, rings = None, list[str](), list[Any]()
    column = form.pitch[0] * form.scale
    named = all(style.width_of(rod.name, style.small()) < 0.85 * column for rod in rods.rods)
    for k, rod in enumerate(rods.rods):
        right, up = form.shift(k)
        corner = form.low[0] + right, form.low[1] + up
        ax.add_patch(Rectangle(corner, *form.size, facecolor=colours.BAND, linewidth=0, zorder=0))
        if rods.axis:
            ax.annotate(rod.name if named else rod.value, corner, (0, 2), textcoords="offset points",
                        va="bottom", size=style.small())  # fmt: skip
        if rod.arrays is None:
            middle = corner[0] + form.size[0] / 2, corner[1] + form.size[1] / 2
            ax.text(*middle, "unsolved", ha="center", va="center", color=colours.SOFT, size=style.small())
            continue
        last = _draw_curve(ax, rod, form, (right, up), norm, width) or last
        if coloured:
            found, sentence = _rings(rod, form)
            rings += [((x + right, y + up), size) for (x, y), size in found]
            notes += sentence
    if rings:  # of one size, which says nothing
        across = max(size for _, size in rings)
        x, y = np.transpose([place for place, _ in rings])
        ax.scatter(x, y, s=across**2, facecolors="none", linewidths=0.8,
                   edgecolors=colours.CROSSED, label=THROUGH, zorder=5)  # fmt: skip
    _frame(ax, rods, form, unit)
    coarse = [f"Dots: {rods.source.sizes['u']} stations miss bends."] if any(map(is_coarse, rods.solved)) else []
    above = [f"Above each curve its {rods.axis_label()}."] if rods.axis and not named else []
    return last, [_said(form), *above, *coarse, *dict.fromkeys(notes)]


def _draw_curve(
    ax: Axes, rod: DrawnRod, form: Strips, shift: tuple[float, float], norm: Any, width: float
) -> LineCollection | None:
    """One curve and its start; a line where the stations are close enough, else dots."""
    x, y = rod.plane_points()
    where = Affine2D().translate(*shift) + ax.transData
    ax.plot(x[0], y[0], "o", color=colours.INK, markersize=3.5, label="s = 0", zorder=4, transform=where)
    if is_coarse(rod):
        ax.plot(x, y, ".", color=colours.DATA, markersize=3, transform=where, label=rod.name, zorder=3)
    elif norm is None:
        ax.plot(x, y, color=colours.DATA, linewidth=width, transform=where, label=rod.name, zorder=3)
    else:
        return push_scale.line(ax, x, y, rod["push"], norm, width, rod.name, shift[1], 3.0, -shift[0])
    return None


def _rings(rod: DrawnRod, form: Strips) -> tuple[list[Any], list[str]]:
    """The places where a rod passes through itself with points across, or a sentence where they are not searched."""
    if "overlaps" not in cautions.keys(rod.caution):
        return [], []
    found = crossings(rod["s"], rod.rho, rod["alpha"], rod["z"], rod.a)
    if found is None:
        return [], [f"The rod of {rod.name} {TOO_LONG}."]
    least = float(np.clip(5 * min(form.size[0] * form.scale, form.size[1] * form.scale * form.factor), *RING))
    across = 72 * form.scale
    return [
        (place, max(across * float(np.linalg.norm(apart * (1, form.factor))) + least / 2, least))
        for place, apart in found
    ], []


def crossings(s: Any, rho: float, alpha: Any, z: Any, a: float) -> list[tuple[Any, Any]] | None:
    """Where a rod passes through itself on the unrolled cylinder: z and distance around, and how far its two stretches
    are apart there, (2,) each; two places where it comes back after a turn. None for a rod that is too long."""
    pairs = self_contact.places(s, frames.position(rho, alpha, z), a)
    if pairs is None:
        return None
    found: list[tuple[Any, Any]] = []
    for pair in pairs:
        both = np.array([np.interp(pair, s, values) for values in (z, rho * (alpha - alpha[0]))]).T
        near = np.linalg.norm(both[1] - both[0]) < NEAR * a
        found += [(both.mean(axis=0), both[1] - both[0])] if near else [(one, np.zeros(2)) for one in both]
    return found


def _frame(ax: Axes, rods: DrawnRods, form: Strips, unit: str) -> None:
    """The limits, and round numbers along each strip at the edge of the figure."""
    columns = min(form.columns, len(rods.rods))
    ends = form.low[0], form.low[0] + (columns - 1) * form.pitch[0] + form.size[0]
    down = form.low[1] + (form.rows - 1) * form.pitch[1] + form.size[1], form.low[1] - HEAD / (form.scale * form.factor)
    ax.set(xlim=ends, ylim=down, aspect=form.factor, anchor="NW")
    for axis, low, size, pitch, count, scale in (
        (ax.xaxis, form.low[0], form.size[0], form.pitch[0], columns, form.scale),
        (ax.yaxis, form.low[1], form.size[1], form.pitch[1], form.rows, form.scale * form.factor),
    ):
        most = max(min(int(size * scale / (0.5 if axis is ax.xaxis else 0.35)), 8), 1)
        ticks: list[float] = []
        while len(ticks) < 2 and most < 12:
            most, ticks = most + 1, [t for t in MaxNLocator(most, steps=[1, 2, 5, 10], min_n_ticks=1).tick_values(
                low, low + size) if low <= t <= low + size]  # fmt: skip
        if size * scale < 0.3:
            ticks = [t for t in ticks if t == 0]
        every, full = 1, count
        if axis is ax.xaxis:
            full = len(rods.rods) - (form.rows - 1) * columns  # have a strip at the edge
            wide = max((style.width_of(text, style.small()) for text in Ticks().format_ticks(ticks)), default=0.0) + 0.1
            if wide * len(ticks) > pitch * scale:
                ticks = sorted(ticks, key=abs)[:1]
            every = ceil(wide * len(ticks) / (pitch * scale))
        texts = Ticks().format_ticks(ticks)
        shown = range(0, full, every)
        axis.set_ticks([t + k * pitch for k in shown for t in ticks], texts * len(shown))
        others = [
            (t + k * pitch, text) for k in range(full, count, every) for t, text in zip(ticks, texts, strict=True)
        ]
        for place, text in others:
            ax.annotate(text, (place, down[0] - form.pitch[1]), (0, -2), textcoords="offset points", ha="center",
                        va="top", size=style.small(), color=colours.SOFT)  # fmt: skip
    ax.tick_params(length=0, pad=2)
    ax.spines[:].set_visible(False)
    _label_columns(ax, form, columns, len(rods.rods), f"z [{unit}]{larger(1 / form.factor)}")
    brief = f", ×{form.factor:g}" if form.factor > 1 else ""
    words = [
        f"{style.AROUND} [{unit}]{larger(form.factor)}",
        *(f"{word} [{unit}]{brief}" for word in (style.AROUND, "around")),
    ]
    ax.set_ylabel(style.shorter(words, form.height - HEAD), labelpad=1)


def _label_columns(ax: Axes, form: Strips, columns: int, count: int, text: str) -> None:
    """The label of the axis to the right below each column, below its lowest strip of so many; where it has room."""
    room = form.pitch[0] * form.scale > style.width_of(text, style.normal())
    middle = form.low[0] + form.size[0] / 2
    ends = ax.get_xlim()
    ax.set_xlabel(text, labelpad=3, x=(middle - ends[0]) / (ends[1] - ends[0]) if room else 0.5)
    for k in range(1, columns if room else 1):
        rows = (count - 1 - k) // columns + 1
        foot = form.low[1] + form.size[1] + (rows - 1) * form.pitch[1]
        ax.annotate(text, (middle + k * form.pitch[0], foot), (0, -4 - style.small() * 1.15), va="top", ha="center",
                    textcoords="offset points", size=style.normal(), annotation_clip=False)  # fmt: skip


def _said(form: Strips) -> str:
    """How the views are read."""
    scale = f"{'all ' if form.rows * form.columns > 1 else ''}at one scale" if form.factor == 1 else "at two scales"
    return f"Unrolled view, seen from outside: {style.WAYS}, {scale}; dot: s = 0."


def inset(
    ax: Axes, box: Sequence[float], x: Any, y: Any, extent: tuple[float, float], factor: float = 1.0, **look: Any
) -> None:
    """Draw one view in the middle of a box inside axes, with a white edge.

    box: left, low, width and height in shares of the axes. x, y: as of `DrawnRod.plane_points`. extent: the lengths to
    the right and down for which there is room. factor: as of `Strips`.
    """
    view = ax.inset_axes((box[0], box[1], box[2], box[3]), zorder=6)
    edge = [withStroke(linewidth=2.6, foreground="white", alpha=0.8)]
    view.plot(x, y, color=colours.INK, clip_on=False, **{"linewidth": 1.1, "path_effects": edge, **look})
    view.plot(x[0], y[0], "o", color=colours.INK, markersize=2.4, clip_on=False)
    for set_ends, values, size in ((view.set_xlim, x, extent[0]), (view.set_ylim, y, -extent[1])):
        middle, half = (values.min() + values.max()) / 2, 0.5 * size or 0.5
        set_ends(middle - half, middle + half)
    view.set_aspect(factor, adjustable="box")
    view.set_axis_off()


def entries(ax: Axes, rods: DrawnRods) -> list[Artist]:
    """The legend: what orange and a ring are."""
    pulled = any(push_scale.pulls(rod["push"]) for rod in rods.solved if "push" in (rod.arrays or {}))
    orange: list[Artist] = (
        [Line2D([], [], color=colours.PULLED, linewidth=2.2, label=push_scale.PULLS)] if pulled else []
    )
    return [*orange, *ring_entries(ax)]


def ring_entries(ax: Axes) -> list[Artist]:
    """The legend of a ring, where there is one."""
    ring = Line2D([], [], markersize=7, markerfacecolor="none", color=colours.CROSSED, label=THROUGH, linestyle="none",
                  marker="o")  # fmt: skip
    return [ring] if any(collection.get_label() == THROUGH for collection in ax.collections) else []
