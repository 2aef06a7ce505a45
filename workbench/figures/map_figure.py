"""The maps of a stored study over two axes: one for each observable, and for each of some values of a third axis."""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..store import law_verdicts, refined, selection
from ..words import labels
from . import canvas, fonts, law_lines, map_panel, thumbnails
from .map_cells import MOST_MAPS, Cells, Choice, cells, choose
from .sheet import SCREEN, Sheet
from .study_figure import level_notes
from .trends import axis_label

COLUMN = 2.0  # inches, the height of maps in columns
LEAST_COLUMN = 1.45  # inches, their least width with a gap
MOST_NARROW = 2  # observables on one column of a page, where none is asked for


def figure(
    ds: xr.Dataset,
    x: str | None = None,
    y: str | None = None,
    show: Sequence[str] = (),
    at: Mapping[str, float] | None = None,
    shapes: thumbnails.Shapes | None = None,
    sheet: Sheet = SCREEN,
) -> Figure:
    """Draw a map of each observable.

    Each observable has one scale of colours over all its maps. A count has the borders of its regions and their
    numbers. A cross in place of a point is a case whose shape no real rod takes. A strip beside a map shows on which
    lines of the grid a law does not hold.
    A third axis has a column of maps for some of its values; any further axis is held where the laws or Table 1 put it.
    In the plane of a refined study each case is the cell around it, and its laws are told below the maps.

    Parameters
    ----------
    ds : xr.Dataset
    x, y, show, at
        As of `map_cells.choose`.
    shapes : thumbnails.Shapes, optional
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
    verdicts = law_verdicts.verdicts(ds) if "laws" in ds.attrs else []
    source, ds = ds, refined.raster(ds) if refined.is_refined(ds) else ds
    most = MOST_NARROW if sheet.narrow and not show else MOST_MAPS
    choice = choose(ds, x, y, show, at, max(int((sheet.width - 1.5) / LEAST_COLUMN), 1), most)
    if shapes is not None:
        thumbnails.check(source, ds, choice, shapes)
    whole = None if source is ds else source
    columns = [cells(ds, choice, where, whole) for where in choice.places()]
    laws, elsewhere = law_lines.judge(ds, choice, verdicts) if whole is None else ([], [])
    maps = _Maps(ds, choice, columns, laws, sheet)
    maps.asked = bool(show)
    maps.more = law_lines.of_coarse_grid(whole, verdicts) if whole is not None else []
    mixed = [law for law in elsewhere if law.is_mixed()]
    rows = maps.rows_of_panels()
    rows += canvas.in_rows([partial(maps.draw_law, law) for law in mixed], len(rows[0][1]), maps.small[1] + 1.2)
    if shapes is not None:
        rows.append((maps.of_shapes[1] + 0.8, [partial(maps.draw_shapes, shapes)]))
    alike = [f"Law {law_lines.sentence(law, ds, choice)}." for law in elsewhere if law not in mixed]
    said = [*map_panel.entries(columns, choice.shown), *maps.notes(), *alike]
    return canvas.page(ds, sheet, rows, said, 0.4)


class _Maps:
    """The maps of one figure, row by row; collects the entries of the legend while it draws."""

    def __init__(
        self, ds: xr.Dataset, choice: Choice, columns: list[Cells], laws: list[law_lines.JudgedLaw], sheet: Sheet
    ) -> None:
        self.width, self.across = sheet.width, 1 if sheet.narrow else 2
        alone = self.width - (1.25 if sheet.narrow else 2.0)
        self.large = alone, alone * 0.605  # inches of a map alone in its row
        beside = (self.width - 2.5) / 2
        self.small = self.large if sheet.narrow else (beside, beside * 0.775)  # of one of two
        self.of_shapes = self.width - 1.4, (self.width - 1.4) * 0.52
        self.ds, self.choice, self.columns, self.laws = ds, choice, columns, laws
        self.places = choice.places()
        self.more: list[str] = []
        self.drawn: dict[str, list[Axes]] = {}
        self.asked = False
        shown = choice.shown
        self.inches = self.large if len(shown) == 1 else self.small
        if choice.along:
            self.inches = (self.width - 1.8) / len(columns) - 0.15, COLUMN
        values = {name: np.stack([column.values(name) for column in columns]) for name in shown}
        self.colours = {name: map_panel.Colours(ds, name, values[name]) for name in shown}

    def rows_of_panels(self) -> list[canvas.Row]:
        """The maps in rows; along a third axis a row an observable."""
        shown, high = self.choice.shown, self.inches[1] + (0.6 if self.choice.along else 0.85)
        if not self.choice.along:
            return canvas.in_rows([partial(self.draw, name, 0, True) for name in shown], self.across, high)
        return [(high, [partial(self.draw, name, k, name == shown[-1]) for k in range(len(self.columns))])
                for name in shown]  # fmt: skip

    def draw(self, name: str, k: int, lowest: bool, ax: Axes) -> canvas.Said:
        """Draw the map of an observable in a column, with its bar of colours; along a third axis they share one."""
        column, where = self.columns[k], self.places[k]
        mesh = map_panel.draw(ax, column, name, self.colours[name], self.inches)
        entries = law_lines.draw(ax, self._laws_of(name), column, self.choice, where, self.inches)
        said = self._title(ax, name, where, leftmost=k == 0)
        self._label(ax, leftmost=k == 0, lowest=lowest)
        self.drawn[name] = [*self.drawn.get(name, []), ax]
        if k == len(self.columns) - 1 or not self.choice.along:
            self.colours[name].bar(mesh, self.drawn[name])
        return [*entries, *said]

    def draw_law(self, law: law_lines.JudgedLaw, ax: Axes) -> canvas.Said:
        """Draw a map of its own for a law along a further axis."""
        where = self.places[0]
        entries = law_lines.draw_map(ax, law, self.columns[0], where)
        self._label(ax, leaving=law.row["axis"])
        ax.set_title(f"verdicts on {law.row['observable']} along {labels.axis_symbol(law.row['axis'])}", loc="left")
        said = f"{law_lines.sentence(law, self.ds, self.choice)}; lines: {law_lines.counts(law, where)}"
        return [*entries, f"Law {said}."]

    def draw_shapes(self, shapes: thumbnails.Shapes, ax: Axes) -> canvas.Said:
        """Draw the panel of shapes: those of the first column, on a pale map of the first observable."""
        name, column = self.choice.shown[0], self.columns[0]
        map_panel.draw(ax, column, name, self.colours[name], self.of_shapes, pale=0.3)
        self._label(ax)
        held = [labels.equations(self.ds, self.places[0])] if self.choice.along else []
        ax.set_title(", ".join([f"unrolled views over the {labels.long_name(self.ds[name])}", *held]), loc="left")
        return thumbnails.draw(ax, column, shapes, self.of_shapes)

    def notes(self) -> list[str]:
        """What the figure says in words."""
        choice, found = self.choice, list(self.more)
        if choice.along:
            found += [f"Law {law_lines.sentence(law, self.ds, choice)}." for law in self.laws]
        if choice.along and len(choice.columns) < self.ds.sizes[choice.along]:
            of = f"the {self.ds.sizes[choice.along]} values of {labels.axis_symbol(choice.along)}"
            found.append(f"The columns show {len(choice.columns)} of {of}.")
        if not self.asked:
            found += level_notes(self.ds, selection.observables(self.ds))
        if choice.left_out:
            found.append(f"Not drawn: {', '.join(choice.left_out)}; choose with --show.")
        if choice.along and choice.held:
            found.append(f"All maps: {labels.equations(self.ds, choice.held)}.")
        return found

    def _laws_of(self, name: str) -> list[law_lines.JudgedLaw]:
        return [law for law in self.laws if law.row["observable"] == name]

    def _title(self, ax: Axes, name: str, where: Mapping[str, int], leftmost: bool) -> list[str]:
        """The observable and the value of the third axis; returns what is said of each law."""
        laws = self._laws_of(name)
        above = sum(law.row["axis"] == self.choice.y for law in laws) * (law_lines.THICK + law_lines.GAP) * 72
        along = self.choice.along
        value = labels.equations(self.ds, {along: where[along]}) if along else ""
        told = []
        for law in laws:
            said, lines = law_lines.sentence(law, self.ds, self.choice), law_lines.counts(law, where)
            text = f"{law.row['claim']}: {lines}" if self.choice.along else f"{said}; lines: {lines}"
            told.append(f"Law {text}{f' at {value}' if value else ''}.")
        title = labels.label(self.ds[name], long=True) + self.colours[name].said()
        title = fonts.break_lines(title, self.inches[0] + 0.3)
        if self.choice.along:
            title = f"{title}\n{value}" if leftmost else value
        ax.set_title(title, loc="left", pad=above + 6)
        return told

    def _label(self, ax: Axes, leftmost: bool = True, lowest: bool = True, leaving: str = "") -> None:
        """The labels of the two axes at the edge of the figure; the values of further axes stand behind that of x.

        leaving: an axis whose value is left out.
        """
        choice = self.choice
        short = choice.along is not None
        held = {} if short else {name: i for name, i in self.places[0].items() if name != leaving}
        where = {**held, choice.x: 0}
        if lowest:
            ax.set_xlabel(
                fonts.break_lines(axis_label(self.ds, choice.x, where, long=not short), max(self.inches[0], 1.0))
            )
        else:
            ax.tick_params(labelbottom=False)
        if leftmost:
            words = [labels.axis_label(choice.y, self.ds[choice.y], long and not short) for long in (True, False)]
            ax.set_ylabel(fonts.shorter(words, 0.7 * self.inches[1]))
        else:
            ax.tick_params(labelleft=False)
