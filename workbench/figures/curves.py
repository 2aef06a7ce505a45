"""Developed curves as small multiples, in the colours of the push, with rings where a rod passes through itself."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from solver.mechanics import frames
from solver.problem.errors import no_such

from ..data import cautions, labels
from ..geometry.self_intersections import places
from . import canvas, developed, drawn_rods, legend, long_figure, push_scale, style
from .drawn_rods import DrawnRod, DrawnRods
from .scales import Ticks
from .sheet import SCREEN, Sheet

NAMES = ("alpha", "z", "push")
MOST = 60
TALLEST = 1.15, 3.4  # the height of all rows as a share of the width; inches of one row where there are several
GAP, HEAD = 0.14, 0.32  # inches between two curves, and above each
LEFT, BAR = 0.65, 0.95  # inches of the axis of z, and of the bar of colours
LEAST = 0.2  # inches of a curve
ALONE = 0.55  # the height of one curve as a share of the width
ENOUGH = 0.75  # of the largest scale: of two pages at such scales the one with fewer rows is taken
LYING = 1.5  # how many times larger lying curves must be than upright ones
RING = (3.5, 8.0)  # points across at least, in the smallest and in the largest panels
BESIDE = 3.0  # radii on the unrolled cylinder: two places that are nearer have one ring between them
THROUGH = "the rod passes through itself"
TOO_LONG = "is too long to search for the places where it passes through itself"


@dataclass(frozen=True)
class Page:
    """How the curves stand.

    across, rows: their number. cell: size of each in inches. factor: how many times wider than high it is drawn. lying:
    whether z is to the right and rho alpha down.
    """

    across: int
    rows: int
    cell: tuple[float, float]
    factor: float
    lying: bool


def figure(
    ds: xr.Dataset, x: str | None = None, at: Mapping[str, float] | None = None, sheet: Sheet = SCREEN
) -> Figure:
    """Draw the developed curves of the rods along an axis, or of one rod, all at one scale.

    Each point has the colour of the push there, and a ring marks where the rod passes through itself. On the unrolled
    cylinder such a place has two rings where the rod comes back to it after a turn about the axis.

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
    found = drawn_rods.choose(ds, NAMES, x, at, MOST)
    return long_figure.figure(found, sheet) or _small_multiples(found, sheet)


