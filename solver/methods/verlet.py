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
from .marching import Scheme, State, march, start_of


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


def _begin(problem: StartProblem) -> State:
    beta = problem.beta0
    return *start_of(problem), slope(problem, beta), np.sin(beta), np.cos(beta)


def _step(problem: StartProblem, state: State, h: Array) -> State:
    beta, v, alpha, z, swirl, kick, s, c = state
    v = v - h / 2 * kick
    beta = beta + h * v
    kick, s_new, c_new = slope(problem, beta), np.sin(beta), np.cos(beta)
    v = v - h / 2 * kick
    alpha, z = alpha + h / 2 * (s + s_new), z + h / 2 * (c + c_new)
    return beta, v, alpha, z, swirl + h / 2 * (s * c + s_new * c_new), kick, s_new, c_new


SCHEME = Scheme(_step, order=2, calls=1, most=2**17, begin=_begin)
