"""Marches of equal steps: `euler`, `rk4` and `verlet`, the paper's difference equation marched from the start.

The number of steps is doubled until the tolerance is met, which also gives the error.
"""

from abc import abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ..numerics.arrays import Array
from ..orbits.potential import slope
from ..problem.dimensionless import StartProblem
from ..problem.trajectory import Trajectory
from .half_period import condition_numbers
from .method import Ladder, StartMethod, knob, largest, trajectory_of, twos

# beta, beta_t, alpha, z and swirl of B problems, (B,) each, and what a rule keeps from one step to the next
State = Any


@dataclass(frozen=True)
class EqualSteps(StartMethod):
    """A march of equal steps.

    rule_order: of convergence without extrapolation. calls: of the equation in a step. most: steps along the rod.
    """

    rule_order: ClassVar[int]
    calls: ClassVar[int]
    most: ClassVar[int]

    steps: int | None = knob(int, least=1)

    def begin(self, problem: StartProblem) -> State:
        """The state at the start, (5, B)."""
        none = np.zeros(problem.size)
        return np.stack([problem.beta0, problem.dbeta0, none, none, none])

    @abstractmethod
    def step(self, problem: StartProblem, state: State, h: Array) -> State:
        """The state of B problems after a step h (B,)."""

    def run(self, problem: StartProblem, t: Array, tol: float) -> Trajectory:
        return self.march(problem, t, tol)

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

    def march(self, problem: StartProblem, t: Array, tol: float, extrapolate: bool = False) -> Trajectory:
        """All problems at once.

        Without `steps` the number is doubled for the problems whose last two answers differ by more than `tol`, until
        `most` steps are reached. With `steps` the answer has that number of steps between neighbouring stations, and a
        finer march measures its error. extrapolate: take Richardson's combination of two successive answers, eq. (47),
        which raises the order by two if the error has only even powers.
        """
        base = t if not t[:, 0].any() else np.concatenate([np.zeros((problem.size, 1)), t], axis=1)
        intervals, power = base.shape[1] - 1, 2.0 ** (self.rule_order + 2 * extrapolate)
        answer, off = np.empty((2, 5, *base.shape))  # of all problems, each as of its last march
        work, left = np.zeros(problem.size, dtype=np.int64), np.arange(problem.size)
        n, marches, answers = self.steps or 1, list[Array](), list[Array]()
        while left.size:
            marches.append(self.at(problem.take(left), base[left], n))
            work[left] += self.calls * intervals * n
            if not extrapolate:
                answers.append(marches[-1])
            elif len(marches) > 1:
                answers.append(_extrapolate(self.rule_order, *marches[-2:]))
            if len(answers) > 1:
                off[:, left] = np.abs(answers[-1] - answers[-2]) * power / (power - 1)
                answer[:, left] = answers[-1 if self.steps is None else 0]
                pending = _error(base, off)[left] > tol
                if self.steps is not None or 2 * n * intervals > self.most:
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


@dataclass(frozen=True)
class Euler(EqualSteps):
    """Explicit Euler. steps: equal steps between neighbouring stations; default: as many as the tolerance needs.

    Not symplectic: h = beta_t^2 + G grows along the rod, and a closed orbit spirals outward.
    """

    name = "euler"
    summary = "explicit Euler, for comparison only"
    order = rule_order = 1
    ladders = (Ladder("euler", "steps", twos(9), "#e0559f", "v"),)
    calls, most = 1, 2**16

    def step(self, problem: StartProblem, state: State, h: Array) -> State:
        return state + h * _rates(problem, state)


@dataclass(frozen=True)
class RK4(EqualSteps):
    """Classical Runge-Kutta. steps: equal steps between stations; default: as many as the tolerance needs."""

    name = "rk4"
    summary = "classical Runge-Kutta of order 4, equal steps"
    order = rule_order = 4
    ladders = (Ladder("rk4", "steps", twos(6), "#a0522d", "s"),)
    calls, most = 4, 2**15

    def step(self, problem: StartProblem, state: State, h: Array) -> State:
        k1 = _rates(problem, state)
        k2 = _rates(problem, state + h / 2 * k1)
        k3 = _rates(problem, state + h / 2 * k2)
        k4 = _rates(problem, state + h * k3)
        return state + h / 6 * (k1 + 2 * (k2 + k3) + k4)


def _rates(problem: StartProblem, y: Array) -> Array:
    """The rate of beta, beta_t, alpha, z, swirl, (5, B)."""
    s, c = np.sin(y[0]), np.cos(y[0])
    return np.stack([y[1], -slope(problem, y[0]), s, c, s * c])


@dataclass(frozen=True)
class Verlet(EqualSteps):
    """The paper's difference equation (41), marched.

    beta_{k+1} - 2 beta_k + beta_{k-1} = -h^2 H(beta_k): Stoermer's rule, written in the summed (velocity) form that
    keeps rounding from growing with 1/h^2. Symplectic; order 2, order 4 once (4 y_{h/2} - y_h)/3 is taken. alpha, z and
    the swirl by the trapezoidal rule on the same points, whose error has the same expansion in h^2.

    steps: equal steps between neighbouring stations; default: as many as the tolerance needs. extrapolate: whether
    Richardson's combination (47) is taken, which raises the order from 2 to 4.
    """

    name = "verlet"
    summary = "the paper's difference equation marched; order 2, extrapolated 4"
    order = 4
    ladders = (
        Ladder("verlet", "steps", twos(8), "#2997f2", "v", fixed={"extrapolate": False}),
        Ladder("verlet", "steps", twos(7), "#0072b2", "*", "--", label="verlet extrapolated"),
    )
    rule_order, calls, most = 2, 1, 2**17

    extrapolate: bool = knob(bool, default=True)

    def run(self, problem: StartProblem, t: Array, tol: float) -> Trajectory:
        return self.march(problem, t, tol, self.extrapolate)

    def begin(self, problem: StartProblem) -> State:
        beta = problem.beta0
        return *super().begin(problem), slope(problem, beta), np.sin(beta), np.cos(beta)

    def step(self, problem: StartProblem, state: State, h: Array) -> State:
        beta, v, alpha, z, swirl, kick, s, c = state
        v = v - h / 2 * kick
        beta = beta + h * v
        kick, s_new, c_new = slope(problem, beta), np.sin(beta), np.cos(beta)
        v = v - h / 2 * kick
        alpha, z = alpha + h / 2 * (s + s_new), z + h / 2 * (c + c_new)
        return beta, v, alpha, z, swirl + h / 2 * (s * c + s_new * c_new), kick, s_new, c_new
