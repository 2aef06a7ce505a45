"""Unrolled views side by side in rows, all at one scale, each below its text; last a key of the directions."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.transforms import Affine2D
from numpy.typing import NDArray

from . import colours, push_scale, style, unrolled
from .scales import round_below
from .sheet import Sheet

LINE, GAP = 1.3 / 72, 0.16  # inches of a line of text per point of its size; between neighbours, and below each row
BESIDE = 0.85  # inches of a page beside them
TALL = 0.7, 0.6  # the height of all shapes over the width of a column and of other pages
NAME = "unrolled views"  # of the axes
KEY = "z", "around"  # its two arrows
LARGEST, SMALLEST, STEP = 8.0, 0.1, 0.97  # inches of the largest curve; from one scale that is tried to the next
NEARLY = 0.6  # of the largest scale is enough for fewer rows
ARROW = 0.5  # inches of the arrows of the key at most
RING = 3.0  # points across

Values = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Shape:
    """An unrolled view.

    x, y: z and the distance around the cylinder, (n,) each [length]. text: above it. look: of its line; or its push and
    the scale of its colours. rings: the places where the rod passes through itself [length].
    """

    x: Values
    y: Values
    text: str
    look: Mapping[str, Any]
    rings: Sequence[Any] = ()

    @property
    def size(self) -> tuple[float, float]:
        """Width and height [length]."""
        return float(np.ptp(self.x)), float(np.ptp(self.y))


@dataclass(frozen=True, eq=False)
class Rows:
    """How shapes stand: inches per length, the left and upper edge of the room of each and of the key, and the size of
    all [inches]; the letters [points]."""

    scale: float
    places: list[tuple[float, float]]
    size: tuple[float, float]
    letters: float


def plan(shapes: Sequence[Shape], sheet: Sheet, tall: tuple[float, float] = TALL) -> Rows:
    """The rows of shapes on a sheet; tall: the height of all over the width of a column, and over that of a page."""
    room = sheet.width - BESIDE, tall[not sheet.narrow] * sheet.width
    return rows(shapes, room, sheet.small)


def rows(shapes: Sequence[Shape], room: tuple[float, float], letters: float) -> Rows:
    """The rows in which shapes are largest, or nearly so in fewer rows, in so many inches to the right and down.

    letters: points of their texts.
    """
    texts = [shape.text for shape in shapes] + ["10 cm"]
    wide = [max(style.width_of(line, letters) for line in text.split("\n")) for text in texts]
    high = max(text.count("\n") + 1 for text in texts) * LINE * letters + GAP
    sizes = [shape.size for shape in shapes]
    scale, best = LARGEST / (max(max(size) for size in sizes) or 1.0), None
    while best is None or scale > NEARLY * best[0]:
        arrow = round_below(ARROW / scale) + 0.1 / scale
        cells = [(max(scale * w, text) + GAP, scale * h + high)
                 for (w, h), text in zip([*sizes, (arrow, arrow)], wide, strict=True)]  # fmt: skip
        breaks = _breaks(cells, room[0] + GAP)
        tall = sum(max(cell[1] for cell in cells[a:b]) for a, b in pairwise(breaks))
        fits = tall <= room[1] and max(cell[0] for cell in cells) <= room[0] + GAP
        if (fits or scale * max(max(size) for size in sizes) < SMALLEST) and (
            best is None or len(breaks) < len(best[1])
        ):
            best = scale, breaks, cells
        scale *= STEP
    scale, breaks, cells = best
    places, top = [], 0.0
    for a, b in pairwise(breaks):
        spare = max(room[0] + GAP - sum(cell[0] for cell in cells[a:b]), 0.0)
        between = min(spare / max(b - a - 1, 1), 3 * GAP)
        lefts = np.cumsum([0.0] + [cell[0] + between for cell in cells[a : b - 1]])
        places += [(float(left), top + high - GAP) for left in lefts]
        top += max(cell[1] for cell in cells[a:b])
    return Rows(scale, places, (room[0], top), letters)


def _breaks(cells: Sequence[tuple[float, float]], width: float) -> list[int]:
    """The first cell of each row, and their number: rows that are low together and filled."""
    best: list[tuple[float, list[int]]] = [(0.0, [0])]
    for end in range(1, len(cells) + 1):
        found = []
        for start in range(end):
            row = cells[start:end]
            spare = 1 - sum(cell[0] for cell in row) / width
            if spare >= 0 or end - start == 1:
                ragged = spare**2 if end < len(cells) else 0.0
                found.append((best[start][0] + max(cell[1] for cell in row) + ragged, [*best[start][1], end]))
        best.append(min(found))
    return best[-1][1]


def draw(ax: Axes, shapes: Sequence[Shape], form: Rows, unit: str) -> Any:
    """Draw shapes and the key, whose arrows have a round length; returns a line in the colours of the push, or None."""
    ax.set(xlim=(0, form.size[0] / form.scale), ylim=(form.size[1] / form.scale, 0), aspect="equal", anchor="NW")
    ax.set_axis_off()
    ax.set_label(NAME)
    drawn = None
    for shape, place in zip(shapes, form.places, strict=False):
        left, top = place[0] / form.scale - shape.x.min(), place[1] / form.scale - shape.y.min()
        where = Affine2D().translate(left, top) + ax.transData
        name = shape.text.partition("\n")[0]
        if "push" in shape.look:
            drawn = push_scale.line(ax, shape.x, shape.y, **shape.look, label=name, shift=top, left=-left)
        else:
            ax.plot(shape.x, shape.y, **shape.look, solid_capstyle="round", transform=where, zorder=3, label=name)
        ax.plot(shape.x[0], shape.y[0], "o", color=colours.INK, markersize=2.8, zorder=4, transform=where,
                label="s = 0")  # fmt: skip
        _write(ax, shape.text, (place[0], place[1]), form)
        if len(shape.rings):
            x, y = np.transpose(shape.rings)
            ax.scatter(x + left, y + top, s=RING**2, facecolors="none", linewidths=0.7, edgecolors=colours.CROSSED,
                       label=unrolled.THROUGH, zorder=5)  # fmt: skip
    for artist in (*ax.lines, *ax.collections):
        artist.set_clip_on(False)
    _draw_key(ax, form, unit)
    return drawn


def _write(ax: Axes, text: str, place: tuple[float, float], form: Rows) -> None:
    ax.annotate(text, (place[0] / form.scale, place[1] / form.scale), (0, 4), textcoords="offset points", va="bottom",
                size=form.letters, linespacing=1.1, annotation_clip=False)  # fmt: skip


def _draw_key(ax: Axes, form: Rows, unit: str) -> None:
    """Two arrows, to the right and down, of one round length, which stands above them."""
    (left, top), length = form.places[-1], round_below(ARROW / form.scale)
    _write(ax, f"{length:g} {unit}", (left, top), form)
    x, y = left / form.scale, top / form.scale
    look: Any = {"arrowstyle": "-|>", "color": colours.SOFT, "linewidth": 0.8, "shrinkA": 0, "shrinkB": 0,
                 "mutation_scale": 6}  # fmt: skip
    for tip, name, offset, beside in (
        ((x + length, y), KEY[0], (3, 0), {"ha": "left", "va": "center"}),
        ((x, y + length), KEY[1], (0, -2), {"ha": "left", "va": "top"}),
    ):
        ax.annotate("", tip, (x, y), arrowprops=look, annotation_clip=False)
        ax.annotate(name, tip, offset, textcoords="offset points", size=form.letters, color=colours.SOFT,
                    annotation_clip=False, ha=beside["ha"], va=beside["va"])  # fmt: skip
