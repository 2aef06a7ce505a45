"""One ends problem with the critical points of its potential; the levels and paths of the orbits that join its ends,
and the time that an orbit takes between them.

A level is given by a pin p (a saddle of G, or one of the ends), a sign and y: eta = G(p) + sign exp(y). A way is the
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

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..core import branch_calls as core
from ..core.library import FLOAT, TIMES, Cutting, cut, fine, numbers_of, on_grid, points, run, structure
from ..core.tuning import AT_REST, LOWEST, MOVED, NUDGE, ON
from ..numerics.arrays import Array, Booleans, Columns, Integers, whole_turns
from ..problem.dimensionless import EndsProblem
from .potential import TAU, HasLoads, load_size, slope

UP, DOWN = 1, -1
_CRITICAL = 16  # room for the critical points of a problem, of which G has at most 8 in a turn. x10: only memory
# factor of the panels along saddles, where time is almost linear in u. x10: these are too long, and halved
STRETCH = 4.0
# of a panel, and how panels are cut: their lengths take the least work for the tolerance. x10: C has no such panels;
# longer ones are halved
NODES, CUTTING = 22, Cutting(0.7, 1e-15, STRETCH)
_Boundary = structure("boundary", "orbit_parts.h")


@dataclass(frozen=True, eq=False)
class _CriticalPoints:
    """The critical points of G in [-pi, pi) of B problems, rising; padded to (B, K) with NaN.

    beta: (B, K). centre: (B, K), whether each is a minimum of G; they alternate. count: (B,), even, at least 2.
    A saddle and a centre may share an angle, where H only touches zero: under twist alone, at beta = 0 or pi.
    """

    beta: Array
    centre: Booleans
    count: Integers


def critical_points(problem: HasLoads) -> _CriticalPoints:
    """All critical points of G, which are the helices of the loads: the roots of H, found as sign changes on a grid and
    refined inside their brackets. None, a count of 0, where a load is not finite."""
    loads = np.stack([problem.lam, problem.mu, problem.phi], axis=1)
    every = _critical_points(loads)
    if every is None:  # all are refused for the sake of those that are not finite
        fit = np.array([_critical_points(load[None]) is not None for load in loads])
        every = _critical_points(np.where(fit[:, None], loads, 0.0))
        assert every is not None
        every.beta[~fit], every.centre[~fit], every.count[~fit] = np.nan, False, 0
    return every


def _critical_points(loads: Array) -> _CriticalPoints | None:
    """The critical points of loads (B, 3); None where one is not finite, or points could not be told apart."""
    B = loads.shape[0]
    beta, centre = np.full((B, _CRITICAL), np.nan), np.zeros((B, _CRITICAL), np.bool_)
    count = np.empty(B, np.int64)
    if not fine(run("rod_critical_points", B, loads, on_grid(), beta, centre, count)):
        return None
    most = int(count.max(initial=0))
    return _CriticalPoints(beta[:, :most], centre[:, :most], count)


@dataclass(frozen=True, eq=False)
class Levels(Columns):
    """M levels: pin (M,), index into the boundary's pins; sign (M,), +1 or -1; y (M,), log of the gap's size."""

    pin: Integers
    sign: Array
    y: Array


@dataclass(frozen=True, eq=False)
class Ways(Columns):
    """N ways from one end to the other, (N,) each: direction at beta(0), UP or DOWN, and turning points passed."""

    leaving: Integers
    turns: Integers

    def counts(self, rising: bool) -> Integers:
        """How many times crossing, above and below (`transit_times`) each way contains, (N, 3)."""
        turns, half = self.turns, (self.turns + 1) // 2
        up = self.leaving == UP
        inward = up == rising
        crossing = 2 * ((turns - ~inward) // 2) + 1
        return np.stack([crossing, 2 * np.where(up, half, turns // 2), 2 * np.where(up, turns // 2, half)], axis=1)


@dataclass(frozen=True, eq=False)
class Paths(Columns):
    """K equilibria of one ends problem, a `Path` each: its fields, (K,) each."""

    pin: Array
    sign: Array
    y: Array
    leaving: Integers
    turns: Integers
    helix: Booleans


@dataclass(frozen=True)
class Path:
    """One equilibrium of an ends problem, by its orbit.

    pin: the angle, in [-pi, pi), from whose height the level is measured: a saddle of G, or one of the two ends.
    sign, y: the gap eta - G(pin) = sign exp(y). leaving: UP or DOWN, the direction at the start. turns: how many
    turning points the rod passes.
    """

    pin: float
    sign: float
    y: float
    leaving: int
    turns: int
    helix: bool = False  # the rod is a helix from end to end: it has no level, and its angle is the pin

    @property
    def direction_at_end(self) -> int:
        """UP or DOWN, the direction at the far end."""
        return self.leaving if self.turns % 2 == 0 else -self.leaving

    @property
    def alone(self) -> Paths:
        """This path as `Paths` of one."""
        return Paths(*(np.array([number]) for number in vars(self).values()))


def helix_path(angle: float) -> Path:
    """The rod that is a helix of an angle from end to end."""
    return Path(angle, 1.0, -np.inf, 0, 0, True)


def path_of(paths: Paths, i: int) -> Path:
    """Equilibrium i of a search."""
    return Path(*(column[i].item() for column in vars(paths).values()))


def repeat(problem: EndsProblem, count: int) -> EndsProblem:
    """`count` copies of one problem."""
    return problem.take(np.zeros(count, dtype=np.int64))


def wrap(beta: float) -> float:
    """The angle in [-pi, pi), as the core wraps it."""
    beta = float(beta - whole_turns(beta))
    return beta - TAU if beta >= np.pi else beta


def nearest_angle(angles: Array, angle: float) -> tuple[float, float]:
    """The one of some angles that is nearest to an angle, full turns aside, and the sine of half the way to it."""
    apart = np.abs(np.sin((angles - angle) / 2))
    nearest = int(np.argmin(apart))
    return float(angles[nearest]), float(apart[nearest])


@dataclass(frozen=True, eq=False)
class Boundary:
    """One ends problem (of size 1) and the critical points of its G.

    critical: its points. low, high: the end angles in order, in [-pi, pi). helix_angle: that of a rod that is a helix
    from end to end; None where the ends are those of no helix, to rounding. whole_turns: of beta between the
    ends. passed: critical points between low and high, without those of the whole turns. rising: whether beta(0) is the
    lower one. pins: (P,), angles in [-pi, pi) from whose heights levels are measured. falls: (P, 2), G(pin) less G at
    low and high. deepest: log gap below which times are linear in it.
    """

    problem: EndsProblem
    critical: _CriticalPoints
    low: float
    high: float
    helix_angle: float | None
    whole_turns: int
    passed: int
    rising: bool
    pins: Array
    falls: Array
    deepest: float

    @cached_property
    def angles(self) -> Array:
        """The critical points of G in [-pi, pi), rising."""
        beta: Array = self.critical.beta[0, : self.critical.count[0]]
        return beta

    @cached_property
    def saddles(self) -> Array:
        """The maxima of G among them."""
        return self.angles[~self.critical.centre[0, : self.angles.size]]

    @property
    def start(self) -> float:
        """The angle of the start in [-pi, pi)."""
        return self.low if self.rising else self.high

    @property
    def end(self) -> float:
        """The angle of the far end in [-pi, pi)."""
        return self.high if self.rising else self.low

    @property
    def is_tied(self) -> bool:
        """Whether G is the same at both ends, so that beta_t passes through 0 at both together."""
        return self.start == self.end or self.fall(self.start, self.end) == 0

    @property
    def helix(self) -> "Path | None":
        """The rod that is a helix from end to end, where there is one."""
        return None if self.helix_angle is None else helix_path(self.helix_angle)

    def fall(self, pin: float, beta: float) -> float:
        """G(pin) - G(beta)."""
        return fall(self.problem, pin, beta, bool((self.angles == pin).any()))

    def own_pin(self, pin: float) -> float:
        """The critical point or the end that the pin of a path means.

        Saddles of the same loads, computed in two ways, differ in their last digit. Next to a saddle the root of a gap
        is less than that, so a level above another angle is another orbit.
        """
        nearest, apart = nearest_angle(np.append(self.angles, [self.low, self.high]), pin)
        return nearest if apart < MOVED else pin

    def with_pin(self, pin: float) -> "Boundary":
        """A boundary whose levels are measured from one angle, one of `own_pin`."""
        pin = self.own_pin(pin)
        falls = [[self.fall(pin, end) for end in (self.low, self.high)]]
        return replace(self, pins=np.array([pin]), falls=np.array(falls))

    def floor(self) -> tuple[float, bool]:
        """The highest of both ends and of the saddles between them: its angle, and whether it is an end that is no
        critical point."""
        best = self.high if self.fall(self.low, self.high) < 0 else self.low
        extremum = bool((self.angles == best).any())
        for s in self.saddles if self.whole_turns else self.saddles[self._holds(self.saddles)]:
            rise = self.fall(s, best)
            if rise > 0 or (rise == 0 and not extremum):
                best, extremum = float(s), True
        return best, not extremum

    def _holds(self, beta: Array) -> Any:
        """Whether angles in [-pi, pi) lie from low up to high."""
        above, below = beta >= self.low, beta <= self.high
        return above & below if self.high >= self.low else above | below

    def joins_at(self, path: "Path") -> bool:
        """Whether the level lies above every maximum of G between the two ends."""
        highest, _ = self.floor()
        pin, gap = self.own_pin(path.pin), path.sign * float(np.exp(max(path.y, self.deepest)))
        return (pin == highest and path.sign > 0) or gap + self.fall(pin, highest) >= 0

    def lengthens(self, path: "Path") -> float:
        """1 where a path of the only pin grows longer with its level, 0 where it grows shorter; NaN of a helix."""
        if path.helix:
            return np.nan
        measured = self.own_pin(path.pin), path.sign
        every = core.charts(numbers_of(self.problem)[0], path)
        nudge = min(
            (nudge for _, at, _, nudge, logarithmic in every if logarithmic and at[:2] == measured), default=NUDGE
        )
        y, way = path.y + nudge * np.array([-1.0, 1.0]), Ways(np.array([path.leaving]), np.array([path.turns]))
        seen = transit_times(self, Levels(np.zeros(2, dtype=np.int64), np.full(2, path.sign), y))
        below, above = seen.lengths(way.counts(self.rising))[0]
        return float(path.sign * (above - below) > 0)

    def start_speed2(self, pin: Any, gap: Array) -> Array:
        """beta_t(0)^2 at levels G(pins[pin]) + gap."""
        return gap + self.falls[pin, 0 if self.rising else 1]

    def ways(self, most_turns: int) -> Ways:
        """Every way of at most so many turning points, but for that of no length."""
        turns = np.arange(most_turns + 1)
        leaving = np.repeat([UP, DOWN], turns.size)
        turns = np.tile(turns, 2)
        separate = self.low != self.high or self.whole_turns > 0
        plain = (leaving == (UP if self.rising else DOWN)) & separate
        kept = (turns > 0) | plain
        leaving, turns = leaving[kept], turns[kept]
        return Ways(leaving, turns)


def boundary_of(problem: EndsProblem) -> Boundary:
    """The ends problem (of size 1) with the critical points of G; ends within rounding of a helix are moved onto it.

    Its `pins`, `falls` and `deepest` are left to `level_grid.level_grid_of`, or `Boundary.with_pin`.
    """
    critical = critical_points(problem)
    angles = critical.beta[0, : critical.count[0]]
    helix = _helix_angle(problem, angles)
    beta0, betaL = float(problem.beta0[0]), float(problem.betaL[0])
    rising = beta0 <= betaL
    around = [wrap(beta) for beta in sorted((beta0, betaL))]
    for i, beta in enumerate(around):
        near = angles[np.abs(_apart(np.full(angles.size, beta), angles)) < ON]
        around[i] = float(near[0]) if near.size else beta
    low, high = around if helix is None else (helix, helix)
    rest = high - low + (TAU if high < low else 0.0)
    whole_turns = round((abs(betaL - beta0) - rest) / TAU)
    behind = [int(np.count_nonzero(angles <= beta)) - 1 for beta in (low, high)]
    passed = behind[1] - behind[0] + (angles.size if high < low else 0)
    ends = low, high, helix, whole_turns, passed, rising
    return Boundary(problem, critical, *ends, np.empty(0), np.empty((0, 2)), LOWEST)


def _apart(a: Array, b: Array) -> Array:
    """a - b moved into [-pi, pi), of angles in [-pi, pi); exact where they are neighbours across the cut at pi."""
    apart = a - b
    return np.where(apart >= np.pi, (a - TAU) - b, np.where(apart < -np.pi, (a + TAU) - b, apart))


def _helix_angle(problem: EndsProblem, angles: Array) -> float | None:
    """The angle in [-pi, pi) of the rod that is a helix from end to end, which has no level to search for.

    angles: critical points. None where the ends are those of no helix, to rounding.
    """
    beta0 = problem.beta0
    if problem.betaL[0] != beta0[0] or np.abs(slope(problem, beta0))[0] > AT_REST * height_scale(problem):
        return None
    apart = beta0[0] - angles
    return float(angles[int(np.argmin(np.abs(apart - whole_turns(apart))))])


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
    if fine(run("rod_transit_times", *_in_core(boundary), M, *_columns(levels), deep, *seen, calls)):
        return TransitTimes(*seen, int(calls[0]))
    nothing = np.full((3, M), np.nan)  # the loads are not finite
    return TransitTimes(nothing, nothing, np.zeros(M, dtype=bool), 0)


def length_roots(boundary: Boundary, levels: Levels, counts: Integers, other: Array) -> tuple[Array, int]:
    """The y at which the length of K paths is the rod's, between those of K levels and others, (K,); evaluations of G.

    counts: (K, 3), of `Ways.counts`. NaN where no root was found.
    """
    calls, roots = np.zeros(1, np.int64), np.empty(other.size)
    pin, sign, y = _columns(levels)
    paths, ends = np.ascontiguousarray(counts, np.int64), (np.minimum(y, other), np.maximum(y, other))
    status = run("rod_level_roots", *_in_core(boundary), y.size, pin, sign, paths, *ends, roots, calls)
    return (roots, int(calls[0])) if fine(status) else (np.full(other.size, np.nan), 0)  # the loads are not finite


def _columns(levels: Levels) -> tuple[Integers, Array, Array]:
    """Pin, sign and y as the core reads them."""
    pin, sign, y = levels.pin, levels.sign, levels.y
    return np.ascontiguousarray(pin, np.int64), np.ascontiguousarray(sign, float), np.ascontiguousarray(y, float)


def _in_core(boundary: Boundary) -> tuple[Any, ...]:
    """One ends problem as the core reads it, and how its panels are cut."""
    problem, critical = boundary.problem, boundary.critical
    loads = (float(v[0]) for v in (problem.lam, problem.mu, problem.phi, problem.span))
    ends = boundary.low, boundary.high, boundary.deepest
    levels = boundary.pins.size, boundary.pins, boundary.falls
    of = _Boundary(*loads, *ends, boundary.whole_turns, boundary.passed, *levels)
    m, how = int(critical.count[0]), (points(NODES), cut(CUTTING, TIMES))
    return of, m, critical.beta[0, :m].copy(), critical.centre[0, :m].astype(np.int64), *how
