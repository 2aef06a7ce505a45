"""What adaptive integrators share: beta, beta_t, alpha, z and the swirl marched from the start.

The tolerance of an integrator is of one step, the error asked for is of the whole rod. So the error is measured.
"""

import math
from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ..numerics.arrays import Array
from ..problem.reduced import StartProblem
from ..problem.trajectory import NOT_FINITE, Trajectory
from .base import TIGHTEST, Answer, StartMethod, knob, one_by_one, tighten
from .swing import condition_numbers

_MOST_CALLS = 400_000  # of one integration: one or two seconds; stiffer cases are for `orbit`


class _TooLong(Exception):
    """The integration needs more calls than allowed."""


_SPENT = f"failed: the integration needs more than {_MOST_CALLS} evaluations"


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

        def answer(i: int) -> Answer:
            single, growth = problem.take(slice(i, i + 1)), float(condition[i])
            columns, error, calls, why = tighten(
                lambda rtol: self.integrate(single, t[i], rtol),
                lambda calls: self.rounding * (1 + calls**0.5) * growth,
                t[i, -1], tol, self.rtol, self.tightest,
            )  # fmt: skip
            return columns, error, growth, calls, why

        return one_by_one(answer, t, tol)


@dataclass(frozen=True)
class ScipyAdaptive(Adaptive):
    """A method by one of scipy's integrators. integrator: its name for `solve_ivp`."""

    tightest = TIGHTEST
    rounding = 1e-15
    integrator: ClassVar[str]

    def integrate(self, problem: StartProblem, t: Array, rtol: float) -> tuple[Array, int, str]:
        return _integrate(self.integrator, problem, t, rtol)


def _integrate(integrator: str, problem: StartProblem, t: Array, rtol: float) -> tuple[Array, int, str]:
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
        answer = scipy.integrate.solve_ivp(rates, (0.0, t[-1]), start, integrator, t_eval=t, rtol=rtol, atol=rtol)
    except (_TooLong, ValueError) as stopped:  # math.sin refuses an infinite angle by a ValueError
        return nothing, calls, _SPENT if isinstance(stopped, _TooLong) else NOT_FINITE
    if answer.status != 0:
        said = answer.message.rstrip(".").lower()
        return nothing, answer.nfev, f"failed: {integrator} of scipy gave up: {said}"
    return answer.y, answer.nfev, ""
