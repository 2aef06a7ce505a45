"""The time that an orbit takes between two end angles, as a function of its level.

An ends problem reduces to this function. Let low and high be the two end angles in order. At the level eta three times
determine the length of every path: `crossing`, from low to high; `above`, from high to the upper turning point;
`below`, from low to the lower one. The length of a path that passes k turning points is a sum of whole multiples of the
three, all of them positive, so no digits cancel.

Next to a saddle o, G(o + x) = G(o) - r^2 x^2 with r^2 = -H'(o). So where the level is eta = G(o) + sign exp(y), each
half passage (from the neighbourhood of the saddle to the saddle or to the turning point before it) adds 1/(2 r) to the
time for every unit that y falls; corrections are of the order of exp(y). Below y = `Boundary.deepest` the three times
are continued by this law, so y has no lower limit.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..core import levels as core
from ..core.panels import Cutting, available
from ..mechanics.potential import TAU, load_size, slope
from ..numerics.arrays import Array, Booleans
from ..numerics.chebyshev import basis
from ..orbit.arcs import apart, arcs_of
from ..orbit.critical_points import CriticalPoints
from ..orbit.local_potential import LocalPotential
from ..orbit.panels import panelled
from ..orbit.pieces import CENTRE, ROTATION, Pieces, start_variable
from ..problem.reduced import EndsProblem
from .paths import Levels

_SAME = 4e-16  # of the size of G: heights that differ by less are equal
STRETCH = 4.0  # factor of the panels along saddles, where time is almost linear in u
NODES, CUTTING = 22, Cutting(0.7, 1e-15, STRETCH)
_BLOCK = 2048  # levels computed at once


def repeated(problem: EndsProblem, count: int) -> EndsProblem:
    """`count` copies of one problem."""
    return problem.take(np.zeros(count, dtype=np.int64))


def wrapped(angle: float) -> float:
    """The angle in [-pi, pi), as `arcs.arcs_of` wraps it."""
    angle = float(angle - TAU * np.round(angle / TAU))
    return angle - TAU if angle >= np.pi else angle


@dataclass(frozen=True, eq=False)
class Boundary:
    """One ends problem (of size 1) and the critical points of its G.

    low, high: the end angles in order, in [-pi, pi). whole_turns: of beta between them. passed: critical points
    between low and high, without those of the whole turns. rising: whether beta(0) is the lower one. pins: (P,), angles
    in [-pi, pi) from whose heights levels are measured. falls: (P, 2), G(pin) less G at low and high. deepest: log gap
    below which times are linear in it.
    """

    problem: EndsProblem
    found: CriticalPoints
    low: float
    high: float
    whole_turns: int
    passed: int
    rising: bool
    pins: Array
    falls: Array
    deepest: float

    def start_speed2(self, pin: Any, gap: Array) -> Array:
        """beta_t(0)^2 at levels G(pins[pin]) + gap."""
        return gap + self.falls[pin, 0 if self.rising else 1]


def height_scale(problem: EndsProblem) -> float:
    """A bound on the size of G."""
    return float(1 + load_size(problem)[0])


def fall(problem: EndsProblem, pin: float, beta: float, extremum: bool) -> float:
    """G(pin) - G(beta) to relative accuracy in beta - pin; 0 for angles far apart where it is less than rounding."""
    return core.fall(problem, pin, beta, extremum) if available() else reference_fall(problem, pin, beta, extremum)


def reference_fall(problem: EndsProblem, pin: float, beta: float, extremum: bool) -> float:
    """The same without the core."""
    x = float(apart(np.array([beta]), np.array([pin]))[0])
    at = np.array([pin])
    value = float(LocalPotential.about(problem, at).drop(np.array([[x]]))[0, 0])
    if not extremum:
        value -= 2 * float(slope(problem, at)[0]) * np.sin(x)
    return 0.0 if abs(x) > 1e-3 and abs(value) < _SAME * height_scale(problem) else value


@dataclass(frozen=True, eq=False)
class TransitTimes:
    """The times crossing, above and below at M levels.

    time: (3, M); NaN where no orbit of the level joins the ends. rate: (3, M), what a unit of falling y adds to each.
    rotates: (M,), whether the orbit is a rotation, which has the crossing alone. calls: evaluations of G.
    """

    time: Array
    rate: Array
    rotates: Booleans
    calls: int

    def lengths(self, counts: Array) -> Array:
        """Lengths of paths with these counts (N, 3) at every level, (N, M); NaN where there is no such orbit."""
        return self._sum(self.time, counts[:, :, None])

    def rates(self, counts: Array) -> Array:
        """What a unit of falling y adds to the lengths, (N, M)."""
        return self._sum(self.rate, counts[:, :, None])

    def lengths_along(self, counts: Array) -> Array:
        """Length of path i at level i, (M,), counts (M, 3)."""
        return self._sum(self.time, counts)

    def _sum(self, value: Array, counts: Array) -> Array:
        total = counts[:, 0] * value[0] + counts[:, 1] * value[1] + counts[:, 2] * value[2]
        return np.where(self.rotates & (counts[:, 1] + counts[:, 2] > 0), np.nan, total)


def transit_times(boundary: Boundary, levels: Levels, deep: bool = True) -> TransitTimes:
    """The times at M levels. deep: continue them below `boundary.deepest`, else take those at `deepest`."""
    if available():
        found = core.transit_times(boundary, levels.pin, levels.sign, levels.y, deep, NODES, CUTTING)
        if found is not None:
            return TransitTimes(*found)
    return reference_transit_times(boundary, levels, deep)


def reference_transit_times(boundary: Boundary, levels: Levels, deep: bool = True) -> TransitTimes:
    """The same without the core."""
    if levels.y.size > _BLOCK:
        blocks = [
            reference_transit_times(boundary, levels.take(slice(k, k + _BLOCK)), deep)
            for k in range(0, levels.y.size, _BLOCK)
        ]
        time, rate = (np.concatenate([getattr(b, name) for b in blocks], axis=1) for name in ("time", "rate"))
        return TransitTimes(time, rate, np.concatenate([b.rotates for b in blocks]), sum(b.calls for b in blocks))
    M = levels.y.size
    gap = levels.sign * np.exp(np.maximum(levels.y, boundary.deepest))
    v2 = gap + boundary.falls[levels.pin].T
    joins = (v2 > 0).all(axis=0)
    v_low, v_high = np.sqrt(np.where(joins, v2, 1.0))
    start = replace(repeated(boundary.problem, M).started(v_low), beta0=np.full(M, boundary.low))
    same = boundary.found
    found = CriticalPoints(np.repeat(same.beta, M, axis=0), np.repeat(same.centre, M, axis=0), np.repeat(same.count, M))
    arcs = arcs_of(start, (boundary.pins[levels.pin], gap), found)
    pieces = _three(boundary, arcs.pieces, v_high, M)
    twice = repeated(boundary.problem, 2 * M).started(np.tile(v_low, 2))
    cut = replace(arcs, pieces=pieces)
    panels = panelled(twice, cut, basis(NODES), CUTTING.length, CUTTING.goal, times_only=True, stretch=CUTTING.stretch)
    time = _by_arc(panels.arc, panels.duration, M)
    rate = _by_arc(pieces.arc, half_passages(pieces, np.tile(gap, 2)).sum(axis=0), M)
    rotates = joins & (arcs.kind == ROTATION)
    for value in (time, rate):
        value[0, rotates] += boundary.whole_turns * (value[0] + value[1])[rotates]
        value[1:, rotates] = 0
    if deep:
        time += rate * np.maximum(boundary.deepest - levels.y, 0)
    joins &= rotates | (boundary.whole_turns == 0)
    return TransitTimes(np.where(joins, time, np.nan), np.where(joins, rate, np.nan), rotates, int(panels.calls.sum()))


def _by_arc(arc: Any, values: Array, M: int) -> Array:
    """Sums over the arcs that `_three` numbers, (3, M): crossing, above, below."""
    total = np.bincount(arc, weights=values, minlength=4 * M).astype(float)
    return np.stack([total[: 2 * M : 2], total[2 * M :: 2], total[1 : 2 * M : 2]])


def _three(boundary: Boundary, pieces: Pieces, v_high: Array, M: int) -> Pieces:
    """The pieces of the arcs from low, the upward ones cut at high.

    They are numbered as arcs: 2 b from low to high, 2 (M + b) beyond high, 2 b + 1 below low.
    """
    upward = pieces.arc % 2 == 0
    holds = np.flatnonzero(upward & (pieces.rank == boundary.passed))
    cut = pieces.take(holds)
    x = apart(np.array([boundary.high]), cut.local.o[:, 0])
    from_low = cut.displacement(cut.u1[:, None])[:, 0] > 0
    x = np.where(from_low & (x < 0), x + TAU, np.where(~from_low & (x > 0), x - TAU, x))
    u, _ = start_variable(cut.kind, cut.scale, x, v_high[cut.arc // 2], np.zeros(x.size, dtype=bool), cut.local)
    u = np.clip(u, np.minimum(cut.u0, cut.u1), np.maximum(cut.u0, cut.u1))
    arc = np.where(upward & (pieces.rank >= boundary.passed), pieces.arc + 2 * M, pieces.arc)
    u0 = pieces.u0.copy()
    u0[holds] = u
    index = np.concatenate([np.arange(arc.size), holds])
    arc = np.concatenate([arc, cut.arc])
    u0, u1 = np.concatenate([u0, cut.u0]), np.concatenate([pieces.u1, u])
    rank = pieces.rank[index]
    order = np.lexsort((rank, arc))
    order = order[u0[order] != u1[order]]
    kept = pieces.take(index[order])
    return Pieces(arc[order], rank[order], kept.kind, kept.base, kept.scale, u0[order], u1[order], kept.local)


def half_passages(pieces: Pieces, gap: Array) -> Array:
    """What a unit of falling log gap adds to the time at the near and at the far end of each piece, (2, P).

    1/(2 r) where the piece ends at the saddle from whose height the level is measured, or at the turning point before
    it, else 0. gap: (B,), of the problem of each piece, arc // 2.
    """
    level = pieces.local.level[:, 0]
    own = (pieces.kind != CENTRE) & (np.abs(np.abs(level) - np.abs(gap[pieces.arc // 2])) < 1e-9 * np.abs(level))
    bend = np.maximum(pieces.local.steepness(np.zeros((level.size, 1)))[:, 0] / 4, 1e-30)
    share = np.where(own, 0.5 / np.sqrt(bend), 0.0)
    return np.stack([np.where(pieces.u0 == 0, share, 0.0), np.where(pieces.u1 == 0, share, 0.0)])