def _small_multiples(found: DrawnRods, sheet: Sheet) -> Figure:
    """The curves of all rods at one scale."""
    lines = {id(rod): rod.developed() for rod in found.solved}
    limits = _limits(list(lines.values()))
    page = _page(len(found.rods), limits, sheet)
    norm = push_scale.scale([rod["push"] for rod in found.solved])
    notes: list[str] = []

    def draw(fig: Figure) -> None:
        grid = fig.add_gridspec(page.rows, page.across)
        axes = [fig.add_subplot(grid[i // page.across, i % page.across]) for i in range(len(found.rods))]
        last = None
        column = (sheet.width - LEFT - BAR * (not sheet.narrow)) / page.across
        named = all(style.width_of(rod.name, style.small()) < column for rod in found.rods)
        for i, (ax, rod) in enumerate(zip(axes, found.rods, strict=True)):
            ax.set_title(
                (rod.name if named else rod.value) if found.axis else "", loc="left", size=style.small(), pad=3
            )
            ax.set_label(rod.name)
            if rod.arrays is not None:
                last = _draw(ax, rod, lines[id(rod)], norm, page)
            else:
                ax.text(0.5, 0.5, "unsolved", transform=ax.transAxes, ha="center", va="center", color=style.SOFT,
                        size=style.small(), rotation=90)  # fmt: skip
            _frame(ax, found, limits, page, i)
            if rod.arrays is not None:
                notes.extend(_ring(ax, rod, lines[id(rod)], page))
        _one_size(axes)
        assert last is not None
        inches = (sheet.width if sheet.narrow else page.rows * (page.cell[1] + HEAD)) - 0.3
        push_scale.bar(fig, last, axes, push_scale.unit(found.source), inches, below=sheet.narrow)
        legend.below(
            fig, _entries(found.solved, axes), [*_said(found, named, page), *found.notes, *dict.fromkeys(notes)], sheet
        )

    tall = max(page.rows * (page.cell[1] + HEAD), 1.2)
    height = tall + 1.1 + 0.7 * sheet.titled + (0.9 if sheet.narrow else 0.0)
    return canvas.figure((sheet.width, height), draw, found.source, sheet=sheet)


def _limits(curves: list[tuple[Any, Any]]) -> tuple[Any, Any]:
    """The range of rho alpha and of z over all curves, with a margin."""
    ranges = [(min(v.min() for v in values), max(v.max() for v in values)) for values in zip(*curves, strict=True)]
    size = max(high - low for low, high in ranges) or 1.0
    margins = [
        max(0.06 * (high - low), 0.02 * size * (high - low <= developed.STRAIGHT * size)) for low, high in ranges
    ]
    found = [(float(low - room), float(high + room)) for (low, high), room in zip(ranges, margins, strict=True)]
    return found[0], found[1]


def _page(count: int, limits: Any, sheet: Sheet) -> Page:
    """The page that shows the curves largest; at one scale where they are not too thin to see."""
    room = sheet.width - LEFT - (0.1 if sheet.narrow else BAR)
    tallest = TALLEST[1] if count > 1 else ALONE * sheet.width
    pages: list[tuple[bool, float, Page]] = []
    for lying in (False, True):
        wide, tall = (high - low for low, high in (limits[::-1] if lying else limits))
        for across in range(1, count + 1):
            rows = ceil(count / across)
            cell = room / across - GAP, min(TALLEST[0] * sheet.width / rows - HEAD, tallest)
            if min(cell) < LEAST:
                continue
            factor = developed.stretch(wide, tall, cell)
            scale = min(cell[0] / (wide * factor), cell[1] / tall)  # inches per length upward
            used = scale * wide * factor, scale * tall
            size = (scale if factor == 1 else min(used)) / (LYING if lying else 1)
            pages.append((factor == 1, size, Page(across, rows, used, factor, lying)))
    at_one_scale = any(plain for plain, _, _ in pages)
    known = [(size, page) for plain, size, page in pages if plain == at_one_scale]
    largest = max(size for size, _ in known)
    return min((page.rows, -size, page.across, page) for size, page in known if size > ENOUGH * largest)[-1]


def _draw(ax: Axes, rod: DrawnRod, curve: tuple[Any, Any], norm: Any, page: Page) -> Any:
    x, y = curve[::-1] if page.lying else curve
    width = float(np.clip(2.2 * min(page.cell) ** 0.5, 1.2, 3.0))
    drawn = push_scale.line(ax, x, y, rod["push"], norm, width, rod.name)
    ax.plot(x[0], y[0], "o", color=style.INK, markersize=1.6 * width, label="s = 0", zorder=4)
    return drawn


def _ring(ax: Axes, rod: DrawnRod, curve: tuple[Any, Any], page: Page) -> list[str]:
    """Ring the places where the rod passes through itself; returns what is to be said where they are not searched."""
    if "overlaps" not in cautions.keys(rod.caution):
        return []
    found = places(rod["s"], frames.position(rod.rho, rod["alpha"], rod["z"]), rod.a)
    if found is None:
        return [f"The rod of {rod.name} {TOO_LONG}."]
    points = 72 * page.cell[0] / float(np.ptp(ax.get_xlim()))  # to the right, for each unit of length
    least = float(np.clip(5 * min(page.cell), *RING))
    rings: list[Any] = []
    sizes: list[float] = []
    for pair in found:
        both = np.array([np.interp(pair, rod["s"], values) for values in (curve[::-1] if page.lying else curve)]).T
        if np.linalg.norm(both[1] - both[0]) < BESIDE * rod.a:
            drawn = points * np.linalg.norm((both[1] - both[0]) * (1, 1 / page.factor))
            rings, sizes = [*rings, both.mean(axis=0)], [*sizes, max(least, float(drawn) + 0.6 * least)]
        else:
            rings, sizes = [*rings, *both], [*sizes, least, least]
    if rings:
        x, y = np.array(rings).T
        ax.scatter(x, y, s=np.square(sizes), facecolors="none", edgecolors=style.CROSSED, linewidths=1.1,
                   label=THROUGH, zorder=5)  # fmt: skip
    return []


def _one_size(axes: list[Axes]) -> None:
    """Give all rings of a figure the size of the largest: size says nothing."""
    rings = [ring for ax in axes for ring in ax.collections if ring.get_label() == THROUGH]
    largest = max((float(ring.get_sizes().max()) for ring in rings), default=0.0)  # type: ignore[attr-defined]
    for ring in rings:
        ring.set_sizes([largest])  # type: ignore[attr-defined]


def _frame(ax: Axes, found: DrawnRods, limits: Any, page: Page, i: int) -> None:
    """The scales of one panel; only those at the edge of the figure have numbers."""
    unit = labels.unit(str(found.source.attrs["length_unit"]))
    names = [f"[{unit}]", f"z [{unit}]"]
    ax.set_xlim(*limits[int(page.lying)])
    ax.set_ylim(*limits[int(not page.lying)][:: -1 if page.lying else 1])
    ax.set_aspect(1 / page.factor, adjustable="box", anchor="NW")
    ax.locator_params(axis="x", nbins=max(int(page.cell[0] / 0.45), 1), steps=[1, 2, 5, 10])
    ax.locator_params(axis="y", nbins=max(int(page.cell[1] / 0.35), 2), steps=[1, 2, 5, 10])
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_formatter(Ticks())
    lowest, leftmost = i + page.across >= len(found.rods), i % page.across == 0
    ax.set_xlabel(names[int(page.lying)], labelpad=1)
    ax.set_ylabel(names[int(not page.lying)], labelpad=1)
    ax.tick_params(length=2, labelbottom=lowest, labelleft=leftmost, pad=2)
    ax.xaxis.label.set_visible(lowest and (leftmost or page.across <= 6))
    ax.yaxis.label.set_visible(leftmost)
    style.with_grid(ax)


def _entries(rods: list[DrawnRod], axes: list[Axes]) -> list[Artist]:
    """The legend: what orange, a ring and a dot are."""
    pulled = any(push_scale.pulls(rod["push"]) for rod in rods)
    said = "the cylinder would have to pull: the rod would lift off"
    orange: list[Artist] = [Line2D([], [], color=push_scale.PULL, linewidth=2.2, label=said)] if pulled else []
    ringed = any(ring.get_label() == THROUGH for ax in axes for ring in ax.collections)
    look = {"linestyle": "none", "marker": "o"}
    ring = Line2D([], [], markersize=7, markerfacecolor="none", color=style.CROSSED, label=THROUGH, **look)  # type: ignore[arg-type]
    start = Line2D([], [], color=style.INK, markersize=4, label="s = 0", **look)  # type: ignore[arg-type]
    return [*orange, *([ring] if ringed else []), start]


def _said(found: DrawnRods, named: bool, page: Page) -> list[str]:
    """What stands above each curve, and at which scale."""
    said = [f"Above each curve its {found.axis_label()}."] if found.axis and not named else []
    said += found.said() if named or not found.axis else []
    wide, tall = ("z", developed.AROUND) if page.lying else (developed.AROUND, "z")
    larger = f"{developed.larger(page.factor, wide)}{developed.larger(1 / page.factor, tall)}"
    ways = f"z to the right, {developed.AROUND} down" if page.lying else f"{developed.AROUND} to the right, z up"
    return [*said, f"Unrolled view, seen from outside: {ways}, at one scale{larger}."]
