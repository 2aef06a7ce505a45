"""The page of a scene: rendered views with title, captions, and what stands below them (`footer`)."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..figures import canvas, style
from . import drawing, footer, measure, pixels
from .arrangement import BELOW, DOT, Arrangement, Box
from .colours import Bar

# pixels at `style.DPI`
MARGIN = 36.0  # around the page
TITLE = 10.0  # from the title to the line below it
AFTER = 30.0  # from there to the views, and from the views to the footer
HEAD, SIDE = 34.0, 16.0  # the height of a line of headings, and the gap between a heading of a row and the row


@dataclass(frozen=True)
class Words:
    """What is written around the views of a scene.

    Attributes
    ----------
    legend
        Colours and their meaning; `footer.RING` for a ring, `footer.OUTLINE` for a hidden stretch.
    columns, rows
        Headings of a table: its quantity, then the values. Default: none.
    radius
        Of the rings.
    """

    title: str
    subtitle: str
    length_unit: str
    legend: Sequence[tuple[str, str]] = ()
    notes: Sequence[str] = ()
    bar: Bar | None = None
    columns: Sequence[str] = ()
    rows: Sequence[str] = ()
    radius: float = drawing.PATCH / 2

    @property
    def heads(self) -> tuple[float, float]:
        """The room of the headings: to the left of the views, and above them."""
        left = max(map(measure.width, self.rows[1:]), default=0.0) + HEAD + 2 * SIDE if self.rows else 0.0
        return left, 2 * HEAD + SIDE if self.columns else 0.0


@dataclass(frozen=True, eq=False)
class Page:
    """What is put together.

    Attributes
    ----------
    pixels
        (height, width, 3 or 4), all views in one picture; without background where there are four channels.
    arrangement
        Where the views are in it, in pixels at `style.DPI`.
    axes
        Where x, y, z point on the page, (3, 2).
    width, height
        Of the page in pixels at `style.DPI`; height 0: as high as its content.
    dpi
        Of the picture; all lengths in pixels grow with it, but `pixels` are taken as they are.
    rings
        Places to be ringed: x and y in the picture, in pixels at `style.DPI` from its upper left.
    marks
        Words beside places, each with x, y and colour.
    bare
        Without words, bars and rings.
    reserved
        The least heights above and below the views: what any frame of a film needs.
    """

    words: Words
    pixels: NDArray[np.uint8]
    arrangement: Arrangement
    axes: NDArray[np.float64]
    width: float
    height: float = 0.0
    dpi: int = style.DPI
    rings: Sequence[tuple[float, float]] = field(default_factory=list)
    marks: Sequence[tuple[float, float, str, str]] = field(default_factory=list)
    bare: bool = False
    reserved: tuple[float, float] = (0.0, 0.0)

    @property
    def notes(self) -> Sequence[str]:
        return self.words.notes

    @property
    def cells(self) -> list[list[Box]]:
        return [list(row) for row in self.arrangement.rows]

    @cached_property
    def head(self) -> tuple[str, str]:
        """Title and subtitle in lines that fit."""
        return fitted(self.words, self.width)

    @cached_property
    def foot(self) -> list[list[drawing.Block]]:
        """The blocks below the views; without views none."""
        if not self.arrangement.rows:
            return []
        along = float(np.hypot(*self.axes[2]))
        return feet(self.words, self.axes, self.arrangement.per_unit, along, self.width)


def fitted(words: Words, width: float) -> tuple[str, str]:
    """Title and subtitle in lines that fit on a page of that width."""
    room = width - 2 * MARGIN
    return measure.wrapped(words.title, room, style.LARGE, bold=True), measure.wrapped(words.subtitle, room)


def feet(
    words: Words, axes: NDArray[np.float64], per_unit: float, along_axis: float, width: float
) -> list[list[drawing.Block]]:
    """The lines below the views on a page of that width."""
    room = width - 2 * MARGIN
    scale = per_unit, words.length_unit, along_axis
    return footer.lines_of(footer.blocks(axes, scale, words.bar, words.legend, words.notes, room, words.radius), room)


def above(words: Words, width: float) -> float:
    """The height of title and subtitle with the gaps around them."""
    title, subtitle = fitted(words, width)
    high = measure.height(title, style.LARGE) + (TITLE + measure.height(subtitle) if subtitle else 0.0)
    return 0.7 * MARGIN + high + AFTER


def below(lines: Sequence[Sequence[drawing.Block]]) -> float:
    """The height of the footer with the gaps around it."""
    return AFTER + footer.height(lines) + 0.7 * MARGIN


def figure(page: Page) -> Figure:
    """The page as a figure of its dpi, in which the pixels of the views are kept."""
    finer = page.dpi / style.DPI
    high, wide = (n / finer for n in page.pixels.shape[:2])
    heads = page.words.heads
    least = np.maximum((above(page.words, page.width), below(page.foot)), page.reserved)
    top, foot = (0.0, 0.0) if page.bare else (float(least[0]), float(least[1]))
    if page.bare:
        heads = 0.0, 0.0
    height = page.height or top + heads[1] + high + foot

    def draw(fig: Figure) -> None:
        if not page.bare:
            _title(fig, page, height)
            footer.draw(fig, page.foot, MARGIN, 0.7 * MARGIN + foot - below(page.foot))
        left = (page.width - wide - heads[0]) / 2 + heads[0]
        bottom = foot + max(height - top - heads[1] - high - foot, 0.0) / 2
        pixels.put(fig, page.pixels, round(left * finer), round(bottom * finer))
        if not page.bare:
            _cells(fig, page, left, bottom + high)
            _headings(fig, page, left, bottom + high)
            for x, y in page.rings:
                drawing.ring(fig, left + x, bottom + high - y, page.words.radius)
            for x, y, text, colour in page.marks:
                drawing.text(fig, left + x, bottom + high - y, text, color=colour, va="center", **drawing.HALO)

    made = canvas.figure((page.width / style.DPI, height / style.DPI), draw, dpi=page.dpi, layout=None)
    if page.pixels.shape[2] == 4:
        made.patch.set_alpha(0.0)
    return made


def _title(fig: Figure, page: Page, height: float) -> None:
    title, subtitle = page.head
    y = height - 0.7 * MARGIN
    drawing.text(fig, MARGIN, y, title, size=style.LARGE, va="top", weight="bold")
    y -= measure.height(title, style.LARGE) + TITLE
    drawing.text(fig, MARGIN, y, subtitle, color=style.SOFT, va="top")


def _cells(fig: Figure, page: Page, left: float, top: float) -> None:
    for row in page.arrangement.rows:
        for box in row:
            cell, middle = box.cell, left + box.x + box.width / 2
            y = top - box.y - box.height - BELOW
            lines = cell.caption.split("\n")
            shift = DOT / 2 if cell.number is not None else 0.0
            drawing.text(fig, middle + shift, y, lines[0], ha="center", va="top")
            for k, line in enumerate(lines[1:], start=1):
                drawing.text(fig, middle, y - measure.step() * k, line, ha="center", va="top")
            if cell.number is not None:
                x = middle + shift - measure.width(lines[0]) / 2 - DOT / 2 - 3
                drawing.dot(fig, x, y - measure.height("1") / 2, str(cell.number), cell.stable)
            if cell.before:
                drawing.text(fig, left + box.x - 8, top - box.y - box.height / 2, cell.before, ha="right", va="center",
                            **drawing.SMALL)  # fmt: skip
            if cell.why_empty:
                reason = measure.wrapped(cell.why_empty, box.width, style.SMALL)
                drawing.text(fig, middle, top - box.y - box.height / 2, reason, color=style.SOFT, ha="center",
                            va="center", **drawing.SMALL)  # fmt: skip


def _headings(fig: Figure, page: Page, left: float, top: float) -> None:
    """The headings of a table: the values above its columns and to the left of its rows, once."""
    boxes, words = page.arrangement.rows, page.words
    if words.columns:
        y, (first, last) = top + SIDE, (boxes[0][0], boxes[0][-1])
        for box, value in zip(boxes[0], words.columns[1:], strict=True):
            drawing.text(fig, left + box.x + box.width / 2, y, value, ha="center", va="bottom")
        middle = left + (first.x + last.x + last.width) / 2
        drawing.text(fig, middle, y + HEAD, words.columns[0], ha="center", va="bottom")
    if words.rows:
        for row, value in zip(boxes, words.rows[1:], strict=True):
            y = top - row[0].y - row[0].height / 2
            drawing.text(fig, left + row[0].x - SIDE, y, value, ha="right", va="center")
        y = top - (boxes[0][0].y + boxes[-1][0].y + boxes[-1][0].height) / 2
        drawing.text(fig, left - words.heads[0] + HEAD / 2, y, words.rows[0], ha="center", va="center", rotation=90)
