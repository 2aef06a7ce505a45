"""Newton's method for a rod on nodes: each stretch is marched with its variations, and the system is banded."""

from dataclasses import dataclass

import numpy as np

from ..core.banded import solve_band
from ..core.varying_loads import BY_STATE, SIZE, march
from ..numerics.arrays import Array
from .loaded_rod import ALPHA, BETA, MU, PHI, ROUND, SHORT, SPEED, LoadedRod, Q

HALF = SIZE // 2
WIDTH = SIZE + HALF - 1  # of the band, on each side of the diagonal
MOST_STEPS = 40
ROUNDING = 1e-12  # of the scales: a correction below this is rounding


@dataclass(frozen=True, eq=False)
class Shape:
    """A rod on nodes. t: (N,). y: (N, 8), states at the nodes. steps: those of Newton that were taken."""

    rod: LoadedRod
    t: Array
    y: Array
    steps: int = 0


@dataclass(frozen=True, eq=False)
class Linear:
    """The equations at a shape, scaled.

    band: by rows, as of `core.banded`. open: (8 N,), what is left open at the start, by the stretches and at the far
    end. transfer: (N - 1, 8, 8), of the stretches.
    """

    band: Array
    open: Array
    transfer: Array


def march_of(shape: Shape, shorter: float = 1.0) -> tuple[Array, Array]:
    """The ends (N, 8) of the stretches and their transfer matrices (N, 8, 8): heights and rotations only add."""
    rod = shape.rod
    found = march(rod.numbers, rod.scale, shape.y[:-1], np.diff(shape.t), BY_STATE, shorter=shorter)
    columns = found.columns
    whole = np.zeros((columns.shape[0], SIZE, SIZE))
    whole[:, :, :BY_STATE] = columns
    whole[:, SHORT, SHORT] = whole[:, ROUND, ROUND] = 1
    return found.end, whole


def linear_at(
    shape: Shape, anchor: Array | None = None, stiffness: Array | None = None, shorter: float = 1.0
) -> Linear:
    """The equations of a shape and their derivatives, scaled.

    anchor, stiffness: (N, 8) and (N, 2): springs at the nodes that pull beta and alpha towards those of the anchor.
    """
    rod, N = shape.rod, shape.t.size - 1
    pulled, transfer = march_of(shape, shorter)
    after = np.tile(np.eye(SIZE), (N, 1, 1))
    if stiffness is not None and anchor is not None:
        for k, (angle, moment) in enumerate(((BETA, SPEED), (ALPHA, Q))):
            after[:-1, moment, angle] -= stiffness[1:-1, k]
            pulled[:-1, moment] += stiffness[1:-1, k] * (shape.y[1:-1, angle] - anchor[1:-1, angle])
    start, _, end, _ = rod.conditions()
    band = np.zeros((SIZE * (N + 1), 3 * WIDTH + 1))
    scale = rod.scale
    put(band, 0, 0, (start * scale)[None])
    put(band, HALF, 0, -transfer * scale / scale[:, None])
    put(band, HALF, SIZE, after * scale / scale[:, None])
    put(band, SIZE * N + HALF, SIZE * N, (end * scale)[None])
    return Linear(band, left_open(shape, pulled), transfer)


def left_open(shape: Shape, after: Array) -> Array:
    """What is open, (8 N,), where the stretches end in the states `after` (N - 1, 8)."""
    start, near, end, far = shape.rod.conditions()
    gap = (shape.y[1:] - after) / shape.rod.scale
    return np.concatenate([start @ shape.y[0] - near, gap.reshape(-1), end @ shape.y[-1] - far])


def open_at(shape: Shape) -> Array:
    """What is left open in the equations of a shape, scaled, as of `Linear`."""
    return left_open(shape, march(shape.rod.numbers, shape.rod.scale, shape.y[:-1], np.diff(shape.t)).end)


def put(band: Array, row: int, column: int, blocks: Array) -> None:
    """Write blocks (K, m, 8), each SIZE rows and columns after the one before, into the band matrix by rows."""
    K, m, n = blocks.shape
    for i in range(m):
        first = WIDTH + column - row - i
        band[row + i : row + i + SIZE * K : SIZE, first : first + n][:K] = blocks[:, i]


def with_known_loads(rod: LoadedRod, t: Array, y: Array) -> Array:
    """The states with the loads that are given and vary in a known way, without the rounding of a solved system."""
    y = y.copy()
    if not rod.rubbed and "rotation" not in rod.held:
        y[:, MU] = rod.far[3]
    if not rod.rubbed and "height" not in rod.held:
        y[:, PHI] = rod.far[2] - rod.along * (rod.span - t)
    return y


def correct(
    shape: Shape,
    anchor: Array | None = None,
    stiffness: Array | None = None,
    reach: float = 0.5,
    most: int = MOST_STEPS,
    enough: float = ROUNDING,
) -> Shape | None:
    """The equilibrium that Newton's method reaches from a shape; None where it reaches none.

    reach: the longest step of the angles, in their scales; steps are shortened to it. enough: a correction, in
    the scales, that ends the steps; Newton's next one would be about its square.
    """
    y, scale, best = shape.y, shape.rod.scale, np.inf
    for count in range(1, most + 1):
        now = Shape(shape.rod, shape.t, y)
        linear = linear_at(now, anchor, stiffness)
        if not np.isfinite(linear.open).all():
            return None
        found = solve_band(linear.band, linear.open)
        if found is None:
            return None
        step = found.reshape(y.shape)
        size = float(np.abs(step[:, [BETA, ALPHA]]).max())
        if not np.isfinite(size):
            return None
        y = y - step * scale * min(1.0, reach / size if size else 1.0)
        whole = float(np.abs(step[:, :PHI]).max())
        if whole < enough or (whole < 1e-7 and whole > best / 4):
            return Shape(shape.rod, shape.t, with_known_loads(shape.rod, shape.t, y), count)
        best = min(best, whole)
    return None


__all__ = ["Linear", "Shape", "correct", "linear_at", "march_of", "open_at", "with_known_loads"]
