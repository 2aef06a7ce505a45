"""One equilibrium of each of B problems with held ends, as a trajectory: that of a rule or of a seed."""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from ..branches.given_numbers import FREE, Given, OrbitState, parts_of, values_of
from ..branches.held_index import dead_index_of
from ..nodes.growth import GrowthWay
from ..nodes.hinges import shape_of
from ..nodes.loaded_rod import LoadedRod, rods_of
from ..nodes.loaded_solutions import answer_ends, way_near, why_unsolved
from ..numerics.arrays import Array
from ..orbits.path_orbits import orbit_of, together, trajectory_on, variations_of
from ..orbits.periodic_orbit import Orbit
from ..problem.case import Case
from ..problem.dimensionless import EndsProblem, HeldProblem, reduce_held
from ..problem.limits import beyond_limits, ends_and_span, unreachable
from ..problem.trajectory import PLAIN, Seed, Trajectory, stood_in
from .equilibrium_choice import Choose, path_of_seed
from .held_alternatives import alternatives_of, away
from .held_moves import state_of_seed
from .held_reach import Reached, by_rule, by_seed

ALTERNATIVE = "another equilibrium with the same ends"


def trajectory_between(reached: Reached, wanted: Given, t: Array, tol: float) -> Trajectory:
    """The orbit of one equilibrium under held ends at stations t (1, n); its error is that of the given numbers."""
    state = reached.state
    orbit = orbit_of(state.problem, state.path)
    values = values_of(_at_length(state, orbit), float(state.problem.span[0]), wanted)
    size = {"z": wanted.span, "alpha": wanted.span, "turn": wanted.span}
    miss = max(
        abs(float(value - given)) / max(size.get(name, 1.0), 1.0)
        for name, value, given in zip(wanted.names, values, wanted.values, strict=True)
    )
    shape = trajectory_on(orbit, t, np.array([miss]), np.array([response_of(state, wanted)]), tol)
    find = None if reached.seed is None else partial(_alternatives, reached.seed, reached.state, wanted, tol)
    begun, how = (np.array([said], dtype=object) for said in (reached.begun, reached.selection))
    held, dead = np.array([reached.index(wanted)]), np.array([dead_index_of(state)])
    return replace(shape, begun=begun, selection=how, held_index=held, dead_index=dead, alternatives=find)


def _alternatives(seed: OrbitState, state: OrbitState, wanted: Given, tol: float, t: Array) -> list[tuple[Any, ...]]:
    """Of each other equilibrium near that of the seed: its distance from the seed, problem and shape."""
    others = alternatives_of(seed, state, wanted)
    rows = [
        (away(seed, other), other.problem, trajectory_between(Reached(other, ALTERNATIVE), wanted, t, tol))
        for other in others
    ]
    return sorted(rows, key=lambda row: row[0])


def _at_length(state: OrbitState, orbit: Orbit) -> Array:
    """The `NUMBERS` of a state as its orbit has them at the length of the rod, (11,)."""
    problem, ends = state.problem, state.problem.span[:, None] * [0, 1]
    beta, v, alpha, z = (value[0] for value in orbit.at(ends))
    loads = problem.lam[0], problem.mu[0], problem.phi[0]
    swirl = orbit.swirl(ends)[0, 1]
    return np.array([problem.beta0[0], beta[1], *v, alpha[1], swirl, z[1], *loads, state.path.y])


def response_of(state: OrbitState, wanted: Given) -> float:
    """The largest |d beta| along the rod by a unit of a given angle, or of a displacement in units of rho."""
    problem, path = state.problem, state.path
    with np.errstate(all="ignore"):
        lengths = [k for k, name in enumerate(wanted.names) if name not in FREE[2:]]
        unit = np.eye(5)[:, lengths]
        parts = parts_of(state.rates, wanted, unit, np.zeros(len(lengths)))
        t = problem.span[:, None] * np.linspace(0, 1, 129)
        moves = variations_of(problem, path).change(t, parts[None]).beta
        largest = float(np.abs(moves).max())
    return max(1.0, largest) if np.isfinite(largest) else np.inf


