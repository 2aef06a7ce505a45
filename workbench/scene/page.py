"""The page of a scene: rendered views with title, captions, scale bar, axes, colour bar and legend around them."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from ..data import labels
from ..figures import canvas, style
from .colours import Bar

# pixels at `style.DPI`
MARGIN, HEAD, FOOT = 36, 112, 126  # around the page, for the title, for legend and scale bar
CAPTION = 76  # below each cell
TRIAD = 46  # an arrow of the axes
ROOMY = 230  # the width of a cell from which its caption has the normal size
BAR = (330, 20)  # the colour bar
NOTE = 31  # letters in a line of the notes
SMALL: dict[str, Any] = {"size": style.SMALL}


@dataclass(frozen=True)
class Cell:
    """The text below a view, why it is empty where it is, and the text before it."""

    caption: str
    why_empty: str = ""
    before: str = ""


@dataclass(frozen=True, eq=False)
class Page:
    """What is put together.

    Attributes
    ----------
    pixels
        (height, width, 3), all views in one picture, each with room for its caption below.
    cells
        The views, row by row.
    per_unit
        Pixels per length.
    axes
        Where x, y, z point on the page, (3, 2).
    legend
        Colours and their meaning.
    least
        Least width and height of the page in pixels at `style.DPI`.
    dpi
        Of the picture; all lengths in pixels grow with it, but `pixels` are taken as they are.
    caption, gutter
        The room below each view and before the first, in pixels at `style.DPI`.
    """

    title: str
    subtitle: str
    pixels: NDArray[np.uint8]
    cells: Sequence[Sequence[Cell]]
    per_unit: float
    length_unit: str
    axes: NDArray[np.float64]
    legend: Sequence[tuple[str, str]] = field(default_factory=list)
    notes: Sequence[str] = field(default_factory=list)
    least: tuple[int, int] = (1300, 0)
    bar: Bar | None = None
    dpi: int = style.DPI
    caption: int = CAPTION
    gutter: int = 0


def figure(page: Page) -> Figure:
    """The page as a figure of its dpi, in which the pixels of the views are kept."""
    finer = page.dpi / style.DPI
    high, wide = (n / finer for n in page.pixels.shape[:2])
    width, height = max(wide + 2 * MARGIN, page.least[0]), max(high + HEAD + FOOT, page.least[1])

    def draw(fig: Figure) -> None:
        _text(fig, MARGIN, height - 30, page.title, size=style.LARGE, va="top", weight="bold")
        _text(fig, MARGIN, height - 72, page.subtitle, color=style.SOFT, va="top")
        left = (width - wide + page.gutter) // 2
        bottom = FOOT + (height - HEAD - FOOT - high) // 2
        fig.figimage(page.pixels, round(left * finer), round(bottom * finer), origin="upper")
        _cells(fig, page, left, bottom, finer)
        right = _triad(fig, MARGIN + TRIAD, FOOT / 2 + 4, page.axes)
        right = _scale_bar(fig, right + 60, FOOT / 2 - 22, page, finer)
        if page.bar:
            right = _colour_bar(fig, right + 70, FOOT / 2 - 16, page.bar)
        _legend(fig, right + 60, width, page)

    return canvas.figure((width / style.DPI, height / style.DPI), draw, dpi=page.dpi, layout=None)


def _cells(fig: Figure, page: Page, left: float, bottom: float, finer: float) -> None:
    high = page.pixels.shape[0] / finer / len(page.cells)
    for i, row in enumerate(reversed(page.cells)):
        wide = page.pixels.shape[1] / finer / len(row)
        for j, cell in enumerate(row):
            x, y = left + (j + 0.5) * wide, bottom + i * high
            size = style.NORMAL if wide > ROOMY else style.SMALL
            letters = max(map(len, cell.caption.split("\n"))) or 1
            size = min(size, 0.95 * wide / style.DPI / (letters * style.LETTER))
            middle = y + (high + page.caption) / 2
            _text(fig, x, y + page.caption - 10, cell.caption, ha="center", va="top", size=size)
            if cell.before:
                _text(fig, x - wide / 2 - 8, middle, cell.before, ha="right", va="center", **SMALL)
            if cell.why_empty:
                reason = fill(cell.why_empty, max(int(wide / 13), 10))
                _text(fig, x, middle, reason, color=style.SOFT, ha="center", va="center", **SMALL)


def _triad(fig: Figure, x: float, y: float, axes: NDArray[np.float64]) -> float:
    """The axes x, y, z as the camera sees them; returns the right end."""
    middle = (np.minimum(axes.min(axis=0), 0) + np.maximum(axes.max(axis=0), 0)) / 2
    origin = np.array([x, y]) - TRIAD * middle
    for name, way in zip("xyz", axes, strict=True):
        tip = origin + TRIAD * way
        if np.hypot(*way) > 0.08:
            fig.add_artist(_line(fig, origin, tip, color=style.INK, linewidth=1.4))
        side = way / max(np.hypot(*way), 0.3) if np.hypot(*way) > 0.08 else -axes.sum(axis=0) / 1.5
        _text(fig, tip[0] + 13 * side[0], tip[1] + 13 * side[1], name, ha="center", va="center", **SMALL)
    return float(x + TRIAD + 12)


def _colour_bar(fig: Figure, x: float, y: float, bar: Bar) -> float:
    """The colour bar with a few round values below and its quantity above; returns its right end."""
    width, height = fig.get_size_inches() * style.DPI
    ax = fig.add_axes((x / width, y / height, BAR[0] / width, BAR[1] / height))
    ax.imshow(np.linspace(0, 1, 256)[None], cmap=bar.ramp, aspect="auto", extent=(bar.low, bar.high, 0, 1))
    ax.set(yticks=[])
    ax.xaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 2.5, 5, 10]))
    ax.xaxis.set_major_formatter(lambda value, _: labels.number(value).replace("-", "−"))
    ax.tick_params(axis="x", length=3, labelsize=style.SMALL, labelcolor=style.INK, pad=2)
    ax.set_title(bar.label, size=style.SMALL, color=style.INK, pad=5, loc="left")
    for spine in ax.spines.values():
        spine.set_visible(False)
    return float(x + BAR[0])


def _scale_bar(fig: Figure, x: float, y: float, page: Page, finer: float) -> float:
    """A bar of a round length; returns its right end."""
    length = round_length(150 * finer / page.per_unit)
    pixels = length * page.per_unit / finer
    for a, b in (((0, 0), (pixels, 0)), ((0, -7), (0, 7)), ((pixels, -7), (pixels, 7))):
        fig.add_artist(_line(fig, np.add((x, y), a), np.add((x, y), b), color=style.INK, linewidth=1.4))
    _text(fig, x + pixels / 2, y + 16, f"{labels.number(length)} {page.length_unit}", ha="center", va="bottom")
    return float(x + pixels)


def round_length(target: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above the target."""
    power = 10.0 ** np.floor(np.log10(target))
    return float(max(step for step in (1, 2, 5) if step * power <= target * (1 + 1e-9)) * power)


