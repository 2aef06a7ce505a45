"""`rk4`: the classical Runge-Kutta rule of order 4 with equal steps, as a textbook would have it."""

from dataclasses import dataclass

import numpy as np

from ..mechanics.potential import slope
from ..numerics.arrays import Array
from ..problem.reduced import StartProblem
from ..problem.trajectory import Trajectory
from .base import Ladder, StartMethod, knob, twos
from .marching import Scheme, march


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


def _march(problem: StartProblem, t: Array, steps: int) -> Array:
    """beta, beta_t, alpha, z, swirl at the stations, (5, B, n)."""
    out = np.empty((5, *t.shape))
    y = np.zeros((5, problem.size))
    y[0], y[1] = problem.beta0, problem.dbeta0
    gap = np.diff(t, axis=1, prepend=0.0) / steps  # the first interval is empty where t begins at 0
    with np.errstate(over="ignore", invalid="ignore"):
        for k in range(t.shape[1]):
            h = gap[:, k]
            for _ in range(steps if h.any() else 0):
                k1 = _rates(problem, y)
                k2 = _rates(problem, y + h / 2 * k1)
                k3 = _rates(problem, y + h / 2 * k2)
                k4 = _rates(problem, y + h * k3)
                y = y + h / 6 * (k1 + 2 * (k2 + k3) + k4)
            out[:, :, k] = y
    return out


def _rates(problem: StartProblem, y: Array) -> Array:
    """The rate of beta, beta_t, alpha, z, swirl, (5, B)."""
    s, c = np.sin(y[0]), np.cos(y[0])
    return np.stack([y[1], -slope(problem, y[0]), s, c, s * c])


SCHEME = Scheme(_march, order=4, calls=4, most=2**15)
