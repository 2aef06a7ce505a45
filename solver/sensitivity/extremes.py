"""The derivatives of the extremes of a density along rods, and of the places where they are."""

from dataclasses import dataclass

import numpy as np

from ..core.measures import DENSITIES, NUMBERS
from ..numerics.arrays import Array
from ..numerics.chebyshev import basis, derivative, polynomials
from ..observe.measurement import BARELY
from .density_changes import SAME, DensityChange

LARGEST, SMALLEST, LARGEST_SIZE = "largest", "smallest", "largest size"
_TURNS = {LARGEST: (1.0,), SMALLEST: (-1.0,), LARGEST_SIZE: (1.0, -1.0)}
_APART = 1e-4  # relative: derivatives that differ by more are different
_STILL = 1e-9  # of the largest pace of a density: one that changes less is stationary
_FAINT = 1e-9  # of the sum of the sizes of its terms: a derivative below this is rounding
_NEAR = 1e-5  # of the length: the place is the one that is observed
_WINDOW, _POINTS = 0.2, 14  # on which a derivative in t is read: of the shortest time of a change; places
_MERGED = 1e-6  # of the same: places nearer than this are one
_ZERO = 1e-12  # of the sum of the sizes of its terms: a value that only touches zero


@dataclass(frozen=True, eq=False)
class Places:
    """All places of an extreme, up to K of a rod; NaN where there is none.

    t, values, size: (b, K), size: the sum of the sizes of the terms of a value. slopes, faint: (b, K, F), the
    derivatives of the values (of LARGEST_SIZE: of their sizes), and what of them is rounding.
    """

    t: Array
    values: Array
    size: Array
    slopes: Array
    faint: Array


def places_of(rods: DensityChange, which: str, until: Array | None = None) -> Places:
    """The places of the extreme up to the times `until` (b,), or along the whole rods."""
    given, turns = rods.candidates if until is None else rods.candidates_until(until), _TURNS[which]
    t, at, a = np.tile(given.t, len(turns)), given.at.tile(len(turns)), np.tile(given.a, (1, len(turns), 1))
    turn = np.repeat(turns, given.t.shape[1])
    last = t >= rods.span[:, None] * (1 - SAME)
    end = last | (t <= 0)
    t = np.where(_repeats(t, turn, _MERGED * rods.shortest), np.nan, t)
    values = np.where(np.isnan(t), -np.inf, turn * at.values)
    best = values.max(axis=1, keepdims=True)
    t = np.where(values >= best - SAME * np.maximum(np.abs(best), 1e-300), t, np.nan)
    shifted = at.pace[..., None] * (a + np.where(last[..., None], rods.later[:, None], 0.0))
    shifted = np.where(end[..., None], shifted, 0.0)
    slopes = np.einsum("bnk,bfk->bnf", at.moved, rods.e) + shifted
    if which == LARGEST_SIZE:
        slopes = slopes * turn[:, None]
    sizes = np.einsum("bnk,bfk->bnf", np.abs(at.moved), np.abs(rods.e)) + np.abs(shifted)
    rounding = BARELY * at.size[..., None] * np.abs(rods.e).max(axis=2)[:, None]
    return Places(t, at.values, at.size, slopes, _FAINT * sizes + rounding)


def _repeats(t: Array, turn: Array, near: Array) -> Array:
    """Which of the places (b, K) are nearer than `near` (b,) to an earlier one of the same turn (K,), an end first."""
    earlier = np.tri(t.shape[1], k=-1, dtype=bool) & (turn[:, None] == turn)
    return ((np.abs(t[:, :, None] - t[:, None, :]) < near[:, None, None]) & earlier).any(axis=2)


def extreme(rods: DensityChange, which: str) -> Array:
    """Of the extreme value along the rod, (b, F); NaN where several places reach it unequally.

    which: LARGEST, SMALLEST or LARGEST_SIZE.
    """
    return _slope_of(places_of(rods, which))


def _slope_of(places: Places) -> Array:
    known, rows = np.isfinite(places.t), np.arange(places.t.shape[0])
    chosen = places.slopes[rows, known.argmax(axis=1)]
    size = np.abs(places.slopes) + np.abs(chosen[:, None])
    off = np.abs(places.slopes - chosen[:, None]) > _APART * size + places.faint
    return np.where((off & known[..., None]).any(axis=1), np.nan, chosen)


