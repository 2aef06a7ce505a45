"""The growth of a small change of the start: the condition number of a shape, section 6 of the physics notes."""

import numpy as np

from .landscape import slope_rate
from .reduced import Array, Reduced


def steps(problem: Reduced, dt: Array, beta: Array) -> tuple[Array, Array, Array]:
    """The 2x2 transfer of eta'' = -H'(beta) eta over steps dt with beta frozen: (diagonal, upper, lower), as dt."""
    rate = slope_rate(problem, beta)
    root = np.sqrt(np.abs(rate))
    angle = root * dt
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        centre = rate >= 0
        diagonal = np.where(centre, np.cos(angle), np.cosh(np.minimum(angle, 700)))
        sine = np.where(centre, np.sin(angle), np.sinh(np.minimum(angle, 700)))
        upper = np.where(angle > 0, sine / np.where(root > 0, root, 1), dt)
    return diagonal, upper, -rate * upper


def growth(problem: Reduced, t: Array, beta: Array) -> Array:
    """Largest |d beta(t)/d beta(0)| and |d beta(t)/d beta_t(0)| over the stations t, at least 1; all (B, n) -> (B,).

    beta is taken as constant between stations, so a digit or two of the answer can be trusted where the stations
    resolve it.
    """
    column = Reduced(*(v[:, None] for v in (problem.lam, problem.mu, problem.phi, problem.span, problem.beta0)))
    diagonal, upper, lower = steps(column, np.diff(t, axis=1), (beta[:, 1:] + beta[:, :-1]) / 2)
    zero, one = np.zeros(problem.size), np.ones(problem.size)
    b1, v1, b2, v2, worst = one, zero, zero, one, one.copy()
    with np.errstate(over="ignore", invalid="ignore"):
        for k in range(diagonal.shape[1]):
            d, u, w = diagonal[:, k], upper[:, k], lower[:, k]
            b1, v1, b2, v2 = d * b1 + u * v1, w * b1 + d * v1, d * b2 + u * v2, w * b2 + d * v2
            worst = np.fmax(worst, np.fmax(np.abs(b1), np.abs(b2)))
    return np.where(np.isfinite(worst), worst, np.inf)


def refined(problem: Reduced, t: Array, most: int) -> tuple[Array, int]:
    """The stations with k - 1 more on equal steps between neighbours, (B, (n - 1) k + 1), and k: a power of two that
    divides `most`, at most 16, and no larger than `growth` needs to see how the field turns between them."""
    steepest = np.abs(problem.lam) + 2 * np.abs(problem.mu) + np.abs(problem.phi) + 2  # |H'| is nowhere larger
    with np.errstate(over="ignore"):
        angle = np.max(np.sqrt(steepest) * np.diff(t, axis=1).max(axis=1, initial=0.0), initial=0.0)
    k = 1
    while k < 16 and angle > k / 2 and most % (2 * k) == 0:
        k *= 2
    if k == 1:
        return t, 1
    parts = t[:, :-1, None] + np.diff(t, axis=1)[:, :, None] * (np.arange(k) / k)
    return np.concatenate([parts.reshape(t.shape[0], -1), t[:, -1:]], axis=1), k
