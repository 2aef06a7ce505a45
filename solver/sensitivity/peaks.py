"""The derivative of the first t at which a density is largest along rods."""

from dataclasses import fields

import numpy as np

from ..numerics.arrays import Array, Integers
from ..numerics.chebyshev import basis, derivative, polynomials
from .density_changes import DensityChange
from .extremes import Candidates, candidates, slope_of_largest

_NEAR = 1e-5  # of the length: the place is the one that is observed
_BENDS = 1e-9  # of the largest pace of a density: one that changes less does not move its maximum smoothly


def first_peak(rods: DensityChange, seen: Array) -> Array:
    """Of the first t of the largest value, (b, F).

    Where the density f is stationary there, (df/dt)(t, q) = 0 gives dt/dq = -(d2f/dt dq)/(d2f/dt2). At the start of the
    rod it is 0, at the far end the change of the length. NaN where several places reach the largest value unequally,
    where the density is stationary at an end and the maximum moves off it, and where another place is observed.

    seen: (b,), the t that is observed.
    """
    found = rods.refine()
    every = candidates(found)
    top, slopes = slope_of_largest(every, seen.size)
    best = _pick(every, top)
    near = np.abs(best.t - seen[best.case]) <= _NEAR * rods.span[best.case]
    moved = _move(found, _pick(best, near))
    kept = _pick(best, near).case
    chosen, off = np.full(slopes.shape, np.nan), np.zeros(slopes.shape, dtype=bool)
    chosen[kept[::-1]] = moved[::-1]
    size = np.abs(moved) + np.abs(chosen[kept])
    np.logical_or.at(off, kept, ~(np.abs(moved - chosen[kept]) <= 1e-6 * size + 1e-9 * np.abs(rods.span[kept, None])))
    return np.where(off | np.isnan(slopes), np.nan, chosen)


def _pick(some: Candidates, index: Array) -> Candidates:
    return Candidates(*(getattr(some, one.name)[index] for one in fields(Candidates)))


def _move(rods: DensityChange, at: Candidates) -> Array:
    """The derivatives of the t of candidates, (N, F)."""
    inner = np.flatnonzero(at.panel >= 0)
    found = np.where((at.t > 0)[:, None], rods.later[at.case], 0.0)
    case, panel, x = at.case[inner], at.panel[inner], at.x[inner]
    bend, across = _rates_on(rods, panel, x)
    t = np.repeat(at.t[inner][:, None], 1, axis=1)
    a = rods.a0[case] + np.einsum("nk,nfk->nf", _phases(rods, case, t[:, 0]), rods.e[case])
    with np.errstate(divide="ignore", invalid="ignore"):
        found[inner] = -a - np.einsum("nk,nfk->nf", across, rods.e[case]) / bend[:, None]
    return found


def _rates_on(rods: DensityChange, panel: Integers, x: Array) -> tuple[Array, Array]:
    """The changes along a panel of the pace (N,) and of `moved` (N, 4); NaN for a pace that hardly changes."""
    nodes, points = rods.nodes, basis(rods.nodes.pace.shape[1])
    both = np.concatenate([nodes.pace[panel, None], np.moveaxis(nodes.moved[panel], 2, 1)], axis=1)
    slopes = both @ points.analyse @ derivative(points.nodes.size)
    found = np.einsum("nkc,cn->nk", slopes, polynomials(x, points.nodes.size))
    most = np.zeros(rods.problem.size)
    np.maximum.at(most, rods.case, np.abs(nodes.pace).max(axis=1))
    per_time = 2 / rods.varied.orbit.panels.duration[panel]
    still = np.abs(found[:, 0]) * per_time <= _BENDS * most[rods.case[panel]]
    return np.where(still, np.nan, found[:, 0]), found[:, 1:]


def _phases(rods: DensityChange, case: Integers, t: Array) -> Array:
    """M at t of the problems `case` less M at their starts, (N, 4)."""
    found = np.zeros((t.size, 4))
    left, when = np.arange(t.size), np.zeros(rods.problem.size)
    while left.size:  # one t of each problem at a time
        mine, first = np.unique(case[left], return_index=True)
        when[mine] = t[left[first]]
        place = rods.varied.at(when[:, None])
        found[left[first]] = (place.M[:, 0, 0] - rods.places[0].M[:, 0])[mine]
        left = np.delete(left, first)
    return found
