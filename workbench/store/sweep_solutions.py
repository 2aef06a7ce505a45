"""The solutions of a sweep: a case's state at the stations wanted, and cases between those of the sweep."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver import Case, Solution, solve
from solver.problem.reduced import EndsProblem, flat
from solver.problem.trajectory import Trajectory
from studies import Study

from .sweep import State, select, state_of

_HELD = ("begun", "held_index")  # of a trajectory between held ends
_DENSE = 2001  # stations of the seed of a method that knows the rod at stations only


def show(study: Study, state: State, stations: Any = None) -> Solution:
    """The solution of a state by the study's method, at the study's stations or at others: a number, or values of s."""
    from solver.methods.automatic import AUTOMATIC

    stations = study.stations if stations is None else stations
    method = study.method if study.method != "auto" else AUTOMATIC["ends"]
    if not state.solved:
        return _nothing(state, stations)
    if method == state.solution.method and state.solution.trajectory.orbit is not None:
        return read(state.solution, stations)
    return solve(state.solution.case, study.tol, method, stations, seed=read(state.solution, _DENSE))


def between(study: Study, case: Case, near: Callable[[], State], stations: Any) -> Solution:
    """A case between those of a sweep, at so many stations: by the study's rule, or on the branch that it follows.

    near: makes the state of the nearest case of the sweep.
    """
    if study.followed is None:
        return show(study, state_of(select(study, case), 0), stations)
    state = near()
    if state.solved:
        state = state_of(solve(case, tol=study.tol, stations=2, seed=state.solution), state.branch, state.stable)
    return show(study, state, stations)


def together(case: Case, found: list[Solution]) -> Solution:
    """Solutions of single cases as the one solution of their grid."""
    names = ("beta", "dbeta", "alpha", "z", "solved", "outcome", "error", "condition", "evaluations")
    columns: dict[str, Any] = {name: np.concatenate([getattr(one.trajectory, name) for one in found]) for name in names}
    swirl = np.concatenate([one.trajectory.swirl() for one in found])
    t = np.concatenate([one.t for one in found])
    if found[0].held:
        columns |= {name: np.concatenate([getattr(one.trajectory, name) for one in found]) for name in _HELD}
    rows = [vars(one.problem) for one in found]
    problem = EndsProblem(**{name: np.concatenate([row[name] for row in rows]) for name in rows[0]})
    answer = Trajectory(**columns, swirl=partial(np.asarray, swirl))
    return Solution(case, problem, answer, t, found[0].method, found[0].tol)


def single(case: Case, i: int) -> Case:
    """Case i of a grid, counted along its axes, the last fastest."""
    parts: list[Any] = []
    part: Any
    for part in (case.rod, case.cylinder, case.given):
        values = {name: value for name, value in vars(part).items() if isinstance(value, np.ndarray)}
        parts.append(replace(part, **{name: float(flat(value, case.shape)[i]) for name, value in values.items()}))
    return Case(*parts)


def _nothing(state: State, stations: Any) -> Solution:
    """A case without a solution: NaN, with the reason."""
    sol, was = state.solution, state.solution.trajectory
    t = _times(sol, stations)
    nothing = np.full(t.shape, np.nan)
    judged = was.solved, was.outcome, was.error, was.condition, was.evaluations
    known = {name: getattr(was, name) for name in _HELD}
    answer = Trajectory(nothing, nothing, nothing, nothing, partial(np.asarray, nothing), *judged, **known)
    return replace(sol, trajectory=answer, t=t)


def _times(sol: Solution, stations: Any) -> NDArray[np.float64]:
    """Stations, a number or values of s, in units of rho, (1, n)."""
    span = sol.problem.span[:, None]
    if isinstance(stations, int):
        return np.asarray(span * np.linspace(0, 1, stations))
    return np.minimum(np.reshape(np.asarray(stations, dtype=float) / float(sol.case.rho), (1, -1)), span)


def read(sol: Solution, stations: Any) -> Solution:
    """The same equilibrium at so many stations, or at these values of s, from its orbit."""
    t, was = _times(sol, stations), sol.trajectory
    orbit: Any = was.orbit
    beta, dbeta, alpha, z = orbit.at(t)
    judged = was.solved, was.outcome, was.error, was.condition, was.evaluations
    known = {name: getattr(was, name) for name in _HELD}
    told = Trajectory(beta, dbeta, alpha, z, partial(orbit.swirl, t), *judged, orbit, **known)
    return replace(sol, trajectory=told, t=t)
