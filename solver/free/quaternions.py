"""Quaternions (w, x, y, z) as the last axis, and the frames that they stand for.

A frame is D1, D2, D3; D3 is the tangent, and D1 = -d1, D2 = -d2 of `orbits.frames.material`, so that the frame of a
rod along the axis, at azimuth 0 and not rotated, is the identity.
"""

import numpy as np

from ..numerics.arrays import Array

_CONJUGATE = np.array([1, -1, -1, -1])
# the components of a b are a @ _PRODUCT[k] @ b: 1, i, j, k are multiplied as two bits are added, but for signs
_PRODUCT = np.where(
    np.bitwise_xor.outer(range(4), range(4)) == np.arange(4)[:, None, None],
    np.array([[1, 1, 1, 1], [1, -1, 1, -1], [1, -1, -1, 1], [1, 1, -1, -1]]),
    0.0,
)
BILINEAR = (_PRODUCT * _CONJUGATE[:, None])[1:]  # the imaginary parts of conj(a) b are a @ BILINEAR[i] @ b
BY_FIRST, BY_SECOND = np.moveaxis(BILINEAR, 1, 0).copy(), np.moveaxis(BILINEAR, 2, 0).copy()  # of a, of b
# the components of the three directors are q @ _ROTATION[d, i] @ q, those of D3 q @ QUADRATIC[i] @ q
_ROTATION = np.einsum("ikm,jkd->dijm", _PRODUCT[1:] * _CONJUGATE, np.swapaxes(_PRODUCT, 0, 1)[..., 1:])
QUADRATIC = _ROTATION[2]
BY_FRAME = np.moveaxis(QUADRATIC, 1, 0).copy()
_PAIRS = tuple(np.moveaxis(table, (-2, -1), (0, 1)).reshape(16, -1) for table in (_PRODUCT, _ROTATION))


def contract(vectors: Array, table: Array) -> Array:
    """Sums over the last axis of vectors (n, k) and the first one of a table (k, a, b), (n, a, b): einsum is slow."""
    return np.asarray((vectors @ table.reshape(table.shape[0], -1)).reshape(-1, *table.shape[1:]))


def _pairs(a: Array, b: Array) -> Array:
    """The products of all components of a and of b, (..., 16)."""
    pairs = a[..., :, None] * b[..., None, :]
    return pairs.reshape(*pairs.shape[:-2], 16)


def product(a: Array, b: Array) -> Array:
    """The quaternion a b, (..., 4)."""
    return np.asarray(_pairs(a, b) @ _PAIRS[0])


def directors(q: Array) -> Array:
    """The directors D1, D2, D3 of frames as rows, (..., 3, 3)."""
    return np.asarray((_pairs(q, q) @ _PAIRS[1]).reshape(*q.shape[:-1], 3, 3))


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
    by_one = np.eye(4, dtype=int)
    by_two = by_one[:, None] + by_one
    return joined[0, 0, 0, 0], joined[tuple(by_one.T)], joined[tuple(np.moveaxis(by_two, -1, 0))]
