"""Panels: short parts of an arc on which beta and the developed curve are Chebyshev series in time."""

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from ..numerics.arrays import Array, Booleans, Integers
from ..numerics.chebyshev import Basis, polynomials
from ..problem.reduced import Reduced
from .arcs import Arcs
from .pieces import Pieces

EPS = 2.0**-52
MOST = 10_000  # panels of one orbit beyond which none is halved any more
_ROUNDS = 14  # how often a panel may be halved
_PATIENCE, _CROWD = 3, 16  # after so many halvings, so many unfinished panels of an arc show that halving does not help
_TOO_LONG = 1e4  # times the rod's length: a first panel that lasts longer is cut
_LONG = 8.0  # in u: a piece longer than this is stretched along a saddle
_NEWTON = 12
_BLOCK = 512  # panels computed at once


@dataclass(frozen=True, eq=False)
class Panels:
    """P panels, in order of arc and of time away from the start.

    arc: (P,), 2 b for the forward arc of problem b, 2 b + 1 for the backward one. rank: (P,), of the panel's piece.
    duration: (P,). series: (P, 5, n + 1), of beta, |beta_t|, alpha, z and the swirl (the integral of sin cos), the last
    three from the panel's near end. fastest: (P,), largest |beta_t|. error: (P,), what the truncated series leave out
    of beta. time_error: (P,), what they leave out of the duration, as a share of it. time_rounding: (P,), what the
    rounding of G changes of the duration, as a share. calls: (P,), evaluations of G.
    """

    arc: Integers
    rank: Integers
    duration: Array
    series: Array
    fastest: Array
    error: Array
    time_error: Array
    time_rounding: Array
    calls: Integers

    def take(self, index: Any) -> "Panels":
        return Panels(**{f.name: getattr(self, f.name)[index] for f in fields(self)})


@dataclass(frozen=True, eq=False)
class _Cuts:
    """Q parts of pieces that become panels: of which piece, their place along it, near and far end in u, (Q,) each."""

    piece: Integers
    order: Array
    near: Array
    far: Array

    def take(self, index: Any) -> "_Cuts":
        return _Cuts(self.piece[index], self.order[index], self.near[index], self.far[index])

    def halved(self, share: Array, round_: int) -> "_Cuts":
        """Each part as two, cut at a share (Q,) of it."""
        share = np.repeat(share, 2)
        twice = self.take(np.repeat(np.arange(self.piece.size), 2))
        middle = twice.near + share * (twice.far - twice.near)
        second = np.arange(twice.piece.size) % 2 == 1
        order = twice.order + np.where(second, 0.5 ** (round_ + 1), 0)
        return _Cuts(twice.piece, order, np.where(second, middle, twice.near), np.where(second, twice.far, middle))


