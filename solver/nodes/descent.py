"""How far a shape is from being stable, and the stable shape to which a rod falls from one that is not."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..core.varying_loads import HALF, count_negatives
from ..numerics.arrays import ROUGHLY, Array
from ..numerics.roots import REACH
from .loaded_rod import ALPHA, BETA, MU, PHI, ROUND, SHORT, SPEED, LoadedRod, Q
from .newton import correct, largest_turn, march_of
from .varying_shapes import Shape
from .weak_modes import weakest_modes


def _index_by_inertia(rod: LoadedRod, transfer: Array, scale: Array, stiffness: Array | None = None) -> int:
    """The negative eigenvalues of the Hessian of the action, from the transfer matrices (N, 8, 8) of the stretches.

    The action over nodes is the sum of p' q' - W(q, p') over the stretches, where W generates the map of a stretch from
    (q, p) to (q', p'), with q = (beta, alpha, z, gamma) and p = (beta_t, lam, phi, mu). Its second derivatives exist on
    any stretch shorter than a conjugate distance, also where a height or a rotation does not change. Eliminating the p,
    of which each stretch has four, leaves the energy with its constraints: the index is the number of negative
    eigenvalues less that of the p. stiffness: (N + 1, 2), springs at the nodes.
    """
    N = transfer.shape[0]
    S, P = scale[[BETA, ALPHA, SHORT, ROUND]], scale[[SPEED, Q, PHI, MU]]
    free = np.array(["beta0" not in rod.held, False, False, False])
    held = np.array([name in rod.held for name in ("betaL", "azimuth", "height", "rotation")])
    springs = np.zeros((N + 1, HALF))
    if stiffness is not None:
        springs[:, :2] = stiffness * S[:2] ** 2
    unit = np.concatenate([S, P])
    return count_negatives(transfer, unit, springs, free, held) - HALF * (N - 1) - int(held.sum())


# of the scales: a correction that is enough on the way, and in a fall. x10: a fall ends beside a saddle
LOOSE, FLUID = 1e-4, 1e-2
# springs: weakest, at first, strongest, change. x10: small steps, and more of them; a change x10 is undone as often as
# it is made
WEAKEST, FIRST, FIRMEST, FACTOR = 1e-7, 1e-2, 1e6, 3.0
KICK = 0.1  # of the angles, in their scales: a push. x10: past the shape below, to another
# how much weaker the springs are when a shape without them is tried; steps of an easy correction. x10: tried late,
# which takes more steps; springs are weakened too soon
EASY, QUICK = 5.0, 4
# steps of a fall; of a long rod; nodes times steps: about three seconds. x10: half a minute before a fall is given up
ROUNDS, LEAST, WORK = 600, 50, 80_000


def index_at(shape: Shape) -> int:
    """The Morse index of a shape."""
    return indices_with_springs(shape, ())[0]


def indices_with_springs(shape: Shape, strengths: Sequence[float]) -> list[int]:
    """The Morse index of a shape alone, and where springs of each strength hold it."""
    shape = fine_shape(shape)
    springs = [None, *(springs_of(shape, strength) for strength in strengths)]
    transfer = march_of(shape)[1]
    return [_index_by_inertia(shape.rod, transfer, shape.rod.scale, spring) for spring in springs]


def fine_shape(shape: Shape) -> Shape:
    """A shape with stretches so short that none holds a conjugate distance: the index counts by stretches.

    The loads alone set the nodes; in a rod that goes far round, beta turns faster.
    """
    t = fine_nodes(shape)
    return shape if t.size == shape.t.size else on_nodes(shape, t)


def fine_nodes(shape: Shape) -> Array:
    """The nodes of `fine_shape`; those of the shape itself where its loads are not finite."""
    parts = np.ceil(np.diff(shape.t) * change_rates(shape)).clip(1)
    if not np.isfinite(parts).all():
        return shape.t
    return np.interp(np.arange(parts.sum() + 1), np.append(0, np.cumsum(parts)), shape.t)


def change_rates(shape: Shape) -> Array:
    """A bound of the root of |H'| on each stretch of a shape, (N - 1,)."""
    y, width = shape.y, np.diff(shape.t)
    sin = np.maximum(np.abs(np.sin(y[1:, BETA])), np.abs(np.sin(y[:-1, BETA])))
    sin = np.minimum(1, sin + width * np.maximum(np.abs(y[1:, SPEED]), np.abs(y[:-1, SPEED])))
    loads = np.maximum(np.abs(y[1:]), np.abs(y[:-1]))
    return np.asarray(np.sqrt(loads[:, PHI] + (loads[:, Q] + 5 * loads[:, MU] + 6 * sin) * sin))


def on_nodes(shape: Shape, t: Array) -> Shape:
    """A shape, read at other nodes."""
    return shape_like(shape.rod, shape, t)


def shape_like(rod: LoadedRod, shape: Shape, t: Array) -> Shape:
    """A shape of one rod as a guess of that of another rod on nodes t, at equal shares of their spans."""
    return Shape(rod, t, shape.at(t * (shape.t[-1] / rod.span)))


def index_of_any(shape: Shape) -> int:
    """The Morse index of a shape; 0 with friction, which has none."""
    return 0 if shape.rod.has_friction else index_at(shape)


def is_near(shape: Shape, other: Shape) -> bool:
    """Whether no angle changed so much that it may be another branch."""
    scale = shape.rod.scale
    return largest_turn((other.y - shape.y) / scale) < 0.5 + largest_turn(shape.y / scale)


def springs_of(shape: Shape, strength: float) -> Array:
    """Springs at the nodes (N, 2), as much on each length, in the scales of beta and alpha."""
    width, T = np.gradient(shape.t), shape.rod.time
    return np.asarray(strength * width[:, None] / np.array([T**2, T**4]))


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
