"""Quaternions (w, x, y, z) as the last axis, and the frames that they stand for.

A frame is D1, D2, D3; D3 is the tangent, and D1 = -d1, D2 = -d2 of `mechanics.frames.material`, so that the frame of a
rod along the axis, at azimuth 0 and not rotated, is the identity.
"""

from functools import lru_cache

import numpy as np

from ..numerics.arrays import Array

# the imaginary parts of conj(a) b are a @ BILINEAR[i] @ b
BILINEAR = np.array(
    [
        [[0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, -1], [0, 0, 1, 0]],
        [[0, 0, 1, 0], [0, 0, 0, 1], [-1, 0, 0, 0], [0, -1, 0, 0]],
        [[0, 0, 0, 1], [0, 0, -1, 0], [0, 1, 0, 0], [-1, 0, 0, 0]],
    ],
    dtype=float,
)
# the components of D3 are q @ QUADRATIC[i] @ q
QUADRATIC = np.array(
    [
        [[0, 0, 1, 0], [0, 0, 0, 1], [1, 0, 0, 0], [0, 1, 0, 0]],
        [[0, -1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1], [0, 0, 1, 0]],
        [[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1]],
    ],
    dtype=float,
)
_CONJUGATE = np.array([1.0, -1.0, -1.0, -1.0])
_PRODUCT = np.concatenate([np.diag(_CONJUGATE)[None], BILINEAR * _CONJUGATE[:, None]])  # of which a @ each @ b is a b
_ORDERS = np.eye(4, dtype=int)


def product(a: Array, b: Array) -> Array:
    """The quaternion a b, (..., 4)."""
    return np.einsum("...i,kij,...j->...k", a, _PRODUCT, b)


def directors(q: Array) -> Array:
    """The directors D1, D2, D3 of frames as rows, (..., 3, 3)."""
    w, x, y, z = np.moveaxis(q, -1, 0)
    rows = [
        [w * w + x * x - y * y - z * z, 2 * (x * y + w * z), 2 * (x * z - w * y)],
        [2 * (x * y - w * z), w * w - x * x + y * y - z * z, 2 * (y * z + w * x)],
        [2 * (x * z + w * y), 2 * (y * z - w * x), w * w - x * x - y * y + z * z],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


@lru_cache(maxsize=16)
def recall_end_frame(angles: tuple[float, ...], lead: tuple[float, ...]) -> tuple[Array, ...]:
    """The frame of `end_frame`, turned on by a small rotation [rad], and its derivatives; the last 16 are kept.

    The ends of a rod are asked for the frames of a few angles thousands of times. The arrays are read-only.
    """
    parts = tuple(product(part, np.array([1.0, *np.divide(lead, 2)])) for part in end_frame(np.array(angles)))
    for part in parts:
        part.flags.writeable = False
    return parts


def end_frame(angles: Array) -> tuple[Array, Array, Array]:
    """The frame with such azimuth, beta, tilt and rotation, and its first and second derivatives by them.

    angles: (4, ...). The frames: (..., 4), (4, ..., 4) and (4, 4, ..., 4): the last axis holds the quaternion.
    """
    angles = np.asarray(angles)
    factors = np.zeros((4, 3, *angles.shape[1:], 4))  # by angle and by order of the derivative
    turns = (3, 1.0), (1, -1.0), (2, 1.0), (3, 1.0)  # axis and sense of the azimuth, beta, the tilt, the rotation
    for factor, angle, (axis, sense) in zip(factors, angles, turns, strict=True):
        c, s = np.cos(angle / 2), sense * np.sin(angle / 2)
        factor[..., 0] = c, -s * sense / 2, -c / 4
        factor[..., axis] = s, c * sense / 2, -s / 4
    first, second = (product(factors[i][:, None], factors[i + 1]) for i in (0, 2))
    joined = product(first[:, :, None, None], second)
    by_one, by_two = _ORDERS, _ORDERS[:, None] + _ORDERS
    return joined[0, 0, 0, 0], joined[tuple(by_one.T)], joined[tuple(np.moveaxis(by_two, -1, 0))]
