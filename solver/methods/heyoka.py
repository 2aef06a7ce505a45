"""`heyoka`: Taylor's method compiled to machine code, the strongest general integrator to compare with; optional.

It needs the package heyoka (the extra `taylor`). Its order follows the tolerance, about twenty at rounding. As with
every adaptive integrator here, a second run measures the error.
"""

import math
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import numpy as np

from ..numerics.arrays import Array
from ..problem.reduced import StartProblem
from ..problem.trajectory import Trajectory, verdicts
from .base import MOST_COMPILED, Ladder, StartMethod, knob, tens
from .swing import condition_numbers

_TIGHTEST, _LOOSEST = 2.3e-16, 1e-2
_MOST_STEPS = 200_000  # of one integration


@dataclass(frozen=True)
class Heyoka(StartMethod):
    """Taylor series, compiled. rtol: the tolerance of a step; default: sought so that `tol` is met."""

    name = "heyoka"
    summary = "Taylor series compiled to machine code (the package heyoka)"
    order = float("inf")
    requires = "heyoka"
    extra = "taylor"
    ladders = (Ladder("heyoka", "rtol", tens(1, 15, 2), "#6424d0", "P", cold=True, most=MOST_COMPILED),)

    rtol: float | None = knob(float)

    def run(self, problem: StartProblem, t: Array, tol: float) -> Trajectory:
        states = np.full((problem.size, 5, t.shape[1]), np.nan)
        error, calls = np.full(problem.size, np.inf), np.zeros(problem.size, dtype=np.int64)
        for i in range(problem.size):
            states[i], error[i], calls[i] = _solve_one(problem.take(slice(i, i + 1)), t[i], tol, self.rtol)
        condition = condition_numbers(problem, t)
        beta, dbeta, alpha, z, swirl = np.moveaxis(states, 1, 0)
        error = error + 2e-16 * (1 + np.sqrt(calls)) * condition
        verdict = verdicts(beta, error, condition, tol)
        return Trajectory(beta, dbeta, alpha, z, partial(np.asarray, swirl), *verdict, error, condition, calls)


def _solve_one(problem: StartProblem, t: Array, tol: float, rtol: float | None) -> tuple[Array, float, int]:
    accuracy = float(np.clip(0.1 * tol if rtol is None else rtol, _TIGHTEST, _LOOSEST))
    coarse, calls = _integrate(problem, t, 30 * accuracy)
    weight = np.array([1, 0, 1, 1, 0]) / np.array([1, 1, max(1.0, t[-1]), max(1.0, t[-1]), 1])
    while True:
        fine, more = _integrate(problem, t, accuracy)
        calls += more
        error = float(np.max(np.abs(fine - coarse) * weight[:, None], initial=0.0))
        if not math.isfinite(error):
            return fine, math.inf, calls
        if rtol is not None or error <= tol or accuracy <= _TIGHTEST:
            return fine, error, calls
        coarse, accuracy = fine, max(_TIGHTEST, accuracy / 30)


def _integrate(problem: StartProblem, t: Array, rtol: float) -> tuple[Array, int]:
    """The state at the stations, (5, n), NaN where the march ended early; and calls of the equation."""
    march = _compile(rtol)
    march.time = 0.0
    march.state[:] = problem.beta0[0], problem.dbeta0[0], 0.0, 0.0, 0.0
    march.pars[:] = problem.lam[0], problem.mu[0], problem.phi[0]
    grid, back = np.unique(np.append(0.0, t), return_inverse=True)
    if grid.size == 1:
        return np.repeat(march.state[:, None].copy(), t.size, axis=1), 0
    _, _, _, steps, _, states = march.propagate_grid(grid=grid, max_steps=_MOST_STEPS)
    calls = int(steps) * (int(march.order) + 1)  # each step evaluates that many derivatives of the equation
    if states.shape[0] < grid.size:
        return np.full((5, t.size), np.nan), calls
    return states.T[:, back[1:]], calls


@cache
def _compile(rtol: float) -> Any:
    """The integrator of that tolerance, made once in a process: compiling takes longer than integrating."""
    import heyoka as hy

    beta, v, alpha, z, swirl = hy.make_vars("beta", "v", "alpha", "z", "swirl")
    lam, mu, phi = hy.par[0], hy.par[1], hy.par[2]
    s, c = hy.sin(beta), hy.cos(beta)
    pull = (lam - mu) * c + 2.0 * mu * hy.sin(0.5 * beta) ** 2.0 * (1.0 + 2.0 * c) - (phi + 2.0 * c * s * s) * s
    rates = [(beta, v), (v, -pull), (alpha, s), (z, c), (swirl, s * c)]
    return hy.taylor_adaptive(rates, [0.0] * 5, tol=rtol, pars=[0.0] * 3)
