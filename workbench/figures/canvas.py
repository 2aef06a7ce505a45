"""The canvas of every figure: a Matplotlib `Figure` without pyplot, its title, its legends, and the file it is put in.

What a panel labels stands in the legend of its figure, each label once; the name of an artist in a table of what is
drawn is its `gid`. The sentences that belong to a figure are its caption, which is kept beside it and printed: a
picture has its data, its legend, and at most one line of words below its title.
"""

import re
from collections.abc import Callable, Iterable, Sequence
from io import BytesIO
from itertools import groupby
from pathlib import Path
from string import ascii_lowercase
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from matplotlib import rc_context
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colorbar import Colorbar
from matplotlib.figure import Figure
from matplotlib.gridspec import GridSpec
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.lines import Line2D
from matplotlib.text import Text
from matplotlib.ticker import AutoLocator, ScalarFormatter
from matplotlib.transforms import ScaledTranslation

from ..run import atomic
from ..stored.stored_study import StoredStudy
from ..words import labels
from . import fonts, legend_room
from .axis_scales import RoomLocator, Ticks
from .colours import INK, SOFT, STATES
from .fonts import DPI, RC
from .print_heights import TALLEST, heighten_axes, resize
from .sheet import SCREEN, Sheet

PANEL = 2.4  # inches of a panel of curves on the screen
ROW = 1.55  # inches of a row of axes in print at least, with labels and title
# inches that a panel with axes gives up for views: at 0.35 the push of a rod keeps one number, at 0.15 views overlap
LABELS = 0.25
MARGIN, AFTER, TITLE = 0.15, 0.1, 0.62  # inches around a title, below it, and of all of it where its lines are short
MOST_LETTERS = 12  # panels; more are a table of panels, which its rows and columns name
# The best place covers no middle of a point; a wide pad in place of the distance to the axes keeps it off whole points
PADDED = {"borderpad": 1.0, "borderaxespad": 0.0}
DIAGRAMS = (".png", ".pdf", ".svg")
Said = Iterable[Any]  # of a figure: sentences of its caption, and labelled artists, the entries of its legend
Panel = Callable[[Axes], Said | None]  # draws, and returns what is said of it
Row = tuple[float, Sequence[Panel | None]]  # its height in inches, and its panels
_CAPTIONS: WeakKeyDictionary[Figure, list[str]] = WeakKeyDictionary()


def figure(
    size: tuple[float, float],
    draw: Callable[[Figure], Any],
    stored: StoredStudy | None = None,
    dpi: float = DPI,
    layout: Any = "constrained",
    sheet: Sheet = SCREEN,
    said: str | None = None,
) -> Figure:
    """A figure of a size in inches with what `draw` draws on it.

    stored: the file whose title is written above that, where the sheet has one. said: what is written below the title;
    default: the reading of the file.
    """
    titled = stored is not None and sheet.titled
    tallest = TALLEST if sheet.style == "paper" else np.inf
    with rc_context(RC | sheet.settings()):
        fig = Figure(figsize=(size[0], min(size[1], tallest)), dpi=dpi, layout=layout)
        FigureCanvasAgg(fig)
        draw(fig)
        if layout is not None:
            _letter_panels(fig)
        if stored is not None and titled:
            _set_title(fig, stored.reading if said is None else said, str(stored.attrs["title"]), tallest)
        _write_numbers(fig)
        set_in_mathematics(fig)
        if layout is not None:
            _clear_legends(fig, sheet)
    return fig


