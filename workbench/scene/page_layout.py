"""A sheet of rendered views: titles, labels, a length scale, the axes and a legend around them."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import Colormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from ..figures import style

# pixels at `style.DPI`: around, title, text under a cell, legend and scale; an axis; a cell whose label may be large
MARGIN, HEAD, LABEL, FOOT = 36, 112, 76, 126
TRIAD, ROOMY = 46, 230
BAR = (330, 20)  # the colour bar
NOTE = 31  # letters a line of small print
SMALL: dict[str, Any] = {"size": style.SMALL}


@dataclass(frozen=True)
class Cell:
    """What is written under a view, why it is empty where it is, and what is written before it."""

    label: str
    why_empty: str = ""
    before: str = ""


@dataclass(frozen=True, eq=False)
class Bar:
    """A colour bar: its map, its ends, and what it shows with its unit."""

    ramp: Colormap
    low: float
    high: float
    label: str


@dataclass(frozen=True, eq=False)
class Sheet:
    """What is put together.

    pixels: (height, width, 3), all views in one picture, each with room for its label below. cells: the views,
    row by row. per_unit: pixels per length. axes: where x, y, z point on the page, (3, 2). legend: colours and
    what they mean. least: width and height of the sheet at `style.DPI`. dpi: of the picture; with it grow all pixels
    but those of `pixels`, which are as they are. label, gutter: the room below each view and before the first, in
    pixels at `style.DPI`.
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
    label: int = LABEL
    gutter: int = 0


def figure(sheet: Sheet) -> Figure:
    """The sheet as a figure of its dpi, in which the pixels are those of the views."""
    finer = sheet.dpi / style.DPI
    high, wide = (n / finer for n in sheet.pixels.shape[:2])
    width, height = max(wide + 2 * MARGIN, sheet.least[0]), max(high + HEAD + FOOT, sheet.least[1])
    with rc_context(style.RC):
        fig = Figure(figsize=(width / style.DPI, height / style.DPI), dpi=sheet.dpi)
        FigureCanvasAgg(fig)
        _text(fig, MARGIN, height - 30, sheet.title, size=style.LARGE, va="top", weight="bold")
        _text(fig, MARGIN, height - 72, sheet.subtitle, color=style.SOFT, va="top")
        left = (width - wide + sheet.gutter) // 2
        bottom = FOOT + (height - HEAD - FOOT - high) // 2
        fig.figimage(sheet.pixels, round(left * finer), round(bottom * finer), origin="upper")
        _cells(fig, sheet, left, bottom, finer)
        right = _triad(fig, MARGIN + TRIAD, FOOT / 2 + 4, sheet.axes)
        right = _scale(fig, right + 60, FOOT / 2 - 22, sheet, finer)
        if sheet.bar:
            right = _bar(fig, right + 70, FOOT / 2 - 16, sheet.bar)
        _legend(fig, right + 60, width, sheet)
    return fig


def _cells(fig: Figure, sheet: Sheet, left: float, bottom: float, finer: float) -> None:
    high = sheet.pixels.shape[0] / finer / len(sheet.cells)
    for i, row in enumerate(reversed(sheet.cells)):
        wide = sheet.pixels.shape[1] / finer / len(row)
        for j, cell in enumerate(row):
            x, y = left + (j + 0.5) * wide, bottom + i * high
            size = style.NORMAL if wide > ROOMY else style.SMALL
            letters = max(map(len, cell.label.split("\n"))) or 1
            size = min(size, 0.95 * wide / style.DPI / (letters * style.LETTER))
            middle = y + (high + sheet.label) / 2
            _text(fig, x, y + sheet.label - 10, cell.label, ha="center", va="top", size=size)
            if cell.before:
                _text(fig, x - wide / 2 - 8, middle, cell.before, ha="right", va="center", **SMALL)
            if cell.why_empty:
                told = fill(cell.why_empty, max(int(wide / 13), 10))
                _text(fig, x, middle, told, color=style.SOFT, ha="center", va="center", **SMALL)


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


def _bar(fig: Figure, x: float, y: float, bar: Bar) -> float:
    """The colour bar with a few round values below and what it shows above; returns its right end."""
    width, height = fig.get_size_inches() * style.DPI
    ax = fig.add_axes((x / width, y / height, BAR[0] / width, BAR[1] / height))
    ax.imshow(np.linspace(0, 1, 256)[None], cmap=bar.ramp, aspect="auto", extent=(bar.low, bar.high, 0, 1))
    ax.set(yticks=[])
    ax.xaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 2.5, 5, 10]))
    ax.xaxis.set_major_formatter(lambda value, _: style.number(value).replace("-", "−"))
    ax.tick_params(axis="x", length=3, labelsize=style.SMALL, labelcolor=style.INK, pad=2)
    ax.set_title(bar.label, size=style.SMALL, color=style.INK, pad=5, loc="left")
    for spine in ax.spines.values():
        spine.set_visible(False)
    return float(x + BAR[0])


def _scale(fig: Figure, x: float, y: float, sheet: Sheet, finer: float) -> float:
    """A bar of a round length; returns its right end."""
    length = round_length(150 * finer / sheet.per_unit)
    pixels = length * sheet.per_unit / finer
    for a, b in (((0, 0), (pixels, 0)), ((0, -7), (0, 7)), ((pixels, -7), (pixels, 7))):
        fig.add_artist(_line(fig, np.add((x, y), a), np.add((x, y), b), color=style.INK, linewidth=1.4))
    _text(fig, x + pixels / 2, y + 16, f"{style.number(length)} {sheet.length_unit}", ha="center", va="bottom")
    return float(x + pixels)


def round_length(target: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above the target."""
    power = 10.0 ** np.floor(np.log10(target))
    return float(max(step for step in (1, 2, 5) if step * power <= target * (1 + 1e-9)) * power)


def _legend(fig: Figure, x: float, width: float, sheet: Sheet) -> None:
    height = fig.get_size_inches()[1] * style.DPI
    handles = [Patch(facecolor=colour, label=text) for colour, text in sheet.legend]
    if handles:
        fig.legend(handles=handles, loc="center left", bbox_to_anchor=(x / width, (FOOT / 2 - 14) / height),
                   fontsize=style.SMALL, handlelength=1.4, labelspacing=0.5)  # fmt: skip
    if sheet.notes:
        told = "\n".join(fill(note, NOTE) for note in sheet.notes)
        _text(fig, width - MARGIN, FOOT / 2 - 4, told, color=style.SOFT, ha="right", va="center",
              **SMALL)  # fmt: skip


def _text(fig: Figure, x: float, y: float, text: str, **how: Any) -> None:
    width, height = fig.get_size_inches() * style.DPI
    fig.text(x / width, y / height, text, **{"linespacing": 1.35, **how})


def _line(fig: Figure, a: Any, b: Any, **how: Any) -> Line2D:
    size = fig.get_size_inches() * style.DPI
    (x0, y0), (x1, y1) = np.asarray(a) / size, np.asarray(b) / size
    return Line2D([x0, x1], [y0, y1], transform=fig.transFigure, solid_capstyle="round", **how)
