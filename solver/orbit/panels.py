"""Short stretches of a course on which beta and the developed curve are Chebyshev series in time."""

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..numerics.arrays import Array
from ..numerics.chebyshev import Basis, polynomials
from ..problem.reduced import Reduced
from .pieces import Arcs, Pieces

EPS = 2.0**-52
MOST = 10_000  # panels made for one orbit: beyond it none is halved any more
_ROUNDS = 14  # how often a panel may be halved
_PATIENCE, _CROWD = 3, 16  # after so many halvings, of so many panels of a course, there is no more to gain
_LINGERS = 1e4
_LONG = 8.0  # in u: a piece longer than this is stretched along a saddle
_NEWTON = 12
_BLOCK = 512  # panels worked on at once


@dataclass(frozen=True, eq=False)
class Panels:
    """P panels in order of part and of time away from the start.

    part: 2 b for the forward course of problem b, 2 b + 1 for the backward one. rank: of its piece. duration: (P,).
    series: (P, 5, n + 1), of beta, |beta_t|, alpha, z and the swirl (the integral of sin cos), the last three from the
    panel's near end. fastest: largest |beta_t|; slack: what the cut series leave out of beta; drift: the same for the
    duration, as a share of it; noise: what the rounding of G leaves out of it, as a share; all (P,). calls:
    evaluations, (P,).
    """

    arc: NDArray[np.int64]
    rank: NDArray[np.int64]
    duration: Array
    series: Array
    fastest: Array
    slack: Array
    drift: Array
    noise: Array
    calls: NDArray[np.int64]

    def take(self, index: Any) -> "Panels":
        return Panels(**{f.name: getattr(self, f.name)[index] for f in fields(self)})


