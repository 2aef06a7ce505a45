"""`orbit`: the periodic orbit by quadrature over half a period; see `orbit.periodic_orbit`."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from ..numerics.arrays import Array
from ..orbit.periodic_orbit import MOST, judge, solve_orbit
from ..problem.reduced import StartProblem
from ..problem.trajectory import TOO_LARGE, Trajectory, beyond_limits, blank, stood_in, verdicts
from .base import TOLERANCES, Ladder, StartMethod

SPENT = f"failed: the orbit needs more than {MOST} panels"


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
        return blank(_run(stood_in(problem, fit), np.where(fit[:, None], t, 0), tol), fit, TOO_LARGE)


def _run(problem: StartProblem, t: Array, tol: float) -> Trajectory:
    orbit = solve_orbit(problem, tol)
    beta, dbeta, alpha, z = orbit.at(t)
    growth, error = judge(orbit)
    spent = np.bincount(orbit.panels.arc // 2, minlength=problem.size) > MOST
    why = np.where(spent & (error > tol * growth), SPENT, "")
    verdict = verdicts(beta, error, growth, tol).failed(why)
    rest = *verdict, error, growth, orbit.evaluations, orbit
    return Trajectory(beta, dbeta, alpha, z, partial(orbit.swirl, t), *rest)