def page(
    stored: StoredStudy | None,
    sheet: Sheet,
    rows: Sequence[Row],
    said: Said = (),
    more: float = 0.5,
    width: float | None = None,
    high: bool = True,
    rest: str | None = None,
    **options: Any,
) -> Figure:
    """A figure of panels in rows, with one legend below.

    In print axes are `LEAST_AXES` high: the figure grows up to the height of a page. Raises `TooLow` where that is not
    enough.

    Parameters
    ----------
    stored
        As of `figure`, which takes the further options.
    sheet
        What it is drawn for.
    rows
        The height of each in inches, and what draws each panel; None leaves a place free. Rows of equal numbers share
        their columns. A panel returns what is said of it: sentences of the caption, and entries of the legend beside
        what it labels. A panel with a legend of its own adds nothing to that of the figure.
    said
        What is said after that of the panels. How many of the shapes a real rod could keep is said before it, below
        the title, once, and what is against the others in the caption.
    more
        Inches of the figure beside the rows.
    width
        Inches; default: of the sheet.
    high
        Whether the axes have scales upward, for which that height is needed.
    rest
        What is said in place of how many of the shapes a real rod could keep.
    """

    rest = labels.capital(stored.restable if rest is None and stored is not None else rest or "")
    why, head = list[str](), [rest]
    if stored is not None:
        given = f"Given: {stored.common_values}." * bool(stored.common_values)
        why = [text for text in (labels.typeset(stored.caution), given) if text]
        head = [str(stored.attrs["title"]), stored.reading, rest]

    def draw(fig: Figure) -> None:
        below: list[Any] = [*(f"{text}." for text in head if text and not sheet.titled), *why]
        groups = [list(group) for _, group in groupby(rows, lambda row: len(row[1]))]
        heights = [sum(tall for tall, _ in group) for group in groups]
        outer = GridSpec(len(groups), 1, fig, height_ratios=heights)
        for i, group in enumerate(groups):
            across = len(group[0][1])
            sizes = [tall for tall, _ in group]
            alone = len(groups) == 1
            grid = (fig.add_gridspec if alone else outer[i, 0].subgridspec)(len(group), across, height_ratios=sizes)
            plain = np.ones(len(group), dtype=bool)
            for k, panel in np.ndenumerate(np.array([panels for _, panels in group], dtype=object)):
                if panel is not None:
                    ax = fig.add_subplot(grid[k])
                    below += panel(ax) or ()
                    below += [] if ax.get_legend() else legend_entries(ax)
                    plain[k[0]] &= not ax.axison
            if sheet.style == "paper":  # a layout shares what labels leave: views without any keep their height
                inner = [tall - LABELS * (not bare) for (tall, _), bare in zip(group, plain, strict=True)]
                grid.set_height_ratios(inner)
                heights[i] = sum(inner)
        outer.set_height_ratios(heights)
        write_below(fig, [*below, *said])

    fig = figure(
        (width or sheet.width, sum(tall for tall, _ in rows) + more),
        draw,
        stored,
        sheet=sheet,
        said=_below_title(stored, rest),
        **options,
    )
    if high and sheet.style == "paper":
        with rc_context(RC | sheet.settings()):  # else formulas are set in other letters, which stay
            heighten_axes(fig)
            if _clear_legends(fig, sheet):  # in axes of another height the best place is another
                heighten_axes(fig)
    return fig


def _clear_legends(fig: Figure, sheet: Sheet) -> bool:
    """Put legends that cover a line or a point below their axes, for which the figure grows; whether there are any."""
    with rc_context(RC | sheet.settings()):
        if not (more := legend_room.clear(fig)):
            return False
        high = fig.get_figheight() + more
        resize(fig, (fig.get_figwidth(), min(high, TALLEST) if sheet.style == "paper" else high))
    return True


def in_rows(panels: Sequence[Panel], across: int, high: float, filled: bool = False) -> list[Row]:
    """Panels in rows of so many, which are so many inches high.

    filled: whether the panels of the last row take the whole width where they are fewer.
    """
    across = max(across, 1)
    padded = panels if filled else [*panels, *[None] * (-len(panels) % across)]
    return [(high, padded[i : i + across]) for i in range(0, len(padded), across)]


def _write_numbers(fig: Figure) -> None:
    """Give every linear axis without ticks or words of its own as many numbers as have room, in full."""
    for axis in (axis for ax in fig.axes for axis in (ax.xaxis, ax.yaxis)):
        if type(axis.get_major_locator()) is AutoLocator:
            axis.set_major_locator(RoomLocator())
        if type(axis.get_major_formatter()) is ScalarFormatter:
            axis.set_major_formatter(Ticks())


