"""The arcs of an orbit, cut into monotone pieces of G, each with a variable in which time is smooth: eq. (36).

The arcs lead from the start forward and backward to the turning points. On each piece one change of variables makes
dt/du smooth however near a saddle the orbit passes: x = a sinh(u) over a saddle that the orbit passes, x = x1 cosh(u)
where it turns before the saddle, x = x1 sin(u) where it turns nearer the centre. x is the distance from that saddle or
centre. The core makes them (arcs.c), and cuts them into panels, on which beta and the developed curve are Chebyshev
series in time. A time on the orbit is folded into the two arcs: its phase.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..numerics.arrays import Array, Booleans, Columns, Integers

PASS, SADDLE, CENTRE = 0, 1, 2
HELIX, LIBRATION, ROTATION = 0, 1, 2


@dataclass(frozen=True, eq=False)
class Pieces:
    """P monotone pieces of arcs, in the order in which the orbit passes them away from its start, (P,) each.

    arc: 2 b for the forward arc of problem b, 2 b + 1 for the backward one. rank: 0 for the piece with the start, then
    counting away from it. kind: PASS, SADDLE or CENTRE. base: the angle from which x counts, with whole turns; origin:
    the same in [-pi, pi). u0, u1: the near and the far end in u. level: eta - G(origin). bend: -H'(origin).
    """

    arc: Integers
    rank: Integers
    kind: Integers
    base: Array
    origin: Array
    u0: Array
    u1: Array
    level: Array
    bend: Array

    @classmethod
    def from_core(cls, table: Array) -> "Pieces":
        """The pieces that the core made, (P, 9): see `rod_orbits_fetch`."""
        return cls(*table[:, :3].T.astype(np.int64), *table[:, 3:].T)


@dataclass(frozen=True, eq=False)
class Arcs:
    """The arcs of B orbits. kind: (B,), HELIX, LIBRATION or ROTATION; direction: (B,), sign of beta_t after the start.

    A libration has a forward and a backward arc, from its start to the turning points; together they are half a period.
    A rotation has a forward arc only, one whole turn. A helix has none.
    """

    kind: Integers
    direction: Array
    pieces: Pieces


MOST = 10_000  # panels of one orbit beyond which none is halved any more


@dataclass(frozen=True, eq=False)
class Panels(Columns):
    """P panels, in order of arc and of time away from the start.

    arc: (P,), 2 b for the forward arc of problem b, 2 b + 1 for the backward one. rank: (P,), of the panel's piece.
    duration: (P,). base: (P,), the angle of a critical point, with whole turns, from which beta counts on the panel:
    next to it beta has relative accuracy. origin: (P,), the same in [-pi, pi). series: (P, 5, n + 1), of beta - base,
    |beta_t|, alpha, z and the swirl (the integral of sin cos), the last three from the panel's near end. fastest: (P,),
    largest |beta_t|. error: (P,), what the truncated series leave out of beta. time_error: (P,), what they leave out of
    the duration, as a share of it. time_rounding: (P,), what the rounding of G changes of the duration, as a share.
    calls: (P,), evaluations of G.
    """

    arc: Integers
    rank: Integers
    duration: Array
    base: Array
    origin: Array
    series: Array
    fastest: Array
    error: Array
    time_error: Array
    time_rounding: Array
    calls: Integers


def running(values: Array, first: Any, count: Any) -> Array:
    """Sums of the values (P, k) before each panel within its part: added part by part, so that none sees another's."""
    part = np.repeat(np.arange(count.size), count)
    rank = np.arange(part.size) - first[part]
    table = np.zeros((count.size, int(count.max(initial=0)) + 1, values.shape[1]))
    table[part, rank + 1] = values
    return np.cumsum(table, axis=1)[part, rank]


@dataclass(frozen=True, eq=False)
class Phase:
    """Times t folded into the arcs of B orbits, (B, n) each.

    arc: 2 b or 2 b + 1, as in `Panels`. local: time along that arc, from the start of the orbit. mirrored: whether the
    orbit is on its way back along the arc. second: whether the arc is the backward one. periods: whole periods passed.
    folded: (B, 1), whether the orbit comes back at all, which a libration does.
    """

    t: Array
    arc: Integers
    local: Array
    mirrored: Booleans
    second: Booleans
    periods: Array
    folded: Booleans

    @property
    def turns(self) -> Array:
        """Turning points passed, (B, n); 0 where beta does not librate."""
        return np.where(self.folded, 2 * self.periods + self.second + self.mirrored, 0.0)


def phase_at(t: Array, kind: Any, ahead: Array, back: Array, period: Array) -> Phase:
    """The phases of t (B, n) on orbits whose arcs last ahead and back, (B,)."""
    ahead, back, period = ahead[:, None], back[:, None], period[:, None]
    with np.errstate(invalid="ignore"):
        rest = np.where(np.isfinite(period), np.fmod(t, period), t)
        periods = np.where(np.isfinite(period), np.round((t - rest) / period), 0.0)
    folded = (kind == LIBRATION)[:, None]
    second = folded & (rest > 2 * ahead)
    local = np.where(second, rest - 2 * ahead, rest)
    limit = np.where(second, back, ahead)
    mirrored = folded & (local > limit)
    local = np.where(mirrored, np.maximum(2 * limit - local, 0), local)
    arc = 2 * np.arange(t.shape[0])[:, None] + second
    return Phase(t, arc, local, mirrored, second, periods, folded)
