"""One equilibrium of each of B problems with held ends, as a trajectory: that of a rule or of a seed."""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from ..equilibrium.charts import CORNER, charts, coordinate
from ..equilibrium.given_numbers import FREE, Given, OrbitState, parts_of, values_of
from ..equilibrium.held_index import dead_index_of
from ..equilibrium.system import correct_equilibrium
from ..held.held_alternatives import alternatives_of, away
from ..levels.boundary import boundary_of
from ..levels.path_orbits import orbit_of, together, trajectory_on, variations_of
from ..mechanics.potential import load_size
from ..numerics.arrays import Array
from ..orbit.periodic_orbit import Orbit
from ..problem.limits import beyond_limits, held_apart, unreachable
from ..problem.reduced import EndsProblem, HeldProblem
from ..problem.trajectory import PLAIN, Seed, Trajectory
from .held_selection import Reached, by_rule, by_seed
from .selection import Choose, path_of_seed

ALTERNATIVE = "another equilibrium with the same ends"


def held_trajectory(reached: Reached, wanted: Given, t: Array, tol: float) -> Trajectory:
    """The orbit of one equilibrium under held ends at stations t (1, n); its error is that of the given numbers."""
    state = at_hinges(reached.state, wanted)
    orbit = orbit_of(state.problem, state.path)
    if orbit.lengthens is not None and orbit.turns[0] > 0 and not state.path.helix:
        lengthens = orbit.turns - dead_index_of(state)  # differences of the length fail at a hinge
        orbit = replace(orbit, lengthens=lengthens)
    values = values_of(_at_length(state, orbit), float(state.problem.span[0]), wanted)
    size = {"z": wanted.span, "alpha": wanted.span, "turn": wanted.span, "dbeta0": _pace(state), "dbetaL": _pace(state)}
    miss = max(
        abs(float(value - given)) / max(size.get(name, 1.0), 1.0)
        for name, value, given in zip(wanted.names, values, wanted.values, strict=True)
    )
    shape = trajectory_on(orbit, t, np.array([miss]), np.array([response_of(state, wanted)]), tol)
    find = None if reached.seed is None else partial(_alternatives, reached.seed, reached.state, wanted, tol)
    begun, how = (np.array([said], dtype=object) for said in (reached.begun, reached.selection))
    held, dead = np.array([reached.index(wanted)]), np.array([dead_index_of(state)])
    return replace(shape, begun=begun, selection=how, held_index=held, dead_index=dead, alternatives=find)


def _alternatives(seed: OrbitState, found: OrbitState, wanted: Given, tol: float, t: Array) -> list[tuple[Any, ...]]:
    """Of each other equilibrium near that of the seed: its distance from the seed, problem and shape."""
    others = alternatives_of(seed, found, wanted)
    rows = [
        (away(seed, other), other.problem, held_trajectory(Reached(other, ALTERNATIVE), wanted, t, tol))
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


def _pace(state: OrbitState) -> float:
    """A size of beta_t for the loads of a state."""
    return float(np.sqrt(1 + load_size(state.problem)[0]))


def at_hinges(state: OrbitState, wanted: Given) -> OrbitState:
    """The state as its orbit has it from the start on; read where it meets beta(L), a rod at rest there has half the
    digits."""
    if not wanted.hinged or state.path.helix:
        return state
    every = charts(boundary_of(state.problem), state.path, True)
    slow = abs(float(state.rates.value("dbeta0")[0])) < 1e-3 * _pace(state)
    corner = [chart for chart in every if chart.kind == CORNER]
    start = [chart for chart in every if chart.kind == "start" and not chart.logarithmic and slow]
    for chart in [*corner, *start]:
        corrected = correct_equilibrium(state.problem, wanted, chart, coordinate(chart))
        if not isinstance(corrected, str):
            return corrected
    return state


def response_of(state: OrbitState, wanted: Given) -> float:
    """The largest |d beta| along the rod by a unit of a given angle, or of a displacement in units of rho, or by a
    change of beta_t at an end of the size that the loads make."""
    problem, path = state.problem, state.path
    with np.errstate(all="ignore"):
        lengths = [k for k, name in enumerate(wanted.names) if name not in FREE[2:]]
        unit = np.eye(5)[:, lengths] * [_pace(state) if wanted.names[k].startswith("d") else 1.0 for k in lengths]
        parts = parts_of(state.rates, wanted, unit, np.zeros(len(lengths)))
        t = problem.span[:, None] * np.linspace(0, 1, 129)
        moves = variations_of(problem, path).change(t, parts[None]).beta
        largest = float(np.abs(moves).max())
    return max(1.0, largest) if np.isfinite(largest) else np.inf


def each_held(
    problem: HeldProblem, t: Array, tol: float, seed: Seed | None, choose: Choose
) -> tuple[Trajectory, EndsProblem]:
    """The answers to B problems at stations t (B, n), and the problems under dead loads that they solve.

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
        answers.append(held_trajectory(reached, Given.of(single), t[i : i + 1], tol))
        for name, value in vars(solved).items():
            value[i] = getattr(reached.state.problem, name)[0]
    return together(answers, t), solved


def _reach(problem: HeldProblem, seed: Seed | None, choose: Choose) -> Reached | str:
    if why := beyond_limits(problem)[0]:
        return str(why)
    if why := unreachable(*held_apart(problem), seed is not None):
        return f"failed: {why}"
    given = Given.of(problem)
    if seed is None:
        return by_rule(given, choose)
    assert seed.problem is not None
    return by_seed(given, seed.problem, path_of_seed(seed))
