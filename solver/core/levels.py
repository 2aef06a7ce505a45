"""Transit times between two end angles, levels of paths, and continuation by the compiled core: `transit_times.c`,
`branch_steps.c`."""

from typing import Any

import numpy as np

from ..numerics.arrays import Array, Booleans, Integers
from .library import AT, FLOAT, INT, Cutting, cut, fine, on_grid, points, run, structure

_Boundary = structure(  # orbit_parts.h
    "boundary", (FLOAT, "lam mu phi span low high deepest"), (INT, "whole_turns passed pins"), (AT, "pin falls")
)


def fall(problem: Any, pin: float, beta: float, extremum: bool) -> float:
    """G(pin) - G(beta) of one problem: see `levels.transit_times.fall`."""
    loads = (float(v[0]) for v in (problem.lam, problem.mu, problem.phi))
    return float(run("rod_fall", *loads, pin, beta, extremum, result=FLOAT))


def _search(boundary: Any, n: int, cutting: Cutting) -> tuple[Any, ...]:
    """One ends problem as the first arguments of `rod_transit_times` and `rod_level_roots`."""
    problem, angles = boundary.problem, boundary.found
    m = int(angles.count[0])
    loads = (float(v[0]) for v in (problem.lam, problem.mu, problem.phi, problem.span))
    pins, falls = np.ascontiguousarray(boundary.pins), np.ascontiguousarray(boundary.falls)
    of = _Boundary(
        *loads,
        boundary.low,
        boundary.high,
        boundary.deepest,
        boundary.whole_turns,
        boundary.passed,
        pins.size,
        pins,
        falls,
    )
    critical = angles.beta[0, :m].copy(), angles.centre[0, :m].astype(np.int64)
    return of, m, *critical, points(n), cut(cutting, True)


def transit_times(
    boundary: Any, pin: Integers, sign: Array, y: Array, deep: bool, n: int, cutting: Cutting
) -> tuple[Array, Array, Booleans, int] | None:
    """Times and rates (3, M), whether each orbit rotates (M,), and evaluations of G; None where it is not possible."""
    M, calls = y.size, np.zeros(1, np.int64)
    time, rate, rotates = np.empty((3, M)), np.empty((3, M)), np.empty(M, np.bool_)
    levels = np.ascontiguousarray(pin, np.int64), np.ascontiguousarray(sign, float), np.ascontiguousarray(y, float)
    status = run("rod_transit_times", *_search(boundary, n, cutting), M, *levels, deep, time, rate, rotates, calls)
    return (time, rate, rotates, int(calls[0])) if fine(status) else None


def level_roots(
    boundary: Any, pin: Integers, sign: Array, counts: Integers, low: Array, high: Array, n: int, cutting: Cutting
) -> tuple[Array, int] | None:
    """y of the root of each path's length less the rod's, (K,), and evaluations of G; None where it is not possible."""
    calls, roots = np.zeros(1, np.int64), np.empty(low.size)
    whole = (
        np.ascontiguousarray(pin, np.int64),
        np.ascontiguousarray(sign, float),
        np.ascontiguousarray(counts, np.int64),
    )
    ends = np.ascontiguousarray(low), np.ascontiguousarray(high)
    status = run("rod_level_roots", *_search(boundary, n, cutting), low.size, *whole, *ends, roots, calls)
    return (roots, int(calls[0])) if fine(status) else None


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
    status = run("rod_continued", first, last, on_grid(), points(n), cut(how, True), at, route)
    return (*at.tolist(), *route.tolist()) if fine(status) else None
