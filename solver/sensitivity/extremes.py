"""The derivatives of the extremes of a density along rods."""

from collections.abc import Callable
from dataclasses import dataclass, fields, replace

import numpy as np

from ..numerics.arrays import Array, Booleans, Integers
from ..orbit.pieces import LIBRATION
from ..orbit.variations import Variations
from . import densities
from .density_changes import DensityChange, Values, first_of, zeros_between

LARGEST, SMALLEST, LARGEST_SIZE = "largest", "smallest", "largest size"
_SAME = 1e-12  # relative: extremes that differ by less are equal
_APART = 1e-4  # relative: derivatives that differ by more are different
STILL = 1e-9  # of the largest pace of a density: one that changes less is stationary
_FAINT = 1e-9  # of the sum of the sizes of its terms: a derivative below this is rounding


@dataclass(frozen=True, eq=False)
class Candidates:
    """Places of rods that an extreme may have: their ends, where a density is stationary, and where panels meet.

    case, t, values: (N,), t of the first pass. size: (N,), the sum of the sizes of the terms of a value. slopes,
    moved: (N, F), the derivatives of the values, and the sizes of the terms of these. panel, x: (N,), the panel and the
    place on it in [-1, 1], of the panels `DensityChange.refine`; panel -1 at the two ends of the rod.
    """

    case: Integers
    t: Array
    values: Array
    size: Array
    slopes: Array
    moved: Array
    panel: Integers
    x: Array

    @property
    def faint(self) -> Array:
        """Derivatives below these are rounding, (N, F)."""
        return _FAINT * self.moved


def extreme(rods: DensityChange, which: str) -> Array:
    """Of the extreme value along the rod, (b, F); NaN where several places reach it unequally.

    which: LARGEST, SMALLEST or LARGEST_SIZE.
    """
    found = candidates(rods.refine())
    if which == LARGEST_SIZE:
        found = _either_sign(found)
    turn = -1.0 if which == SMALLEST else 1.0
    return slope_of_largest(replace(found, values=turn * found.values), rods.problem.size)[1]


def slope_of_largest(found: Candidates, size: int) -> tuple[Booleans, Array]:
    """Which candidates have the largest value of their rod, (N,), and its derivative, (b, F); NaN where these have
    unequal ones."""
    case, values, slopes = found.case, found.values, found.slopes
    best = np.full(size, -np.inf)
    np.fmax.at(best, case, values)
    top = values >= (best - _SAME * np.maximum(np.abs(best), 1e-300))[case]
    chosen = np.zeros((best.size, slopes.shape[1]))
    chosen[case[top][::-1]] = slopes[top][::-1]  # the first of each case
    off = np.abs(slopes - chosen[case]) > _APART * (np.abs(slopes) + np.abs(chosen[case])) + found.faint
    unequal = np.zeros_like(chosen, dtype=bool)
    np.logical_or.at(unequal, case[top], off[top])
    return top, np.where(unequal, np.nan, chosen)


def _either_sign(found: Candidates) -> Candidates:
    """The candidates, and the same of minus the values."""
    twice = {field.name: np.concatenate([getattr(found, field.name)] * 2) for field in fields(Candidates)}
    sign = np.repeat([1.0, -1.0], found.case.size)
    return replace(Candidates(**twice), values=sign * twice["values"], slopes=sign[:, None] * twice["slopes"])


def candidates(found: DensityChange) -> Candidates:
    """The candidates of b rods, whose panels are refined."""
    pace = found.nodes.pace
    q, _, x = zeros_between(pace)
    most = np.zeros(found.problem.size)
    np.maximum.at(most, found.case, np.abs(pace).max(axis=1))
    edges = np.abs(pace[:, [0, -1]]) <= STILL * most[found.case, None]
    edge, side = np.nonzero(edges)
    q, x = np.concatenate([q, edge]), np.concatenate([x, 2.0 * side - 1])
    t, passed = _passes(found.varied, q, x)
    q, x, t = q[passed], x[passed], t[passed]
    beta, place = found.varied.on_panels(q, x[:, None])
    at = first_of(found.at(found.case[q], beta, place))
    case = found.case[q]
    rows, (begin, until) = np.arange(found.problem.size), found.times
    none = np.full_like(rows, -1)
    parts = [
        Candidates(case, t, at.values, at.size, _along(at, found.e[case]), _along(at, found.e[case], np.abs), q, x)
    ]
    for one, when, along in zip(found.ends, (begin, until), (found.a0, found.a + found.later), strict=True):
        shifted = along * one.pace[:, None]
        moved = _along(one, found.e, np.abs) + np.abs(shifted)
        slopes = _along(one, found.e) + shifted
        parts.append(Candidates(rows, when, one.values, one.size, slopes, moved, none, 0.0 * when))
    names = (field.name for field in fields(Candidates))
    return Candidates(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


def _along(at: Values, e: Array, size: Callable[[Array], Array] = np.asarray) -> Array:
    """The change of values (N,) where nothing moves along the orbit, (N, F); size: applied to each factor."""
    return np.asarray(np.einsum("nk,nfk->nf", size(at.moved), size(e)))


def _passes(varied: Variations, q: Array, x: Array) -> tuple[Array, Array]:
    """When the rod first passes the places x of panels q, and whether it does, (N,) each."""
    orbit, panels = varied.orbit, varied.orbit.panels
    case, second = panels.arc[q] // 2, panels.arc[q] % 2 == 1
    span, ahead, back = orbit.problem.span[case], orbit.ahead[case], orbit.back[case]
    local = orbit.since[q] + panels.duration[q] * (1 + x) / 2
    there = local + np.where(second, 2 * ahead, 0.0)
    again = np.where(orbit.kind[case] == LIBRATION, 2 * ahead + np.where(second, 2 * back, 0.0) - local, np.inf)
    first = np.minimum(there, again)
    return first, (first <= span) | (orbit.period[case] <= span)


EXTREMES = {
    "low": (densities.angle, SMALLEST),
    "high": (densities.angle, LARGEST),
    "tightest": (densities.curvature, LARGEST),
    "least": (densities.outward, SMALLEST),
    "most": (densities.outward, LARGEST),
    "tension": (densities.tension, LARGEST_SIZE),
}
INTEGRALS = {"curvature": densities.curvature, "bending": densities.bending, "potential": densities.potential}
PUSHES = ("pushed", "pulled", "share")
MIDDLE_PUSH, LIFTS, PEAK = "middle push", "lifts", "peak"
MIDDLE_GAINS = ("middle turned", "middle risen")
MEASURED = (*EXTREMES, *INTEGRALS, *PUSHES, MIDDLE_PUSH, LIFTS, PEAK, *MIDDLE_GAINS)