def _legend(fig: Figure, x: float, width: float, page: Page) -> None:
    height = fig.get_size_inches()[1] * style.DPI
    handles = [Patch(facecolor=colour, label=text) for colour, text in page.legend]
    if handles:
        fig.legend(handles=handles, loc="center left", bbox_to_anchor=(x / width, (FOOT / 2 - 14) / height),
                   fontsize=style.SMALL, handlelength=1.4, labelspacing=0.5)  # fmt: skip
    if page.notes:
        notes = "\n".join(fill(note, NOTE) for note in page.notes)
        _text(fig, width - MARGIN, FOOT / 2 - 4, notes, color=style.SOFT, ha="right", va="center",
              **SMALL)  # fmt: skip


def _text(fig: Figure, x: float, y: float, text: str, **how: Any) -> None:
    width, height = fig.get_size_inches() * style.DPI
    fig.text(x / width, y / height, text, **{"linespacing": 1.35, **how})


def _line(fig: Figure, a: Any, b: Any, **how: Any) -> Line2D:
    size = fig.get_size_inches() * style.DPI
    (x0, y0), (x1, y1) = np.asarray(a) / size, np.asarray(b) / size
    return Line2D([x0, x1], [y0, y1], transform=fig.transFigure, solid_capstyle="round", **how)
