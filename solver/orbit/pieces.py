"""The arcs of an orbit, cut into monotone pieces of G, each with a variable in which time is smooth: eq. (36).

The arcs lead from the start forward and backward to the turning points. On each piece one change of variables makes
dt/du smooth however near a saddle the orbit passes: x = a sinh(u) over a saddle that the orbit passes, x = x1 cosh(u)
where it turns before the saddle, x = x1 sin(u) where it turns nearer the centre. x is the distance from that saddle or
centre. The core makes them (arcs.c).
"""

from dataclasses import dataclass

import numpy as np

from ..mechanics.potential import TAU
from ..numerics.arrays import Array, Integers

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
        """The pieces that the core made, (P, 17): see `rod_orbits_fetch`."""
        arc, rank, kind = table[:, :3].T.astype(np.int64)
        base, _, u0, u1, *_ = table[:, 3:].T
        origin, level, s, c, _, double, fixed = table[:, 10:].T
        bend = fixed - 2 * double + c * c * (s * s + s * (2 * s + 3 * s))
        return cls(arc, rank, kind, base, origin, u0, u1, level, bend)


@dataclass(frozen=True, eq=False)
class Arcs:
    """The arcs of B orbits. kind: (B,), HELIX, LIBRATION or ROTATION; direction: (B,), sign of beta_t after the start.

    A libration has a forward and a backward arc, from its start to the turning points; together they are half a period.
    A rotation has a forward arc only, one whole turn. A helix has none.
    """

    kind: Integers
    direction: Array
    pieces: Pieces


def apart(a: Array, b: Array) -> Array:
    """a - b moved into [-pi, pi), of angles in [-pi, pi); exact where they are neighbours across the cut at pi."""
    x = a - b
    return np.where(x >= np.pi, (a - TAU) - b, np.where(x < -np.pi, (a + TAU) - b, x))
