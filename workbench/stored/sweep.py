"""Sweeps: studies whose cases continue from one another, to tell their branches or because an axis is followed.

In a sweep over ends problems the equilibrium of a case depends on its own numbers only. It is on the branch of its
neighbour if the equilibrium of the neighbour continues to its own; else it is on another branch: on that of a neighbour
along another axis that continues to it and is on another branch too, or on one of a new number. Only along a followed
axis the equilibrium itself continues from the case before; where the branch does not reach a case, it has none.

The first case of a sweep is the middle of the grid, along a followed axis the first value. From it the cases continue
along the first axis, from each of these along the second, and so on: a tree in which each case is one step from the one
it continues from. The order depends on the grid alone. The process of the run solves the cases from which blocks begin
(`Sweep`), without arrays along the rod. A worker begins at the cases that came with its chunk, so the bits do not
depend on which worker it is.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver import Branch, Case, InputError, Solution, follow, solve
from solver.follow_result import BORDER, HELIX
from solver.numerics.arclength import FOLD
from solver.observe.observables import observe
from solver.problem.case_fields import value_of
from solver.problem.errors import attempt
from studies import Study
from studies.grammar.axes import in_words, quantity_of

from ..words.outcome_counts import NO_BRANCH
from .case_solving import solve_one

LOST = "unstable here, stable where its branch begins"
BEYOND = "failed: the followed branch"
SAME = 1e-6  # of the numbers at both ends, in units of rho: below it two solutions are one
_STRAIGHT = 1e-6  # rad
SHAPE = ("beta", "dbeta", "alpha", "z")
_DENSE = 2001  # stations of the seed of a method that knows the rod at stations only


@dataclass(frozen=True, eq=False)
class SweepState:
    """The equilibrium of one case, with stations at its two ends only.

    branch: 0 for that of the first case, else 1 + the flat index of a case where it begins; `NONE` where the case is
    not solved. stable: whether the branch is stable where it begins. remark: an addition to the outcome: where the
    branch begins, or that it is not stable here.
    """

    solution: Solution
    branch: int
    stable: bool
    remark: str = ""

    @property
    def solved(self) -> bool:
        return self.branch != NO_BRANCH


def select(study: Study, case: Case) -> Solution:
    """The equilibrium of a case that the study's rule takes, at two stations."""
    return solve_one(case, study.equilibrium, study.tol, "auto", 2)


def step(study: Study, case: Case, before: SweepState, place: int, name: str, neighbour: float) -> SweepState:
    """The state of a case next to another one. Along a followed axis it continues from that one.

    name: the axis between the two. neighbour: its value there.
    """
    at = in_words(name, neighbour)
    if name == study.variation.followed:
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
    for each in (reached, sol):
        ends.append(
            np.concatenate([each.beta, each.dbeta * rho, each.alpha - each.alpha[0], (each.z - each.z[0]) / rho])
        )
    return bool(np.abs(ends[0] - ends[1]).max() <= SAME * (1 + np.abs(ends[1]).max()))


def follow_to(before: Solution, case: Case, field: str, neighbour: str) -> Solution:
    """The solution of a case on the branch of another one, which differs in one field; or unsolved, with the reason.

    field: its name in a study. neighbour: its value in the other case, in words.
    """
    if not before.solved:
        said = str(before.outcome)
        first = f"failed: no equilibrium at {neighbour}, from which the axis is followed"
        return _blank(before, case, said if said.startswith(BEYOND) else first)
    name = quantity_of(field).name
    value = value_of(case, name)
    target: dict[str, Any] = {name: value}
    try:
        branch = attempt(lambda: follow(before, **target))
    except InputError as error:
        branch = str(error)
    if isinstance(branch, str):
        return _blank(before, case, f"{BEYOND} stops at {neighbour}: {branch.removeprefix('failed: ')}")
    if (why := _end(branch, value)) is not None:
        return _blank(before, case, why)
    reached = solve(case, tol=before.tol, stations=2, seed=branch.points[-1].solution)
    return reached if reached.solved else _blank(before, case, f"{BEYOND} stops before this case: {reached.outcome}")


