"""The condition number of a shape that is known at stations alone: the growth of a small change of its start."""

import numpy as np

from ..mechanics.potential import Loads, slope_rate, steepest
from ..numerics.arrays import Array
from ..problem.reduced import Reduced, StartProblem

_BLOCK = 2**18  # stations computed at once
_MOST = 2**22  # largest number of stations, for their memory


def slope_weight(problem: StartProblem) -> Array:
    """w = max(1, |beta_t(0)|, sqrt|H'(beta(0))|), (B,): the factor of a change of beta_t(0).

    With it a change of beta_t counts as the change of angle that it becomes a quarter of a period later, so the
    condition number does not depend on where in its period an orbit starts.
    """
    natural = np.sqrt(np.abs(slope_rate(problem, problem.beta0)))
    return np.maximum(np.maximum(1, np.abs(problem.dbeta0)), natural)


def growth(problem: StartProblem, t: Array, beta: Array, rate: Array) -> Array:
    """The largest |d beta(t)/d beta(0)| and w |d beta(t)/d beta_t(0)| over the stations; w as in `slope_weight`.

    Of order 4 in the distance of the stations, so one or two digits are right where the stations resolve beta; none
    after a long stay near a saddle, where large growths cancel.

    Parameters
    ----------
    problem : Reduced
        B problems.
    t, beta, rate : array (B, n)
        Stations, beta and beta_t there.

    Returns
    -------
    array (B,)
        At least 1.
    """
    worst, weight = np.ones(problem.size), slope_weight(problem)
    share = max(1, _BLOCK // t.shape[1])
    for first in range(0, problem.size, share):
        some = slice(first, first + share)
        product = _transfers(problem.take(some), t[some], beta[some], rate[some])
        for reach in (2**k for k in range((t.shape[1] - 1).bit_length())):  # of all steps from the start: doubling
            product[..., reach:] = _after(product[..., reach:], product[..., :-reach])
        grown = np.abs(product[:2])
        grown[1] *= weight[some, None]
        largest = np.fmax.reduce(grown, axis=(0, 2), initial=1.0)
        worst[some] = np.where(np.isfinite(product).any(axis=(0, 2)) | (t.shape[1] < 2), largest, np.inf)
    return worst


def _after(late: Array, early: Array) -> Array:
    """The products late times early of matrices [[a, b], [c, d]] stored as (4, ...)."""
    a, b, c, d = late
    e, f, g, h = early
    with np.errstate(over="ignore", invalid="ignore"):
        return np.stack([a * e + b * g, a * f + b * h, c * e + d * g, c * f + d * h])


def _transfers(problem: Reduced, t: Array, beta: Array, rate: Array) -> Array:
    """The transfer matrix of (eta, eta_t) over each step, where eta'' = -H'(beta) eta: four entries, (4, B, n - 1).

    Magnus' exponential of order 4, H' by Simpson's rule with Hermite's cubic for beta between the stations; its
    determinant is 1, also for a long step at a steep saddle.
    """
    column = Loads.columns(problem)
    dt = np.diff(t, axis=1)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        middle = (beta[:, :-1] + beta[:, 1:]) / 2 + dt / 8 * (rate[:, :-1] - rate[:, 1:])
        first, last = slope_rate(column, beta[:, :-1]), slope_rate(column, beta[:, 1:])
        mean = (first + 4 * slope_rate(column, middle) + last) / 6
        tilt = (last - first) * dt * dt / 12
        square = tilt * tilt - mean * dt * dt  # of the exponent, a matrix without trace
        root = np.sqrt(np.abs(square))
        grows = square > 0
        even = np.where(grows, np.cosh(np.minimum(root, 700)), np.cos(root))
        odd = np.where(grows, np.sinh(np.minimum(root, 700)), np.sin(root)) / np.where(root > 0, root, 1)
        odd = np.where(root > 0, odd, 1.0)
        return np.stack([even + tilt * odd, dt * odd, -mean * dt * odd, even - tilt * odd])


def refine(problem: Reduced, t: Array, most: int) -> tuple[Array, int]:
    """The stations with k - 1 more on equal steps between neighbours, (B, (n - 1) k + 1), and k.

    k is a power of two that divides `most`, at most 16, and no larger than `growth` needs to resolve H' between the
    stations, or than memory allows for very many problems.
    """
    bound = steepest(problem)
    with np.errstate(over="ignore"):
        angle = np.max(np.sqrt(bound) * np.diff(t, axis=1).max(axis=1, initial=0.0), initial=0.0)
    k = 1
    while k < 16 and angle > k / 4 and most % (2 * k) == 0 and 2 * k * t.size <= _MOST:
        k *= 2
    if k == 1:
        return t, 1
    parts = t[:, :-1, None] + np.diff(t, axis=1)[:, :, None] * (np.arange(k) / k)
    return np.concatenate([parts.reshape(t.shape[0], -1), t[:, -1:]], axis=1), k
