"""The second variation of an equilibrium between given ends, as the tridiagonal matrix of -eta'' - H'(beta) eta.

Both beta(0) and beta(L) are held, FZ, MZ and M3 are dead loads and the positions of the ends are free: an equilibrium
with no negative direction here is stable in that sense. Clamping the positions as well would forbid some directions,
so it could only make more shapes stable.
"""

import numpy as np

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


def response(problem: Reduced, h: Array, beta: Array) -> Array:
    """Largest |d beta(t)/d beta(L)| along each equilibrium, (B,): unbounded at a fold, 1 or so away from one."""
    diagonal = _diagonal(problem, h, beta)
    out = np.empty(beta.shape[0])
    for i, row in enumerate(diagonal):
        out[i] = _one_response(row)
    return out


def _one_response(diagonal: Array) -> float:
    """By elimination without pivoting, which follows the Jacobi field; an indefinite matrix is no obstacle to it."""
    n = diagonal.size
    ratio = np.empty(n)  # eta_k = ratio_k eta_{k+1}
    last = 0.0
    for k in range(n):
        pivot = diagonal[k] - last
        last = 1 / pivot if pivot != 0 else np.inf
        ratio[k] = last
    largest, eta = 1.0, 1.0
    for value in ratio[::-1]:
        eta *= value
        if not np.isfinite(eta):
            return np.inf
        largest = max(largest, abs(eta))
    return largest


def _diagonal(problem: Reduced, h: Array, beta: Array) -> Array:
    column = Reduced(*(v[:, None] for v in (problem.lam, problem.mu, problem.phi, problem.span, problem.beta0)))
    return 2 - h[:, None] ** 2 * slope_rate(column, beta[:, 1:-1])
