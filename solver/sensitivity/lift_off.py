"""The derivative of the first t at which a density falls below zero along rods."""

import numpy as np

from ..numerics.arrays import Array
from ..observe.measurement import BARELY
from .density_changes import DensityChange, first_of
from .extremes import candidates
from .integrals import cut_at_zeros

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
