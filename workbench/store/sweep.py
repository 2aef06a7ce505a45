"""A sweep over ends problems: each case is solved by the study's rule, and labelled with the branch that it lies on.

The equilibrium of a case depends on its own numbers only. A case is on the branch of its neighbour, in the order of
`sweep_order`, if the equilibrium of the neighbour continues to its own; else it begins a branch of another number. Only
along a followed axis the equilibrium itself continues from the case before.

The process of the run solves the cases from which blocks begin (`Spine`), without arrays along the rod. A worker begins
at the cases that came with its block, so the bits do not depend on which worker it is.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from solver import Case, Solution, equilibria, solve
from solver.choose.selection import INCOMPLETE, NEAREST, Choose
from solver.equilibria import nearest
from solver.observe.observables import observe
from studies import Study
from studies.grammar.axes import Which, is_angle

from ..words.branch_numbers import NONE
from .followed_case import follow_to
from .sweep_order import Grid

LOST = "unstable here, stable where its branch begins"
SAME = 1e-6  # of the numbers at both ends, in units of rho: below it two solutions are one
MOST_KEPT = 2000  # cases of a single line that the run itself solves


@dataclass(frozen=True, eq=False)
class State:
    """The equilibrium of one case, with stations at its two ends only.

    branch: 0 for that of the first case, else 1 + the flat index of the case where it begins; `NONE` where the case is
    not solved. stable: whether the branch is stable where it begins. remark: an addition to the outcome: where the
    branch begins, or that it is not stable here.
    """

    solution: Solution
    branch: int
    stable: bool
    remark: str = ""

    @property
    def solved(self) -> bool:
        return self.branch != NONE


@dataclass(frozen=True, eq=False)
class Spine:
    """The cases from which blocks begin, each compared with those before it when it is first needed."""

    study: Study
    coordinates: Mapping[str, NDArray[np.float64]]
    block: int
    known: dict[int, State] = field(default_factory=dict)

    @property
    def grid(self) -> Grid:
        return grid_of(self.study, tuple(values.size for values in self.coordinates.values()))

    def first(self) -> State:
        """The state of the first case."""
        return self.state(self.grid.place(self.grid.first))

    def hand_over(self, start: int, stop: int) -> dict[int, State]:
        """The states that the blocks of the cases `start` to `stop` begin with."""
        wanted: list[int] = []
        for a in range(start, stop, self.block):
            b = min(a + self.block, stop)
            wanted += range(a, b) if self._keeps_all else [entry for _, _, entry in self.grid.pieces(a, b)]
        return {place: self.state(place) for place in wanted}

    def nearest(self, values: Mapping[str, float]) -> State:
        """The state of the case nearest to these values of the axes."""
        rows = self.coordinates.items()
        return self.state(self.grid.place(tuple(int(np.abs(row - values[name]).argmin()) for name, row in rows)))

    def state(self, place: int) -> State:
        """The state of one case."""
        way: list[tuple[int, tuple[int, int] | None]] = []
        at: int | None = place
        while at is not None and at not in self.known:
            parent = self.grid.parent(at)
            way.append((at, parent))
            at = None if parent is None else parent[0]
        state = None if at is None else self.known[at]
        for here, parent in reversed(way):
            state = self._solve_place(here, parent, state)
            if self._keeps(here):
                self.known[here] = state
        assert state is not None
        return state

    def _solve_place(self, place: int, parent: tuple[int, int] | None, before: State | None) -> State:
        case = self.study.case_of(self._values(place))
        if parent is None or before is None:
            return state_of(select(self.study, case), 0)
        name = list(self.coordinates)[parent[1]]
        return step(self.study, case, before, place, name, self._values(parent[0])[name])

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


def grid_of(study: Study, shape: tuple[int, ...]) -> Grid:
    """The order of the cases of a study."""
    return Grid(shape, study.followed is not None)


def rule_of(which: Which | None) -> Choose:
    """The rule by which a study takes the equilibrium of a case."""
    return NEAREST if which is None or which.rule is None else which.rule


def select(study: Study, case: Case) -> Solution:
    """The equilibrium of a case that the study's rule takes, at two stations."""
    which = study.equilibrium
    if which is not None and which.dbeta0 is not None and which.energy is not None:
        every = equilibria(case, study.tol, 2)
        if len(every):
            return nearest(every, which.dbeta0, which.energy).solution
    return solve(case, tol=study.tol, stations=2, choose=rule_of(which))


def step(study: Study, case: Case, before: State, place: int, name: str, neighbour: float) -> State:
    """The state of a case next to another one. Along a followed axis it continues from that one.

    name: the axis between the two. neighbour: its value there.
    """
    at = tell(name, neighbour)
    if name == study.followed:
        return state_of(follow_to(before.solution, case, name, at), before.branch, before.stable)
    taken = select(study, case)
    if not before.solved:
        return state_of(taken, 1 + place, remark=f"taken anew, as none was found at {at}")
    if not taken.solved or continues(before.solution, taken):
        return state_of(taken, before.branch, before.stable)
    return state_of(taken, 1 + place, remark=f"another branch than at {at}")


def continues(before: Solution, sol: Solution) -> bool:
    """Whether the branch of a solution leads to another one, of a case that differs in its numbers."""
    reached = solve(sol.case, tol=sol.tol, stations=2, seed=before)
    if not reached.solved:
        return False
    rho, ends = float(sol.case.rho), []
    for one in (reached, sol):
        ends.append(np.concatenate([one.beta, one.dbeta * rho, one.alpha - one.alpha[0], (one.z - one.z[0]) / rho]))
    return bool(np.abs(ends[0] - ends[1]).max() <= SAME * (1 + np.abs(ends[1]).max()))


def state_of(sol: Solution, branch: int, stable: bool | None = None, remark: str = "") -> State:
    """A state that can be sent to another process. stable: of its branch where that begins; None: it begins here."""
    light = replace(sol, trajectory=replace(sol.trajectory, swirl=_not_kept))
    if not sol.solved:
        return State(light, NONE, False)
    here = float(sol.held_index if sol.held else observe(light, ["index"])["index"]) == 0
    if stable and not here:
        remark = LOST
    if sol.selection is not None and not sol.selection.complete:
        remark = f"{remark}; {INCOMPLETE}" if remark else INCOMPLETE
    return State(light, branch, here if stable is None else stable, remark)


def _not_kept() -> NDArray[np.float64]:
    raise NotImplementedError("the state of a sweep keeps no shape")


def tell(name: str, value: float) -> str:
    """``FZ = -150``; angles in degrees."""
    return f"{name} = {np.rad2deg(value):.6g} deg" if is_angle(name) else f"{name} = {value:.6g}"


def walk_states(
    study: Study, grid: Grid, values: Mapping[str, NDArray[np.float64]], start: int, known: Mapping[int, State]
) -> list[State]:
    """The states of the cases from `start` on, in order, each after one of those known.

    values: of each axis, (cases,).
    """
    cases = next(iter(values.values())).size
    name = list(values)[-1]
    found: dict[int, State] = {}
    for a, b, entry in grid.pieces(start, start + cases):
        found[entry] = known[entry]
        for way, last in ((1, b), (-1, a - 1)):
            for place in range(entry + way, last, way):
                if place in known:
                    found[place] = known[place]
                    continue
                case = study.case_of({axis: row[place - start] for axis, row in values.items()})
                neighbour = float(values[name][place - way - start])
                found[place] = step(study, case, found[place - way], place, name, neighbour)
    return [found[start + i] for i in range(cases)]