def panelled(
    problem: Reduced,
    way: Arcs,
    points: Basis,
    length: float,
    goal: float,
    times_only: bool = False,
    stretch: float = 1.0,
) -> Panels:
    """Panels of about `length` in u, halved until their series end below `goal` (of beta, and of repeated time).

    stretch: how much longer panels begin on pieces long in u, most of which lie next to a saddle, where all is smooth.
    times_only: the durations are wanted and no shape; the series then hold beta at the far end alone, (P, 1, 1).
    """
    assert problem.dbeta0 is not None
    pieces = way.pieces
    wide = np.abs(pieces.u1 - pieces.u0)
    wide = np.where(np.isfinite(wide), wide, 0.0)  # what no float can describe is one panel without a number: refused
    share = np.maximum(np.ceil(wide / np.where(wide > _LONG, stretch * length, length)), 1).astype(np.int64)
    piece = np.repeat(np.arange(share.size), share)
    k = np.arange(piece.size) - np.repeat(np.cumsum(share) - share, share)
    step = ((pieces.u1 - pieces.u0) / share)[piece]
    near, far = (
        pieces.u0[piece] + k * step,
        np.where(k + 1 == share[piece], pieces.u1[piece], pieces.u0[piece] + (k + 1) * step),
    )
    order = k.astype(float)
    # a late start of the phase is repeated all along the rod
    fastest = np.sqrt(
        problem.dbeta0**2 + 4 * (2 * np.abs(problem.lam) + 2 * np.abs(problem.phi) + np.abs(problem.mu) + 1)
    )
    repeats = np.maximum(1, problem.span * fastest)
    leads = np.diff(pieces.arc, prepend=-1) != 0
    done: list[tuple[Any, Array, Panels]] = []
    made = np.zeros(problem.size, dtype=np.int64)
    for round_ in range(_ROUNDS + 1):
        batch = pieces.take(piece)
        with np.errstate(over="ignore", invalid="ignore"):  # told by the slack
            panels = _in_blocks(batch, near, far, points, _times if times_only else _series)
        enough = (panels.slack <= max(goal, 20 * EPS)) & (
            panels.drift <= np.maximum(goal / repeats[batch.arc // 2], 40 * EPS)
        )
        # a rod that ends long before its first panel needs a shorter one: sums over the long one would swamp its own
        span = problem.span[batch.arc // 2]
        lingers = (order == 0) & leads[piece] & (panels.duration > _LINGERS * np.maximum(1, span))
        enough &= ~lingers
        # panels beside a singularity are few; many that halving does not help are at the end of what rounding allows
        left = np.bincount(batch.arc[~enough], minlength=2 * problem.size)
        made = made + np.bincount(batch.arc // 2, minlength=problem.size)
        spent = (round_ >= _PATIENCE) & (left[batch.arc] > _CROWD) | (round_ == _ROUNDS) | ~np.isfinite(panels.slack)
        enough |= spent | (made > MOST)[batch.arc // 2]
        done.append((piece[enough], order[enough], panels.take(enough)))
        if enough.all():
            break
        with np.errstate(divide="ignore", over="ignore"):
            cut = np.repeat(np.where(lingers, np.minimum(4 * span / panels.duration, 0.5), 0.5)[~enough], 2)
        piece, near, far, order = (np.repeat(v[~enough], 2) for v in (piece, near, far, order))
        middle = near + cut * (far - near)
        second = np.arange(piece.size) % 2 == 1
        near, far = np.where(second, middle, near), np.where(second, far, middle)
        order = order + np.where(second, 0.5 ** (round_ + 1), 0)
    if len(done) == 1:
        return done[0][2]
    place = np.lexsort((np.concatenate([d[1] for d in done]), np.concatenate([d[0] for d in done])))
    return joined([d[2] for d in done]).take(place)


def running(values: Array, first: Any, count: Any) -> Array:
    """Sums of the values (P, k) before each panel within its part: added part by part, so that none sees another's."""
    part = np.repeat(np.arange(count.size), count)
    rank = np.arange(part.size) - first[part]
    table = np.zeros((count.size, int(count.max(initial=0)) + 1, values.shape[1]))
    table[part, rank + 1] = values
    return np.cumsum(table, axis=1)[part, rank]


def _in_blocks(pieces: Pieces, near: Array, far: Array, points: Basis, made: Callable[..., Panels]) -> Panels:
    """`made` of few enough panels at a time for what it works on to stay in the cache."""
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
    at, met = _inverted(clock, rate, duration, points)
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
        slack = np.maximum(tail[:, [0, 2, 3]].max(axis=1), late * fastest)
        drift = late / duration
    # where the clock could not be inverted, beta is known to lie within the panel and no better
    slack = np.where(met, slack, np.abs(x[:, -1] - x[:, 0]))
    noise = EPS / 2 * pieces.well.weight(np.abs(x).max(axis=1)) * pace.max(axis=1) ** 2
    calls = np.full(near.size, 2 * points.nodes.size)
    return Panels(
        pieces.arc,
        pieces.rank,
        duration,
        series,
        fastest,
        slack,
        drift,
        noise,
        calls,
    )


def _times(pieces: Pieces, near: Array, far: Array, points: Basis) -> Panels:
    """The panels between `near` and `far` in u, (P,), with their durations and no more."""
    middle, half = ((near + far) / 2)[:, None], ((far - near) / 2)[:, None]
    u = middle + half * points.nodes
    x = pieces.displacement(u)
    pace, _ = pieces.pace(u, x)
    clock = (np.abs(half) * pace) @ points.analyse @ points.integrate
    duration = clock.sum(axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        drift = np.abs(clock[:, -3:]).max(axis=1) / duration
    none = np.zeros(near.size)
    beta = (pieces.base + x[:, -1])[:, None, None]
    calls = np.full(near.size, points.nodes.size)
    return Panels(pieces.arc, pieces.rank, duration, beta, none, none, drift, none, calls)


def _inverted(clock: Array, rate: Array, duration: Array, points: Basis) -> tuple[Array, NDArray[np.bool_]]:
    """Where in [-1, 1] the clock shows the nodes' shares of the duration, (P, n), and whether Newton's rule met."""
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
