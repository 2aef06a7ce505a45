"""The stable shape to which a rod falls from one that is not."""

from dataclasses import replace

import numpy as np

from ..numerics.arrays import ROUGHLY, Array
from ..numerics.roots import REACH
from .banded_newton import correct, largest_turn
from .shape_index import index_at, indices_with_springs, springs_of
from .varying_shapes import Shape
from .weak_modes import weakest_modes

FLUID = 1e-2  # of the scales: a correction that is enough in a fall. x10: it ends beside a saddle
# springs: weakest, at first, strongest, change. x10: small steps, and more of them; a change x10 is undone as often as
# it is made
WEAKEST, FIRST, FIRMEST, FACTOR = 1e-7, 1e-2, 1e6, 3.0
KICK = 0.1  # of the angles, in their scales: a push. x10: past the shape below, to another
# how much weaker the springs are when a shape without them is tried; steps of an easy correction. x10: tried late,
# which takes more steps; springs are weakened too soon
EASY, QUICK = 5.0, 4
# steps of a fall; of a long rod; nodes times steps: about three seconds. x10: half a minute before a fall is given up
ROUNDS, LEAST, WORK = 600, 50, 80_000


def is_near(shape: Shape, other: Shape) -> bool:
    """Whether no angle changed so much that it may be another branch."""
    scale = shape.rod.scale
    return largest_turn((other.y - shape.y) / scale) < 0.5 + largest_turn(shape.y / scale)


def descend(shape: Shape, change: Array | None = None) -> Shape | None:
    """The stable equilibrium to which a shape falls as if through a viscous fluid; None where it reaches none.

    Springs at the nodes hold each shape near the one before it. Their strength keeps the steps short and the held shape
    stable, so that each step lowers the energy. At a shape that does not move and is not stable the rod is pushed along
    its weakest mode. A rod with friction has no energy, and none is sought.
    """
    if shape.rod.has_friction:
        return None
    strength, tried, eased = FIRST, FIRST, False
    y = shape.y + (KICK * weakest_modes(shape)[0] if change is None else change)
    for _ in range(int(np.clip(WORK / shape.t.size, LEAST, ROUNDS))):
        now = replace(shape, y=y)
        ahead = correct(now, y, springs_of(now, strength), most=6, enough=FLUID)
        moved = np.inf if ahead is None else largest_turn((ahead.y - y) / shape.rod.scale)
        index, held = (1, 1) if ahead is None or moved > REACH else indices_with_springs(ahead, (strength,))
        if ahead is None or held > 0:
            strength, eased = strength * FACTOR, False
            if strength > FIRMEST:
                return None
            continue
        y = ahead.y
        if index == 0 and strength <= tried / EASY:
            tried = strength
            free = correct(ahead, most=12)
            if free is not None and is_near(ahead, free) and index_at(free) == 0:
                return free
        if index > 0:
            tried = FIRST
        if eased and ahead.steps <= QUICK:
            strength = max(WEAKEST, strength / FACTOR)
        eased = True
        if moved < ROUGHLY and index > 0:
            y = y + KICK * weakest_modes(ahead)[0]
    return None
