"""Transit times between two end angles, levels of paths, and continuation by the compiled core: `transit_times.c`,
`continuation.c`."""

import ctypes
from typing import Any, NamedTuple

import numpy as np

from ..numerics.arrays import Array, Booleans, Integers
from .library import Cutting, address, cut, fine, functions, on_grid, points


class _Boundary(ctypes.Structure):
    """`boundary` in transit_times.c."""

    _fields_ = (
        [(name, ctypes.c_double) for name in ("lam", "mu", "phi", "span", "low", "high", "deepest")]
        + [(name, ctypes.c_int64) for name in ("whole_turns", "passed", "pins")]
        + [(name, ctypes.c_void_p) for name in ("pin", "falls")]
    )


def fall(problem: Any, pin: float, beta: float, extremum: bool) -> float:
    """G(pin) - G(beta) of one problem: see `levels.transit_times.fall`."""
    value: float = functions().rod_fall(problem.lam[0], problem.mu[0], problem.phi[0], pin, beta, extremum)
    return value


class _Search(NamedTuple):
    """What `rod_transit_times` and `rod_level_roots` are told of one ends problem; kept: the arrays behind it."""

    arguments: tuple[Any, ...]
    kept: Any


def _search(boundary: Any, n: int, cutting: Cutting) -> _Search:
    problem, angles = boundary.problem, boundary.found
    m = int(angles.count[0])
    kept = [np.ascontiguousarray(boundary.pins), np.ascontiguousarray(boundary.falls)]
    kept += [angles.beta[0, :m].copy(), angles.centre[0, :m].astype(np.int64)]
    loads = (float(v[0]) for v in (problem.lam, problem.mu, problem.phi, problem.span))
    of = _Boundary(
        *loads, boundary.low, boundary.high, boundary.deepest, boundary.whole_turns, boundary.passed, kept[0].size,
        address(kept[0]), address(kept[1]),
    )  # fmt: skip
    head = (ctypes.byref(of), ctypes.c_int64(m), address(kept[2]), address(kept[3]))
    return _Search((*head, points(n), cut(cutting, True)), (kept, of))


def transit_times(
    boundary: Any, pin: Integers, sign: Array, y: Array, deep: bool, n: int, cutting: Cutting
) -> tuple[Array, Array, Booleans, int] | None:
    """Times and rates (3, M), whether each orbit rotates (M,), and evaluations of G; None where it is not possible."""
    search, M, calls = _search(boundary, n, cutting), y.size, ctypes.c_int64(0)
    time, rate, rotates = np.empty((3, M)), np.empty((3, M)), np.empty(M, np.bool_)
    levels = np.ascontiguousarray(pin, np.int64), np.ascontiguousarray(sign, float), np.ascontiguousarray(y, float)
    status = functions().rod_transit_times(
        *search.arguments, ctypes.c_int64(M), *(address(a) for a in levels), int(deep), address(time),
        address(rate), address(rotates), ctypes.byref(calls),
    )  # fmt: skip
    return (time, rate, rotates, calls.value) if fine(status) else None


def level_roots(
    boundary: Any, pin: Integers, sign: Array, counts: Integers, low: Array, high: Array, n: int, cutting: Cutting
) -> tuple[Array, int] | None:
    """y of the root of each path's length less the rod's, (K,), and evaluations of G; None where it is not possible."""
    search, K, calls = _search(boundary, n, cutting), low.size, ctypes.c_int64(0)
    roots = np.empty(K)
    whole = [np.ascontiguousarray(a, np.int64) for a in (pin, counts)]
    whole[1:1] = [np.ascontiguousarray(sign, float)]
    whole += [np.ascontiguousarray(a) for a in (low, high)]
    status = functions().rod_level_roots(
        *search.arguments, ctypes.c_int64(K), *(address(a) for a in whole), address(roots), ctypes.byref(calls)
    )
    return (roots, calls.value) if fine(status) else None


def resume(
    first: Array, last: Array, level: tuple[float, float, float], way: tuple[int, int], n: int, how: Cutting
) -> tuple[float, float, float, int, int] | None:
    """The equilibrium of the ends problem `last` (6,) on the branch of one of `first`, by continuation.

    Parameters
    ----------
    first, last : (6,)
        lam, mu, phi, span, beta(0), beta(L).
    level : pin, sign, y
    way : leaving, turns
    n, how
        As of `orbits`, for the transit times.

    Returns
    -------
    tuple or None
        Pin, sign, y, leaving and turns; None where the branch ends, or where it needs a leap or passes a helix.
    """
    at, route = np.array(level, dtype=float), np.array(way, dtype=np.int64)
    status = functions().rod_continued(
        address(first), address(last), *on_grid(),
        points(n), cut(how, True), address(at), address(route),
    )  # fmt: skip
    return (*at.tolist(), *route.tolist()) if fine(status) else None