def _end(branch: Branch, value: float) -> str | None:
    """Where and why a branch does not reach a value without turning back; None where it does."""
    for special in branch.special:
        if special.kind == FOLD:
            return f"{BEYOND} ends in a fold at {in_words(branch.field, special.value, 10)}"
    if branch.values[-1] == value:
        return None
    far = branch.values[int(np.abs(branch.values - branch.values[0]).argmax())]
    if branch.end.kind == BORDER:  # back at its own value, without a fold
        where = f"a pitchfork at {in_words(branch.field, float(far), 10)}"
        turn = next((special for special in branch.special if special.value == far), None)
        beta = np.full(2, np.nan) if turn is None else branch.points[turn.position].solution.beta
        if np.ptp(beta) > _STRAIGHT or not abs(np.sin(beta[0])) < _STRAIGHT:
            return f"{BEYOND} turns back in {where}"
        return f"{BEYOND} ends where the rod becomes straight, in {where}"
    if branch.end.kind == HELIX:
        return f"{BEYOND} ends at {in_words(branch.field, branch.end.value, 10)}: {branch.end.reason}"
    return f"{BEYOND} stops at {in_words(branch.field, branch.end.value, 10)}: {branch.end.reason}"


def state_of(sol: Solution, branch: int, stable: bool | None = None, remark: str = "") -> SweepState:
    """A state that can be sent to another process. stable: of its branch where that begins; None: it begins here."""
    light = replace(sol, trajectory=replace(sol.trajectory, swirl=_not_kept))
    if not sol.solved:
        return SweepState(light, NO_BRANCH, False)
    is_stable = float(sol.held_index if sol.held else observe(light, ["index"])["index"]) == 0
    if stable and not is_stable:
        remark = LOST
    said = "" if sol.selection is None else sol.selection.remark
    remark = "; ".join(filter(None, (remark, said)))
    return SweepState(light, branch, is_stable if stable is None else stable, remark)


def _not_kept() -> NDArray[np.float64]:
    raise NotImplementedError("the state of a sweep keeps no shape")


def show(study: Study, state: SweepState, stations: Any = None) -> Solution:
    """The solution of a state by the study's method, at the study's stations or at others: a number, or values of s."""
    from solver.methods import AUTOMATIC

    stations = study.stations if stations is None else stations
    method = study.method if study.method != "auto" else AUTOMATIC["ends"]
    if not state.solved:
        return _without_shape(state.solution, _times(state.solution, stations))
    known = state.solution.trajectory
    if method == state.solution.method and (known.orbit is not None or known.shapes is not None):
        return read(state.solution, stations)
    return solve(state.solution.case, study.tol, method, stations, seed=read(state.solution, _DENSE))


def between(study: Study, case: Case, near: Callable[[], SweepState], stations: Any) -> Solution:
    """A case between those of a sweep, at so many stations: by the study's rule, or on the branch that it follows.

    near: makes the state of the nearest case of the sweep.
    """
    if study.variation.followed is None:
        return show(study, state_of(select(study, case), 0), stations)
    state = near()
    if state.solved:
        state = state_of(solve(case, tol=study.tol, stations=2, seed=state.solution), state.branch, state.stable)
    return show(study, state, stations)


def read(sol: Solution, stations: Any) -> Solution:
    """An equilibrium at so many stations, or at these values of s, from its orbit or its shape on nodes."""
    t, orbit, shapes = _times(sol, stations), sol.trajectory.orbit, sol.trajectory.shapes
    if orbit is None:
        along = shapes.read(t, np.reshape(sol.case.given.alpha, -1))
        return _with_shape(sol, t, [along[name] for name in SHAPE], along["swirl"])
    return _with_shape(sol, t, orbit.at(t), partial(orbit.swirl, t))


