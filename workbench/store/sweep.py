"""A sweep over ends problems: the order of its cases, and the cases from which its blocks begin.

The first case is the middle of the grid, along a followed axis the first value. From it the cases continue along the
first axis, from each of these along the second, and so on: a tree in which each case is one step from the one it
continues from. The order depends on the grid alone.

The process of the run solves the cases from which blocks begin (`Spine`), without arrays along the rod. A worker begins
at the cases that came with its block, so the bits do not depend on which worker it is.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from studies import Study

from .case_solutions import State, select, state_of, step

LINE = 256  # cases of a line that is solved in one block where there are several lines
BLOCK_OF_ONE, BLOCK_OF_LONG = 8, 32  # cases a block: of a single line, and of lines longer than that
MOST_KEPT = 2000  # cases of a single line that the run itself solves


@dataclass(frozen=True)
class Grid:
    """The order of a sweep. shape: of the grid; places are counted along the axes, the last fastest. follows: whether
    the last axis is followed, from its first value on."""

    shape: tuple[int, ...]
    follows: bool = False

    @property
    def first(self) -> tuple[int, ...]:
        """The cell that the others continue from: the middle, or the begin of a followed axis."""
        middle = tuple((n - 1) // 2 for n in self.shape)
        return (*middle[:-1], 0) if self.follows else middle

    def cell(self, place: int) -> tuple[int, ...]:
        return tuple(int(i) for i in np.unravel_index(place, self.shape))

    def place(self, cell: tuple[int, ...]) -> int:
        return int(np.ravel_multi_index(cell, self.shape))

    def parent(self, place: int) -> tuple[int, int] | None:
        """The place that a case continues from, and the axis between the two; None for the first case."""
        cell, first = list(self.cell(place)), self.first
        for k in range(len(cell) - 1, -1, -1):
            if cell[k] != first[k]:
                cell[k] += 1 if cell[k] < first[k] else -1
                return self.place(tuple(cell)), k
        return None

    def pieces(self, start: int, stop: int) -> Iterable[tuple[int, int, int]]:
        """Of the cases `start` to `stop` each stretch on one line of the last axis: begin, end, and the case in it that
        the others of the stretch continue from."""
        n, middle = self.shape[-1], self.first[-1]
        a = start
        while a < stop:
            line = a // n * n
            b = min(line + n, stop)
            yield a, b, min(max(line + middle, a), b - 1)
            a = b


def block_size(shape: tuple[int, ...], most: int) -> int:
    """Cases a block, at most `most`: whole lines where they are short and several."""
    n = shape[-1]
    if len(shape) == 1 or math.prod(shape) == n:
        return max(1, min(BLOCK_OF_ONE, most))
    if n > min(LINE, most):
        return max(1, min(BLOCK_OF_LONG, most))
    return n * max(1, min(BLOCK_OF_LONG, most) // n)


@dataclass(frozen=True, eq=False)
class States:
    """The states of the cases of a sweep, each found when it is first needed, after the case that it continues from.

    values: the fields that vary of a case, by its place. keeps: whether the state of a case is kept, by its place.
    known: those that are.
    """

    study: Study
    grid: Grid
    values: Callable[[int], dict[str, float]]
    keeps: Callable[[int], bool]
    known: dict[int, State] = field(default_factory=dict)

    def state(self, place: int) -> State:
        """The state of one case."""
        way: list[tuple[int, tuple[int, int] | None]] = []
        at: int | None = place
        while at is not None and at not in self.known:
            parent = self.grid.parent(at)
            way.append((at, parent))
            at = None if parent is None else parent[0]
        state = None if at is None else self.known[at]
        for step_at, parent in reversed(way):
            state = self._continue(step_at, parent, state)
            if self.keeps(step_at):
                self.known[step_at] = state
        assert state is not None
        return state

    def _continue(self, place: int, parent: tuple[int, int] | None, before: State | None) -> State:
        case = self.study.case_of(self.values(place))
        if parent is None or before is None:
            return state_of(select(self.study, case), 0)
        neighbour, axis = self.values(parent[0]), parent[1]
        name = list(neighbour)[axis]
        return step(self.study, case, before, place, name, neighbour[name])


@dataclass(frozen=True, eq=False)
class Spine:
    """The cases from which the blocks of a sweep begin. coordinates: of each axis. block: cases in a block."""

    study: Study
    coordinates: Mapping[str, NDArray[np.float64]]
    block: int

    @property
    def grid(self) -> Grid:
        return Grid(tuple(values.size for values in self.coordinates.values()), self.study.followed is not None)

    @cached_property
    def _states(self) -> States:
        return States(self.study, self.grid, self._values, self._keeps)

    def first(self) -> State:
        """The state of the first case."""
        return self._states.state(self.grid.place(self.grid.first))

    def hand_over(self, start: int, stop: int) -> dict[int, State]:
        """The states that the blocks of the cases `start` to `stop` begin with."""
        places: list[int] = []
        for a in range(start, stop, self.block):
            b = min(a + self.block, stop)
            places += range(a, b) if self._keeps_all else [entry for _, _, entry in self.grid.pieces(a, b)]
        return {place: self._states.state(place) for place in places}

    def nearest(self, values: Mapping[str, float]) -> State:
        """The state of the case nearest to these values of the axes."""
        rows = self.coordinates.items()
        cell = tuple(int(np.abs(row - values[name]).argmin()) for name, row in rows)
        return self._states.state(self.grid.place(cell))

    def _values(self, place: int) -> dict[str, float]:
        cell = self.grid.cell(place)
        return {name: float(values[i]) for (name, values), i in zip(self.coordinates.items(), cell, strict=True)}

    @property
    def _keeps_all(self) -> bool:
        shape = self.grid.shape
        return math.prod(shape) == shape[-1] <= MOST_KEPT

    def _keeps(self, place: int) -> bool:
        grid = self.grid
        if self._keeps_all or grid.cell(place)[-1] == grid.first[-1]:
            return True
        start = place // self.block * self.block
        stop = min(start + self.block, math.prod(grid.shape))
        return any(place == entry for _, _, entry in grid.pieces(start, stop))


def states_of_block(
    study: Study, shape: tuple[int, ...], values: Mapping[str, NDArray[np.float64]], start: int,
    known: Mapping[int, State],
) -> Iterator[State]:  # fmt: skip
    """The states of the cases from `start` on, in order, each after one of those known.

    shape: of the grid. values: of each axis, (cases,).
    """

    def place_values(place: int) -> dict[str, float]:
        return {name: float(row[place - start]) for name, row in values.items()}

    states = States(study, Grid(shape, study.followed is not None), place_values, lambda place: True, dict(known))
    return (states.state(start + i) for i in range(next(iter(values.values())).size))
