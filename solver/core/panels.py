"""What the calls for quadrature over orbits share: the library, how panels are cut, and their nodes, as in panels.h."""

import ctypes
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from ..numerics.chebyshev import Basis, basis
from .library import address, library, widest

_NO_MEMORY = 1


class _Points(ctypes.Structure):
    """`points` in panels.h."""

    _fields_ = [("n", ctypes.c_int64)] + [(n, ctypes.c_void_p) for n in ("nodes", "analyse", "values", "differentiate")]


class _Cutting(ctypes.Structure):
    """`cutting` in panels.h."""

    _fields_ = [(name, ctypes.c_double) for name in ("length", "goal", "stretch")]
    _fields_ += [("times_only", ctypes.c_int), ("lanes", ctypes.c_int)]
    _fields_ += [("relative", ctypes.c_int)]


class Cutting(NamedTuple):
    """How panels are cut: see `orbit.panels.panelled`. lanes: numbers computed at once, 0 for as many as there can be;
    their number changes no bit. relative: whether series of beta count from the angles of their pieces, and not from 0;
    those of alpha, z and the swirl then have no meaning."""

    length: float
    goal: float
    stretch: float
    lanes: int = 0
    relative: bool = False


@cache
def _points(n: int) -> tuple[_Points, Any]:
    """The nodes of panels and the maps on them, and the arrays that hold them."""
    one: Basis = basis(n)
    kept = [np.ascontiguousarray(a) for a in (one.nodes, one.analyse, one.values, one.differentiate)]
    return _Points(n, *(address(a) for a in kept)), kept


def points(n: int) -> Any:
    """The nodes of panels, as an argument of the core."""
    return ctypes.byref(_points(n)[0])


def cut(cutting: Cutting, times_only: bool) -> Any:
    """How panels are cut, as an argument of the core."""
    length, goal, stretch, lanes, relative = cutting
    return ctypes.byref(_Cutting(length, goal, stretch, int(times_only), lanes or widest(), int(relative)))


@cache
def functions() -> Any:
    """The library with the types of what its functions return."""
    core = library()
    core.rod_orbits.restype = ctypes.c_void_p
    for one in (core.rod_orbits_fetch, core.rod_orbits_read, core.rod_orbits_action, core.rod_series_read):
        one.restype = None
    core.rod_fall.restype = ctypes.c_double
    core.rod_fall.argtypes = [ctypes.c_double] * 5 + [ctypes.c_int]
    return core


def fine(status: int) -> bool:
    """Whether a function of the core could do its work."""
    if status == _NO_MEMORY:
        raise MemoryError
    return status == 0
