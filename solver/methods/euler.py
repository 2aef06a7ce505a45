"""`euler`: the explicit Euler rule, which the paper holds its own scheme against.

Order 1, and not symplectic: h = beta_t^2 + G grows in step with the arc, and a closed orbit winds outward. It is here
so that the comparison can be repeated; nothing should be computed with it.
"""

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
    beta, v = problem.beta0.copy(), problem.dbeta0.copy()
    alpha, z, swirl = (np.zeros(problem.size) for _ in range(3))
    gap = np.diff(t, axis=1, prepend=0.0) / steps  # the first interval is empty where t begins at 0
    with np.errstate(over="ignore", invalid="ignore"):
        for k in range(t.shape[1]):
            h = gap[:, k]
            for _ in range(steps if h.any() else 0):
                s, c = np.sin(beta), np.cos(beta)
                alpha, z, swirl = alpha + h * s, z + h * c, swirl + h * s * c
                beta, v = beta + h * v, v - h * slope(problem, beta)
            out[:, :, k] = beta, v, alpha, z, swirl
    return out


SCHEME = Scheme(_march, order=1, calls=1, most=2**16)

EULER = Method("euler", run, ("start",), 1, "explicit Euler, for comparison only", {"steps": Knob(int, 1)})
