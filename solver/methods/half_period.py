"""`orbit` and `swing`: half a period of the orbit of beta, the rest by symmetry.

`orbit` integrates by quadrature (`orbits.periodic_orbit`), `swing` marches by Taylor's method in the compiled core
(`orbits.marched_orbit`). Next to a saddle a march loses the digits that decide where the orbit goes; there `swing`
hands the rod to `orbit`. Its error is measured: the covariance of the truncation and rounding of its steps is carried
along with them.
"""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ..core.tuning import MOST_PANELS
from ..numerics.arrays import Array
from ..orbits.marched_orbit import MarchedOrbit, march_orbit
from ..orbits.periodic_orbit import judge, solve_orbit
from ..problem.dimensionless import StartProblem
from ..problem.errors import DEFAULT_TOLERANCE
from ..problem.limits import LARGEST, beyond_limits
from ..problem.outcomes import Verdicts, all_solved, verdicts
from ..problem.trajectory import Trajectory, blank, stood_in
from .method import TOLERANCES, Ladder, StartMethod

# times the tolerance: an error beyond it is handed over, also where the condition number excuses it. x10: answers that
# miss the tolerance so far are kept
_DIGITS = 100


@dataclass(frozen=True)
class OrbitQuadrature(StartMethod):
    """The periodic orbit by quadrature; it has no knobs."""

    name = "orbit"
    summary = "quadrature over half a period, the rest by symmetry"
    order = float("inf")
    knows_orbit = True
    batched = True
    ladders = (Ladder("orbit", "tol", TOLERANCES, "#00704f", "o", bold=True),)

    def run(self, problem: StartProblem, t: Array, tol: float) -> Trajectory:
        fit = beyond_limits(problem) == ""
        return blank(_integrate(stood_in(problem, fit), np.where(fit[:, None], t, 0), tol), fit, LARGEST.why)


def _integrate(problem: StartProblem, t: Array, tol: float) -> Trajectory:
    orbit = solve_orbit(problem, tol)
    beta, dbeta, alpha, z = orbit.at(t)
    growth, error = judge(orbit)
    spent = np.bincount(orbit.panels.arc // 2, minlength=problem.size) > MOST_PANELS
    why = np.where(spent & (error > tol * growth), f"failed: the orbit needs more than {MOST_PANELS} panels", "")
    verdict = verdicts(beta, error, growth, tol).with_failures(why)
    rest = *verdict, error, growth, orbit.evaluations, orbit
    return Trajectory(beta, dbeta, alpha, z, partial(orbit.swirl, t), *rest)


@dataclass(frozen=True)
class SwingTaylor(StartMethod):
    """Half a period of the orbit by compiled Taylor series; it has no knobs."""

    name = "swing"
    summary = "Taylor series over half a period, compiled; the rest by symmetry"
    order = float("inf")
    knows_orbit = True
    batched = True
    blockwise = False
    ladders = (Ladder("swing", "tol", TOLERANCES, "#000000", "h"),)

    def run(self, problem: StartProblem, t: Array, tol: float) -> Trajectory:
        """All problems in one call; `orbit` solves those that a march loses or cannot do to the tolerance."""
        whole = np.empty((4, *t.shape))
        orbit = march_orbit(problem, tol, t, whole)
        if orbit.found["sound"].all():
            verdict = all_solved(problem.size)
        else:
            orbit, verdict = _mend(orbit, whole, t, tol)
        (beta, dbeta, alpha, z), numbers = whole, orbit.found
        rest = *verdict, numbers["error"], numbers["condition"], numbers["evaluations"], orbit
        return Trajectory(beta, dbeta, alpha, z, partial(orbit.swirl, t), *rest)


def condition_numbers(problem: StartProblem, t: Array) -> Array:
    """The condition numbers of B start problems up to their last stations, t (B, n), for methods that know no orbit."""
    reach = t[:, -1]
    condition = SwingTaylor().run(replace(problem, span=reach), t[:, -1:], DEFAULT_TOLERANCE).condition
    return np.where(reach == 0, 1.0, condition)


def _mend(orbit: MarchedOrbit, whole: Array, t: Array, tol: float) -> tuple[MarchedOrbit, Verdicts]:
    """The orbits and their verdicts, `orbit` in place of each march that fails; its values are written to `whole`."""
    numbers = orbit.found
    whole[:, orbit.lost] = np.nan
    solved, outcome = verdicts(whole[0], numbers["error"], numbers["condition"], tol)
    # a quadrature also recovers digits that the condition number would excuse
    lost = orbit.lost | ~solved | (numbers["error"] > _DIGITS * tol) | ~np.isfinite(numbers["condition"])
    if lost.any():
        answer = OrbitQuadrature().run_in_blocks(orbit.problem.take(lost), t[lost], tol)
        whole[:, lost] = answer.beta, answer.dbeta, answer.alpha, answer.z
        solved[lost], outcome[lost] = answer.solved, answer.outcome
        orbit = orbit.complete(lost, answer)
    return orbit, Verdicts(solved, outcome)
