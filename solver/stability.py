"""The second variation of an equilibrium between given ends, as the tridiagonal matrix of -eta'' - H'(beta) eta.

Both beta(0) and beta(L) are held, FZ, MZ and M3 are dead loads and the positions of the ends are free: an equilibrium
with no negative direction here is stable in that sense. Clamping the positions as well would forbid some directions,
so it could only make more shapes stable.

The index is counted in two ways that share nothing but H': negative pivots of that matrix on a mesh, and zeros of the
Jacobi field along the orbit itself.
"""

from typing import Any

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


def jacobi_zeros(problem: Reduced, orbit: Any, steps: int | None = None) -> Array:
    """Zeros inside (0, L) of eta'' + H'(beta) eta = 0, eta(0) = 0, eta'(0) = 1, on B orbits: the Morse index, (B,).

    The field is carried by transfers of fourth order (Magnus, two Gauss points a step) and scaled back after each, so
    however long the rod and however steep the saddle it hugs nothing overflows; only its direction is kept. `steps`:
    how many; enough for less than a tenth of a turn in each where left out.
    """
    if steps is None:
        fastest = np.sqrt(4 * (np.abs(problem.lam) + np.abs(problem.mu) + np.abs(problem.phi) + 1))
        steps = int(np.ceil(np.max(problem.span * fastest / 0.2, initial=16)))
    h = problem.span / steps
    points = (np.arange(steps)[:, None] + 0.5 + np.array([-1, 1]) / np.sqrt(12)).reshape(-1)
    column = Reduced(*(v[:, None] for v in (problem.lam, problem.mu, problem.phi, problem.span, problem.beta0)))
    rate = slope_rate(column, orbit.at(h[:, None] * points)[0]).reshape(-1, steps, 2)
    early, late = rate[:, :, 0], rate[:, :, 1]
    skew, pull = np.sqrt(3) / 12 * h[:, None] ** 2 * (late - early), -h[:, None] / 2 * (early + late)
    square = skew**2 + h[:, None] * pull
    root = np.sqrt(square.astype(complex))  # imaginary where the field swings
    even = np.cosh(root).real
    odd = np.where(square == 0, 1.0, (np.sinh(root) / np.where(square == 0, 1, root)).real)
    eta, climb = np.zeros(problem.size), np.ones(problem.size)
    zeros = np.zeros(problem.size, dtype=np.int64)
    for k in range(steps):
        e, o = even[:, k], odd[:, k]
        last = eta
        eta, climb = (
            (e + o * skew[:, k]) * eta + o * h * climb,
            o * pull[:, k] * eta + (e - o * skew[:, k]) * climb,
        )
        size = np.hypot(eta, climb)
        eta, climb = eta / size, climb / size
        zeros += last * eta < 0
    return zeros


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
