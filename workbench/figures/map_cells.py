"""What a map shows: its two axes, its observables, the values of further axes, and the cells of each panel."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, QuadMesh
from numpy.typing import NDArray

from solver.problem.declared_fields import FIELDS
from solver.problem.errors import InputError, choices
from studies.grammar.axes import SAMPLE, WORDS
from studies.language.refine_table import LEVEL

from ..stored.quantity_variables import dimension
from ..stored.stored_cases import BENDS, NEARLY_STRAIGHT
from ..stored.stored_study import StoredStudy
from ..words import caution_words, labels
from . import regions
from .axis_scales import Scale, scale_of

SWING = "swing"  # the logarithm of what `swings` gives of the cases of a refined study, as a variable of its raster
LEAST = 1e-12  # rad: beta of a straight rod varies by rounding. x10: no change, as all of them are nearly straight
MOST_COLUMNS = 5  # values of a third axis
MOST_MAPS = 4  # observables where none is asked for


@dataclass(frozen=True, eq=False)
class Choice:
    """What a figure of maps shows.

    x, y: the two axes. shown: the observables; left_out: those that have no room. along: a third axis of which some
    values have a column each, or None; columns: their indices on it. held: the index on every further axis.
    """

    x: str
    y: str
    shown: tuple[str, ...]
    left_out: tuple[str, ...]
    along: str | None
    columns: tuple[int, ...]
    held: Mapping[str, int]

    def places(self) -> list[dict[str, int]]:
        """The indices on all axes but x and y, of each column."""
        return [{**self.held, self.along: i} for i in self.columns] if self.along else [dict(self.held)]


@dataclass(frozen=True, eq=False)
class Cells:
    """The cells of one column of maps, (rows, columns) of the values of y and x, both rising.

    stored: the cases there. solved: of each cell. straight: whether beta varies by less than `NEARLY_STRAIGHT` along
    its rod. turned: whether its rod turns back against both its ends, and has no colour as laws leave it out.
    source: the study with the arrays along the rod, at `place`.
    """

    stored: StoredStudy
    x: Scale
    y: Scale
    solved: NDArray[np.bool_]
    straight: NDArray[np.bool_]
    turned: NDArray[np.bool_]
    source: StoredStudy

    def place(self, j: int, i: int) -> dict[str, int]:
        """The indices of the case of a cell in the source."""
        if SAMPLE in self.source.sizes:
            return {SAMPLE: int(self.stored["case"].values[j, i])}
        down, across = map(str, self.stored["outcome"].dims)
        return {down: j, across: i}

    def samples(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
        """The values of x and y of the cases, and whether no real rod could keep the shape, (n,) each."""
        refined = SAMPLE in self.source.sizes
        stored = self.source if refined else self.stored
        texts = stored["caution"].values.ravel() if "caution" in stored else np.full(stored["outcome"].size, "")
        barred = np.array([caution_words.is_barred(str(text)) for text in texts])
        if refined:
            x, y = (
                labels.in_label_unit(stored[str(dim)], stored[str(dim)].values)
                for dim in self.stored["outcome"].dims[::-1]
            )
            return x, y, barred
        x, y = np.meshgrid(self.x.values, self.y.values)
        return x.ravel(), y.ravel(), barred

    def nearly_straight(self, name: str) -> NDArray[np.bool_]:
        """The cases of a refined study whose number the map of `name` does not show, (n,): of those its coarse grid
        alone is drawn, as the others were added where that number changes."""
        return self.source.unbent(name).values.ravel() & (SAMPLE in self.source.sizes)

    def marks(self, name: str, one_of: int) -> NDArray[np.int64]:
        """The indices of the cases that the map of `name` has a mark for, of one out of so many."""
        shown, straight = np.arange(self.samples()[2].size) % one_of == 0, self.nearly_straight(name)
        return np.flatnonzero(np.where(straight, self.source[LEVEL].values == 0, shown) if straight.any() else shown)

    def values(self, name: str) -> NDArray[np.float64]:
        """An observable in the unit of its label, NaN where a cell is not solved, turns back or has no known number,
        and the number of bends of a rod that is nearly straight."""
        values = labels.in_label_unit(self.stored[name], self.stored[name].values.astype(float))
        return np.where(self.solved & ~self.turned & np.isfinite(values) & ~self.unbent(name), values, np.nan)

    def colour(self, ax: Axes, values: NDArray[np.float64], **colours: Any) -> QuadMesh:
        """Colour the cells by values; colours: options of `pcolormesh`."""
        self.x.apply(ax, "x")
        self.y.apply(ax, "y")
        return ax.pcolormesh(self.x.edges, self.y.edges, np.ma.masked_invalid(values), rasterized=True, **colours)

    def draw_borders(self, ax: Axes, values: NDArray[np.float64], **look: Any) -> None:
        """Draw the borders between cells of different values."""
        lines = list(regions.borders(values, self.x.edges, self.y.edges))
        ax.add_collection(LineCollection(lines, **look), autolim=False)

    def unbent(self, name: str) -> NDArray[np.bool_]:
        """Where an observable is the number of bends of a rod that is nearly straight."""
        return self.straight & (name == BENDS)


def mappable(stored: StoredStudy) -> list[str]:
    """The axes that a map can have: those of a field of the case with at least two values."""
    fields = {dimension(name) for name in FIELDS if name not in WORDS}
    return [axis for axis in stored.varied if axis in fields]


def choose(
    stored: StoredStudy,
    x: str | None = None,
    y: str | None = None,
    show: Sequence[str] = (),
    at: Mapping[str, float] | None = None,
    columns: int = MOST_COLUMNS,
    most: int = MOST_MAPS,
) -> Choice:
    """What a figure of maps shows.

    Parameters
    ----------
    stored : StoredStudy
    x, y : str, optional
        The axes to the right and up; default: the first axes of the study.
    show : sequence of str
        Observables; default: of those that vary, first those of laws, as many as have room.
    at : mapping of float, optional
        Values of further axes.
    columns : int
        For how many values of a third axis there is room.
    most : int
        Observables for which there is room.

    Returns
    -------
    Choice

    Raises
    ------
    InputError
        For fewer than two axes, an unknown axis or observable, `x` equal to `y`, too many observables.
    """
    x, y = _two_axes(stored, x, y, dict(at or {}))
    shown = stored.names_of_figure(show) if show else list(stored.names_that_vary or stored.observables[:1])
    left_out: Sequence[str] = ()
    if not show:
        judged = {law.observable for law in stored.laws}
        shown.sort(key=lambda name: name not in judged)
        # a map of a property of two values has nothing to read off, unless there is no other
        known = {name: stored[name].values[np.isfinite(stored[name].values)] for name in shown}
        flags = [name for name, values in known.items() if values.size and np.isin(values, (0, 1)).all()]
        if properties := [name for name in flags if name in stored.counts and len(flags) < len(shown)]:
            shown = [name for name in shown if name not in properties]
            left_out = properties
        shown, left_out = shown[:most], [*shown[most:], *left_out]
    if not shown:
        raise InputError("the study stores no observable; a map shows one")
    held = {name: i for name, i in stored.place(at).items() if name not in (x, y)}
    free = [axis for axis in mappable(stored) if axis in held and axis not in (at or {})]
    if not free:
        return Choice(x, y, tuple(shown), tuple(left_out), None, (), held)
    order = [where[free[0]] for where in stored.places(free[0], most=min(columns, MOST_COLUMNS))]
    del held[free[0]]
    return Choice(x, y, tuple(shown), tuple(left_out), free[0], tuple(order), held)


def cells(stored: StoredStudy, choice: Choice, where: Mapping[str, int], source: StoredStudy | None = None) -> Cells:
    """The cells of one column of maps; where: as of `Choice.places`. source: the refined study of a raster."""
    plane = stored.plane(choice.x, choice.y, where)
    solved = plane["solved"].values.astype(bool)
    turned = np.zeros(solved.shape, dtype=bool)
    if leaves_out_turned(stored):
        turned = solved & caution_words.has_key(plane["caution"].values, caution_words.TURNED)
    scales = scale_of(plane, choice.x), scale_of(plane, choice.y)
    swing = np.exp(plane[SWING].values) if SWING in plane else plane.swings.values
    straight = solved & (swing < NEARLY_STRAIGHT)
    return Cells(plane, *scales, solved, straight, turned, plane if source is None else source)


def leaves_out_turned(stored: StoredStudy) -> bool:
    """Whether maps leave out rods that turn back against both their ends: not where all do, or where a law has them."""
    if "caution" not in stored or any(law.turned_back for law in stored.laws):
        return False
    solved = stored["solved"].values.astype(bool)
    return not caution_words.has_key(stored["caution"].values, caution_words.TURNED)[solved].all()


def raster_of(stored: StoredStudy) -> StoredStudy:
    """The raster of a refined study, on which beta varies evenly between the cases: a limit of nearly straight rods
    along the edges of the cells around them would have steps as large as these. By its logarithm, as it may grow
    tenfold from one case to the next."""
    return stored.raster(**{SWING: np.log(np.maximum(stored.swings.values, LEAST))})


def _two_axes(stored: StoredStudy, x: str | None, y: str | None, at: dict[str, float]) -> tuple[str, str]:
    """The axes to the right and up."""
    axes = mappable(stored)
    if len(axes) < 2:
        has, kind = f"only {axes[0]}" if axes else "none", "lines" if stored.varied else "rod"
        raise InputError(f"a map needs two axes with several values, and the study has {has}; choose the kind {kind}")
    given = [stored.axis(name) for name in (x, y) if name is not None]
    if len(given) == 2 and given[0] == given[1]:
        others = choices(axis for axis in axes if axis != given[0])
        raise InputError(f"x and y are both {given[0]}; choose another axis for one of them: {others}")
    for name in given:
        if name not in axes:
            raise InputError(f"the axis {name} has a single value; choose from {choices(axes)}")
        if name in at:
            raise InputError(f"{name} is an axis of the map and has no fixed value; leave out the value of {name}")
    rest = [axis for axis in axes if axis not in given and axis not in at]
    if len(given) + len(rest) < 2:
        raise InputError(
            f"a map needs two axes, and {choices(at)} has a fixed value; leave one of {choices(axes)} free"
        )
    names_left = iter(rest)
    first = next(names_left) if x is None else given[0]
    return first, (next(names_left) if y is None else given[-1])
