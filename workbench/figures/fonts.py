"""The letters of figures: their sizes, the room that a text takes, and Matplotlib's settings. Colours: `colours`."""

import functools
import re
import textwrap
from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.font_manager import FontProperties
from matplotlib.gridspec import SubplotSpec
from matplotlib.textpath import TextToPath

from .colours import INK, SOFT

AROUND = "distance around the cylinder"
WAYS = f"z to the right, {AROUND} down"  # of every unrolled view

DPI = 200
SMALL, NORMAL, LARGE = 8.0, 9.5, 12.0  # points
LETTER = 0.6 / 72  # inches that a letter is wide per point of its size, where its text is not known yet
LINE = 1.22 / 72  # inches from line to line per point of their size
BESIDE = 0.8  # inches of the ticks and the label beside axes
SHARES = 0.5, 0.55, 0.6, 0.7, 0.8, 0.9  # of a label in one line, the lengths of two lines that are tried
GLUE = "\x1f"  # in place of a space at which no line ends
_TEXT = TextToPath()

RC: Any = {
    "font.family": "DejaVu Sans",  # comes with Matplotlib
    "font.size": NORMAL,
    "axes.titlesize": NORMAL,
    "axes.labelsize": NORMAL,
    "axes.edgecolor": SOFT,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "text.color": INK,
    "xtick.color": SOFT,
    "ytick.color": SOFT,
    "xtick.labelsize": SMALL,
    "ytick.labelsize": SMALL,
    "legend.frameon": False,
    "legend.fontsize": SMALL,
    "figure.titlesize": LARGE,
    "figure.facecolor": "white",
    "savefig.facecolor": "auto",  # that of the figure
    "figure.dpi": DPI,
    "savefig.dpi": DPI,
    "pdf.fonttype": 42,
    "mathtext.default": "regular",
    "text.parse_math": False,  # a title may come from anyone, and has its $ as they are
}


def normal() -> float:
    """Points of ordinary letters on the sheet that is being drawn."""
    return _points(rcParams["font.size"])


def small() -> float:
    """Points of small letters on the sheet that is being drawn."""
    return _points(rcParams["legend.fontsize"])


def large() -> float:
    """Points of the letters of its title."""
    return _points(rcParams["figure.titlesize"])


def _points(size: Any) -> float:
    return FontProperties(size=size).get_size_in_points()


def wrap(text: str, ax: Axes, size: float | None = None) -> str:
    """The text in lines that are no longer than the axes are wide, for a font of that size in points."""
    return break_lines(text, inches(ax)[0], size)


def break_lines(text: str, room: float, size: float | None = None, bold: bool = False, cut: bool = True) -> str:
    """The text in lines that are no longer than so many inches, for a font of that size in points.

    A product such as ``5 x 4`` is one word. No line begins with a unit in brackets, with a dot between two texts, with
    what a symbol equals, or with where it is held. cut: whether a word that is longer than a line is cut.
    """
    size = size or normal()
    room = max(room, 12 * size * LETTER)
    text = re.sub(r"(?<=\d) x (?=\d)", "\N{NO-BREAK SPACE}x\N{NO-BREAK SPACE}", text)
    most = int(1.2 * len(text) * room / max(width_of(text, size, bold), room)) + 1
    text = re.sub(r" (?=[\[·=])|(?<==) |(?<=, at) ", GLUE, text)
    while True:
        lines = textwrap.wrap(text, most, break_long_words=cut, break_on_hyphens=False)
        lines = [line.replace(GLUE, " ") for line in lines]
        widest = max((width_of(line, size, bold) for line in lines), default=0.0)
        if widest <= room or most == 1:
            return "\n".join(lines)
        most = max(min(most - 1, int(most * room / widest) + 1), 1)


def fit_label(label: Callable[[bool], str], room: float, most: int = 2) -> str:
    """A label in full where its words fit into so many lines of so many inches, nearly alike in length, else in short.

    label: takes whether it is in full.
    """
    whole = width_of(label(True), normal())
    for length in [whole] if whole <= room or most == 1 else [share * whole for share in SHARES]:
        full = break_lines(label(True), min(length, room), cut=False)
        if full.count("\n") < most and width_of(full, normal()) <= room:
            return full
    return label(False)


def height_of(text: str, size: float) -> float:
    """The height of a text in its lines in inches, for a font of that size in points; 0 without any."""
    return (text.count("\n") + 1) * size * LINE if text else 0.0


@functools.lru_cache(maxsize=10_000)  # `break_lines` asks for each line again with a word more
def width_of(text: str, size: float, bold: bool = False) -> float:
    """The width of a text in its lines in inches, for a font of that size in points."""
    font = FontProperties(family=RC["font.family"], size=size, weight="bold" if bold else "normal")
    return (
        max(float(_TEXT.get_text_width_height_descent(line, font, ismath=False)[0]) for line in text.split("\n")) / 72
    )


def inches(ax: Axes) -> tuple[float, float]:
    """Width and height of the room of axes before they are laid out: a little less than what it gets."""
    box, figure, place = ax.get_position(original=True), ax.get_figure(root=True), ax.get_subplotspec()
    assert figure is not None
    wide = box.width * figure.get_figwidth()
    if place is not None:
        share = _share(place)
        top = place.get_topmost_subplotspec()
        wide = max((share if top is place else share * _share(top)) * figure.get_figwidth() - BESIDE, 0.5)
    return wide, box.height * figure.get_figheight()


def _share(place: SubplotSpec) -> float:
    """The share of the width of its grid that a cell has."""
    grid = place.get_gridspec()
    ratios = np.asarray(grid.get_width_ratios() or [1.0] * grid.ncols, dtype=float)
    return float(ratios[place.colspan.start : place.colspan.stop].sum() / ratios.sum())
