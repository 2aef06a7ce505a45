"""`heyoka`: Taylor's method compiled to machine code, the strongest general integrator to compare with; optional.

It needs the package heyoka (the extra `taylor`). Its order follows the tolerance, about twenty at rounding. As with
every adaptive integrator here, a second run measures the error.
"""

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from ..numerics.arrays import Array
from ..problem.reduced import StartProblem
from .adaptive import Adaptive
from .base import MOST_COMPILED, Ladder, tens

_MOST_STEPS = 200_000  # of one integration


@dataclass(frozen=True)
class Heyoka(Adaptive):
    """Taylor series, compiled. rtol: the tolerance of a step; default: sought so that `tol` is met."""

    name = "heyoka"
    summary = "Taylor series compiled to machine code (the package heyoka)"
    order = float("inf")
    requires = "heyoka"
    extra = "taylor"
    ladders = (Ladder("heyoka", "rtol", tens(1, 15, 2), "#6424d0", "P", cold=True, most=MOST_COMPILED),)

    tightest = 2.3e-16
    rounding = 2e-16

    def integrate(self, problem: StartProblem, t: Array, rtol: float) -> tuple[Array, int, str]:
        """NaN where the march ended early."""
        march = _compile(rtol)
        march.time = 0.0
        march.state[:] = problem.beta0[0], problem.dbeta0[0], 0.0, 0.0, 0.0
        march.pars[:] = problem.lam[0], problem.mu[0], problem.phi[0]
        grid, back = np.unique(np.append(0.0, t), return_inverse=True)
        if grid.size == 1:
            return np.repeat(march.state[:, None].copy(), t.size, axis=1), 0, ""
        _, _, _, steps, _, states = march.propagate_grid(grid=grid, max_steps=_MOST_STEPS)
        calls = int(steps) * (int(march.order) + 1)  # each step evaluates that many derivatives of the equation
        if states.shape[0] < grid.size:
            return np.full((5, t.size), np.nan), calls, ""
        return states.T[:, back[1:]], calls, ""


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
