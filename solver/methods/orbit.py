"""`orbit`: the periodic orbit by quadrature over half a period; see `orbit.periodic_orbit`."""

from typing import Any

import numpy as np

from ..numerics.arrays import Array
from ..orbit.conditioning import condition
from ..orbit.error_estimate import estimated_error
from ..orbit.panels import MOST
from ..orbit.periodic_orbit import solve_orbit
from ..problem.limits import TOO_LARGE, dimensionless
from ..problem.reduced import Reduced
from ..problem.trajectory import Trajectory, blanked, stood_in, verdicts
from .base import Method

SPENT = f"failed: more than the {MOST} panels that one orbit may take"


def run(problem: Reduced, t: Array, tol: float, **_: Any) -> Trajectory:
    """All problems at once; those whose numbers a float cannot hold are refused by their outcome."""
    fit = dimensionless(problem)
    return blanked(_run(stood_in(problem, fit), np.where(fit[:, None], t, 0), tol), fit, TOO_LARGE)


def _run(problem: Reduced, t: Array, tol: float) -> Trajectory:
    orbit = solve_orbit(problem, tol)
    beta, dbeta, alpha, z = orbit.at(t)
    growth = condition(orbit)
    error = estimated_error(orbit, growth)
    outcome = verdicts(beta, error, growth, tol)
    spent = np.bincount(orbit.panels.arc // 2, minlength=problem.size) > MOST
    outcome[spent & (error > tol * growth)] = SPENT
    calls = np.bincount(orbit.panels.arc // 2, weights=orbit.panels.calls, minlength=problem.size).astype(np.int64)
    return Trajectory(beta, dbeta, alpha, z, lambda: orbit.swirl(t), outcome, error, growth, calls, orbit)


ORBIT = Method("orbit", run, ("start",), float("inf"), "quadrature over half a period, the rest by symmetry")
