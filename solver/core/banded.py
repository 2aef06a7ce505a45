"""Compiled linear algebra of a chain of stretches: `banded.c` on NumPy arrays."""

import ctypes

import numpy as np

from ..numerics.arrays import Array, Booleans
from .library import begin_of, function

_INT, _AT = ctypes.c_int64, ctypes.c_void_p


def solve_band(band: Array, right: Array) -> Array | None:
    """The solution (n, m) for right sides (n, m); None where the matrix is singular.

    band: (n, 3 w + 1), of which row i holds the columns i - w .. i + w, and w zeros.
    """
    band, found = band.copy(), np.array(right, dtype=float, order="C")
    call = function("rod_solve_band", ctypes.c_int, _INT, _INT, _AT, _INT, _AT)
    columns = found.size // band.shape[0]
    return None if call(band.shape[0], band.shape[1] // 3, begin_of(band), columns, begin_of(found)) else found


def count_negatives(
    qq: Array, qp: Array, pp: Array, unit: Array, springs: Array, free: Booleans, held: Booleans
) -> int:
    """The number of negative eigenvalues of the Hessian of an action over nodes; `rod_negatives` says of which."""
    call = function("rod_negatives", _INT, _INT, *7 * [_AT])
    blocks = [np.ascontiguousarray(v, dtype=float) for v in (qq, qp, pp, unit, springs)]
    flags = [np.ascontiguousarray(v, dtype=np.int64) for v in (free, held)]
    return int(call(qq.shape[0], *(begin_of(v) for v in (*blocks, *flags))))