def first_peak(rods: DensityChange, seen: Array) -> Array:
    """Of the first t of the largest value, (b, F).

    Where the density f is stationary there, (df/dt)(t, q) = 0 gives dt/dq = -(d2f/dt dq)/(d2f/dt2). At the start of the
    rod it is 0, at the far end the change of the length. NaN where several places reach the largest value unequally,
    where the density is stationary at an end and the maximum moves off it, and where another place is observed.

    seen: (b,), the t that is observed.
    """
    places = places_of(rods, LARGEST)
    off = np.abs(places.t - seen[:, None])
    rows, span = np.arange(seen.size), rods.span
    near = np.nanargmin(off, axis=1)
    t, slopes = places.t[rows, near], _slope_of(places)
    first, last = t <= 0, t >= span * (1 - SAME)
    at, _ = rods.read(t[:, None])
    still = np.abs(at.pace[:, 0]) <= _STILL * rods.most_pace
    inner, bend = _rate_of_peak(rods, t)
    inner = np.where((np.abs(bend) <= _STILL * rods.most_pace)[:, None], np.nan, inner)
    end = np.where(last[:, None], rods.later, 0.0)
    size = np.abs(inner) + np.abs(end)
    stays = ~still[:, None] | (np.abs(inner - end) <= 1e-6 * size + 1e-9 * np.abs(span[:, None]))
    moved = np.where((first | last)[:, None], np.where(stays, end, np.nan), inner)
    return np.where(np.isnan(slopes) | (off[rows, near] > _NEAR * span)[:, None], np.nan, moved)


def _rate_of_peak(rods: DensityChange, t: Array) -> tuple[Array, Array]:
    """-(d2f/dt dq)/(d2f/dt2) at t (b,), (b, F), and the divisor (b,): from series in t about that place."""
    points = basis(_POINTS)
    half = np.minimum(_WINDOW * rods.shortest, rods.span / 2)
    middle = np.clip(t, half, rods.span - half)
    at, a = rods.read(middle[:, None] + half[:, None] * points.nodes)
    changed = np.einsum("bnk,bfk->bnf", at.moved, rods.e) + a * at.pace[..., None]
    both = np.concatenate([at.pace[..., None], changed], axis=2)
    rates = np.einsum("bnf,nk->bfk", both, points.analyse @ derivative(_POINTS))
    found = np.einsum("bfk,kb->bf", rates, polynomials((t - middle) / half, _POINTS)) / half[:, None]
    return -found[:, 1:] / found[:, :1], found[:, 0]


def first_below(rods: DensityChange, seen: Array) -> Array:
    """Of the first t with a negative value, or of the whole length where there is none, (b, F).

    f(t, q) = 0 gives dt/dq = -(df/dq)/(df/dt). NaN where f only touches zero on the way, and a change of f there lets
    that t jump.

    seen: (b,), the t that is observed.
    """
    at, a = rods.read(seen[:, None])
    moved = -a[:, 0] - np.einsum("bk,bfk->bf", at.moved[:, 0], rods.e) / at.pace
    whole, begun = seen >= rods.span, seen > 0
    found = np.where(whole[:, None], rods.later, np.where(begun[:, None], moved, 0.0))
    lowest = places_of(rods, SMALLEST, seen)
    touches = np.isfinite(lowest.t) & (np.abs(lowest.values) <= _ZERO * lowest.size)
    jumps = touches[..., None] & (np.abs(lowest.slopes) > lowest.faint)
    return np.where(jumps.any(axis=1), np.nan, found)


EXTREMES = {
    "low": ("angle", SMALLEST),
    "high": ("angle", LARGEST),
    "tightest": ("curvature", LARGEST),
    "least": ("outward", SMALLEST),
    "most": ("outward", LARGEST),
    "tension": ("tension", LARGEST_SIZE),
}
INTEGRALS = tuple(name for name in DENSITIES if name in NUMBERS and name not in EXTREMES)  # of the density of that name
PUSHES = ("pushed", "pulled", "share")
MIDDLE_PUSH, LIFTS, PEAK = "middle push", "lifts", "peak"
MIDDLE_GAINS = ("middle turned", "middle risen")
MEASURED = (*EXTREMES, *INTEGRALS, *PUSHES, MIDDLE_PUSH, LIFTS, PEAK, *MIDDLE_GAINS)