def _blank(before: Solution, case: Case, outcome: str) -> Solution:
    """A case without a solution, in the form of that of the case before it."""
    held = None if before.trajectory.held_index is None else np.array([np.nan])
    judged = {"solved": np.array([False]), "outcome": np.array([outcome], dtype=object), "held_index": held}
    judged |= {name: np.array([np.inf]) for name in ("error", "condition")}
    return _without_shape(replace(before, case=case), before.t, **judged)


def _without_shape(sol: Solution, t: NDArray[np.float64], **judged: Any) -> Solution:
    """A case that is not solved, with NaN at the stations t, (1, n)."""
    nothing = np.full(t.shape, np.nan)
    return _with_shape(sol, t, [nothing] * 4, partial(np.asarray, nothing), orbit=None, **judged)


def _with_shape(sol: Solution, t: NDArray[np.float64], shape: Any, swirl: Callable[[], Any], **others: Any) -> Solution:
    """A solution with other arrays: beta, dbeta, alpha and z at the stations t, (1, n). others: of its trajectory."""
    arrays = dict(zip(SHAPE, shape, strict=True))
    others |= {"selection": None, "alternatives": None}  # a state has said what they tell
    return replace(sol, trajectory=replace(sol.trajectory, **arrays, swirl=swirl, **others), t=t)


def _times(sol: Solution, stations: Any) -> NDArray[np.float64]:
    """Stations, a number or values of s, in units of rho, (1, n)."""
    span = sol.problem.span[:, None]
    if isinstance(stations, int):
        return np.asarray(span * np.linspace(0, 1, stations))
    return np.minimum(np.reshape(np.asarray(stations, dtype=float) / float(sol.case.rho), (1, -1)), span)


LINE = 256  # cases of a line that is solved in one block where there are several lines
BLOCK_OF_ONE, BLOCK_OF_LONG = 8, 32  # cases a block: of a single line, and of lines longer than that
MOST_KEPT = 2000  # cases of a single line that the run itself solves


