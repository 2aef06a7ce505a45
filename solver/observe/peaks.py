"""Where a density is largest along each rod: the first place, and how far the others are that may be larger."""

from typing import Any

import numpy as np

from ..core.measures import NODES
from ..numerics.arrays import EPS, Array, Integers
from ..numerics.chebyshev import derivative, series_at
from .quadrature import Resolved


def first_peak(found: Resolved, doubt: Array, same: Array) -> tuple[Any, Any]:
    """The first t at which the density reaches its largest value, and the error of that t, (B,) each.

    A density that is the same all along, within `doubt`, has it at t = 0. What a rod passes backward, it passed forward
    before, with the same values; so only the way forward counts.

    Parameters
    ----------
    found : Resolved
        The density.
    doubt : array (B,)
        Error of its largest value. Of the local maxima whose values are the largest within `doubt`, the first counts.
    same : array (B,)
        Values that differ by less are equal.

    Returns
    -------
    tuple of array (B,)
        t, and the largest distance to a t at which a density with this error may be larger.
    """
    p, span = found.pieces, found.pieces.problem.span
    q, x, t, values = _candidates(found)
    case, doubt = p.case[q], np.where(np.isnan(doubt), 0, doubt)
    best = _most(case, values, span.size)
    high = values >= (best - doubt)[case]
    first = -_most(case[high], -t[high], span.size)
    mine = high & (t == first[case])
    until = first + _most(case[mine], _width(found, q, x, doubt[case], 0.0)[mine], span.size)
    near = (t >= first[case]) & (t <= until[case])  # the end of a piece may be next to the maximum
    there = _most(case[near], values[near], span.size)
    mine = near & (values == there[case])
    place = -_most(case[mine], -t[mine], span.size)
    mine &= t == place[case]
    rival = (values >= (best - 2 * doubt)[case]) & (np.abs(values - there[case]) > same[case])
    error = np.maximum(
        _most(case[rival], np.abs(t - place[case])[rival], span.size),
        _most(case[mine], _width(found, q, x, doubt[case], 1.0)[mine], span.size),
    )
    varies = best + found.most(-found.values.min(axis=1))
    error = np.where(varies <= same, 0, np.minimum(error, span)) + 8 * EPS * span
    place = np.where(varies <= np.maximum(doubt, same), 0, place)
    return np.where(np.isfinite(best), place, np.nan), error


def _most(case: Array, values: Array, size: int) -> Array:
    """The largest value of each case, (C,) -> (B,); -inf where there is none."""
    found = np.full(size, -np.inf)
    np.fmax.at(found, case, values)
    return found


def _candidates(found: Resolved) -> tuple[Integers, Array, Array, Array]:
    """Pieces where the density has a local maximum, ends included, places in [-1, 1] on them, t, and values, (C,)."""
    p, rate = found.pieces, found.rates
    q, cell = np.nonzero((rate[:, :-1] > 0) & (rate[:, 1:] <= 0))
    inner = found.turning(q, cell, -1.0)
    begins = (rate[:, 0] <= 0) | (p.begin <= -found.most(-p.begin)[p.case])
    left, right = np.flatnonzero(begins), np.flatnonzero(rate[:, -1] >= 0)
    q = np.concatenate([q, left, right])
    x = np.concatenate([inner, np.full(left.size, -1.0), np.ones(right.size)])
    return q, x, p.begin[q] + (1 + x) / 2 * p.time[q], series_at(found.coefficients[q], x)


def _width(found: Resolved, q: Array, x: Array, doubt: Array, noise: float) -> Array:
    """How far from places x of pieces q the density falls by twice its doubt, (C,).

    noise: how much of the rounding of the derivatives is taken off them.
    """
    slopes = found.coefficients[q] @ derivative(NODES)
    rounding = noise * NODES**2 * (EPS * found.size.max(axis=1) + found.tail)[q]
    slope = np.maximum(np.abs(series_at(slopes, x)) - rounding, 0)
    bend = np.maximum(np.abs(series_at(slopes @ derivative(NODES), x)) - NODES**2 * rounding, 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.fmin(np.sqrt(4 * doubt / bend), 2 * doubt / slope) * found.pieces.time[q] / 2)
