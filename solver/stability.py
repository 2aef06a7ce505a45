"""The second variation of an equilibrium between given ends, as the tridiagonal matrix of -eta'' - H'(beta) eta.

Both beta(0) and beta(L) are held, FZ, MZ and M3 are dead loads and the positions of the ends are free: an equilibrium
with no negative direction here is stable in that sense. Clamping the positions as well would forbid some directions,
so it could only make more shapes stable.

The index is counted in two ways that share nothing: negative pivots of that matrix on a mesh, and zeros of the Jacobi
field, known from the orbit itself. The pivots lose the rod that stays near a saddle for long: what it does after
that hangs on digits that no mesh keeps.
"""

from typing import Any

import numpy as np

from .course import HELIX, LIBRATION
from .landscape import slope_rate
from .reduced import Array, Reduced


def morse_index(problem: Reduced, h: Array, beta: Array) -> Array:
    """Negative pivots of the Hessian at beta (B, n) on equal steps h (B,): the number of unstable directions, (B,)."""
    diagonal = _diagonal(problem, h, beta)
    index = np.zeros(beta.shape[0], dtype=np.int64)
    pivot = np.full(beta.shape[0], np.inf)
    for k in range(diagonal.shape[1]):
        pivot = diagonal[:, k] - 1 / pivot
        pivot = np.where(pivot == 0, 1e-300, pivot)
        index += pivot < 0
    return index


def jacobi_zeros(problem: Reduced, orbit: Any, lengthens: Array) -> Array:
    """Zeros inside (0, L) of eta'' + H'(beta) eta = 0, eta(0) = 0, eta'(0) = 1, on B orbits: the Morse index, (B,).

    No march: beta_t solves the same equation, so by Sturm eta has one zero between each two of its zeros, the turning
    points. Whether another follows the last of them is told by the sign of eta(L) = d beta(L)/d beta_t(0), which is
    that of -2 beta_t(0) beta_t(L) dT/d(level), T being the length of the orbit between the two angles. Exact however
    long the rod and however closely it hugs a saddle. `lengthens`: (B,), whether dT/d(level) > 0.
    """
    swing = orbit.ahead + orbit.back
    first = np.where(orbit.ahead > 0, orbit.ahead, swing)
    with np.errstate(divide="ignore", invalid="ignore"):
        turns = np.maximum(np.ceil((problem.span - first) / swing * (1 - 1e-12)), 0)
        rate = slope_rate(problem, problem.beta0)
        waves = np.ceil(np.sqrt(np.maximum(rate, 0)) * problem.span / np.pi * (1 - 1e-12)) - 1
    swings = orbit.course.kind == LIBRATION
    at_rest = orbit.back == 0  # eta is beta_t itself
    index = np.where(swings, np.maximum(turns - (lengthens & ~at_rest), 0), 0)
    return np.where(orbit.course.kind == HELIX, np.maximum(waves, 0), index).astype(np.int64)


def response(problem: Reduced, h: Array, beta: Array) -> Array:
    """Largest |d beta(t)/d beta(L)| along each equilibrium, (B,): unbounded at a fold, 1 or so away from one.

    By elimination without pivoting, which follows the Jacobi field; an indefinite matrix is no obstacle to it.
    """
    diagonal = np.ascontiguousarray(_diagonal(problem, h, beta).T)
    ratio = np.empty_like(diagonal)  # eta_k = ratio_k eta_{k+1}
    last = np.zeros(beta.shape[0])
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        for k in range(ratio.shape[0]):
            last = 1 / (diagonal[k] - last)
            ratio[k] = last
        eta = np.cumprod(ratio[::-1], axis=0)
    largest = np.maximum(1, np.abs(eta).max(axis=0, initial=1))
    return np.where(np.isfinite(largest), largest, np.inf)


def _diagonal(problem: Reduced, h: Array, beta: Array) -> Array:
    column = Reduced(*(v[:, None] for v in (problem.lam, problem.mu, problem.phi, problem.span, problem.beta0)))
    return 2 - h[:, None] ** 2 * slope_rate(column, beta[:, 1:-1])
