"""`swing`: half a period by Taylor's method, compiled; the rest by symmetry. Optional (the extra `fast`: numba).

It marches where `orbit` integrates by quadrature. Next to a saddle a march loses the digits that decide where the
orbit goes; there `swing` hands the rod to `orbit`. Its error is measured: the covariance of the truncation and rounding
of its steps is carried along with them.
"""

from dataclasses import dataclass

import numpy as np

from ..numerics.arrays import Array
from ..orbit.marched_orbit import joined, march_orbit, memory_for, read_orbit
from ..orbit.pieces import LIBRATION
from ..problem.limits import TOO_LARGE, dimensionless
from ..problem.reduced import StartProblem
from ..problem.trajectory import Trajectory, blanked, stood_in, verdicts
from .base import StartMethod
from .ladder import TOLERANCES, Ladder
from .orbit import OrbitQuadrature

_DIGITS = 100  # times the tolerance: an error beyond it is handed over, also where the condition number excuses it
_BLOCK = 128  # orbits marched and read while their series are in the cache


@dataclass(frozen=True)
class SwingTaylor(StartMethod):
    """Half a period of the orbit by compiled Taylor series; it has no knobs."""

    name = "swing"
    summary = "Taylor series over half a period, compiled; the rest by symmetry"
    order = float("inf")
    knows_orbit = True
    batched = True
    requires = "numba"
    extra = "fast"
    ladders = (Ladder("swing", "tol", TOLERANCES, "#000000", "X"),)

    def run(self, problem: StartProblem, t: Array, tol: float) -> Trajectory:
        """All problems, a block at a time; `orbit` solves those that a march loses or cannot do to the tolerance."""
        fit = dimensionless(problem)
        problem = stood_in(problem, fit)
        t = np.where(fit[:, None], t, 0)
        whole, blocks, memory = np.empty((4, *t.shape)), [], memory_for(min(_BLOCK, problem.size))
        for block in (slice(k, k + _BLOCK) for k in range(0, problem.size, _BLOCK)):
            some, steps = march_orbit(problem.take(block), tol, memory)
            read_orbit(some.lost, some.kind == LIBRATION, some.arcs, steps, t[block], whole[:, block])
            blocks.append(some)
        found = joined(blocks, problem)
        solved, outcome = verdicts(whole[0], found.error, found.condition, tol)
        # a quadrature also recovers digits that the condition number would excuse
        lost = found.lost | ~solved | (found.error > _DIGITS * tol) | ~np.isfinite(found.condition)
        if lost.any():
            answer = OrbitQuadrature().run(problem.take(lost), t[lost], tol)
            whole[:, lost] = answer.beta, answer.dbeta, answer.alpha, answer.z
            solved[lost], outcome[lost] = answer.solved, answer.outcome
            found = found.completed(lost, answer)
        beta, dbeta, alpha, z = whole
        rest = (solved, outcome, found.error, found.condition, found.evaluations, found)
        return blanked(Trajectory(beta, dbeta, alpha, z, lambda: found.swirl(t), *rest), fit, TOO_LARGE)
