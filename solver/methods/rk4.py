"""`rk4`: the classical Runge-Kutta rule of order 4 with equal steps, as a textbook would have it."""

from dataclasses import dataclass

import numpy as np

from ..mechanics.potential import slope
from ..numerics.arrays import Array
from ..problem.reduced import StartProblem
from ..problem.trajectory import Trajectory
from .base import Ladder, StartMethod, knob, twos
from .marching import Scheme, State, march


@dataclass(frozen=True)
class RK4(StartMethod):
    """Classical Runge-Kutta. steps: equal steps between stations; default: as many as the tolerance needs."""

    name = "rk4"
    summary = "classical Runge-Kutta of order 4, equal steps"
    order = 4
    ladders = (Ladder("rk4", "steps", twos(6), "#a0522d", "s"),)

    steps: int | None = knob(int, least=1)

    def run(self, problem: StartProblem, t: Array, tol: float) -> Trajectory:
        return march(SCHEME, problem, t, tol, self.steps)


def _step(problem: StartProblem, state: State, h: Array) -> State:
    k1 = _rates(problem, state)
    k2 = _rates(problem, state + h / 2 * k1)
    k3 = _rates(problem, state + h / 2 * k2)
    k4 = _rates(problem, state + h * k3)
    return state + h / 6 * (k1 + 2 * (k2 + k3) + k4)


def _rates(problem: StartProblem, y: Array) -> Array:
    """The rate of beta, beta_t, alpha, z, swirl, (5, B)."""
    s, c = np.sin(y[0]), np.cos(y[0])
    return np.stack([y[1], -slope(problem, y[0]), s, c, s * c])


SCHEME = Scheme(_step, order=4, calls=4, most=2**15)
