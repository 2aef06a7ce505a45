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
from .marching import Scheme, State, march


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


def _step(problem: StartProblem, state: State, h: Array) -> State:
    beta, v, alpha, z, swirl = state
    s, c = np.sin(beta), np.cos(beta)
    return beta + h * v, v - h * slope(problem, beta), alpha + h * s, z + h * c, swirl + h * s * c


SCHEME = Scheme(_step, order=1, calls=1, most=2**16)
