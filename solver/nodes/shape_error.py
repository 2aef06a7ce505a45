"""The estimated error of a shape on nodes, and its condition number."""

import numpy as np

from ..core.tuning import SAFETY
from ..core.weight_friction import HALF, SIZE
from ..numerics.arrays import SQUARE_LOST
from .banded_newton import linear_at
from .loaded_rod import ALPHA, BETA, SHORT
from .varying_shapes import Shape
from .weak_modes import largest_move

# steps of the second march, whose difference from the first estimates the error of an ends problem. x10: longer steps,
# whose error is not that of the answer: good ones are said to fail
SHORTER = 0.7
ROUNDING = 2e-16  # of a number and its condition: one rounding. x10: ends problems are said to have fewer digits


def estimate(shape: Shape) -> tuple[float, float]:
    """The error of a shape and its condition number, in radians.

    The error is what shorter steps of the series leave open, carried through the equations; where these are nearly
    singular, as at a fold, with the curvature that ends its growth.
    """
    scale, span = shape.rod.scale, max(1.0, shape.rod.span)
    linear = linear_at(shape, shorter=SHORTER)
    size = linear.open.size
    right = np.zeros((size, 3))
    right[:, 0] = linear.open
    right[0, 1] = right[size - HALF, 2] = 1
    change = linear.solve(right, soft=True)
    if change is None:
        return np.inf, np.inf
    moved = np.abs(change.reshape(-1, SIZE, 3)) * scale[:, None]
    off = moved[:, :, 0].max(axis=0)
    condition = max(1.0, float(moved[:, BETA, 1:].max() / scale[BETA]))
    error = float(SAFETY * max(off[BETA], off[ALPHA] / span, off[SHORT] / span) + ROUNDING * condition)
    # a larger error may be less than the equations say, which are linear
    return largest_move(shape, error) if SQUARE_LOST < error < np.inf else error, condition
