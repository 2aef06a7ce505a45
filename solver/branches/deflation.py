"""Newton's rule led away from equilibria that are known, to find other ones with the same held ends.

Distances are taken in the `NUMBERS`.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from ..numerics.arrays import ALIKE, ASIDE, Array
from ..numerics.roots import REACH, Ending, lead_away, solve
from ..problem.dimensionless import EndsProblem
from .charts import Chart, charts, coordinate
from .given_numbers import (
    FREE,
    Given,
    OrbitState,
    answer,
    move,
    problem_after,
    size_of,
    values_of,
)
from .orbit_rates import NUMBERS, orbit_rates
from .path_correction import path_on, settle

# the goal is where plain Newton's method takes over. x10: it would from places that it leaves
_ENDING = Ending(rounds=20, goal=0.03)
_HALVED = 4  # times that a step is halved where no orbit is found. x10: so many more orbits are tried in vain


def end_vector(state: OrbitState) -> Array:
    """The numbers in which distances are taken, (10,): all but the level."""
    return np.asarray(state.rates.values[0, :-1])


def is_known(state: OrbitState, known: list[Array]) -> bool:
    """Whether a state is one of the known equilibria, given by their `end_vector`."""
    return any(are_same(end_vector(state), numbers) for numbers in known)


def are_same(numbers: Array, other: Array) -> bool:
    """Whether two equilibria with the same given numbers are one, from their `end_vector`."""
    return bool((np.abs(numbers - other) < ALIKE * (1 + np.abs(other))).all())


def deflate(state: OrbitState, wanted: Given, known: list[Array]) -> OrbitState | None:
    """An equilibrium with the wanted numbers that is none of the known ones; None where the rounds lead to none.

    known: the `end_vector` each.
    """

    def newton_step(state: OrbitState) -> tuple[Array, Array, Array] | None:
        values, length = state.rates.values[0], float(state.rates.length[0])
        off = wanted.values - values_of(values, length, wanted)
        change = answer(state.rates, wanted, off[:, None], np.array([wanted.span - length]))[:, 0]
        return (end_vector(state), change[:-1], change) if np.isfinite(change[:-1]).all() else None

    near = lead_away(state, newton_step, partial(_next_state, wanted), known, _ENDING)
    settled = "" if near is None else settle(near.problem, near.path, wanted)
    return None if isinstance(settled, str) or is_known(settled, known) else settled


def _next_state(wanted: Given, state: OrbitState, change: Array, factor: float) -> tuple[OrbitState, float] | None:
    """The state after a step, halved where no orbit is there; and the size of the step of Newton's rule itself."""
    for chart in charts(state.problem, state.path)[:2]:
        x = coordinate(chart)
        dx = float(move(chart, x, change))
        size = size_of(state.problem, chart, dx, change)
        if not np.isfinite(size) or size == 0:
            continue
        share = float(np.clip(factor, -REACH / size, REACH / size))
        for _ in range(_HALVED):
            ahead = _state_at(problem_after(state.problem, wanted, change, share), chart, x + share * dx)
            if ahead is not None:
                return ahead, size
            share /= 2
    return None


def _state_at(problem: EndsProblem, chart: Chart, x: float) -> OrbitState | None:
    """The state at a coordinate; None where there is no orbit."""
    path = path_on(problem, chart, x)
    if path is None:
        return None
    rates = orbit_rates(problem, [path])
    if not (np.isfinite(rates.values[0, :-1]).all() and np.isfinite(rates.rows[0, :-1]).all()):
        return None
    return OrbitState(problem, path, rates)


def fold_beside(state: OrbitState, wanted: Given) -> tuple[Array, float] | None:
    """The change of the `NUMBERS` (11,), of length 1, towards the equilibrium that meets this one at the nearest fold,
    and how much of it leads there, to second order; None where it is not known.

    Along the direction in which the equations have their smallest slope sigma, they are about sigma t + b t^2, so the
    other zero is at t = -sigma/b.
    """
    (rows,), (by_span,) = state.rates.rows_of(wanted.names, wanted.ratio)
    every = state.rates.rows[0]
    if state.path.helix or not np.isfinite(every[:-1]).all():
        return None
    unit = solve(np.linalg.qr(every[:-1])[1][None], np.eye(5)[None])[0]  # parts that change the numbers by one
    if not np.isfinite(unit).all():
        return None
    left, slopes, right = np.linalg.svd(rows @ unit)
    change = np.asarray(every @ (unit @ right[-1]))
    off = []
    for share in (0.0, ASIDE, -ASIDE):  # of the change, over which the curvature of the equations is read
        beside = _beside(state, change, share)
        if beside is None:
            return None
        numbers, length = beside.rates.values[0], float(beside.rates.length[0])
        off.append(float(left[:, -1] @ (values_of(numbers, length, wanted) + by_span * (wanted.span - length))))
    bend = (off[1] + off[2] - 2 * off[0]) / (2 * ASIDE**2)
    return (change, float(-slopes[-1] / bend)) if np.isfinite(bend) and bend != 0 else None


def across_fold(state: OrbitState, wanted: Given) -> list[OrbitState]:
    """Guesses of the equilibrium that meets this one at the nearest fold, on either side of it, the likelier first."""
    beside = fold_beside(state, wanted)
    if beside is None:
        return []
    change, t = beside[0], float(np.clip(beside[1], -1, 1))
    states = [_beside(state, change, share) for share in (t, -t)]
    return [state for state in states if state is not None]


def _beside(state: OrbitState, change: Array, share: float) -> OrbitState | None:
    """The state after a share of a change of the `NUMBERS`."""
    new = {name: getattr(state.problem, name) + share * change[NUMBERS.index(name)] for name in FREE}
    problem = replace(state.problem, **new)
    for chart in charts(state.problem, state.path)[:2]:
        x = coordinate(chart)
        beside = _state_at(problem, chart, x + share * float(move(chart, x, change)))
        if beside is not None:
            return beside
    return None