def set_in_mathematics(fig: Figure) -> None:
    """Set the index of ``FZ``, ``MZ`` and ``FY`` low and powers such as ``^0.5`` high: Unicode has no such letters.

    Every number below 0 has a minus sign in place of its hyphen.
    """
    for text in fig.findobj(Text):
        plain = text.get_text()
        signed = plain if "$" in plain else labels.minus_signs(plain)
        in_mathematics = labels.mathematical(signed)
        if in_mathematics != signed and "$" not in plain:
            text.set(text=in_mathematics, parse_math=True)
        elif signed != plain:
            text.set_text(signed)


def _letter_panels(fig: Figure) -> None:
    """Give several panels with scales their letters, and the labels of each column one place."""
    shown = {
        ax: ax.get_subplotspec()
        for ax in fig.axes
        if ax.get_label() != "<colorbar>" and ax.xaxis.get_visible() and len(ax.get_xticks())
    }
    grids = {ax: place.get_gridspec() for ax, place in shown.items() if place is not None}
    panels = list(grids)
    for grid in grids.values():
        fig.align_ylabels([ax for ax in panels if grids[ax] is grid])
    if not 1 < len(panels) <= MOST_LETTERS:
        return
    for letter, ax in zip(ascii_lowercase, panels, strict=False):
        lines = ax.get_title(loc="left").count("\n") if ax.axison else -1  # the words of views stand in their axes
        above = 72 * float(ax.titleOffsetTrans.transform((0, 0))[1]) / fig.dpi  # type: ignore[attr-defined]
        ax.annotate(
            letter,
            (0, 1),
            (-6, max(above, 6) + 1.2 * lines * fonts.normal() - (lines < 0)),
            xycoords="axes fraction",
            textcoords="offset points",
            ha="right",
            weight="bold",
            size=fonts.normal(),
        )


def save(fig: Figure, path: str | Path | BytesIO, dpi: float = DPI) -> None:
    """Save a figure in the format of the suffix, or as PNG in memory; dpi: pixels per inch where it has pixels.

    Raises `InputError` for another name than of a diagram, and where the file cannot be written; an existing file then
    stays as it was.
    """
    with rc_context(RC):
        if isinstance(path, BytesIO):
            fig.savefig(path, dpi=dpi)
        else:
            atomic.write(atomic.check_name(path, DIAGRAMS), lambda aside: fig.savefig(aside, dpi=dpi))


def write_title(fig: Figure, title: str, below: str) -> float:
    """Write a title and a line below it at the upper left of a figure; returns the inches that they take."""
    upper_left = fig.dpi_scale_trans + ScaledTranslation(0, 1, fig.transFigure)  # type: ignore[arg-type]
    used = MARGIN * bool(title or below)
    for text, size, weight, colour in ((title, fonts.large(), "bold", INK), (below, fonts.normal(), "normal", SOFT)):
        lines = fonts.break_lines(text, fig.get_figwidth() - 2 * MARGIN, size, weight == "bold")
        fig.text(MARGIN, -used, lines, va="top", size=size, weight=weight, color=colour, transform=upper_left)
        used += fonts.height_of(lines, size)
    return used + AFTER * bool(used)


def title_height(stored: StoredStudy, sheet: Sheet) -> float:
    """Inches of the title of a `page` of a study with what is written below it; 0 on a sheet without one."""
    if not sheet.titled:
        return 0.0
    below = _below_title(stored, labels.capital(stored.restable))
    with rc_context(RC | sheet.settings()):
        return write_title(Figure((sheet.width, 1.0)), str(stored.attrs["title"]), below)


def _below_title(stored: StoredStudy | None, rest: str) -> str:
    return " · ".join(text for text in (stored.reading if stored is not None else "", rest) if text)


def _set_title(fig: Figure, below: str, title: str, tallest: float) -> None:
    """A title, and a line below it, above a constrained layout, for which the figure grows up to so many inches."""
    used = write_title(fig, title, below)
    fig.set_figheight(min(fig.get_figheight() + used, tallest))
    engine = fig.get_layout_engine()
    assert isinstance(engine, ConstrainedLayoutEngine)
    engine.set(rect=(0, 0, 1, 1 - used / fig.get_figheight()), w_pad=0.1, h_pad=0.08)


def add_to_caption(fig: Figure, sentences: Sequence[str]) -> None:
    """Add sentences to the caption of a figure."""
    _CAPTIONS[fig] = [*_CAPTIONS.get(fig, []), *sentences]


