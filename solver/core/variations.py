"""Variations of orbits by the compiled core: `variations.c`."""

import ctypes
from typing import Any

import numpy as np

from ..numerics.arrays import Array
from .library import address
from .orbits import reading
from .panels import fine, functions, points

_PAIRS, _SERIES = 10, 19  # elements of M that are kept; series of a panel
KEPT = ("v", "H", "c", "shift", "gamma", "M", "jump", "closing", "series", "gain")


class _Kept(ctypes.Structure):
    """`kept` in variations.c."""

    _fields_ = [(name, ctypes.c_void_p) for name in KEPT]


def variations(orbit: Any, origin: Array) -> dict[str, Array]:
    """The arrays of `orbit.variations.Variations` and of its nodes, by their names.

    orbit: B orbits, none of them a helix, whose series of beta count from angles; origin: (P,), these, without whole
    turns.
    """
    problem, (of, kept), n = orbit.problem, reading(orbit), orbit.panels.series.shape[2] - 1
    P, B = origin.size, problem.size
    loads, origin = np.stack([problem.lam, problem.mu, problem.phi], axis=1), np.ascontiguousarray(origin)
    shapes = (P, n), (P, n), (P,), (P, 3), (P, 3, n), (P, _PAIRS, n), (P, _PAIRS), (2 * B, _PAIRS)
    out = dict(zip(KEPT, map(np.empty, (*shapes, (P, _SERIES, n + 1), (B, 2, _PAIRS))), strict=True))
    fine(functions().rod_variations(
        ctypes.c_int64(B), address(loads), ctypes.byref(of), address(origin), points(n),
        ctypes.byref(_Kept(*(address(a) for a in out.values()))),
    ))  # fmt: skip
    del kept
    return out
