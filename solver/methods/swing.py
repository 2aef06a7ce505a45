"""`swing`: half a swing by Taylor's method, compiled; the rest by symmetry. Optional (the extra `fast`: numba).

What `orbit` does by quadrature and for every extreme, this does by marching, for orbits that do not rest next to a
saddle: there a march loses the digits that say where the orbit goes, and `swing` hands the rod to `orbit`. Its error
is measured, not hoped: the covariance of what its steps leave out and round off is carried along with them.
"""

from typing import Any

import numpy as np

from ..core.loader import INSTALLED as INSTALLED
from ..numerics.arrays import Array
from ..orbit.marched_orbit import joined, march_orbit, memory_for, read_orbit
from ..orbit.pieces import LIBRATION
from ..problem.limits import TOO_LARGE, dimensionless
from ..problem.reduced import Reduced
from ..problem.trajectory import SOLVED, Trajectory, blanked, stood_in, verdicts
from . import orbit
from .base import Method

MISSING = "method 'swing' needs the package numba, which is not installed: pip install 'rod-workbench[fast]'"
_DIGITS = 100  # times the tolerance: an error beyond it is handed over, also where the condition number excuses it
_BLOCK = 128  # orbits marched and read while their series are in the cache


def run(problem: Reduced, t: Array, tol: float, **_: Any) -> Trajectory:
    """All problems, a block at a time; what a march would lose, or cannot do to the tolerance, `orbit` does."""
    fit = dimensionless(problem)
    problem = stood_in(problem, fit)
    t = np.where(fit[:, None], t, 0)
    whole, blocks, memory = np.empty((4, *t.shape)), [], memory_for(min(_BLOCK, problem.size))
    for block in (slice(k, k + _BLOCK) for k in range(0, problem.size, _BLOCK)):
        some, steps = march_orbit(problem.take(block), tol, memory)
        read_orbit(some.lost, some.kind == LIBRATION, some.arcs, steps, t[block], whole[:, block])
        blocks.append(some)
    found = joined(blocks, problem)
    outcome = verdicts(whole[0], found.error, found.condition, tol)
    # promised or not, digits that only a march loses are worth a quadrature
    failed = np.array([not text.startswith(SOLVED) for text in outcome])
    lost = found.lost | failed | (found.error > _DIGITS * tol) | ~np.isfinite(found.condition)
    if lost.any():
        answer = orbit.run(problem.take(lost), t[lost], tol)
        whole[:, lost] = answer.beta, answer.dbeta, answer.alpha, answer.z
        outcome[lost] = answer.outcome
        found = found.completed(lost, answer)
    beta, dbeta, alpha, z = whole
    rest = (outcome, found.error, found.condition, found.evaluations, found)
    return blanked(Trajectory(beta, dbeta, alpha, z, lambda: found.swirl(t), *rest), fit, TOO_LARGE)


SWING = Method(
    "swing", run, ("start",), float("inf"), "Taylor series over half a period, compiled; the rest by symmetry"
)
