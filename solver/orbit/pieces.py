"""The course of an orbit: from the start forward and backward, cut at every extremum of G and at the turning points.

On each monotone piece of G one change of variables makes dt/du smooth however near a saddle the orbit passes:
x = a sinh(u) over a saddle that is passed, x = x1 cosh(u) where the orbit turns before it, x = x1 sin(u) where it turns
nearer the centre; x is measured from that saddle or centre. Eq. (36), regularised.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..mechanics.potential import TAU, slope
from ..numerics.arrays import Array
from ..problem.reduced import Reduced
from .critical_points import CriticalPoints, critical_points
from .local_potential import LocalPotential

PASS, SADDLE, CENTRE = 0, 1, 2
HELIX, LIBRATION, ROTATION = 0, 1, 2
_BLUR = 64.0  # times the rounding of an angle: what that of G may cost the start
TINY = 1e-150  # angles and speeds below this have squares that a float cannot hold: none


@dataclass(frozen=True, eq=False)
class Pieces:
    """P monotone pieces of courses, in the order they are travelled away from the start. Fields (P,) but `well`.

    part: 2 b for the forward course of problem b, 2 b + 1 for the backward one. rank: 0 for the piece with the start,
    then counting away from it. base: the angle that x counts from.
    kind: PASS, SADDLE or CENTRE. scale: a or x1 (signed). u0, u1: ends in u, along the travel.
    """

    arc: NDArray[np.int64]
    rank: NDArray[np.int64]
    kind: NDArray[np.int64]
    base: Array
    scale: Array
    u0: Array
    u1: Array
    well: LocalPotential

    def take(self, index: Any) -> "Pieces":
        fields = (self.arc, self.rank, self.kind, self.base, self.scale, self.u0, self.u1)
        part, rank, kind, base, scale, u0, u1 = (v[index] for v in fields)
        return Pieces(part, rank, kind, base, scale, u0, u1, self.well.take(index))

    def displacement(self, u: Array) -> Array:
        """x at u (P, n)."""
        return self.scale[:, None] * _by_kind(self.kind, u, (np.sinh, np.cosh, np.sin))

    def pace(self, u: Array, x: Array) -> tuple[Array, Array]:
        """dt/|du| and |beta_t| at u, x (P, n)."""
        scale = self.scale[:, None]
        passes = self.kind == PASS
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            if passes.all():
                root = self._passing(x, scale)
            elif passes.any():
                root = np.where(passes[:, None], self._passing(x, scale), self._turning(x, scale))
            else:
                root = self._turning(x, scale)
            stretch = _by_kind(self.kind, u, (np.cosh, np.sinh, np.cos))
            return 1 / root, np.abs(scale * stretch) * root

    def _passing(self, x: Array, scale: Array) -> Array:
        return np.sqrt(self.well.speed2(x) / (x * x + scale * scale))

    def _turning(self, x: Array, scale: Array) -> Array:
        return _turning(self.well, x, scale)


def _turning(well: LocalPotential, x: Array, scale: Array) -> Array:
    """beta_t over sqrt(x1^2 - x^2); never zero, as where the turning point is next to a helix it would be."""
    return np.sqrt(np.maximum(np.abs(well.ratio(x, scale)), well.faintest))


def _by_kind(kind: Any, u: Array, functions: tuple[Any, Any, Any]) -> Array:
    """The function of each row's kind at u (P, n)."""
    out = np.empty_like(u)
    with np.errstate(over="ignore"):
        for value, function in enumerate(functions):
            rows = kind == value
            if rows.any():
                out[rows] = function(u[rows])
    return out


@dataclass(frozen=True, eq=False)
class Arcs:
    """B orbits: kind (B,): HELIX, LIBRATION or ROTATION; direction (B,): sign of beta_t just after the start."""

    kind: NDArray[np.int64]
    direction: Array
    pieces: Pieces


