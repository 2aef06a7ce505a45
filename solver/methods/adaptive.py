"""Adaptive integrators: `dop853`, `lsoda` and `heyoka` march beta, beta_t, alpha, z and the swirl from the start.

The tolerance of an integrator is of one step, the error asked for is of the whole rod. So the error is measured.
"""

import math
from abc import abstractmethod
from dataclasses import dataclass
from functools import cache
from typing import Any, ClassVar

import numpy as np

from ..core.tuning import MOST_STEPS
from ..numerics.arrays import Array
from ..problem.dimensionless import StartProblem
from ..problem.outcomes import NOT_FINITE
from ..problem.trajectory import Trajectory
from .half_period import condition_numbers
from .method import (
    MOST_CALLED,
    MOST_COMPILED,
    TIGHTEST,
    Ladder,
    SingleAnswer,
    StartMethod,
    knob,
    one_by_one,
    tens,
    tighten,
)

# of one integration: one or two seconds; stiffer cases are for `orbit`. x10: twenty seconds before one fails
_MOST_CALLS = 400_000


class _TooLong(Exception):
    """The integration needs more calls than allowed."""


@dataclass(frozen=True)
class Adaptive(StartMethod):
    """A method whose tolerance is one of a step, so that a second run measures the error.

    tightest: of that tolerance. rounding: of a state, by one evaluation.
    """

    tightest: ClassVar[float]
    rounding: ClassVar[float]

    rtol: float | None = knob(float)

    @abstractmethod
    def integrate(self, problem: StartProblem, t: Array, rtol: float) -> tuple[Array, int, str]:
        """States of one case at t (5, n); evaluations; and why there are none, or an empty text."""

    def run(self, problem: StartProblem, t: Array, tol: float) -> Trajectory:
        condition = condition_numbers(problem, t)

        def answer(i: int) -> SingleAnswer:
            single, growth = problem.take(slice(i, i + 1)), float(condition[i])
            columns, error, calls, why = tighten(
                lambda rtol: self.integrate(single, t[i], rtol),
                lambda calls: self.rounding * (1 + calls**0.5) * growth,
                t[i, -1],
                tol,
                self.rtol,
                self.tightest,
            )
            return columns, error, growth, calls, why

        return one_by_one(answer, t, tol)


@dataclass(frozen=True)
class ScipyAdaptive(Adaptive):
    """A method by one of scipy's integrators. integrator: its name for `solve_ivp`."""

    tightest = TIGHTEST
    rounding = 1e-15
    integrator: ClassVar[str]

    def integrate(self, problem: StartProblem, t: Array, rtol: float) -> tuple[Array, int, str]:
        """States at t (5, n); calls; why there are none, or an empty text."""
        lam, mu, phi = float(problem.lam[0]), float(problem.mu[0]), float(problem.phi[0])
        calls = 0

        def rates(_: float, y: Array) -> list[float]:
            nonlocal calls
            calls += 1
            if calls > _MOST_CALLS:
                raise _TooLong
            s, c = math.sin(y[0]), math.cos(y[0])
            pull = lam * c - mu * (c - s) * (c + s) - (phi + 2 * c * s * s) * s
            return [y[1], -pull, s, c, s * c]

        start = [problem.beta0[0], problem.dbeta0[0], 0.0, 0.0, 0.0]
        import scipy

        nothing = np.full((5, t.size), np.nan)
        try:
            answer = scipy.integrate.solve_ivp(
                rates, (0.0, t[-1]), start, self.integrator, t_eval=t, rtol=rtol, atol=rtol
            )
        except (_TooLong, ValueError) as stopped:  # math.sin refuses an infinite angle by a ValueError
            spent = f"failed: the integration needs more than {_MOST_CALLS} evaluations"
            return nothing, calls, spent if isinstance(stopped, _TooLong) else NOT_FINITE
        if answer.status != 0:
            said = answer.message.rstrip(".").lower()
            return nothing, answer.nfev, f"failed: {self.integrator} of scipy gave up: {said}"
        return answer.y, answer.nfev, ""


@dataclass(frozen=True)
class DOP853(ScipyAdaptive):
    """Adaptive Runge-Kutta. rtol: the tolerance of a step; default: sought so that `tol` is met."""

    name = "dop853"
    summary = "adaptive Runge-Kutta of order 8 (scipy), the reference"
    order = 8
    integrator = "DOP853"
    ladders = (Ladder("dop853", "rtol", (*tens(2, 12, 2), 1e-13), "#d96a00", "D", most=3 * MOST_CALLED),)


@dataclass(frozen=True)
class LSODA(ScipyAdaptive):
    """Multistep formulas: of Adams, which change to BDF where the problem is stiff. They evaluate the equation once a
    step, an advantage where evaluations are expensive; here they are cheap.

    rtol: the tolerance of a step; default: sought so that `tol` is met.
    """

    name = "lsoda"
    summary = "multistep formulas of variable order, to 12 (scipy's LSODA)"
    order = 12
    integrator = "LSODA"
    ladders = (Ladder("lsoda", "rtol", (*tens(2, 12, 2), 1e-13), "#a04890", "^", most=2 * MOST_CALLED),)


@dataclass(frozen=True)
class Heyoka(Adaptive):
    """Taylor series, compiled to machine code; the strongest general integrator to compare with. Its order follows the
    tolerance, about twenty at rounding.

    rtol: the tolerance of a step; default: sought so that `tol` is met.
    """

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
        _, _, _, steps, _, states = march.propagate_grid(grid=grid, max_steps=MOST_STEPS)
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
