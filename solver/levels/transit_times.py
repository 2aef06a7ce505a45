"""Levels and paths of the orbits that join two end angles, and the time that an orbit takes between them.

A level is given by a pin p (a saddle of G, or one of the ends), a sign and y: eta = G(p) + sign exp(y). A path is the
direction in which the orbit leaves the start and reaches the far end, and how many whole periods lie between. An ends
problem reduces to the time as a function of the level. Let low and high be the two end angles in order. At the level
eta three times determine the length of every path: `crossing`, from low to high; `above`, from high to the upper
turning point; `below`, from low to the lower one. The length of a path that passes k turning points is a sum of whole
multiples of the three, all of them positive, so no digits cancel.

Next to a saddle o, G(o + x) = G(o) - r^2 x^2 with r^2 = -H'(o). So where the level is eta = G(o) + sign exp(y), each
half passage (from the neighbourhood of the saddle to the saddle or to the turning point before it) adds 1/(2 r) to the
time for every unit that y falls; corrections are of the order of exp(y). Below y = `Boundary.deepest` the three times
are continued by this law, so y has no lower limit. The core computes them: `transit_times.c`.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..core.critical_points import CriticalPoints
from ..core.library import AT, FLOAT, INT, Cutting, cut, fine, points, run, structure
from ..mechanics.potential import TAU, load_size
from ..numerics.arrays import Array, Booleans, Columns, Integers
from ..problem.reduced import EndsProblem

UP, DOWN = 1, -1


@dataclass(frozen=True, eq=False)
class Levels(Columns):
    """M levels: pin (M,), index into the boundary's pins; sign (M,), +1 or -1; y (M,), log of the gap's size."""

    pin: Integers
    sign: Array
    y: Array


@dataclass(frozen=True, eq=False)
class Paths(Columns):
    """N paths from one end to the other, (N,) each: direction at beta(0), UP or DOWN, and turning points passed."""

    leaving: Integers
    turns: Integers

    def counts(self, rising: bool) -> Integers:
        """How many times crossing, above and below (`transit_times`) each path contains, (N, 3)."""
        turns, half = self.turns, (self.turns + 1) // 2
        up = self.leaving == UP
        inward = up == rising
        crossing = 2 * ((turns - ~inward) // 2) + 1
        return np.stack([crossing, 2 * np.where(up, half, turns // 2), 2 * np.where(up, turns // 2, half)], axis=1)


@dataclass(frozen=True, eq=False)
class LevelPaths(Columns):
    """The level and the path of K solutions, (K,) each: eta = G(pin) + sign exp(y); see `Paths`."""

    pin: Array
    sign: Array
    y: Array
    leaving: Integers
    turns: Integers
    helix: Booleans


STRETCH = 4.0  # factor of the panels along saddles, where time is almost linear in u
NODES, CUTTING = 22, Cutting(0.7, 1e-15, STRETCH)
_Boundary = structure(  # orbit_parts.h
    "boundary", (FLOAT, "lam mu phi span low high deepest"), (INT, "whole_turns passed pins"), (AT, "pin falls")
)


def repeat(problem: EndsProblem, count: int) -> EndsProblem:
    """`count` copies of one problem."""
    return problem.take(np.zeros(count, dtype=np.int64))


def wrap(angle: float) -> float:
    """The angle in [-pi, pi), as the core wraps it."""
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

    def paths(self, most_turns: int) -> Paths:
        """Every path of at most so many turning points, but for that of no length."""
        turns = np.arange(most_turns + 1)
        leaving = np.repeat([UP, DOWN], turns.size)
        turns = np.tile(turns, 2)
        separate = self.low != self.high or self.whole_turns > 0
        plain = (leaving == (UP if self.rising else DOWN)) & separate
        kept = (turns > 0) | plain
        leaving, turns = leaving[kept], turns[kept]
        return Paths(leaving, turns)


def height_scale(problem: EndsProblem) -> float:
    """A bound on the size of G."""
    return float(1 + load_size(problem)[0])


def fall(problem: EndsProblem, pin: float, beta: float, extremum: bool) -> float:
    """G(pin) - G(beta) to relative accuracy in beta - pin; 0 for angles far apart where it is less than rounding."""
    loads = (float(v[0]) for v in (problem.lam, problem.mu, problem.phi))
    return float(run("rod_fall", *loads, pin, beta, extremum, result=FLOAT))


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
    M, calls = levels.y.size, np.zeros(1, np.int64)
    seen = np.empty((3, M)), np.empty((3, M)), np.empty(M, np.bool_)
    if fine(run("rod_transit_times", *_search(boundary), M, *_columns(levels), deep, *seen, calls)):
        return TransitTimes(*seen, int(calls[0]))
    nothing = np.full((3, M), np.nan)  # the loads are not finite
    return TransitTimes(nothing, nothing, np.zeros(M, dtype=bool), 0)


def length_roots(boundary: Boundary, levels: Levels, counts: Integers, other: Array) -> tuple[Array, int]:
    """The y at which the length of K paths is the rod's, between those of K levels and others, (K,); evaluations of G.

    counts: (K, 3), of `Paths.counts`. NaN where no root was found.
    """
    calls, roots = np.zeros(1, np.int64), np.empty(other.size)
    pin, sign, y = _columns(levels)
    paths, ends = np.ascontiguousarray(counts, np.int64), (np.minimum(y, other), np.maximum(y, other))
    status = run("rod_level_roots", *_search(boundary), y.size, pin, sign, paths, *ends, roots, calls)
    return (roots, int(calls[0])) if fine(status) else (np.full(other.size, np.nan), 0)  # the loads are not finite


def _columns(levels: Levels) -> tuple[Integers, Array, Array]:
    """Pin, sign and y as the core reads them."""
    pin, sign, y = levels.pin, levels.sign, levels.y
    return np.ascontiguousarray(pin, np.int64), np.ascontiguousarray(sign, float), np.ascontiguousarray(y, float)


def _search(boundary: Boundary) -> tuple[Any, ...]:
    """One ends problem as the core reads it, and how its panels are cut."""
    problem, points_of_G = boundary.problem, boundary.found
    loads = (float(v[0]) for v in (problem.lam, problem.mu, problem.phi, problem.span))
    pins, falls = np.ascontiguousarray(boundary.pins), np.ascontiguousarray(boundary.falls)
    ends = boundary.low, boundary.high, boundary.deepest
    of = _Boundary(*loads, *ends, boundary.whole_turns, boundary.passed, pins.size, pins, falls)
    m = int(points_of_G.count[0])
    critical = points_of_G.beta[0, :m].copy(), points_of_G.centre[0, :m].astype(np.int64)
    return of, m, *critical, points(NODES), cut(CUTTING, True)