def panelled(
    problem: Reduced,
    arcs: Arcs,
    points: Basis,
    length: float,
    goal: float,
    times_only: bool = False,
    stretch: float = 1.0,
) -> Panels:
    """The panels of the arcs of B start problems.

    Parameters
    ----------
    problem : Reduced
        B start problems.
    arcs : Arcs
        Their arcs.
    points : Basis
        The Chebyshev points of each panel.
    length : float
        Length of a panel in u before any is halved.
    goal : float
        Panels are halved until their series leave out no more than this of beta, and of the time, as often as it is
        repeated along the rod.
    times_only : bool
        Compute the durations alone; the series then hold beta at the far end, (P, 1, 1).
    stretch : float
        How many times longer panels begin on pieces that are long in u, most of which lie next to a saddle.
    """
    assert problem.dbeta0 is not None
    pieces = arcs.pieces
    cuts = _first_cuts(pieces, length, stretch)
    # an error of the time is repeated all along the rod
    fastest = np.sqrt(
        problem.dbeta0**2 + 4 * (2 * np.abs(problem.lam) + 2 * np.abs(problem.phi) + np.abs(problem.mu) + 1)
    )
    repeats = np.maximum(1, problem.span * fastest)
    leads = np.diff(pieces.arc, prepend=-1) != 0
    done: list[tuple[_Cuts, Panels]] = []
    made = np.zeros(problem.size, dtype=np.int64)
    for round_ in range(_ROUNDS + 1):
        batch = pieces.take(cuts.piece)
        with np.errstate(over="ignore", invalid="ignore"):  # the panel's error tells of it
            panels = _in_blocks(batch, cuts.near, cuts.far, points, _times if times_only else _series)
        b = batch.arc // 2
        enough = (panels.error <= max(goal, 20 * EPS)) & (panels.time_error <= np.maximum(goal / repeats[b], 40 * EPS))
        # a rod that ends long before its first panel needs a shorter one: sums over the long one would swamp its own
        too_long = (cuts.order == 0) & leads[cuts.piece]
        too_long &= panels.duration > _TOO_LONG * np.maximum(1, problem.span[b])
        enough &= ~too_long
        # panels beside a singularity are few; many that halving does not help are at the limit of rounding
        left = np.bincount(batch.arc[~enough], minlength=2 * problem.size)
        made = made + np.bincount(b, minlength=problem.size)
        hopeless = (round_ >= _PATIENCE) & (left[batch.arc] > _CROWD) | (round_ == _ROUNDS) | ~np.isfinite(panels.error)
        enough |= hopeless | (made > MOST)[b]
        done.append((cuts.take(enough), panels.take(enough)))
        if enough.all():
            break
        with np.errstate(divide="ignore", over="ignore"):
            share = np.where(too_long, np.minimum(4 * problem.span[b] / panels.duration, 0.5), 0.5)
        cuts = cuts.take(~enough).halved(share[~enough], round_)
    if len(done) == 1:
        return done[0][1]
    order = np.concatenate([some.order for some, _ in done])
    return joined([panels for _, panels in done]).take(np.lexsort((order, np.concatenate([c.piece for c, _ in done]))))


def _first_cuts(pieces: Pieces, length: float, stretch: float) -> _Cuts:
    """The pieces in equal parts of about `length` in u."""
    wide = np.abs(pieces.u1 - pieces.u0)
    wide = np.where(np.isfinite(wide), wide, 0.0)  # beyond a float: one panel, without a number, which is refused
    share = np.maximum(np.ceil(wide / np.where(wide > _LONG, stretch * length, length)), 1).astype(np.int64)
    piece = np.repeat(np.arange(share.size), share)
    k = np.arange(piece.size) - np.repeat(np.cumsum(share) - share, share)
    step = ((pieces.u1 - pieces.u0) / share)[piece]
    near = pieces.u0[piece] + k * step
    far = np.where(k + 1 == share[piece], pieces.u1[piece], pieces.u0[piece] + (k + 1) * step)
    return _Cuts(piece, k.astype(float), near, far)


def running(values: Array, first: Any, count: Any) -> Array:
    """Sums of the values (P, k) before each panel within its part: added part by part, so that none sees another's."""
    part = np.repeat(np.arange(count.size), count)
    rank = np.arange(part.size) - first[part]
    table = np.zeros((count.size, int(count.max(initial=0)) + 1, values.shape[1]))
    table[part, rank + 1] = values
    return np.cumsum(table, axis=1)[part, rank]


def _in_blocks(pieces: Pieces, near: Array, far: Array, points: Basis, made: Callable[..., Panels]) -> Panels:
    """`made` of few enough panels at a time that their arrays stay in the cache."""
    if near.size <= _BLOCK:
        return made(pieces, near, far, points)
    blocks = [slice(k, k + _BLOCK) for k in range(0, near.size, _BLOCK)]
    return joined([made(pieces.take(block), near[block], far[block], points) for block in blocks])


def joined(parts: list[Panels]) -> Panels:
    """Panels one after the other."""
    columns: dict[str, Any] = {f.name: np.concatenate([getattr(p, f.name) for p in parts]) for f in fields(Panels)}
    return Panels(**columns)