def arcs_of(problem: Reduced, pin: tuple[Array, Array] | None = None, found: CriticalPoints | None = None) -> Arcs:
    """Where each orbit goes, and the pieces of its way; the problems' numbers must be finite. found: the extrema, where
    they are known.

    pin: angles r in [-pi, pi) and gaps eta - G(r), (B,) each, that fix the level more finely than beta_t(0) can where
    the orbit hugs a saddle r; without them the start does, r = beta(0) and the gap beta_t(0)^2.
    """
    assert problem.dbeta0 is not None
    found = critical_points(problem) if found is None else found
    m, B = found.count, problem.size
    start = problem.beta0 - TAU * np.round(problem.beta0 / TAU)
    start = np.where(start >= np.pi, start - TAU, start)
    behind = np.count_nonzero(found.beta <= start[:, None], axis=1) - 1  # -1: the last one, a turn lower
    level = _levels(problem, found, *((start, problem.dbeta0**2) if pin is None else pin))
    v = problem.dbeta0
    rest = np.abs(v) < TINY
    # a rod that starts without slope goes downhill: up where the extremum above it is a centre
    rows = np.arange(B)
    above = found.centre[rows, (behind + 1) % m]
    direction = np.where(rest, np.where(above, 1.0, -1.0), np.sign(v))
    near = np.abs(_apart(start[:, None], found.beta)) < TINY
    still = rest & (near.any(axis=1) | (slope(problem, start) == 0))
    forward, blocked = _blocked(found, level, behind, direction)
    backward, _ = _blocked(found, level, behind, -direction)
    kind = np.where(still, HELIX, np.where(blocked, LIBRATION, ROTATION))
    # pieces of the forward and the backward course of each problem; a rotation goes once round and has no backward one
    counts = np.zeros((B, 2), dtype=np.int64)
    counts[:, 0] = np.where(still, 0, np.where(blocked, forward + 1, m + 1))
    counts[:, 1] = np.where(still | ~blocked | rest, 0, backward + 1)
    pieces = _pieces(problem, found, level, start, behind, direction, kind, counts.reshape(-1))
    return Arcs(kind, direction, pieces)


def _levels(problem: Reduced, found: CriticalPoints, pinned: Array, gap: Array) -> Array:
    """eta - G at every extremum, (B, K), kept to relative accuracy where both parts of it are small; NaN beyond."""
    drop, x = _falls(problem, found, pinned)
    nearest = np.nanargmin(np.abs(x), axis=1)
    beside = np.take_along_axis(x, nearest[:, None], axis=1)[:, 0]
    rows = np.flatnonzero((np.abs(beside) < 1e-3) & (beside != 0))
    if rows.size:  # seen from next to an extremum, those of its height must be as high as it is
        some = CriticalPoints(found.beta[rows], found.centre[rows], found.count[rows])
        close = nearest[rows]
        about, _ = _falls(problem.take(rows), some, some.beta[np.arange(rows.size), close])
        drop[rows] = about + drop[rows, close][:, None]
    level = gap[:, None] - drop
    # within rounding of the saddle's own level either side is as true; none is zero
    floor = 2e-17 * (np.abs(gap[:, None]) + np.abs(drop)) + 1e-300
    return np.where(np.abs(level) < floor, np.where(level > 0, floor, -floor), level)


def _falls(problem: Reduced, found: CriticalPoints, angle: Array) -> tuple[Array, Array]:
    """G at every extremum less G at an angle (B,), and how far the angle lies from there, (B, K) each.

    CriticalPoints as high as the angle and far from it, which symmetry makes common, must share its height.
    """
    B, K = found.beta.shape
    wide = problem.take(np.repeat(np.arange(B), K))
    x = _apart(angle[:, None], found.beta)
    drop = LocalPotential.about(wide, found.beta.reshape(-1)).drop(x.reshape(-1, 1)).reshape(B, K)
    heights = np.abs(problem.lam) + np.abs(problem.mu) + np.abs(problem.phi) + 1
    return np.where((np.abs(drop) < 4e-16 * heights[:, None]) & (np.abs(x) > 1e-3), 0.0, drop), x