@dataclass(frozen=True)
class SweepGrid:
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

    def across(self, place: int, axis: int) -> list[int]:
        """The neighbours of a place along the other axes that are nearer to the first case."""
        cell, nearer = self.cell(place), list[int]()
        for k, middle in enumerate(self.first):
            if k != axis and cell[k] != middle:
                step = 1 if cell[k] < middle else -1
                nearer.append(self.place((*cell[:k], cell[k] + step, *cell[k + 1 :])))
        return nearer

    def entries(self, start: int, stop: int) -> list[int]:
        """Of the cases `start` to `stop`, on each line of the last axis, the one that the others continue from."""
        n, middle = self.shape[-1], self.first[-1]
        return [min(max(line + middle, start), min(line + n, stop) - 1) for line in range(start // n * n, stop, n)]


def block_size(shape: tuple[int, ...], most: int) -> int:
    """Cases a block, at most `most`: whole lines where they are short and several."""
    n = shape[-1]
    if len(shape) == 1 or math.prod(shape) == n:
        return max(1, min(BLOCK_OF_ONE, most))
    if n > min(LINE, most):
        return max(1, min(BLOCK_OF_LONG, most))
    return n * max(1, min(BLOCK_OF_LONG, most) // n)


@dataclass(frozen=True, eq=False)
class Sweep:
    """The states of the cases of a sweep, each found when it is first needed, after the case that it continues from.

    coordinates: of each axis. block: cases in a block. known: the states that are kept, by place: those from which
    blocks begin, or all. keeps_all: whether all are kept, as a worker does of its chunk.
    """

    study: Study
    coordinates: Mapping[str, NDArray[np.float64]]
    block: int
    known: dict[int, SweepState] = field(default_factory=dict)
    keeps_all: bool = False
    _begins: dict[int, int] = field(default_factory=dict, repr=False)  # of places, as `_origin` finds them
    _choices: dict[int, Solution] = field(default_factory=dict, repr=False)
    _led: dict[tuple[int, int], bool] = field(default_factory=dict, repr=False)  # from one place to another

    @cached_property
    def grid(self) -> SweepGrid:
        shape = tuple(values.size for values in self.coordinates.values())
        return SweepGrid(shape, self.study.variation.followed is not None)

    def first(self) -> SweepState:
        """The state of the first case."""
        return self.state(self.grid.place(self.grid.first))

    def nearest(self, values: Mapping[str, float]) -> SweepState:
        """The state of the case nearest to these values of the axes."""
        rows = self.coordinates.items()
        return self.state(self.grid.place(tuple(int(np.abs(row - values[name]).argmin()) for name, row in rows)))

    def state(self, place: int) -> SweepState:
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
            if self._keeps(step_at):
                self.known[step_at] = state
        assert state is not None
        return state

    def solve(self, place: int) -> tuple[Solution, str, int]:
        """The solution of one case at the study's stations, an addition to its outcome, and its branch."""
        state = self.state(place)
        return show(self.study, state), state.remark, state.branch

    def hand_over(self, study: Study, start: int, stop: int) -> "Sweep":
        """The sweep for a worker that solves the cases `start` to `stop`: with the states with which blocks begin."""
        places: set[int] = set()
        for a in range(start, stop, self.block):
            b = min(a + self.block, stop)
            places |= {*range(a, b)} if self._is_short else {*self.grid.entries(a, b)}
        known = {place: self.state(place) for place in sorted(places)}
        return Sweep(study, self.coordinates, self.block, known, keeps_all=True)

    def _continue(self, place: int, parent: tuple[int, int] | None, before: SweepState | None) -> SweepState:
        case = self.study.case_of(self._values(place))
        if parent is None or before is None:
            return state_of(select(self.study, case), 0)
        neighbour, axis = self._values(parent[0]), parent[1]
        name = list(neighbour)[axis]
        state = step(self.study, case, before, place, name, neighbour[name])
        self._led[parent[0], place] = state.solved and state.branch == before.branch
        return replace(state, branch=1 + self._origin(place, axis)) if state.branch == 1 + place else state

    def _origin(self, place: int, axis: int) -> int:
        """Where the branch begins upon which a step along an axis comes at a place.

        It is that of a neighbour across the axis, nearer to the first case, where such a step comes upon another branch
        too, and from which it leads to the place; so on from there.
        """
        way = [place]
        while way[-1] not in self._begins:
            beside = (at for at in self.grid.across(way[-1], axis) if self._is_on_its_branch(way[-1], at))
            nearer = next(beside, None)
            if nearer is None:
                self._begins[way[-1]] = way[-1]
            else:
                way.append(nearer)
        self._begins.update(dict.fromkeys(way, self._begins[way[-1]]))
        return self._begins[place]

    def _is_on_its_branch(self, place: int, beside: int) -> bool:
        """Whether a case is on the branch of one beside it, upon which a step comes there."""
        parent = self.grid.parent(beside)
        return parent is not None and not self._leads(parent[0], beside) and self._leads(beside, place)

    def _leads(self, before: int, place: int) -> bool:
        """Whether both cases are solved, and the branch of one leads to the other."""
        if (before, place) not in self._led:
            seed, sol = (self._choice(at) for at in (before, place))
            self._led[before, place] = bool(seed.solved and sol.solved and continues(seed, sol))
        return self._led[before, place]

    def _choice(self, place: int) -> Solution:
        """The equilibrium of a case by the study's rule."""
        if place in self.known:
            return self.known[place].solution
        if place not in self._choices:
            self._choices[place] = select(self.study, self.study.case_of(self._values(place)))
        return self._choices[place]

    def _values(self, place: int) -> dict[str, float]:
        cell = self.grid.cell(place)
        return {name: float(values[i]) for (name, values), i in zip(self.coordinates.items(), cell, strict=True)}

    @property
    def _is_short(self) -> bool:
        """Whether it is a single line that the run itself solves."""
        shape = self.grid.shape
        return math.prod(shape) == shape[-1] <= MOST_KEPT

    def _keeps(self, place: int) -> bool:
        grid = self.grid
        if self.keeps_all or self._is_short or grid.cell(place)[-1] == grid.first[-1]:
            return True
        start = place // self.block * self.block
        return place in grid.entries(start, min(start + self.block, math.prod(grid.shape)))
