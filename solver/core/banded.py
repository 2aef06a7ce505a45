"""Compiled linear algebra of a chain of stretches: `banded.c` on NumPy arrays."""

import ctypes

import numpy as np

from ..numerics.arrays import Array, Booleans
from .library import begin_of, function

_INT, _AT = ctypes.c_int64, ctypes.c_void_p


def solve_chain(
    transfer: Array, scale: Array, start: Array, end: Array, stiffness: Array | None, right: Array
) -> Array | None:
    """The scaled changes (8 (N + 1), m) for right sides (8 (N + 1), m); None where the equations are singular.

    transfer: (N, 8, 8), of the stretches. scale: (8,), of the states. start, end: (4, 8), rows of the conditions.
    stiffness: (N + 1, 2), of springs at the nodes, or None.
    """
    found = np.array(right, dtype=float, order="C")
    blocks = [np.ascontiguousarray(v, dtype=float) for v in (transfer, scale, start, end)]
    springs = None if stiffness is None else np.ascontiguousarray(stiffness, dtype=float)
    call = function("rod_solve_chain", ctypes.c_int, _INT, *5 * [_AT], _INT, _AT)
    at = [begin_of(v) for v in blocks], None if springs is None else begin_of(springs)
    failed = call(transfer.shape[0], *at[0], at[1], found.size // found.shape[0], begin_of(found))
    return None if failed else found


def count_negatives(transfer: Array, unit: Array, springs: Array, free: Booleans, held: Booleans) -> int:
    """The number of negative eigenvalues of the Hessian of an action over nodes; `rod_negatives` says of which."""
    call = function("rod_negatives", _INT, _INT, *5 * [_AT])
    blocks = [np.ascontiguousarray(v, dtype=float) for v in (transfer, unit, springs)]
    flags = [np.ascontiguousarray(v, dtype=np.int64) for v in (free, held)]
    return int(call(transfer.shape[0], *(begin_of(v) for v in (*blocks, *flags))))
