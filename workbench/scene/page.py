"""The page of a scene: a Matplotlib figure, and in it the rendered picture, pixel by pixel, among words and bars.

Lengths are in inches from the lower left of the page.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from ..figures import canvas, colours, legend, style
from ..figures.colours import SURFACE
from ..figures.scales import round_below
from ..store import atomic
from ..words import labels
from .captions import Cell
from .paint import Bar
from .views import BELOW, DOT, Arrangement

Pixels = NDArray[np.uint8]

MARGIN, LOW = canvas.MARGIN, 0.12  # around the page, and below the line at its foot
HEAD = 0.17  # the height of a line of headings
FOOT, APART = 0.42, 0.22  # the height of glyph and bars, and the gap after each
GLYPH, WEIGHT, SCALE, BAR = 0.62, 0.5, 1.0, 1.6  # widths: the glyph, the longest scale bar, the colour bar
RING, OUTLINE = "ring", "outline"  # in place of a colour: an open circle, the outline of a hidden stretch
QUALITY = 92  # of JPEG
RUNS = 3  # the strategy of zlib that looks for runs alone: at level 1 the size of level 3 in two thirds of the time


@dataclass(frozen=True, eq=False)
class Words:
    """What is written around the views of a scene.

    Attributes
    ----------
    legend
        Colours and their meaning; `RING` for a ring, `OUTLINE` for a hidden stretch.
    columns, rows
        Headings of a table: its quantity, then the values. Default: none.
    toward
        The direction to the viewer, (3,), where one view shows it; default: no glyph.
    along
        The share of a length along the axis that is seen.
    down
        The direction of the weight on the page, (2,); default: no arrow.
    """

    title: str
    subtitle: str
    unit: str
    legend: Sequence[tuple[str, str]] = ()
    notes: Sequence[str] = ()
    bar: Bar | None = None
    columns: Sequence[str] = ()
    rows: Sequence[str] = ()
    toward: NDArray[np.float64] | None = None
    along: float = 1.0
    down: NDArray[np.float64] | None = None

    @property
    def heads(self) -> tuple[float, float]:
        """The room of the headings: to the left of the views, and above them."""
        left = max((style.width_of(row, style.NORMAL) for row in self.rows[1:]), default=0.0) + 2 * HEAD
        return (left if self.rows else 0.0), (2 * HEAD if self.columns else 0.0)

    @property
    def left(self) -> float:
        """Where the legend begins, beside the glyph, the scale and the bar of colours."""
        widths = [GLYPH] * (self.toward is not None) + [WEIGHT] * (self.down is not None) + [SCALE]
        return MARGIN + sum(wide + APART for wide in widths) + (BAR + 1.4 * APART if self.bar else 0.0)

    def write(self, fig: Figure) -> tuple[float, float]:
        """Write title, legend and notes on a figure; returns the heights of what stands above and below the views."""
        above = canvas.write_title(fig, self.title, self.subtitle)
        key = legend.below(fig, [_handle(*entry) for entry in self.legend], self.notes, left=self.left)
        high = FOOT
        if key is not None:
            shown: Any = fig.canvas
            high = max(FOOT, key.get_window_extent(shown.get_renderer()).height / fig.dpi)
            key.set_bbox_to_anchor((self.left, LOW + high / 2), fig.dpi_scale_trans)
        return above, canvas.AFTER + high + LOW

    def heights(self, width: float) -> tuple[float, float]:
        """The same heights on a page of that width, which is not kept."""
        found: list[tuple[float, float]] = []
        canvas.figure((width, 1.0), lambda fig: found.append(self.write(fig)), layout=None)
        return found[0]


@dataclass(frozen=True, eq=False)
class Page:
    """What is put together: a figure without its background where `pixels` have four channels.

    Attributes
    ----------
    pixels
        All views in one picture, (height, width, 3 or 4).
    arrangement
        Where the views are in it.
    width, height
        Of the page; height 0: as high as its content.
    dpi
        Pixels per inch.
    rings
        Places to be ringed, x and y in the picture from its upper left, and their radius.
    bare
        Without words, bars and rings.
    """

    words: Words
    pixels: Pixels
    arrangement: Arrangement
    width: float
    height: float = 0.0
    dpi: int = style.DPI
    rings: Sequence[tuple[float, float, float]] = ()
    bare: bool = False

    @property
    def size(self) -> tuple[float, float]:
        """Width and height of the rendered picture."""
        high, wide = (n / self.dpi for n in self.pixels.shape[:2])
        return wide, high

    @cached_property
    def room(self) -> tuple[float, float, float, float]:
        """The room to the left of the picture, above, and below it, and the height of the page."""
        left, top, foot = 0.0, 0.0, 0.0
        if not self.bare:
            left, over = self.words.heads
            above, foot = self.words.heights(self.width)
            top = above + over
        return left, top, foot, self.height or top + self.size[1] + foot

    @property
    def corner(self) -> NDArray[np.float64]:
        """The lower left corner of the picture, between two pixels."""
        (wide, high), (left, top, foot, whole) = self.size, self.room
        corner = np.array([(self.width - wide - left) / 2 + left, foot + (whole - top - high - foot) / 2])
        return np.round(np.maximum(corner, 0.0) * self.dpi) / self.dpi

    @property
    def places(self) -> list[list[float]]:
        """Left, top, right and bottom of each cell with words, in order, as shares of the page from its upper left."""
        whole, (left, low) = self.room[3], self.corner
        top, by = whole - low - self.size[1], np.array([self.width, whole] * 2)
        boxes = [box for row in self.arrangement.rows for box in row if box.cell != Cell()]
        each = [(left + box.x, top + box.y, left + box.x + box.width, top + box.y + box.height) for box in boxes]
        return [[round(float(share), 5) for share in np.array(edges) / by] for edges in each]


def figure(page: Page) -> Figure:
    """The page as a figure of its dpi, in which the pixels of the views are kept."""
    whole, corner, high = page.room[3], page.corner, page.size[1]

    def draw(fig: Figure) -> None:
        place_picture(fig, page.pixels, *(corner * page.dpi).round().astype(int))
        if page.bare:
            return
        ax = fig.add_axes((0.0, 0.0, 1.0, 1.0))
        ax.set(xlim=(0, page.width), ylim=(0, whole))
        ax.axis("off")
        _draw_foot(fig, ax, page, page.words.write(fig)[1])
        _draw_cells(ax, page, corner[0], corner[1] + high)
        _draw_headings(ax, page, corner[0], corner[1] + high)
        for x, y, radius in page.rings:
            _draw_ring(ax, corner[0] + x, corner[1] + high - y, radius)

    made = canvas.figure((page.width, whole), draw, dpi=page.dpi, layout=None)
    if page.pixels.shape[2] == 4:
        made.patch.set_alpha(0.0)
    return made


def place_picture(fig: Figure, pixels: Pixels, x: int, y: int) -> None:
    """Put a picture, (height, width, 3 or 4), on a figure; x, y: its lower left in pixels of the figure."""
    fig.figimage(pixels, x, y, origin="upper", zorder=-1)


def _draw_cells(ax: Axes, page: Page, left: float, top: float) -> None:
    """The words below, beside and in place of the views."""
    for box in (box for row in page.arrangement.rows for box in row):
        cell, middle, foot = box.cell, left + box.x + box.width / 2, top - box.y - box.height - BELOW
        dot = DOT / 2 if cell.number is not None else 0.0
        for k, line in enumerate(cell.caption.split("\n")):
            ax.text(middle + dot * (k == 0), foot - k * style.NORMAL * style.LINE, line, ha="center", va="top")
        if cell.number is not None:
            x = middle + dot - style.width_of(cell.caption.split("\n")[0], style.NORMAL) / 2 - DOT / 2
            y = foot - style.NORMAL / 72 / 2
            ax.add_patch(Circle((x, y), 0.075, edgecolor=colours.INK, linewidth=0.9,
                                facecolor=colours.INK if cell.stable else "white"))  # fmt: skip
            ax.text(x, y, str(cell.number), ha="center", va="center_baseline", size=style.SMALL * (0.9 if
                    cell.number < 10 else 0.75), color="white" if cell.stable else colours.INK)  # fmt: skip
        if cell.before:
            ax.text(left + box.x - 0.04, top - box.y - box.height / 2, cell.before, ha="right", va="center",
                    size=style.SMALL)  # fmt: skip
        if cell.why_empty:
            ax.text(middle, top - box.y - box.height / 2, style.break_lines(cell.why_empty, box.width, style.SMALL),
                    color=colours.SOFT, ha="center", va="center", size=style.SMALL)  # fmt: skip


def _draw_headings(ax: Axes, page: Page, left: float, top: float) -> None:
    """The headings of a table: the values above its columns and to the left of its rows, once."""
    boxes, words = page.arrangement.rows, page.words
    if words.columns:
        for box, value in zip(boxes[0], words.columns[1:], strict=True):
            ax.text(left + box.x + box.width / 2, top + 0.05, value, ha="center", va="bottom")
        middle = (boxes[0][0].x + boxes[0][-1].x + boxes[0][-1].width) / 2
        ax.text(left + middle, top + HEAD + 0.05, words.columns[0], ha="center", va="bottom")
    if words.rows:
        for row, value in zip(boxes, words.rows[1:], strict=True):
            ax.text(left + row[0].x - 0.08, top - row[0].y - row[0].height / 2, value, ha="right", va="center")
        y = top - (boxes[0][0].y + boxes[-1][0].y + boxes[-1][0].height) / 2
        ax.text(left - words.heads[0] + HEAD / 2, y, words.rows[0], ha="center", va="center", rotation=90)


def _draw_foot(fig: Figure, ax: Axes, page: Page, high: float) -> None:
    """From where it is seen, the scale bar and the colour bar, beside the legend; high: all of it with its edges."""
    words, x, middle = page.words, MARGIN, (high - canvas.AFTER + LOW) / 2
    if not page.arrangement.rows:
        return
    if words.toward is not None:
        _draw_glyph(ax, x, middle, words.toward)
        x += GLYPH + APART
    if words.down is not None:
        draw_weight(ax, x, middle, words.down)
        x += WEIGHT + APART
    _draw_scale(ax, x, middle, page.arrangement.per_unit * words.along, words.unit, words.along)
    x += SCALE + APART
    if words.bar:
        draw_bar(fig, words.bar, (x, middle - 0.06), (BAR, 0.1))


def _handle(colour: str, text: str) -> Artist:
    """What stands beside a text in the legend."""
    if colour == RING:
        return Line2D(
            [], [], color=colours.INK, marker="o", markersize=7, fillstyle="none", linestyle="none", label=text
        )
    face, edge = (SURFACE, colours.SOFT) if colour == OUTLINE else (colour, "none")
    return Patch(facecolor=face, edgecolor=edge, label=text)


def _draw_ring(ax: Axes, x: float, y: float, radius: float) -> None:
    """An open circle in ink with a white edge, seen on every colour."""
    for colour, wide in (("white", 2.2), (colours.INK, 1.0)):
        ax.add_patch(Circle((x, y), radius, fill=False, edgecolor=colour, linewidth=wide, zorder=3))


def _draw_scale(ax: Axes, x: float, y: float, per_unit: float, unit: str, along: float) -> None:
    """A bar of a round length; where the axis is seen at a slant, of a length along it. per_unit: inches."""
    length = round_below(SCALE / per_unit)
    wide = length * per_unit
    ax.errorbar(x + wide / 2, y, xerr=wide / 2, color=colours.INK, linewidth=1.2, capsize=2.5, capthick=1.2)
    ax.text(x + wide / 2, y + 0.06, f"{labels.number(length)} {unit}", ha="center", va="bottom", size=style.SMALL)
    if along < 1 - 1e-9:
        ax.text(x, y - 0.06, "along the axis", va="top", size=style.SMALL, color=colours.SOFT)


def _draw_glyph(ax: Axes, x: float, y: float, toward: NDArray[np.float64]) -> None:
    """The cylinder seen along its axis, where alpha = 0, and an eye where the viewer is."""
    middle, radius = np.array([x + GLYPH / 2, y]), 0.13
    ax.add_patch(Circle(tuple(middle), radius, facecolor=SURFACE, edgecolor=colours.SOFT, linewidth=0.8))
    ax.plot([middle[0], middle[0] + radius], [y, y], color=colours.SOFT, linewidth=0.8)
    way = np.asarray(toward[:2]) / max(float(np.hypot(*toward[:2])), 1e-9)
    eye, across = middle + 1.75 * radius * way, np.array([-way[1], way[0]])
    t = np.linspace(-1, 1, 31)[:, None]
    lid = 0.022 * (1 - t**2) * way
    for side in (1, -1):
        ax.plot(*(eye + 0.06 * t * across + side * lid).T, color=colours.INK, linewidth=0.9)
    ax.add_patch(Circle(tuple(eye), 0.014, facecolor=colours.INK, linewidth=0))
    if way[0] < 0.8:
        ax.text(middle[0] + radius + 0.03, y, "α = 0", size=0.75 * style.SMALL, color=colours.SOFT, va="center")


def draw_weight(ax: Axes, x: float, y: float, down: NDArray[np.float64]) -> None:
    """An arrow along the weight of the rods."""
    way = 0.17 * np.asarray(down) / max(float(np.hypot(*down)), 1e-9)
    middle = np.array([x + 0.14, y])
    ax.annotate(
        "",
        tuple(middle + way),
        tuple(middle - way),
        arrowprops={"arrowstyle": "-|>", "color": colours.INK, "lw": 1.0, "shrinkA": 0, "shrinkB": 0},
    )
    ax.text(x + 0.3, y, "weight", size=0.75 * style.SMALL, color=colours.SOFT, va="center")


def draw_bar(fig: Figure, bar: Bar, corner: tuple[float, float], size: tuple[float, float]) -> None:
    """A colour bar with a few round values below and its quantity above; corner and size in inches."""
    wide, whole = fig.get_size_inches()
    ax = fig.add_axes((corner[0] / wide, corner[1] / whole, size[0] / wide, size[1] / whole))
    scale = ScalarMappable(Normalize(bar.paint.low, bar.paint.high), bar.paint.ramp)
    legend.colour_bar(fig, scale, cax=ax, orientation="horizontal", ticks=MaxNLocator(4, steps=[1, 2, 2.5, 5, 10]))
    ax.set_xlim(bar.low, bar.high)
    ax.xaxis.set_major_formatter(lambda value, _: labels.minus_signs(labels.number(value)))
    ax.tick_params(labelcolor=colours.INK, pad=1)
    ax.set_title(bar.label, size=style.SMALL, loc="left", pad=2)


def pixels_of(fig: Figure) -> Pixels:
    """The figure as pixels, (height, width, 3), or 4 where its background is transparent."""
    shown: Any = fig.canvas
    with rc_context(style.RC):
        shown.draw()
    channels = 3 if fig.patch.get_alpha() is None else 4
    return np.array(shown.buffer_rgba())[..., :channels]


def save(page: Page, path: Path, level: int = 1) -> None:
    """Save the page as PNG or JPEG by the suffix of the path; level: how hard a PNG is compressed, from 1 to 9.

    A PNG has the places of its rods in its text "rods": a list of left, top, right and bottom, as shares of the page
    from its upper left. Raises `InputError` where the file cannot be written; an existing file then stays as it was.
    """
    from PIL import Image, PngImagePlugin

    picture, how = Image.fromarray(pixels_of(figure(page))), dict[str, Any](quality=QUALITY)
    if path.suffix.lower() == ".png":
        facts = PngImagePlugin.PngInfo()
        facts.add_text("rods", json.dumps(page.places))
        how = {"compress_level": level, "compress_type": RUNS if level == 1 else 0, "pnginfo": facts}
    atomic.write(path, lambda aside: picture.save(aside, dpi=(page.dpi, page.dpi), **how))
