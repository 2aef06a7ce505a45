"""What the data say about the parameters: covariance, intervals, what they cannot tell apart, which data decide."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import special

from ..numerics.arrays import ALIKE, DOUBTFUL, SQUARE_LOST, Array
from .parameters import Parameter, rates_at, values_at

LEVEL = 0.95  # probability of the stated intervals, as is usual. x10: none


class Decomposition(NamedTuple):
    """What the derivatives (N, F) of N data say about F parameters: the singular values of their columns.

    norms: of the columns, (F,). active: whether a parameter is free and has an effect, (F,). left, sizes, right: the
    decomposition of the A active columns, each of norm 1, (N, N), (min(N, A),) and (A, A). rank: how many of the sizes
    are more than rounding; the other rows of `right` are combinations that change no datum.
    """

    norms: Array
    active: NDArray[np.bool_]
    left: Array
    sizes: Array
    right: Array
    rank: int


def decomposition(jacobian: Array, free: NDArray[np.bool_]) -> Decomposition:
    """What the derivatives (N, F) determine of the parameters that are free, (F,)."""
    norms = np.linalg.norm(jacobian, axis=0)
    active = free & (norms > DOUBTFUL * max(norms.max(initial=0.0), 1e-300))
    left, sizes, right = np.linalg.svd(jacobian[:, active] / norms[active], full_matrices=True)
    return Decomposition(norms, active, left, sizes, right, int((sizes > SQUARE_LOST * sizes.max(initial=0.0)).sum()))


@dataclass(frozen=True, eq=False)
class Uncertainty:
    """F parameters as N data determine them, by the derivatives at the minimum.

    covariance: of the values of the parameters, (F, F); infinite on the diagonal where the data do not determine one,
    NaN where no variance of the data is known. low, high: the ends of the 95 % intervals, (F,). shares: of each datum
    in what is known of each parameter, (F, N), each row of sum 1. condition: the condition number of the derivatives,
    each column normalised. directions: combinations (F,) of changes of x that change no datum. quantile: half the width
    of an interval in standard deviations. freedom: number of data less that of determined combinations.
    """

    covariance: Array
    low: Array
    high: Array
    shares: Array
    condition: float
    directions: list[Array]
    quantile: float
    freedom: int


def uncertainty(
    parameters: Sequence[Parameter], x: Array, jacobian: Array, residuals: Array, known: bool, free: Array
) -> Uncertainty:
    """The uncertainty at a minimum.

    jacobian: (N, F), derivatives of the residuals (N,). known: whether the residuals are in standard deviations;
    otherwise their variance is estimated. free: (F,), False for a parameter at a bound, which counts as known.
    """
    N, F = jacobian.shape
    norms, active, U, sizes, Vt, rank = decomposition(jacobian, free)
    silent = [np.eye(F)[k] for k in np.flatnonzero(free & ~active)]
    mixed = [_whole(row / norms[active], active) for row in _reduce(Vt[rank:])]
    inverse = np.zeros((F, N))
    if rank:
        inverse[active] = (Vt[:rank].T / sizes[:rank]) @ U[:, :rank].T / norms[active][:, None]
    unknown = free & ((np.abs(np.array([*silent, *mixed])) > 0).any(axis=0) if silent or mixed else False)
    freedom = N - rank
    variance, quantile = _variance(residuals, freedom, known)
    rates = rates_at(parameters, x)
    errors = np.sqrt(variance) * np.linalg.norm(inverse, axis=1)
    errors = np.where(unknown, np.inf, np.where(free, errors, np.nan))
    low, high = (_end(parameters, x, side * quantile * errors) for side in (-1, 1))
    covariance = variance * (inverse @ inverse.T) * np.outer(rates, rates)
    covariance[unknown] = covariance[:, unknown] = np.nan
    covariance[unknown, unknown] = np.inf
    with np.errstate(invalid="ignore", divide="ignore"):
        shares = inverse**2 / (inverse**2).sum(axis=1, keepdims=True)
    shares[unknown | ~free] = np.nan
    condition = float(sizes[0] / sizes[-1]) if sizes.size and rank == active.sum() == free.sum() else np.inf
    return Uncertainty(covariance, low, high, shares, condition, [*silent, *mixed], quantile, freedom)


def _variance(residuals: Array, freedom: int, known: bool) -> tuple[float, float]:
    """The variance of a residual, and the quantile of its distribution: normal, or Student's t."""
    if known:
        return 1.0, float(special.ndtri((1 + LEVEL) / 2))
    if freedom <= 0:
        return np.nan, np.nan
    return float(residuals @ residuals) / freedom, float(special.stdtrit(freedom, (1 + LEVEL) / 2))


def _end(parameters: Sequence[Parameter], x: Array, away: Array) -> Array:
    """One end of each interval; a parameter that the data do not determine has the whole range of its field."""
    with np.errstate(over="ignore"):
        return np.array(list(values_at(parameters, x + away).values()))


def _reduce(rows: Array) -> list[Array]:
    """A basis of the same space with as many zeros as there are rows: each names the fewest parameters."""
    rows = rows.copy()
    for k in range(rows.shape[0]):
        pivot = np.abs(rows[k]).argmax()
        rows[k] /= rows[k, pivot]
        others = np.arange(rows.shape[0]) != k
        rows[others] -= rows[others, pivot][:, None] * rows[k]
    # a parameter whose part of a direction is smaller does not belong to it
    return [np.where(np.abs(row) > ALIKE * np.abs(row).max(), row, 0.0) for row in rows]


def _whole(part: Array, active: Array) -> Array:
    """A direction of all parameters, its largest element 1."""
    direction = np.zeros(active.size)
    direction[active] = part
    return direction / direction[np.abs(direction).argmax()]
