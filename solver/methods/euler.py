"""`euler`: the explicit Euler rule, with which the paper compares its own scheme.

Order 1, and not symplectic: h = beta_t^2 + G grows along the rod, and a closed orbit spirals outward. It is for
comparison only.
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
class Euler(StartMethod):
    """Explicit Euler. steps: equal steps between neighbouring stations; default: as many as the tolerance needs."""

    name = "euler"
    summary = "explicit Euler, for comparison only"
    order = 1
    ladders = (Ladder("euler", "steps", twos(9), "#8a8f98", "v"),)

    steps: int | None = knob(int, least=1)

    def run(self, problem: StartProblem, t: Array, tol: float) -> Trajectory:
        return march(SCHEME, problem, t, tol, self.steps)


def _march(problem: StartProblem, t: Array, steps: int) -> Array:
    """beta, beta_t, alpha, z, swirl at the stations, (5, B, n)."""
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
