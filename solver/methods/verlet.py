"""`verlet`: the paper's central difference equation (41), marched from the start, with its extrapolation (47).

beta_{k+1} - 2 beta_k + beta_{k-1} = -h^2 H(beta_k): Stoermer's rule, written in the summed (velocity) form that keeps
rounding from growing with 1/h^2. Symplectic; order 2, order 4 once (4 y_{h/2} - y_h)/3 is taken. alpha, z and the swirl
by the trapezoidal rule on the same points, whose error has the same expansion in h^2.
"""

from dataclasses import dataclass

import numpy as np

from ..mechanics.potential import slope
from ..numerics.arrays import Array
from ..problem.reduced import StartProblem
from ..problem.trajectory import Trajectory
from .base import Ladder, StartMethod, knob, twos
from .marching import Scheme, march


@dataclass(frozen=True)
class Verlet(StartMethod):
    """The paper's difference equation, marched.

    steps: equal steps between neighbouring stations; default: as many as the tolerance needs. extrapolate: whether
    Richardson's combination (47) is taken, which raises the order from 2 to 4.
    """

    name = "verlet"
    summary = "the paper's difference equation marched; order 2, extrapolated 4"
    order = 4
    ladders = (
        Ladder("verlet", "steps", twos(8), "#2997f2", "d", fixed={"extrapolate": False}),
        Ladder("verlet", "steps", twos(7), "#0072b2", "*", "--", label="verlet extrapolated"),
    )

    steps: int | None = knob(int, least=1)
    extrapolate: bool = knob(bool, default=True)

    def run(self, problem: StartProblem, t: Array, tol: float) -> Trajectory:
        return march(SCHEME, problem, t, tol, self.steps, self.extrapolate)


def _march(problem: StartProblem, t: Array, steps: int) -> Array:
    """beta, beta_t, alpha, z, swirl at the stations, (5, B, n)."""
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
