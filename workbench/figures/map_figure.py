"""The maps of a stored study over two axes: one for each observable, and for each of some values of a third axis.

Beside a map stands the verdict of each law on each line of the grid, and on it the line that decides. A law along an
axis that the map does not have is judged on one line for each cell: it has a map of its own.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch, PathPatch
from numpy.typing import NDArray

from studies.laws import law_words
from studies.laws.line_verdicts import FAILS, HOLDS, VERDICTS

from ..stored import stored_verdicts
from ..stored.stored_study import StoredStudy
from ..words import labels
from . import canvas, colours, fonts, law_panel, map_panel, print_heights, regions
from .map_cells import MOST_MAPS, Cells, Choice, cells, choose, raster_of
from .sheet import SCREEN, Sheet

COLUMN = 2.0  # inches, the height of maps in columns
LEAST_COLUMN = 1.45  # inches, their least width with a gap
MOST_NARROW = 2  # observables on one column of a page, where none is asked for
THICK, GAP = 0.06, 0.04  # inches of a strip of verdicts, and between strips
DECIDES: dict[str, Any] = {
    "color": colours.INK,
    "linewidth": 1.3,
    "linestyle": (0, (5, 2)),
    "label": "the law is judged on this line",
}
FALSE: dict[str, Any] = {**colours.UNSOLVED, "facecolor": colours.VERDICTS[FAILS], "edgecolor": "white"}
OF_VERDICTS: dict[str, Any] = {
    "cmap": ListedColormap([colours.VERDICTS[verdict] for verdict in VERDICTS]),
    "vmin": -0.5,
    "vmax": len(VERDICTS) - 0.5,
}


def figure(
    stored: StoredStudy,
    x: str | None = None,
    y: str | None = None,
    show: Sequence[str] = (),
    at: Mapping[str, float] | None = None,
    shapes: map_panel.ShapeCounts | None = None,
    sheet: Sheet = SCREEN,
) -> Figure:
    """Draw a map of each observable.

    Each observable has one scale of colours over all its maps. A count has the borders of its regions and their
    numbers. A cross in place of a point is a case whose shape no real rod could keep. A strip beside a map shows on
    which lines of the grid a law does not hold.
    A third axis has a column of maps for some of its values; any further axis is held where the laws or Table 1 put it.
    In the plane of a refined study each case is the cell around it, and its laws are told below the maps.

    Parameters
    ----------
    stored : StoredStudy
    x, y, show, at
        As of `map_cells.choose`.
    shapes : map_panel.ShapeCounts, optional
        Numbers of unrolled views that a further panel shows; default: no such panel.
    sheet : Sheet
        What the figure is drawn for.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        As of `map_cells.choose`; where shapes are not stored or more than the values of an axis; for invalid laws.
    """
    verdicts = stored.verdicts if "laws" in stored.attrs else []
    whole = stored if stored.is_refined else None
    grid = stored if whole is None else raster_of(stored)
    watched = [] if whole is None else list(whole.refinement.watch)  # what else it stores is as coarse as ever

    def draw(most: int) -> Figure:
        """The maps of so many observables at most."""
        choice = choose(grid, x, y, show or watched, at, max(int((sheet.width - 1.5) / LEAST_COLUMN), 1), most)
        if shapes is not None:
            map_panel.check_shapes(stored, grid, choice, shapes)
        columns = [cells(grid, choice, where, whole) for where in choice.places()]
        laws = _judge(grid, choice, verdicts) if whole is None else []
        maps = _Maps(grid, choice, columns, [law for law in laws if law.row["axis"] in (choice.x, choice.y)], sheet)
        elsewhere = [law for law in laws if law not in maps.laws]
        mixed = [law for law in elsewhere if law.is_mixed()]
        rows = maps.rows_of_panels()
        rows += canvas.in_rows([partial(maps.draw_law, law) for law in mixed], len(rows[0][1]), maps.small[1] + 1.2)
        if shapes is not None:
            rows.append((maps.of_shapes[1] + 0.8, [partial(maps.draw_shapes, shapes)]))
        said: list[str | Artist] = [*map_panel.entries(columns, choice.shown, maps.inches)]
        said += [] if whole is None else _refinement(whole, verdicts)
        said += [f"{_law_sentence(law.sentence(grid))}." for law in maps.laws if choice.along]
        if choice.along and len(choice.columns) < grid.sizes[choice.along]:
            of = f"the {grid.sizes[choice.along]} values of {labels.axis_symbol(choice.along)}"
            said.append(f"The columns show {len(choice.columns)} of {of}.")
        said += grid.level_notes(grid.observables) if not show else []
        said += labels.definitions(grid.expressions, choice.shown)
        coarse = [name for name in grid.observables if watched and not show and name not in watched]
        said += canvas.say_left_out([*choice.left_out, *coarse], "--show")
        if choice.along and choice.held:
            said.append(f"All maps: {grid.equations(choice.held)}.")
        said += [f"{_law_sentence(law.sentence(grid))}." for law in elsewhere if law not in mixed]
        return canvas.page(stored, sheet, rows, said, 0.4)

    most = MOST_NARROW if sheet.narrow and not show else MOST_MAPS
    if show or sheet.style != "paper":
        return draw(most)
    return print_heights.with_room(draw, min(most, max(len(stored.observables), 1)))


class _Maps:
    """The maps of one figure, row by row."""

    def __init__(
        self, stored: StoredStudy, choice: Choice, columns: list[Cells], laws: list["_JudgedLaw"], sheet: Sheet
    ) -> None:
        self.across = 1 if sheet.narrow else min(len(choice.shown), 2)
        alone, beside = sheet.width - (1.25 if sheet.narrow else 2.0), (sheet.width - 2.5) / 2
        large = alone, alone * 0.605  # inches of a map alone in its row
        self.small = large if sheet.narrow else (beside, beside * 0.775)  # of one of two
        self.of_shapes = sheet.width - 1.4, (sheet.width - 1.4) * 0.52
        self.stored, self.choice, self.columns, self.laws, self.places = stored, choice, columns, laws, choice.places()
        self.drawn: dict[str, list[Axes]] = {name: [] for name in choice.shown}
        self.inches = large if len(choice.shown) == 1 else self.small
        if choice.along:
            self.inches = (sheet.width - 1.8) / len(columns) - 0.15, COLUMN
        self.colours = {
            name: map_panel.Colours(stored, name, np.stack([column.values(name) for column in columns]))
            for name in choice.shown
        }

    def rows_of_panels(self) -> list[canvas.Row]:
        """The maps in rows; along a third axis a row an observable."""
        shown, high = self.choice.shown, self.inches[1] + (0.6 if self.choice.along else 0.85)
        if not self.choice.along:
            return canvas.in_rows([partial(self.draw, name, 0, True) for name in shown], self.across, high)
        return [
            (high, [partial(self.draw, name, k, name == shown[-1]) for k in range(len(self.columns))]) for name in shown
        ]

    def draw(self, name: str, k: int, lowest: bool, ax: Axes) -> canvas.Said:
        """Draw the map of an observable in a column, with its bar of colours; along a third axis they share one.

        Returns the entries of the legend, and what is said of each law.
        """
        column, where, along = self.columns[k], self.places[k], self.choice.along
        laws = [law for law in self.laws if law.row["observable"] == name]
        mesh = map_panel.draw(ax, column, name, self.colours[name], self.inches)
        entries = _draw_laws(ax, laws, column, self.choice, where, self.inches)
        value = self.stored.equations({along: where[along]}) if along else ""
        heads = [f"{law.row['claim']}: " if along else f"{law.sentence(self.stored)}; lines: " for law in laws]
        tail = f" at {value}." if value else "."
        others = ["" if along else law_words.others(law.row, lambda of: labels.symbol(self.stored[of])) for law in laws]
        said = [
            _law_sentence(f"{head}{law.counts(where)}{tail} {other}".rstrip())
            for head, law, other in zip(heads, laws, others, strict=True)
        ]
        if laws and column.unbent(name).any():
            said.append("A law counts the bends of nearly straight rods too, which the map does not show.")
        title = labels.label(self.stored[name], long=True) + self.colours[name].said
        title = fonts.break_lines(title, self.inches[0] + 0.2)
        if along:
            title = f"{title}\n{value}" if k == 0 else value
        above = sum(law.row["axis"] == self.choice.y for law in laws) * (THICK + GAP) * 72
        ax.set_title(title, loc="left", pad=above + 6)
        self._label(ax, leftmost=k == 0, lowest=lowest)
        self.drawn[name].append(ax)
        if k == len(self.columns) - 1:
            self.colours[name].bar(mesh, self.drawn[name])
            said += self.colours[name].notes
        return [*entries, *said]

    def draw_law(self, law: "_JudgedLaw", ax: Axes) -> canvas.Said:
        """Draw the verdict on the line through each cell, for a law along an axis that the map does not have."""
        on_map, column = law.at(self.places[0]), self.columns[0]
        verdicts = on_map.sortby([*on_map.dims]).transpose(*column.stored["outcome"].dims).values
        column.colour(ax, _numbers(verdicts), **OF_VERDICTS)
        _hatch_false(ax, verdicts, column.x.edges, column.y.edges)
        column.draw_borders(ax, _numbers(verdicts), colors="white", linewidths=1.0)
        self._label(ax, leaving=law.row["axis"])
        claim = f"law on the {labels.noun_of(law.row['observable'])} along {labels.axis_symbol(law.row['axis'])}"
        ax.set_title(f"where the {claim} is true".replace("the the", "the"), loc="left")
        return [
            *_entries(verdicts),
            _law_sentence(f"{law.sentence(self.stored)}; lines: {law.counts(self.places[0])}."),
        ]

    def draw_shapes(self, shapes: map_panel.ShapeCounts, ax: Axes) -> canvas.Said:
        """Draw the panel of shapes: those of the first column, on a pale map of the first observable."""
        name, column = self.choice.shown[0], self.columns[0]
        map_panel.draw(ax, column, name, self.colours[name], self.of_shapes, pale=0.3)
        self._label(ax)
        held = [self.stored.equations(self.places[0])] if self.choice.along else []
        ax.set_title(", ".join([f"unrolled views over the {labels.long_name(self.stored[name])}", *held]), loc="left")
        return map_panel.draw_shapes(ax, column, shapes, self.of_shapes)

    def _label(self, ax: Axes, leftmost: bool = True, lowest: bool = True, leaving: str = "") -> None:
        """The labels of the two axes at the edge of the figure; the values of further axes stand behind that of x.

        leaving: an axis whose value is left out.
        """
        choice = self.choice
        short = choice.along is not None
        where = {} if short else {name: i for name, i in self.places[0].items() if name != leaving}
        ax.tick_params(labelbottom=lowest, labelleft=leftmost)
        if lowest:
            held = self.stored.equations({name: i for name, i in where.items() if name != choice.x})
            text = labels.axis_label(self.stored[choice.x], not short, held)
            ax.set_xlabel(fonts.break_lines(text, max(self.inches[0], 1.0)))
        if leftmost:
            label = partial(labels.axis_label, self.stored[choice.y])
            ax.set_ylabel(label(False) if short else fonts.fit_label(label, 0.9 * self.inches[1], most=3))


@dataclass(frozen=True, eq=False)
class _JudgedLaw:
    """A law on a map: its row of `stored_verdicts.verdicts`, and the verdict on each line of the grid."""

    row: Mapping[str, Any]
    lines: xr.DataArray

    def at(self, where: Mapping[str, int]) -> xr.DataArray:
        """The verdicts at indices on other axes; a law has none along its own."""
        return self.lines.isel({name: i for name, i in where.items() if name in self.lines.dims})

    def is_mixed(self) -> bool:
        """Whether lines differ in their verdict."""
        return np.unique(self.lines.values).size > 1

    def counts(self, where: Mapping[str, int]) -> str:
        """How many lines of one map have each verdict: ``16 hold, 3 fail``."""
        verdicts = self.at(where).values
        return law_words.count({verdict: int(np.count_nonzero(verdicts == verdict)) for verdict in VERDICTS})

    def sentence(self, stored: StoredStudy) -> str:
        """``(1): the number of bends falls with E; true in part: true at R = 0.75 cm``, on the line that decides."""
        row = self.row
        at = ", ".join(labels.equation(stored[name], value) for name, value in row["at"].items())
        at = at.replace(" ", "\N{NO-BREAK SPACE}")
        show = law_panel.show_of(stored.expressions, stored[row["observable"]], stored[row["axis"]])
        text = law_words.law_in_words(row, labels.noun_of(row["observable"]), labels.axis_symbol(row["axis"]), show)
        said = f"{row['claim']}: {labels.typeset(text)}; {row['verdict']}"
        if not at:
            return said
        place = {
            name: int(np.abs(self.lines[name].values - value).argmin())
            for name, value in row["at"].items()
            if name in self.lines.dims
        }
        decided = str(self.lines.isel(place).values)
        how = f": {decided} at" if decided in VERDICTS and decided != row["verdict"] else "; judged at"
        return f"{said}{how} {at}"


def _law_sentence(sentence: str) -> str:
    """A sentence that begins with what its law is called: ``Law (1): ...``, ``Fewer bends: ...``."""
    return f"Law {sentence}" if sentence.startswith("(") else labels.capital(sentence)


def _judge(stored: StoredStudy, choice: Choice, rows: Sequence[Mapping[str, Any]]) -> list[_JudgedLaw]:
    """The laws on the observables shown; rows: of `stored_verdicts.verdicts`, in the same order."""
    return [
        _JudgedLaw(row, stored_verdicts.verdicts_of_lines(stored, law))
        for law, row in zip(stored.laws, rows, strict=True)
        if law.observable in choice.shown
    ]


def _draw_laws(
    ax: Axes,
    laws: Sequence[_JudgedLaw],
    cells: Cells,
    choice: Choice,
    where: Mapping[str, int],
    inches: tuple[float, float],
) -> list[Artist]:
    """Draw the laws along its axes on a map of that width and height in inches; returns the entries of the legend.

    The lines on which a law does not hold are a strip of colours beside the map, or above it. where: the indices on
    the other axes.
    """
    entries: list[Artist] = []
    count = {True: 0, False: 0}  # strips
    for law in laws:
        upward = law.row["axis"] == choice.x  # its lines lie one above the other
        across, scale = (choice.y, cells.y) if upward else (choice.x, cells.x)
        verdicts = law.at(where).sortby(across).values
        size = inches[0] if upward else inches[1]
        start, thick = 1 + (GAP + count[upward] * (THICK + GAP)) / size, THICK / size
        count[upward] += 1
        strip = ax.inset_axes((start, 0, thick, 1) if upward else (0, start, 1, thick))
        numbers, whole = np.ma.masked_where(verdicts == HOLDS, _numbers(verdicts)), np.array([0.0, 1.0])
        grid = (whole, scale.edges, numbers[:, None]) if upward else (scale.edges, whole, numbers[None])
        strip.pcolormesh(*grid, **OF_VERDICTS, rasterized=True)
        _hatch_false(strip, np.reshape(verdicts, grid[2].shape), *grid[:2])
        scale.apply(strip, "y" if upward else "x")
        strip.tick_params(left=False, bottom=False, labelleft=False, labelbottom=False)
        strip.set_axis_off()
        entries += _entries(verdicts, unless=HOLDS)
        at = law.row["at"]
        if across in at and all(name not in at or at[name] == float(cells.stored[name]) for name in where):
            place = float(labels.in_label_unit(cells.stored[across], at[across]))
            entries.append((ax.axhline if upward else ax.axvline)(place, **DECIDES))
    return entries


def _hatch_false(ax: Axes, verdicts: NDArray[np.str_], x: NDArray[np.float64], y: NDArray[np.float64]) -> None:
    """Hatch the cells of false laws, which have no colour of their own in grey; x, y: the edges of the cells."""
    if FAILS in verdicts:
        ax.add_patch(PathPatch(regions.path(verdicts == FAILS, x, y), **FALSE))


def _entries(verdicts: NDArray[np.str_], unless: str = "") -> list[Artist]:
    """The legend of the verdicts that occur, without that of one which is not drawn."""
    return [
        Patch(label=f"law {verdict} on these lines", **FALSE if verdict == FAILS else {"facecolor": colour})
        for verdict, colour in colours.VERDICTS.items()
        if verdict in verdicts and verdict != unless
    ]


def _numbers(verdicts: NDArray[np.str_]) -> NDArray[np.float64]:
    return np.vectorize(VERDICTS.index, otypes=[float])(verdicts)


def _refinement(stored: StoredStudy, rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """The refinement of a study in words, and the verdict of each of its laws."""
    watched = stored.refinement.watch
    ended = stored.refinement_in_words
    ended = re.sub(r"\w+", lambda word: labels.noun_of(word[0]) if word[0] in watched else word[0], ended)
    verdicts = [
        f"law {row['claim']}: {labels.law_text(row, law_words.law_in_words(row))}; {row['verdict']}" for row in rows
    ]
    return [labels.sentence(text) for text in (ended, *verdicts) if text]
