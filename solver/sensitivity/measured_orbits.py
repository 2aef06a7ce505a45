"""The derivatives of what is measured along rods that are no helices."""

from dataclasses import fields
from typing import Any

import numpy as np

from ..numerics.arrays import Array, Integers
from ..numerics.chebyshev import basis, derivative, polynomials
from ..observe.measurement import BARELY, MIDDLE
from . import densities
from .density_changes import DensityChange, first_of
from .extremes import (
    EXTREMES,
    INTEGRALS,
    LIFTS,
    MIDDLE_PUSH,
    PEAK,
    PUSHES,
    STILL,
    Candidates,
    candidates,
    extreme,
    slope_of_largest,
)
from .integrals import cut_at_zeros, integral, parts, positive_between
from .motions import Motion

_NEAR = 1e-5  # of the length: the place is the one that is observed


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
    return Candidates(*(getattr(some, field.name)[index] for field in fields(Candidates)))


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
    still = np.abs(found[:, 0]) * per_time <= STILL * most[rods.case[panel]]
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


_ZERO = 1e-12  # of the sum of the sizes of its terms: a value that only touches zero


def first_below(rods: DensityChange) -> Array:
    """Of the first t with a negative value, or of the whole length where there is none, (b, F).

    f(t, q) = 0 gives dt/dq = -(df/dq)/(df/dt). NaN where f only touches zero on the way, and a change of f there lets
    that t jump.
    """
    t = _first_below(rods)
    place = rods.varied.at(t[:, None])
    there = rods.at(np.arange(t.size), rods.varied.beta(t[:, None]), place)
    at, M = first_of(there), place.M[:, 0, 0]
    a = rods.a0 + np.einsum("bk,bfk->bf", M - rods.places[0].M[:, 0], rods.e)
    moved = -a - np.einsum("bk,bfk->bf", at.moved, rods.e) / at.pace[:, None]
    whole, begun = t >= rods.span, t > 0
    found = np.where(whole[:, None], rods.later, np.where(begun[:, None], moved, 0.0))
    return np.where(_jumps(rods, t), np.nan, found)


def _first_below(rods: DensityChange) -> Array:
    """The first t with a value below rounding, at most the length, (b,).

    What a rod passes backward, it passed forward before; so only the way forward counts.
    """
    cut = cut_at_zeros(rods)
    orbit, arc = cut.varied.orbit, cut.varied.orbit.panels.arc
    begin = orbit.since + np.where(arc % 2 == 1, 2 * orbit.ahead[cut.case], 0.0)
    below = cut.nodes.values.mean(axis=1) < -BARELY * cut.nodes.size.mean(axis=1)
    first = np.array(rods.span)
    np.fmin.at(first, cut.case[below], begin[below])
    return first


def _jumps(rods: DensityChange, t: Array) -> Array:
    """Whether values that only touch zero up to t change there, (b, F)."""
    found = candidates(rods.refine())
    touches = (np.abs(found.values) <= _ZERO * found.size) & (found.t <= t[found.case])
    jumps = np.zeros(rods.a0.shape, dtype=bool)
    np.logical_or.at(jumps, found.case[touches], (np.abs(found.slopes) > found.faint)[touches])
    return jumps


def of_orbits(
    motion: Motion, unit: Array, later: Array, sign: Array, wanted: set[str], peak: Array
) -> dict[str, Array]:
    """The derivatives of what is measured, and of half a period, (b, F) each.

    unit: (b, 5, F), of `result.amounts`. later: (b, F), the change of the length in t. sign: (b,), of `Case.outward`.
    peak: (b,), the t of the largest push that is observed; read where it is wanted.
    """
    varied, span = motion.varied, motion.problem.span
    assert varied is not None
    a0, e, places = unit[:, 0], unit[:, 1:].swapaxes(1, 2), (varied.start, motion.end)
    found = {"half_period": -np.einsum("bk,bgk->bg", varied.gain[:, :, :4].sum(axis=1), e)}

    def measure(density: Any) -> DensityChange:
        turn = sign if density is densities.outward else np.ones_like(span)
        return DensityChange(motion.problem, varied, span, places, density, turn, a0, e, later)

    for name in wanted:
        if name in EXTREMES:
            density, which = EXTREMES[name]
            found[name] = extreme(measure(density), which)
        elif name in INTEGRALS:
            found[name] = integral(measure(INTEGRALS[name]))
    push = measure(densities.outward)
    if wanted & set(PUSHES):
        made = dict(zip(PUSHES, parts(push), strict=True))
        found |= {name: value for name, value in made.items() if name in wanted}
    if MIDDLE_PUSH in wanted:
        found[MIDDLE_PUSH] = positive_between(push, *MIDDLE)
    if LIFTS in wanted:
        found[LIFTS] = first_below(push)
    if PEAK in wanted:
        found[PEAK] = first_peak(push, peak)
    return found
