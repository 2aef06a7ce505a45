"""The Morse index of a shape on nodes, by the inertia of the second derivatives of its action."""

from collections.abc import Sequence

import numpy as np

from ..core.weight_friction import HALF, count_negatives
from ..numerics.arrays import Array
from .banded_newton import march_of
from .loaded_rod import ALPHA, BETA, MU, PHI, ROUND, SHORT, SPEED, LoadedRod, Q
from .varying_shapes import Shape


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


def springs_of(shape: Shape, strength: float) -> Array:
    """Springs at the nodes (N, 2), as much on each length, in the scales of beta and alpha."""
    width, T = np.gradient(shape.t), shape.rod.time
    return np.asarray(strength * width[:, None] / np.array([T**2, T**4]))
