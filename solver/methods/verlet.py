"""`verlet`: the paper's central difference equation (41), marched from the start, with its extrapolation (47).

beta_{k+1} - 2 beta_k + beta_{k-1} = -h^2 H(beta_k): Stoermer's rule, written in the summed (velocity) form that keeps
rounding from growing with 1/h^2. Symplectic; order 2, order 4 once (4 y_{h/2} - y_h)/3 is taken. alpha, z and the swirl
by the trapezoidal rule on the same points, whose error has the same expansion in h^2.
"""

from typing import Any

import numpy as np

from ..mechanics.potential import slope
from ..numerics.arrays import Array
from ..problem.reduced import Reduced
from ..problem.trajectory import Trajectory
from .base import Knob, Method
from .marching import Scheme, marched


def run(
    problem: Reduced, t: Array, tol: float, steps: int | None = None, extrapolate: bool = True, **_: Any
) -> Trajectory:
    """March all problems at once, with `steps` equal steps between neighbouring stations, or as many as `tol` needs."""
    return marched(SCHEME, problem, t, tol, steps, extrapolate)


def _march(problem: Reduced, t: Array, steps: int) -> Array:
    """beta, beta_t, alpha, z, swirl at the stations, (5, B, n)."""
    assert problem.dbeta0 is not None
    out = np.empty((5, *t.shape))
    beta, v = problem.beta0.copy(), problem.dbeta0.copy()
    alpha, z, swirl = (np.zeros(problem.size) for _ in range(3))
    with np.errstate(over="ignore", invalid="ignore"):
        kick, s, c = slope(problem, beta), np.sin(beta), np.cos(beta)
        gap = np.diff(t, axis=1, prepend=0.0) / steps  # the first interval is empty where t begins at 0
        for k in range(t.shape[1]):
            h = gap[:, k]
            for _ in range(steps if h.any() else 0):
                v = v - h / 2 * kick
                beta = beta + h * v
                kick, s_new, c_new = slope(problem, beta), np.sin(beta), np.cos(beta)
                v = v - h / 2 * kick
                alpha, z = alpha + h / 2 * (s + s_new), z + h / 2 * (c + c_new)
                swirl = swirl + h / 2 * (s * c + s_new * c_new)
                s, c = s_new, c_new
            out[:, :, k] = beta, v, alpha, z, swirl
    return out


SCHEME = Scheme(_march, order=2, calls=1, most=2**17)

VERLET = Method(
    "verlet",
    run,
    ("start",),
    4,
    "the paper's difference equation marched; order 2, extrapolated 4",
    {"steps": Knob(int, 1), "extrapolate": Knob(bool)},
)
