"""The arcs of an orbit: from its start forward and backward to the turning points, cut at every extremum of G."""

from dataclasses import dataclass

import numpy as np

from ..mechanics.potential import TAU
from ..numerics.arrays import Array, Integers
from .pieces import Pieces


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
