"""The arcs of an orbit: from its start forward and backward to the turning points, cut at every extremum of G."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..mechanics.potential import TAU, load_size, slope
from ..numerics.arrays import Array, Booleans, Integers
from ..problem.reduced import StartProblem
from .critical_points import CriticalPoints, critical_points
from .local_potential import LocalPotential
from .pieces import CENTRE, HELIX, LIBRATION, PASS, ROTATION, SADDLE, Pieces, scales, start_variable, variable

TINY = 1e-150  # angles and speeds below this have squares that a float cannot hold: they count as zero


@dataclass(frozen=True, eq=False)
class Arcs:
    """The arcs of B orbits. kind: (B,), HELIX, LIBRATION or ROTATION; direction: (B,), sign of beta_t after the start.

    A libration has a forward and a backward arc, from its start to the turning points; together they are half a period.
    A rotation has a forward arc only, one whole turn. A helix has none.
    """

    kind: Integers
    direction: Array
    pieces: Pieces


def arcs_of(problem: StartProblem, pin: tuple[Array, Array] | None = None, known: CriticalPoints | None = None) -> Arcs:
    """The arcs of the orbits of B start problems with finite numbers.

    Parameters
    ----------
    problem : StartProblem
        B start problems.
    pin : tuple of arrays, optional
        Angles r in [-pi, pi) and gaps eta - G(r), (B,) each. They fix the level more finely than beta_t(0) can where
        the orbit passes a saddle r closely. Default: r = beta(0) and the gap beta_t(0)^2.
    known : CriticalPoints, optional
        The critical points of the problems, where the caller knows them.
    """
    found = critical_points(problem) if known is None else known
    m, B = found.count, problem.size
    start = problem.beta0 - TAU * np.round(problem.beta0 / TAU)
    start = np.where(start >= np.pi, start - TAU, start)
    behind = np.count_nonzero(found.beta <= start[:, None], axis=1) - 1  # -1: the last one, a turn lower
    level = _levels(problem, found, *((start, problem.dbeta0**2) if pin is None else pin))
    v = problem.dbeta0
    rest = np.abs(v) < TINY
    # a rod that starts with beta_t = 0 goes downhill: up where the extremum above it is a centre
    rows = np.arange(B)
    above = found.centre[rows, (behind + 1) % m]
    direction = np.where(rest, np.where(above, 1.0, -1.0), np.sign(v))
    near = np.abs(apart(start[:, None], found.beta)) < TINY
    still = rest & (near.any(axis=1) | (slope(problem, start) == 0))
    forward, blocked = _blocked(found, level, behind, direction)
    backward, _ = _blocked(found, level, behind, -direction)
    kind = np.where(still, HELIX, np.where(blocked, LIBRATION, ROTATION))
    # number of pieces of the forward and the backward arc
    counts = np.zeros((B, 2), dtype=np.int64)
    counts[:, 0] = np.where(still, 0, np.where(blocked, forward + 1, m + 1))
    counts[:, 1] = np.where(still | ~blocked | rest, 0, backward + 1)
    cells = _cells(found, level, start, behind, direction, counts.reshape(-1))
    return Arcs(kind, direction, _pieces(problem, cells, start, kind, counts.reshape(-1)))


def _levels(problem: StartProblem, found: CriticalPoints, pinned: Array, gap: Array) -> Array:
    """eta - G at every critical point, (B, K), to relative accuracy where both parts of it are small; NaN beyond."""
    drop, x = _falls(problem, found, pinned)
    nearest = np.nanargmin(np.abs(x), axis=1)
    beside = np.take_along_axis(x, nearest[:, None], axis=1)[:, 0]
    rows = np.flatnonzero(beside != 0)
    if rows.size:  # those of the same height as the nearest critical point must be as high as that point
        some = CriticalPoints(found.beta[rows], found.centre[rows], found.count[rows])
        close = nearest[rows]
        about, _ = _falls(problem.take(rows), some, some.beta[np.arange(rows.size), close])
        tied = (np.abs(beside[rows]) < 1e-3)[:, None] | (about == 0)
        drop[rows] = np.where(tied, about + drop[rows, close][:, None], drop[rows])
    level = gap[:, None] - drop
    # within rounding of the saddle's own level either sign is as good; zero is not
    floor = 2e-17 * (np.abs(gap[:, None]) + np.abs(drop)) + 1e-300
    return np.where(np.abs(level) < floor, np.where(level > 0, floor, -floor), level)


def _falls(problem: StartProblem, found: CriticalPoints, angle: Array) -> tuple[Array, Array]:
    """G at every critical point less G at an angle (B,), and the distance of the angle from it, (B, K) each.

    Critical points far from the angle and as high to rounding, which symmetry makes common, get exactly its height.
    """
    B, K = found.beta.shape
    wide = problem.take(np.repeat(np.arange(B), K))
    x = apart(angle[:, None], found.beta)
    drop = LocalPotential.about(wide, found.beta.reshape(-1)).drop(x.reshape(-1, 1)).reshape(B, K)
    heights = load_size(problem) + 1
    return np.where((np.abs(drop) < 4e-16 * heights[:, None]) & (np.abs(x) > 1e-3), 0.0, drop), x


def apart(a: Array, b: Array) -> Array:
    """a - b moved into [-pi, pi), of angles in [-pi, pi); exact where they are neighbours across the cut at pi."""
    x = a - b
    return np.where(x >= np.pi, (a - TAU) - b, np.where(x < -np.pi, (a + TAU) - b, x))


def _blocked(found: CriticalPoints, level: Array, behind: Any, direction: Array) -> tuple[Any, Any]:
    """How many critical points an orbit passes before the one that is too high, and whether any is, (B,) each."""
    K = found.beta.shape[1]
    rank = np.arange(K)[None, :]
    m = found.count[:, None]
    up = direction[:, None] > 0
    index = np.where(up, behind[:, None] + 1 + rank, behind[:, None] - rank) % m
    stops = (np.take_along_axis(level, index, axis=1) <= 0) & (rank < m)
    return np.argmax(stops, axis=1), stops.any(axis=1)


@dataclass(frozen=True, eq=False)
class _Cells:
    """P monotone intervals of G, (P,) each, one for each piece.

    arc, rank: as in `Pieces`. sign: of beta_t on the piece. width: length of the interval. empty: where a saddle and a
    centre coincide. low, high: its ends, in [-pi, pi); turn_low, turn_high: whole turns to add to them. g_low, g_high:
    eta - G there. saddle_low: whether the lower end is the saddle. x_low, x_high: the start from either end.
    """

    arc: Integers
    rank: Integers
    sign: Array
    width: Array
    empty: Booleans
    low: Array
    high: Array
    turn_low: Array
    turn_high: Array
    g_low: Array
    g_high: Array
    saddle_low: Booleans
    x_low: Array
    x_high: Array


def _cells(found: CriticalPoints, level: Array, start: Array, behind: Any, direction: Array, counts: Any) -> _Cells:
    """The intervals between neighbouring critical points that the arcs pass, counted through whole turns."""
    arc = np.repeat(np.arange(counts.size), counts)
    rank = np.arange(arc.size) - np.repeat(np.cumsum(counts) - counts, counts)
    b = arc // 2
    m = found.count[b]
    sign = np.where(arc % 2 == 0, direction[b], -direction[b])
    low = behind[b] + np.where(sign > 0, rank, -rank)
    c_low, c_high = found.beta[b, low % m], found.beta[b, (low + 1) % m]
    turn_low, turn_high = TAU * (low // m), TAU * ((low + 1) // m)
    width = c_high - c_low + np.where((low + 1) % m == 0, TAU, 0.0)
    empty = width <= 0  # between a saddle and a centre that coincide
    width = np.where(empty, 1.0, width)
    g_low, g_high = level[b, low % m], level[b, (low + 1) % m]
    # the start in its interval, from either end (also one turn on, where a rotation closes)
    x_low, x_high = apart(start[b], c_low), apart(start[b], c_high)
    x_low, x_high = np.where(x_low < 0, x_low + TAU, x_low), np.where(x_high > 0, x_high - TAU, x_high)
    x_low, x_high = (np.where(np.abs(x) < TINY, 0.0, x) for x in (x_low, x_high))
    saddle_low = ~found.centre[b, low % m]
    ends = (c_low, c_high, turn_low, turn_high, g_low, g_high, saddle_low)
    return _Cells(arc, rank, sign, width, empty, *ends, x_low, x_high)


def _pieces(problem: StartProblem, cells: _Cells, start: Array, kind: Any, counts: Any) -> Pieces:
    """The pieces of the arcs, one in each interval; those of no length are left out."""
    arc, rank, width, saddle_low = cells.arc, cells.rank, cells.width, cells.saddle_low
    b = arc // 2
    last = (rank == counts[arc] - 1) & (kind[b] == LIBRATION)
    around = (rank == counts[arc] - 1) & (kind[b] == ROTATION)
    g_saddle = np.where(saddle_low, cells.g_low, cells.g_high)
    at_rest = np.abs(problem.dbeta0[b]) < TINY
    passes = g_saddle > 0
    # the origin of x: the saddle, or the centre where the orbit turns on its half of the interval
    local = LocalPotential.about(problem.take(b), np.where(saddle_low, cells.low, cells.high), g_saddle)
    limit = np.where(saddle_low, width, -width)
    near_centre = ~passes & (local.speed2(limit[:, None] / 2)[:, 0] < 0)
    on_low = saddle_low ^ near_centre
    if near_centre.any():
        origin, level = np.where(on_low, cells.low, cells.high), np.where(on_low, cells.g_low, cells.g_high)
        local = LocalPotential.about(problem.take(b), origin, level)
    x_start = np.where(on_low, cells.x_low, cells.x_high)
    scale = scales(local, passes, np.where(on_low, width, -width))
    # a rod that starts with beta_t = 0 starts at its turning point
    scale = np.where(~passes & at_rest & (rank == 0), x_start, scale)
    # ends of the piece: at the start, at an extremum, or at the turning point
    x_first = np.where(on_low, 0.0, -width)  # the interval's lower end, from the origin
    x_second = np.where(on_low, width, 0.0)
    x_from = np.where(cells.sign > 0, x_first, x_second)
    x_to = np.where(cells.sign > 0, x_second, x_first)
    form = np.where(passes, PASS, np.where(near_centre, CENTRE, SADDLE))
    speed = np.where(at_rest, 0.0, problem.dbeta0[b])
    here, scale = start_variable(form, scale, x_start, speed, rank == 0, local)
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        u_from, u_to = variable(form, scale, x_from), variable(form, scale, x_to)
    u0 = np.where(rank == 0, here, u_from)
    u1 = np.where(last, np.where(form == CENTRE, np.pi / 2, 0.0), np.where(around, here, u_to))
    shift = (problem.beta0 - start)[b]
    base = np.where(on_low, cells.low + cells.turn_low, cells.high + cells.turn_high) + shift
    moving = np.flatnonzero((u0 != u1) & ~cells.empty)
    return Pieces(arc, rank, form, base, scale, u0, u1, local).take(moving)