def each_held(
    problem: HeldProblem, t: Array, tol: float, seed: Seed | None, choose: Choose
) -> tuple[EndsProblem, Trajectory]:
    """The problems under dead loads that B problems lead to, and the answers at stations t (B, n).

    A problem that is not solved stands there as a plain one.
    """
    answers: list[Trajectory | str] = []
    solved = EndsProblem(**{name: np.full(problem.size, PLAIN[name]) for name in (*FREE, "span")})
    for i in range(problem.size):
        single = problem.take(slice(i, i + 1))
        reached = _reach(single, None if seed is None else seed.take(slice(i, i + 1)), choose)
        if isinstance(reached, str):
            answers.append(reached)
            continue
        answers.append(trajectory_between(reached, Given.of(single), t[i : i + 1], tol))
        for name, value in vars(solved).items():
            value[i] = getattr(reached.state.problem, name)[0]
    return solved, together(answers, t)


def each_hinged(
    case: Case, problem: HeldProblem, t: Array, tol: float, seed: Seed | None, choose: Choose
) -> tuple[EndsProblem, Trajectory]:
    """The problems and answers of B rods with a given end moment, on nodes; problem: theirs."""
    rods, reached = rods_of(case), list[Reached | str]()
    for i, rod in enumerate(rods):
        row = slice(i, i + 1)
        why = why_unsolved(rod, seeded=True)  # whether the ends are within reach is said below
        reached.append(f"failed: {why}" if why else _reach(problem.take(row), seed and seed.take(row), choose))
    ways = [
        GrowthWay(None, why=end.removeprefix("failed: "))
        if isinstance(end, str)
        else way_between_hinges(end.state, rod)
        for end, rod in zip(reached, rods, strict=True)
    ]
    solved, answer = answer_ends(case, t, tol, ways)
    begun, how = (
        np.array([None if isinstance(end, str) else getattr(end, name) for end in reached], dtype=object)
        for name in ("begun", "selection")
    )
    find, first = None, reached[0]
    if not isinstance(first, str) and first.seed is not None:  # of a single problem, as the trajectory says
        find = partial(_alternatives_between_hinges, first.seed, first.state, case, tol)
    fit = np.array([way.shape is not None for way in ways])
    return stood_in(solved, fit), replace(answer, begun=begun, selection=how, alternatives=find)


def way_between_hinges(state: OrbitState, rod: LoadedRod) -> GrowthWay:
    """The shape of an equilibrium of a rod with a given end moment, as an answer."""
    return way_near(shape_of(state, rod))


def _alternatives_between_hinges(
    seed: OrbitState, state: OrbitState, case: Case, tol: float, t: Array
) -> list[tuple[Any, ...]]:
    """What `_alternatives` gives, of a rod with a given end moment."""
    (rod,) = rods_of(case)
    rows = []
    for other in alternatives_of(seed, state, Given.of(reduce_held(case))):
        problem, answer = answer_ends(case, t, tol, [way_between_hinges(other, rod)])
        rows.append((away(seed, other), problem, replace(answer, begun=np.array([ALTERNATIVE], dtype=object))))
    return sorted(rows, key=lambda row: row[0])


def _reach(problem: HeldProblem, seed: Seed | None, choose: Choose) -> Reached | str:
    if why := beyond_limits(problem)[0]:
        return str(why)
    given = Given.of(problem)
    if why := unreachable(*ends_and_span(problem), seed is not None and not given.has_hinge):
        return f"failed: {why}"
    if seed is None:
        return by_rule(given, choose)
    assert seed.problem is not None
    shape = None if seed.shapes is None else seed.shapes[0]
    path = None if given.has_hinge and shape is not None else path_of_seed(seed)
    return by_seed(given, state_of_seed(seed.problem, path, shape, given))