def _apart(a: Array, b: Array) -> Array:
    """a - b moved into [-pi, pi), of angles in [-pi, pi); exact where they are neighbours across the cut at pi."""
    x = a - b
    return np.where(x >= np.pi, (a - TAU) - b, np.where(x < -np.pi, (a + TAU) - b, x))


def _blocked(found: CriticalPoints, level: Array, behind: Any, direction: Array) -> tuple[Any, Any]:
    """How many extrema are passed before the one that blocks, and whether any does, (B,), (B,)."""
    K = found.beta.shape[1]
    rank = np.arange(K)[None, :]
    m = found.count[:, None]
    up = direction[:, None] > 0
    index = np.where(up, behind[:, None] + 1 + rank, behind[:, None] - rank) % m
    stops = (np.take_along_axis(level, index, axis=1) <= 0) & (rank < m)
    return np.argmax(stops, axis=1), stops.any(axis=1)


def _pieces(
    problem: Reduced,
    found: CriticalPoints,
    level: Array,
    start: Array,
    behind: Any,
    direction: Array,
    kind: Any,
    counts: Any,
) -> Pieces:
    part = np.repeat(np.arange(counts.size), counts)
    rank = np.arange(part.size) - np.repeat(np.cumsum(counts) - counts, counts)
    b = part // 2
    m = found.count[b]
    way = np.where(part % 2 == 0, direction[b], -direction[b])
    last = (rank == counts[part] - 1) & (kind[b] == LIBRATION)
    around = (rank == counts[part] - 1) & (kind[b] == ROTATION)
    # the monotone interval of each piece lies between extrema `low` and `low + 1`, whole turns counted
    low = behind[b] + np.where(way > 0, rank, -rank)
    c_low, c_high = found.beta[b, low % m], found.beta[b, (low + 1) % m]
    turn_low, turn_high = TAU * (low // m), TAU * ((low + 1) // m)
    width = c_high - c_low + np.where((low + 1) % m == 0, TAU, 0.0)
    empty = width <= 0  # between a saddle and a centre that coincide
    width = np.where(empty, 1.0, width)
    saddle_low = ~found.centre[b, low % m]
    g_low, g_high = level[b, low % m], level[b, (low + 1) % m]
    # the start's place in its interval, from either end (also one turn on, where a rotation closes)
    x_low, x_high = _apart(start[b], c_low), _apart(start[b], c_high)
    x_low, x_high = np.where(x_low < 0, x_low + TAU, x_low), np.where(x_high > 0, x_high - TAU, x_high)
    x_low, x_high = (np.where(np.abs(x) < TINY, 0.0, x) for x in (x_low, x_high))
    g_saddle = np.where(saddle_low, g_low, g_high)
    at_rest = np.abs(problem.dbeta0[b]) < TINY  # type: ignore[index]
    passes = g_saddle > 0
    # the origin of x: the saddle, or the centre where the orbit turns on its half of the interval
    well = LocalPotential.about(problem.take(b), np.where(saddle_low, c_low, c_high), g_saddle)
    limit = np.where(saddle_low, width, -width)
    near_centre = ~passes & (well.speed2(limit[:, None] / 2)[:, 0] < 0)
    on_low = saddle_low ^ near_centre
    if near_centre.any():
        well = LocalPotential.about(problem.take(b), np.where(on_low, c_low, c_high), np.where(on_low, g_low, g_high))
    x_start = np.where(on_low, x_low, x_high)
    scale = _scales(well, passes, np.where(on_low, width, -width))
    # a rod that starts without slope starts at its turning point
    scale = np.where(~passes & at_rest & (rank == 0), x_start, scale)
    # ends of the piece: at the start, at an extremum, or at the turning point
    x_first = np.where(on_low, 0.0, -width)  # the interval's lower end, from the origin
    x_second = np.where(on_low, width, 0.0)
    x_from = np.where(way > 0, x_first, x_second)
    x_to = np.where(way > 0, x_second, x_first)
    form = np.where(passes, PASS, np.where(near_centre, CENTRE, SADDLE))
    speed = np.where(at_rest, 0.0, problem.dbeta0[b])  # type: ignore[index]
    here, scale = _start_variable(form, scale, x_start, speed, rank == 0, well)
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        u_from, u_to = _variable(form, scale, x_from), _variable(form, scale, x_to)
    u0 = np.where(rank == 0, here, u_from)
    u1 = np.where(last, np.where(form == CENTRE, np.pi / 2, 0.0), np.where(around, here, u_to))
    shift = (problem.beta0 - start)[b]
    base = np.where(on_low, c_low + turn_low, c_high + turn_high) + shift
    moving = np.flatnonzero((u0 != u1) & ~empty)
    return Pieces(part, rank, form, base, scale, u0, u1, well).take(moving)


def _scales(well: LocalPotential, passes: Any, limit: Array) -> Array:
    """x1 where the orbit turns; where it passes, how far from the saddle the speed starts to grow, (P,)."""
    scale = np.empty(limit.size)
    turn = np.flatnonzero(~passes)
    if turn.size:
        scale[turn] = well.take(turn).turning(limit[turn])
    over = np.flatnonzero(passes)
    if over.size:
        scale[over] = _passing_scale(well.take(over), limit[over])
    return scale


def _passing_scale(well: LocalPotential, limit: Array) -> Array:
    """a of x = a sinh(u), (P,)."""
    level = well.level[:, 0]
    bend = well.steepness(np.zeros((limit.size, 1)))[:, 0] / 4
    with np.errstate(divide="ignore", invalid="ignore"):  # a width that no float can hold when squared
        rise = well.drop(limit[:, None])[:, 0] / limit**2
        a = np.sqrt(level / np.maximum(bend, rise))
    flat = np.flatnonzero((bend < 0.01 * rise) & (level < 0.1 * rise * limit**2))
    if flat.size:  # a saddle with next to no curvature: the speed grows with a higher power of x
        a[flat] = np.abs(well.take(flat).turning(limit[flat]))
    return np.where(np.isfinite(a), np.minimum(a, 1e8), 1e8)


def _variable(form: Any, scale: Array, x: Array) -> Array:
    """u at x, (P,)."""
    ratio = x / scale
    return np.where(
        form == PASS,
        np.arcsinh(ratio),
        np.where(form == SADDLE, np.arccosh(np.maximum(ratio, 1)), np.arcsin(np.clip(ratio, -1, 1))),
    )


def _start_variable(
    form: Any, scale: Array, x: Array, v: Array, first: Any, well: LocalPotential
) -> tuple[Array, Array]:
    """u at the start, from the slope, which loses no digits next to a turning point; and the scale, (P,) each.

    Where G is so flat that its rounding blurs the turning point of a `first` piece, that is moved to agree with angle
    and slope at the start; where it swamps the slope, u comes from the angle.
    """
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        root = _turning(well, x[:, None], scale[:, None])[:, 0]
        sine = np.where(v == 0, 0.0, np.abs(v) / (np.abs(scale) * root))
        slanted = np.where(form == SADDLE, np.arcsinh(sine), np.arctan2(np.abs(x / scale), sine))
        u = np.where(form == PASS, np.arcsinh(x / scale), slanted)
        blur = np.where(first & (form != PASS), well.weight(np.abs(x)) / root**2, 0)
        blurred = blur > _BLUR
        if blurred.any():
            lost = blur * sine**2 > _BLUR
            moved = x / np.where(form == SADDLE, np.cosh(u), np.sin(u))
            scale = np.where(blurred & ~lost, moved, scale)
            u = np.where(lost, _variable(form, scale, x), u)
        return u, scale
