"""`shooting`: ends problems through `orbit`, so exact to rounding however long the rod.

Next to a seed by Newton's rule on the start's slope, all problems at once. Without one, and where the start's slope is
too blunt a handle (a shape that hugs a saddle), by the search over levels and paths of `equilibria`.
"""

from typing import Any

import numpy as np

from ..reduced import Array, Reduced
from .base import Method, Seed, Trajectory
from .orbit import solve_orbit

_ROUNDS = 40


def run(problem: Reduced, t: Array, tol: float, seed: Seed | None = None, **_: Any) -> Trajectory:
    """The equilibrium next to `seed`, or that of lowest energy without one."""
    from ..equilibria import (
        chosen,
        trajectory,
    )  # the search stands above the methods; it is asked only where nothing else will do

    slopes = np.full(problem.size, np.nan) if seed is None else _next_to(problem, seed.slope)
    columns = np.full((5, problem.size, t.shape[1]), np.nan)
    error, condition, calls = (np.full(problem.size, v) for v in (np.inf, np.inf, 0.0))
    outcome = np.full(problem.size, "failed: no equilibrium joins these end angles under these loads", dtype=object)
    near = np.flatnonzero(np.isfinite(slopes))
    if near.size:
        some = problem.take(near)
        orbit = solve_orbit(some.started(slopes[near]), 1e-13)
        found = trajectory(some, orbit, t[near], tol)
        if near.size == problem.size:
            return found
        columns[:, near] = found.beta, found.dbeta, found.alpha, found.z, found.swirl()
        error[near], condition[near], calls[near] = found.error, found.condition, found.evaluations
        outcome[near] = found.outcome
    for i in np.flatnonzero(~np.isfinite(slopes)):
        one = problem.take(slice(i, i + 1))
        alone = chosen(one, t[i : i + 1], tol, None if seed is None else float(seed.slope[i]))
        if alone is None:
            continue
        if problem.size == 1:
            return alone
        columns[:, i] = alone.beta[0], alone.dbeta[0], alone.alpha[0], alone.z[0], alone.swirl()[0]
        error[i], condition[i], calls[i] = alone.error[0], alone.condition[0], alone.evaluations[0]
        outcome[i] = alone.outcome[0]
    beta, dbeta, alpha, z, swirl = columns
    return Trajectory(beta, dbeta, alpha, z, lambda: swirl, outcome, error, condition, calls.astype(np.int64))


def _next_to(problem: Reduced, slope: Array) -> Array:
    """beta_t(0) of the solution next to a guess, (B,); NaN where Newton's rule does not settle."""
    assert problem.betaL is not None
    B = problem.size
    twice = Reduced(*(np.tile(v, 2) for v in (problem.lam, problem.mu, problem.phi, problem.span, problem.beta0)))
    at = np.where(np.isfinite(slope), slope, 0.0)
    off = np.full(B, np.inf)
    for _ in range(_ROUNDS):
        nudge = 1e-7 * np.maximum(1, np.abs(at))
        orbit = solve_orbit(twice.started(np.concatenate([at, at + nudge])), 1e-13)
        end = orbit.at(twice.span[:, None])[0][:, 0]
        off = end[:B] - problem.betaL
        with np.errstate(divide="ignore", invalid="ignore"):
            step = -off / ((end[B:] - end[:B]) / nudge)
        step = np.clip(np.where(np.isfinite(step), step, 0.01), -0.05, 0.05)
        if (np.abs(off) <= 2e-13 * np.maximum(1, np.abs(problem.betaL))).all():
            break
        at = np.where(np.abs(off) <= 2e-13 * np.maximum(1, np.abs(problem.betaL)), at, at + step)
    met = (np.abs(off) <= 1e-10) & np.isfinite(slope) & (np.abs(at - slope) <= 0.1 * (1 + np.abs(slope)))
    return np.where(met, at, np.nan)


SHOOTING = Method("shooting", run, ("ends",), float("inf"), "the level at which the orbit's length is the rod's")