def _series(pieces: Pieces, near: Array, far: Array, points: Basis) -> Panels:
    """The panels between `near` and `far` in u, (P,), each with one series."""
    middle, half = ((near + far) / 2)[:, None], ((far - near) / 2)[:, None]
    u = middle + half * points.nodes
    pace, _ = pieces.pace(u, pieces.displacement(u))
    rate = (np.abs(half) * pace) @ points.analyse
    clock = rate @ points.integrate
    duration = clock.sum(axis=1)
    at, converged = _inverted(clock, rate, duration, points)
    u = middle + half * at
    x = pieces.displacement(u)
    _, speed = pieces.pace(u, x)
    angle = pieces.base[:, None] + x
    s, c = np.sin(angle), np.cos(angle)
    values = np.stack([x, speed, s, c, s * c], axis=1)
    cut = values @ points.analyse
    series = np.empty((near.size, 5, points.nodes.size + 1))
    series[:, :2, :-1], series[:, :2, -1] = cut[:, :2], 0
    series[:, 0, 0] += pieces.base
    series[:, 2:] = (cut[:, 2:] @ points.integrate) * (duration / 2)[:, None, None]
    fastest = speed.max(axis=1)
    tail = np.abs(cut[:, :, -2:]).max(axis=2)
    late = np.abs(clock[:, -3:]).max(axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        error = np.maximum(tail[:, [0, 2, 3]].max(axis=1), late * fastest)
        time_error = late / duration
    # where the clock could not be inverted, all that is known of beta is that it lies within the panel
    error = np.where(converged, error, np.abs(x[:, -1] - x[:, 0]))
    rounding = EPS / 2 * pieces.local.weight(np.abs(x).max(axis=1)) * pace.max(axis=1) ** 2
    calls = np.full(near.size, 2 * points.nodes.size)
    return Panels(pieces.arc, pieces.rank, duration, series, fastest, error, time_error, rounding, calls)


def _times(pieces: Pieces, near: Array, far: Array, points: Basis) -> Panels:
    """The panels between `near` and `far` in u, (P,), with their durations and no more."""
    middle, half = ((near + far) / 2)[:, None], ((far - near) / 2)[:, None]
    u = middle + half * points.nodes
    x = pieces.displacement(u)
    pace, _ = pieces.pace(u, x)
    clock = (np.abs(half) * pace) @ points.analyse @ points.integrate
    duration = clock.sum(axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        time_error = np.abs(clock[:, -3:]).max(axis=1) / duration
    none = np.zeros(near.size)
    beta = (pieces.base + x[:, -1])[:, None, None]
    calls = np.full(near.size, points.nodes.size)
    return Panels(pieces.arc, pieces.rank, duration, beta, none, none, time_error, none, calls)


def _inverted(clock: Array, rate: Array, duration: Array, points: Basis) -> tuple[Array, Booleans]:
    """Where in [-1, 1] the clock shows the nodes' shares of the duration, (P, n); whether Newton converged."""
    nodes = points.nodes
    wanted = duration[:, None] * ((1 + nodes) / 2)
    both = np.zeros((duration.size, 2, clock.shape[1]))
    both[:, 0], both[:, 1, :-1] = clock, rate
    shown = both @ points.values
    at = np.empty(wanted.shape)
    at[:, 0], at[:, -1] = -1, 1
    with np.errstate(invalid="ignore", divide="ignore"):
        # from the clock at the nodes themselves, corrected for the change of pace between the two
        early = (wanted - shown[:, 0]) / shown[:, 1]
        change = (rate @ points.differentiate) / shown[:, 1]
        guess = nodes + early * (1 - 0.5 * change * early)
    at[:, 1:-1] = np.clip(guess[:, 1:-1], -1, 1)
    step = np.full((duration.size, 1), np.inf)
    for _ in range(_NEWTON):
        shown = np.einsum("pcn,npk->cpk", both, polynomials(at[:, 1:-1], both.shape[2]))
        with np.errstate(invalid="ignore", divide="ignore"):
            step = (shown[0] - wanted[:, 1:-1]) / shown[1]
        at[:, 1:-1] = np.clip(at[:, 1:-1] - step, -1, 1)
        if not np.abs(step).max(initial=0.0) > 1e-8:  # the next step is its square
            break
    return at, np.abs(step).max(axis=1, initial=0.0) < 1e-7
