"""Marches of equal steps: the number of steps is doubled until the tolerance is met, which also gives the error."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..numerics.arrays import Array
from ..problem.reduced import StartProblem
from ..problem.trajectory import Trajectory
from .base import largest, trajectory_of
from .swing import condition_numbers

# beta, beta_t, alpha, z and swirl of B problems, (B,) each, and what a scheme keeps from one step to the next
State = Any


def start_of(problem: StartProblem) -> State:
    """The state at the start, (5, B)."""
    none = np.zeros(problem.size)
    return np.stack([problem.beta0, problem.dbeta0, none, none, none])


@dataclass(frozen=True)
class Scheme:
    """A march of equal steps.

    step: problems, their state and the step (B,) -> the state after it. order: of convergence. calls: of the equation
    in a step. most: steps along the rod. begin: problems -> the state at the start.
    """

    step: Callable[[StartProblem, State, Array], State]
    order: int
    calls: int
    most: int
    begin: Callable[[StartProblem], State] = start_of

    def at(self, problem: StartProblem, t: Array, steps: int) -> Array:
        """beta, beta_t, alpha, z, swirl at the stations t, so many steps between two of them, (5, B, n)."""
        out = np.empty((5, *t.shape))
        gap = np.diff(t, axis=1, prepend=0.0) / steps  # the first interval is empty where t begins at 0
        with np.errstate(over="ignore", invalid="ignore"):
            state = self.begin(problem)
            for k in range(t.shape[1]):
                h = gap[:, k]
                for _ in range(steps if h.any() else 0):
                    state = self.step(problem, state, h)
                out[:, :, k] = state[:5]
        return out


def march(
    scheme: Scheme, problem: StartProblem, t: Array, tol: float, steps: int | None, extrapolate: bool = False
) -> Trajectory:
    """All problems at once, with `steps` equal steps between neighbouring stations.

    Without `steps` the number is doubled for the problems whose last two answers differ by more than `tol`, until the
    scheme's largest number of steps is reached. With `steps` the answer has that number of steps, and a finer march
    measures its error. extrapolate: take Richardson's combination of two successive answers, eq. (47), which raises the
    order by two if the error has only even powers.
    """
    base = t if not t[:, 0].any() else np.concatenate([np.zeros((problem.size, 1)), t], axis=1)
    intervals, power = base.shape[1] - 1, 2.0 ** (scheme.order + 2 * extrapolate)
    answer, off = np.empty((2, 5, *base.shape))  # of all problems, each as of its last march
    work, left = np.zeros(problem.size, dtype=np.int64), np.arange(problem.size)
    n, marches, answers = steps or 1, list[Array](), list[Array]()
    while left.size:
        marches.append(scheme.at(problem.take(left), base[left], n))
        work[left] += scheme.calls * intervals * n
        if not extrapolate:
            answers.append(marches[-1])
        elif len(marches) > 1:
            answers.append(_extrapolate(scheme.order, *marches[-2:]))
        if len(answers) > 1:
            off[:, left] = np.abs(answers[-1] - answers[-2]) * power / (power - 1)
            answer[:, left] = answers[-1 if steps is None else 0]
            pending = _error(base, off)[left] > tol
            if steps is not None or 2 * n * intervals > scheme.most:
                pending[:] = False
            marches, answers, left = [marches[-1][:, pending]], [answers[-1][:, pending]], left[pending]
        n *= 2
    condition = condition_numbers(problem, t)
    error = _error(base, off) + 2e-16 * np.sqrt(work) * condition
    return trajectory_of(answer[:, :, base.shape[1] - t.shape[1] :], error, condition, work, tol)


def _extrapolate(order: int, coarse: Array, fine: Array) -> Array:
    """Richardson's combination of two answers, eq. (47)."""
    power = 2.0**order
    return (power * fine - coarse) / (power - 1)


def _error(t: Array, off: Array) -> Array:
    """The error of the answers at t (B, n) whose difference is off (5, B, n), (B,)."""
    return np.nan_to_num(largest(off, t[:, -1:]), nan=np.inf)
