"""What adaptive integrators share: beta, beta_t, alpha, z and the swirl marched from the start.

The tolerance of an integrator is of one step, the error asked for is of the whole rod. So the error is measured: a
second run at thirty times the tolerance is compared, and the tolerance is tightened until the two agree.
"""

import math
from abc import abstractmethod
from dataclasses import dataclass
from functools import partial
from typing import ClassVar

import numpy as np

from ..numerics.arrays import Array
from ..problem.reduced import StartProblem
from ..problem.trajectory import NOT_FINITE, Trajectory, verdicts
from .base import StartMethod, knob
from .swing import condition_numbers

_MOST_CALLS = 400_000  # of one integration: one or two seconds; stiffer cases are for `orbit`


class _TooLong(Exception):
    """The integration needs more calls than allowed."""


_LOST = NOT_FINITE
_SPENT = f"failed: the integration needs more than {_MOST_CALLS} evaluations"


@dataclass(frozen=True)
class Adaptive(StartMethod):
    """A method whose tolerance is one of a step, so that a second run measures the error.

    tightest, loosest: of that tolerance. rounding: of a state, by one evaluation.
    """

    tightest: ClassVar[float]
    loosest: ClassVar[float] = 1e-2  # the run it is compared with has thirty times that, and must differ
    rounding: ClassVar[float]

    rtol: float | None = knob(float)

    @abstractmethod
    def integrate(self, problem: StartProblem, t: Array, rtol: float) -> tuple[Array, int, str]:
        """States of one case at t (5, n); evaluations; and why there are none, or an empty text."""

    def run(self, problem: StartProblem, t: Array, tol: float) -> Trajectory:
        n = t.shape[1]
        states = np.full((problem.size, 5, n), np.nan)
        error, condition = np.full(problem.size, np.inf), condition_numbers(problem, t)
        calls, why = np.zeros(problem.size, dtype=np.int64), np.full(problem.size, "", dtype=object)
        for i in range(problem.size):
            single = problem.take(slice(i, i + 1))
            states[i], error[i], calls[i], why[i] = self._solve_one(single, t[i], tol, float(condition[i]))
        beta, dbeta, alpha, z, swirl = np.moveaxis(states, 1, 0)
        verdict = verdicts(beta, error, condition, tol).failed(why)
        return Trajectory(beta, dbeta, alpha, z, partial(np.asarray, swirl), *verdict, error, condition, calls)

    def _solve_one(
        self, problem: StartProblem, t: Array, tol: float, condition: float
    ) -> tuple[Array, float, int, str]:
        """States (5, n), error, calls, and why there is no answer or an empty text."""
        accuracy = float(np.clip(0.1 * tol if self.rtol is None else self.rtol, self.tightest, self.loosest))
        coarse, calls, why = self.integrate(problem, t, 30 * accuracy)
        if why:  # a tighter run would take longer still
            return coarse, math.inf, calls, why
        weight = np.array([1, 0, 1, 1, 0]) / np.array([1, 1, max(1.0, t[-1]), max(1.0, t[-1]), 1])
        while True:
            fine, more, why = self.integrate(problem, t, accuracy)
            calls += more
            error = float(np.max(np.abs(fine - coarse) * weight[:, None], initial=0.0))
            if why or not math.isfinite(error):
                return fine, math.inf, calls, why
            error += self.rounding * (1 + calls**0.5) * condition
            if self.rtol is not None or error <= tol or accuracy <= self.tightest:
                return fine, error, calls, ""
            coarse, accuracy = fine, max(self.tightest, accuracy / 30)


@dataclass(frozen=True)
class ScipyAdaptive(Adaptive):
    """A method by one of scipy's integrators. integrator: its name for `solve_ivp`."""

    tightest = 3e-14  # scipy refuses rtol below 100 eps
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
        return nothing, calls, _SPENT if isinstance(stopped, _TooLong) else _LOST
    if answer.status != 0:
        said = answer.message.rstrip(".").lower()
        return nothing, answer.nfev, f"failed: {integrator} of scipy gave up: {said}"
    return answer.y, answer.nfev, ""
