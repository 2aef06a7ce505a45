"""The one equilibrium of an ends problem that a seed or a rule selects, as a trajectory or as a seed."""

from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ..core import orbits as core
from ..levels.level_search import Found, search
from ..numerics.arrays import Array
from ..orbit.periodic_orbit import Orbit
from ..problem.reduced import EndsProblem
from ..problem.trajectory import Seed, Trajectory, verdicts
from .selection import NEAREST, Choose, none_of, select, selection

NO_EQUILIBRIUM = "failed: the search found no equilibrium, though at least one exists"


def equilibrium_trajectory(problem: EndsProblem, orbit: Orbit, t: Array, tol: float) -> Trajectory:
    """The orbits of K ends problems at stations t (K, n); their error is that of beta(L)."""
    beta, dbeta, alpha, z = orbit.at(t)
    condition = core.response(orbit) if orbit.response is None else orbit.response
    miss = np.abs(orbit.at(problem.span[:, None])[0][:, 0] - problem.betaL)
    error = (2 * miss + 1e-14) * condition
    calls = np.bincount(orbit.panels.arc // 2, weights=orbit.panels.calls, minlength=t.shape[0]).astype(np.int64)
    verdict = verdicts(beta, error, condition, tol)
    return Trajectory(beta, dbeta, alpha, z, partial(orbit.swirl, t), *verdict, error, condition, calls, orbit)


def selection_of(
    problem: EndsProblem, t: Array, tol: float, slope: float | None, choose: Choose = NEAREST
) -> Trajectory | str:
    """The equilibrium of one ends problem with beta_t(0) nearest `slope`, or without `slope` the one of the rule.

    Returns the outcome, a sentence, where there is none.
    """
    found = _search(problem, slope, choose)
    if found is None:
        return NO_EQUILIBRIUM
    if slope is not None:
        return equilibrium_trajectory(problem, found.orbit.take(int(np.argmin(np.abs(found.slope - slope)))), t, tol)
    i = select(choose, found.index, found.energy, found.stray, found.slope)
    if i is None:
        return none_of(choose, found.index, found.total)
    if not isinstance(choose, int) and found.index[i] != 0 and found.remark:  # by degree there is a stable equilibrium
        return f"failed: {found.remark}"
    how = np.array([selection(choose, found.index, found.total, not found.remark)], dtype=object)
    return replace(equilibrium_trajectory(problem, found.orbit.take(i), t, tol), selection=how)


def _search(problem: EndsProblem, slope: float | None, choose: Choose) -> Found | None:
    """The equilibria that the rule needs.

    A stable one has one turning point at most, one of index K at most K + 1, and that of lowest energy is stable.
    """
    if slope is not None:
        return search(problem)
    found = search(problem, most_turns=choose + 1 if isinstance(choose, int) else 1)
    needs_stable = found is None or not (found.index == 0).any()
    return search(problem) if not isinstance(choose, int) and needs_stable else found


def select_seed(
    problem: EndsProblem, choose: Choose = NEAREST, points: int = 2001
) -> tuple[Seed, NDArray[np.object_], list[str]]:
    """The equilibrium of each of B ends problems that the rule takes, as a seed at `points` stations.

    Returns the seed, NaN where there is no equilibrium; (B,) how each was selected; and the outcomes that say why there
    is none, empty where there is one.
    """
    u = np.linspace(0, 1, points)
    taken, why = np.full(problem.size, None, dtype=object), [""] * problem.size
    slopes, shapes = np.full(problem.size, np.nan), np.full((problem.size, points), np.nan)
    for i in range(problem.size):
        one = problem.take(slice(i, i + 1))
        found = selection_of(one, one.span[:, None] * u, 1e-8, None, choose)
        if isinstance(found, str):
            why[i] = found
            continue
        slopes[i], shapes[i] = found.dbeta[0, 0], found.beta[0]
        taken[i] = None if found.selection is None else found.selection[0]
    return Seed(slopes, np.tile(u, (problem.size, 1)), shapes), taken, why
