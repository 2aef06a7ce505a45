"""The derivatives of the largest and the smallest value of a density along rods."""

from collections.abc import Callable

import numpy as np

from ..numerics.arrays import Array
from ..numerics.chebyshev import basis
from ..orbit.pieces import LIBRATION
from ..orbit.variations import Variations
from .density_changes import DensityChange, Values, first_of, zeros_of

_SAME = 1e-12  # relative: extremes that differ by less are equal
_APART = 1e-4  # relative: derivatives that differ by more are different
_EDGE = 1e-9  # of the largest pace of a density: at the end of a panel the density is stationary
_FAINT = 1e-9  # of the sum of the sizes of its terms: a derivative below this is rounding


def extreme(rods: DensityChange, largest: bool) -> Array:
    """Of the largest or the smallest value along the rod, (b, F); NaN where several places reach it unequally."""
    turn = 1.0 if largest else -1.0
    case, values, slopes, sizes = _candidates(rods)
    best = np.full(rods.problem.size, -np.inf)
    np.fmax.at(best, case, turn * values)
    top = turn * values >= (best - _SAME * np.maximum(np.abs(best), 1e-300))[case]
    chosen = np.zeros((best.size, slopes.shape[1]))
    chosen[case[top][::-1]] = slopes[top][::-1]  # the first of each case
    off = np.abs(slopes - chosen[case]) > _APART * (np.abs(slopes) + np.abs(chosen[case])) + _FAINT * sizes
    unequal = np.zeros_like(chosen, dtype=bool)
    np.logical_or.at(unequal, case[top], off[top])
    return np.where(unequal, np.nan, chosen)


def _candidates(rods: DensityChange) -> tuple[Array, Array, Array, Array]:
    """Cases (N,), values (N,), their derivatives and the sizes of these, (N, F): at the ends of the rods, where the
    values are stationary, and where panels meet, as roots there are missed."""
    found = rods.refined()
    nodes = basis(found.varied.nodes.v.shape[1]).nodes
    pace = found.nodes.pace
    up = pace > 0
    q, cell = np.nonzero(up[:, 1:] != up[:, :-1])
    rises = up[q, cell + 1]
    low, high = np.where(rises, nodes[cell], nodes[cell + 1]), np.where(rises, nodes[cell + 1], nodes[cell])
    x = zeros_of(pace[q] @ basis(nodes.size).analyse, low, high)
    most = np.zeros(rods.problem.size)
    np.maximum.at(most, found.case, np.abs(pace).max(axis=1))
    edges = np.abs(pace[:, [0, -1]]) <= _EDGE * most[found.case, None]
    edge, side = np.nonzero(edges)
    q, x = np.concatenate([q, edge]), np.concatenate([x, 2.0 * side - 1])
    passed = _passed(found.varied, q, x)
    q, x = q[passed], x[passed]
    beta, place = found.varied.on_panels(q, x[:, None])
    at = first_of(found.at(found.case[q], beta, place))
    case = found.case[q]
    values, slopes, sizes = [at.values], [_along(at, rods.e[case])], [_along(at, rods.e[case], np.abs)]
    first, end = rods.ends
    for one, along in ((first, rods.a0), (end, rods.a + rods.later)):
        shifted = along * one.pace[:, None]
        values.append(one.values)
        slopes.append(_along(one, rods.e) + shifted)
        sizes.append(_along(one, rods.e, np.abs) + np.abs(shifted))
    rows = np.arange(rods.problem.size)
    cases = np.concatenate([case, rows, rows])
    return cases, np.concatenate(values), np.concatenate(slopes), np.concatenate(sizes)


def _along(at: Values, e: Array, size: Callable[[Array], Array] = np.asarray) -> Array:
    """The change of values (N,) where nothing moves along the orbit, (N, F); size: applied to each factor."""
    return np.asarray(np.einsum("nk,nfk->nf", size(at.moved), size(e)))


def _passed(varied: Variations, q: Array, x: Array) -> Array:
    """Whether the rod passes the places x of panels q, (N,)."""
    orbit, panels = varied.orbit, varied.orbit.panels
    case, second = panels.arc[q] // 2, panels.arc[q] % 2 == 1
    span, ahead, back = orbit.problem.span[case], orbit.ahead[case], orbit.back[case]
    local = orbit.since[q] + panels.duration[q] * (1 + x) / 2
    there = local + np.where(second, 2 * ahead, 0.0)
    again = np.where(orbit.kind[case] == LIBRATION, 2 * ahead + np.where(second, 2 * back, 0.0) - local, np.inf)
    return np.asarray((np.minimum(there, again) <= span) | (orbit.period[case] <= span))
