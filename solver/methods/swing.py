"""`swing`: half a period by Taylor's method, in the compiled core; the rest by symmetry.

It marches where `orbit` integrates by quadrature. Next to a saddle a march loses the digits that decide where the
orbit goes; there `swing` hands the rod to `orbit`. Its error is measured: the covariance of the truncation and rounding
of its steps is carried along with them.
"""

from dataclasses import dataclass

import numpy as np

from ..core.library import library, why_missing
from ..numerics.arrays import Array
from ..orbit.marched_orbit import march_orbit
from ..problem.limits import TOO_LARGE, dimensionless
from ..problem.reduced import StartProblem
from ..problem.trajectory import Trajectory, blanked, stood_in, verdicts
from .base import StartMethod
from .blocks import run_in_blocks
from .ladder import TOLERANCES, Ladder
from .orbit import OrbitQuadrature

_DIGITS = 100  # times the tolerance: an error beyond it is handed over, also where the condition number excuses it


@dataclass(frozen=True)
class SwingTaylor(StartMethod):
    """Half a period of the orbit by compiled Taylor series; it has no knobs."""

    name = "swing"
    summary = "Taylor series over half a period, compiled; the rest by symmetry"
    order = float("inf")
    knows_orbit = True
    batched = True
    blockwise = False
    ladders = (Ladder("swing", "tol", TOLERANCES, "#000000", "X"),)

    @classmethod
    def lacks(cls) -> str:
        return "" if library() is not None else f"the compiled core, which is missing: {why_missing()}"

    def run(self, problem: StartProblem, t: Array, tol: float) -> Trajectory:
        """All problems in one call; `orbit` solves those that a march loses or cannot do to the tolerance."""
        fit = dimensionless(problem)
        if not fit.all():
            problem, t = stood_in(problem, fit), np.where(fit[:, None], t, 0)
        whole = np.empty((4, *t.shape))
        found = march_orbit(problem, tol, t, whole)
        whole[:, found.lost] = np.nan
        solved, outcome = verdicts(whole[0], found.error, found.condition, tol)
        # a quadrature also recovers digits that the condition number would excuse
        lost = found.lost | ~solved | (found.error > _DIGITS * tol) | ~np.isfinite(found.condition)
        if lost.any():
            answer = run_in_blocks(OrbitQuadrature(), problem.take(lost), t[lost], tol)
            whole[:, lost] = answer.beta, answer.dbeta, answer.alpha, answer.z
            solved[lost], outcome[lost] = answer.solved, answer.outcome
            found = found.completed(lost, answer)
        beta, dbeta, alpha, z = whole
        rest = (solved, outcome, found.error, found.condition, found.evaluations, found)
        return blanked(Trajectory(beta, dbeta, alpha, z, lambda: found.swirl(t), *rest), fit, TOO_LARGE)
