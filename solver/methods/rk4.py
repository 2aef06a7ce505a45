"""`rk4`: the classical Runge-Kutta rule of order 4 with equal steps, as a textbook would have it."""

from typing import Any

import numpy as np

from ..mechanics.potential import slope
from ..numerics.arrays import Array
from ..problem.reduced import Reduced
from ..problem.trajectory import Trajectory
from .base import Knob, Method
from .marching import Scheme, marched


def run(problem: Reduced, t: Array, tol: float, steps: int | None = None, **_: Any) -> Trajectory:
    """March all problems at once, with `steps` equal steps between neighbouring stations, or as many as `tol` needs."""
    return marched(SCHEME, problem, t, tol, steps)


def _march(problem: Reduced, t: Array, steps: int) -> Array:
    """beta, beta_t, alpha, z, swirl at the stations, (5, B, n)."""
    assert problem.dbeta0 is not None
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


def _rates(problem: Reduced, y: Array) -> Array:
    """The rate of beta, beta_t, alpha, z, swirl, (5, B)."""
    s, c = np.sin(y[0]), np.cos(y[0])
    return np.stack([y[1], -slope(problem, y[0]), s, c, s * c])


SCHEME = Scheme(_march, order=4, calls=4, most=2**15)

RK4 = Method("rk4", run, ("start",), 4, "classical Runge-Kutta of order 4, equal steps", {"steps": Knob(int, 1)})