NOT_DRAWN = "Not drawn: "


def caption(fig: Figure, advice: bool = True) -> list[str]:
    """The sentences of the caption of a figure, each once; without advice: of what is drawn alone."""
    sentences = dict.fromkeys(labels.minus_signs(" ".join(text.split())) for text in _CAPTIONS.get(fig, []))
    return [text for text in sentences if advice or not text.startswith(NOT_DRAWN)]


def say_left_out(names: Sequence[str], options: str) -> list[str]:
    """The sentence that names what has no room; none where all has."""
    return [f"{NOT_DRAWN}{', '.join(names)}; choose with {options}."] if names else []


def add_legend(ax: Axes, most: float = np.inf, **where: Any) -> None:
    """The legend of what is drawn on the axes; none without a label, or with more than so many.

    where: options of `Axes.legend`.
    """
    once = {str(entry.get_label()): entry for entry in legend_entries(ax)}
    if 0 < len(once) <= most:
        ax.legend(list(once.values()), list(once), **{"loc": "best", **PADDED, **where})


def legend_entries(ax: Axes) -> list[Any]:
    """The labelled artists of axes: states in their order, other lines and areas as they are drawn, then marks."""
    order = {word: k for k, word in enumerate(STATES)}

    def rank(one: Any) -> tuple[bool, int]:
        is_mark = isinstance(one, Line2D) and one.get_linestyle() == "None"
        return is_mark, order.get(str(one.get_label()).partition(" but ")[0], len(order))

    return sorted(ax.get_legend_handles_labels()[0], key=rank)


def write_below(fig: Figure, said: Said) -> None:
    """One legend below all axes of a figure with a constrained layout, its entries in columns.

    said: those entries, of which one is left out where another one with the same mark says more, and sentences for the
    caption.
    """
    said = list(said)
    named = {str(entry.get_label()): entry for entry in said if not isinstance(entry, str)}
    entries = {name: each for name, each in named.items() if not any(_says_more(more, each) for more in named.values())}
    add_to_caption(fig, [sentence for sentence in said if isinstance(sentence, str)])
    if not entries:
        return
    columns, names = legend_room.legend_columns(
        list(entries), fig.get_figwidth() - 0.3, handle=legend_room.HANDLE + 0.1
    )
    fig.legend(
        list(entries.values()),
        names,
        ncols=columns,
        loc="outside lower left",
        alignment="left",
        handlelength=2.6,
        handleheight=1.2,
    )


def _says_more(more: Artist, entry: Artist) -> bool:
    """Whether an entry with the mark of another one has its words and more, all between commas."""
    lines = [each for each in (more, entry) if isinstance(each, Line2D)]
    marks = {(line.get_marker(), line.get_color(), line.get_linestyle(), line.get_linewidth()) for line in lines}
    words, least = (set(re.split("[,;] ", str(each.get_label()))) for each in (more, entry))
    return len(lines) == 2 and len(marks) == 1 and words > least


def draw_arrow(
    ax: Axes,
    start: Any,
    tip: Any,
    style: str = "-|>",
    colour: str = INK,
    width: float = 1.0,
    order: float = 3.0,
    **look: Any,
) -> None:
    """An arrow between two places of axes; width: points of its line; look: further options of its patch."""
    arrow = {"arrowstyle": style, "color": colour, "linewidth": width, "shrinkA": 0, "shrinkB": 0, **look}
    ax.annotate("", tuple(tip), tuple(start), arrowprops=arrow, zorder=order, annotation_clip=False)


def colour_bar(beside: Sequence[Axes], colours: ScalarMappable, label: str = "", **where: Any) -> Colorbar:
    """The bar of a scale of colours beside axes, with a name in small letters; where: options of `Figure.colorbar`."""
    fig = beside[0].get_figure(root=True)
    assert fig is not None
    bar = fig.colorbar(colours, **{} if "cax" in where else {"ax": list(beside)}, **where)  # type: ignore[arg-type]
    bar.set_label(label, size=fonts.small())
    bar.outline.set_visible(False)
    bar.ax.tick_params(length=2)
    if "ticks" not in where:
        bar.locator, bar.formatter = RoomLocator(), Ticks()
    bar.minorticks_off()
    return bar
