"""Integrals and extremes along rods, and the search for self-contact, by the compiled core: `measures.c`,
`strand_pairs.c`, and of curves at points `crossings.c`."""

import ctypes
import re
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np

from ..numerics.arrays import Array, Integers
from .build import HERE
from .library import begin_of, fine, function, share_out, widest
from .orbits import reading

NODES = 24  # of each piece, at which densities are computed

# the table of measured.h, which needs no library: densities; group, name and rates of the numbers
_HEADER = (HERE / "measured.h").read_text(encoding="utf-8")
DENSITIES = tuple(re.findall(r"ROW\(\w+, (\w+)\)", _HEADER))
_ROWS = re.findall(r"ROW\((\w+), \w+, (\w+), ([01])\)", _HEADER)
NUMBERS = tuple(name for _, name, _ in _ROWS)
RATED = {name: k for k, (_, name, rated) in enumerate(_ROWS) if rated == "1"} | {"middle push": len(_ROWS)}
GROUPS = [tuple(name for kind, name, _ in _ROWS if kind == group) for group in dict.fromkeys(row[0] for row in _ROWS)]
_COUNTS = ("coefficients", "kinds", "monotone", "groups")
_PIECES, _RODS = ("low", "high", "time", "count", "begin"), ("lam", "mu", "phi", "span", "beta0", "sign", "error")


class _Rods(ctypes.Structure):
    """`rods` in stretches.h."""

    _fields_ = [
        *((name, ctypes.c_int64) for name in _COUNTS),
        ("goal", ctypes.c_double),
        *((name, ctypes.c_void_p) for name in ("series", "first", "row", *_PIECES, *_RODS)),
    ]


def groups_with(names: Iterable[str]) -> list[tuple[str, ...]]:
    """The groups that contain one of the names."""
    return [group for group in GROUPS if not set(names).isdisjoint(group)]


def measure(
    pieces: Any, given: Mapping[str, Array], names: Iterable[str], goal: float, lanes: int = 0
) -> dict[str, tuple[Any, Any]]:
    """Measure rods.

    Parameters
    ----------
    pieces : Pieces
        The pieces of B rods.
    given : mapping
        ``sign`` of the push and ``error`` of beta, (B,) each.
    names : iterable of str
        Of `NUMBERS`; what is measured together with one of them is measured too.
    goal : float
        Allowed error of the series, relative.
    lanes : int
        Numbers computed at once, 0 for as many as the processor allows; their number changes no bit.

    Returns
    -------
    dict
        Name -> values and errors, (B,) each.
    """
    groups = groups_with(names)
    rods, kept = rods_of(pieces, given, goal, sum(1 << GROUPS.index(group) for group in groups))
    size = pieces.problem.size
    out = np.zeros((size, 2, len(NUMBERS)))
    call = function("rod_measure", ctypes.c_int, *2 * [ctypes.c_void_p], *2 * [ctypes.c_int64], ctypes.c_int)

    def part(a: int, b: int) -> None:
        _check(call(ctypes.addressof(rods), begin_of(out), a, b, lanes or widest()), pieces)

    share_out(part, size)
    del kept
    places_of = {name: NUMBERS.index(name) for group in groups for name in group}
    return {name: (out[:, 0, k], out[:, 1, k]) for name, k in places_of.items()}


def station_series(loads: Array, t: Array, beta: Array, rate: Array) -> Array:
    """Chebyshev series of beta and beta_t between neighbouring stations (B, n), (B (n - 1), 2, 6): quintic polynomials
    through the values there and their rates, which the equation gives. loads: (B, 3), lam, mu and phi."""
    given = [np.ascontiguousarray(array, dtype=float) for array in (loads, t, beta, rate)]
    B, n = t.shape
    out = np.empty((B * max(n - 1, 0), 2, 6))
    call = function("rod_station_series", None, *2 * [ctypes.c_int64], *5 * [ctypes.c_void_p])
    call(B, n, *(begin_of(array) for array in (*given, out)))
    return out


class Density(NamedTuple):
    """A density at points (Q, m), in units of A and rho, and its derivatives by beta, |beta_t|, lam, mu and phi.

    size: the sum of the sizes of the terms of a value, whose rounding is that many eps.
    """

    values: Array
    size: Array
    beta: Array
    speed: Array
    lam: Array
    mu: Array
    phi: Array


def densities(kind: str, loads: Array, beta: Array, rate: Array) -> Density:
    """One of the `DENSITIES` and its derivatives; of the curvature there are none where a rod is straight.

    Parameters
    ----------
    kind : str
    loads : array, (Q, 4)
        lam, mu, phi and the sign of the push.
    beta, rate : array, (Q, m)
        beta, and beta_t, whose sign does not matter.
    """
    given = [np.ascontiguousarray(array, dtype=float) for array in (loads, beta, rate)]
    out = np.empty((len(Density._fields), *beta.shape))
    call = function("rod_densities", None, ctypes.c_int, *2 * [ctypes.c_int64], *4 * [ctypes.c_void_p])
    call(DENSITIES.index(kind), *beta.shape, *(begin_of(array) for array in (*given, out)))
    return Density(*out)


def _check(status: int, pieces: Any) -> None:
    if not fine(status):
        raise ValueError(f"a series of {pieces.series.shape[2]} coefficients is too long to be measured")


def rods_of(pieces: Any, given: Mapping[str, Array], goal: float, groups: int) -> tuple[_Rods, dict[str, Any]]:
    """The rods, and the arrays that must live as long."""
    size, order = pieces.problem.size, np.argsort(pieces.case, kind="stable")
    kept: dict[str, Any] = {name: getattr(pieces, name)[order] for name in _PIECES}
    kept["first"] = np.searchsorted(pieces.case[order], np.arange(size + 1))
    kept["row"], kept["series"] = pieces.row[order], pieces.series
    kept |= {name: getattr(pieces.problem, name) for name in _RODS[:5]}
    kept |= given
    kept = {
        name: np.ascontiguousarray(array, dtype=np.int64 if name in ("first", "row") else float)
        for name, array in kept.items()
    }
    counts = pieces.series.shape[2], pieces.series.shape[1], int(pieces.monotone), groups
    places = {name: begin_of(array) for name, array in kept.items()}
    return _Rods(**dict(zip(_COUNTS, counts, strict=True)), goal=goal, **places), kept


_STEPS, _NUMBERS = ("first", "since", "width", "series"), ("period", "length", "a", "apart")


class Limits(NamedTuple):
    """The largest numbers of periods and of pairs compared for a rod, and of periods compared together."""

    rounds: int
    most_pairs: int
    together: int


class _ComparedRods(ctypes.Structure):
    """`rods` in strand_pairs.c."""

    _fields_ = [
        *((name, ctypes.c_void_p) for name in ("orbits", "panels", *_STEPS, *_NUMBERS, "periods")),
        *((name, ctypes.c_int64) for name in (*Limits._fields, "lanes")),
    ]


def meets(orbit: Any, numbers: Mapping[str, Array], periods: Integers, limits: Limits) -> Array:
    """Whether B rods meet themselves, (B,): 1, 0, or NaN where `limits` leaves that open.

    Parameters
    ----------
    orbit : MarchedOrbit or Orbit
        B orbits, none of them lost.
    numbers : mapping
        period, length, a, and the smallest distance along the rod of points that meet (apart), (B,) each.
    periods : array, (B,)
        Periods that are compared with the first.
    limits : Limits
    """
    kept: dict[str, Any] = {"periods": periods}
    panels, arrays = reading(orbit) if hasattr(orbit, "panels") else (None, None)
    if panels is None:
        kept |= {name: getattr(orbit.steps, name) for name in _STEPS} | {"orbits": orbit.found}
    kept |= {name: np.asarray(numbers[name], dtype=float) for name in _NUMBERS}
    kept = {name: np.ascontiguousarray(array) for name, array in kept.items()}
    places = {name: begin_of(array) for name, array in kept.items()}
    if panels is not None:
        places["panels"] = ctypes.addressof(panels)
    rods, answers = _ComparedRods(**places, **limits._asdict(), lanes=widest()), np.empty(periods.size)
    call = function("rod_meets", ctypes.c_int, *2 * [ctypes.c_void_p], *2 * [ctypes.c_int64])

    def part(a: int, b: int) -> None:
        fine(call(ctypes.addressof(rods), begin_of(answers), a, b))

    share_out(part, periods.size)
    del arrays
    return answers


_MOST_CROSSINGS = 64  # for which there is room at once


def crossings(s: Array, points: Array, near: float, apart: float, whole: float = np.inf) -> Integers:
    """The places where a curve comes nearer to itself than `near`: of each the two points that are nearest.

    Parameters
    ----------
    s, points : arrays, (n,) and (n, 3)
        Length along the curve, rising, and places.
    near, apart : float
        Only points farther than `apart` from each other along the curve are compared.
    whole : float
        Length of a closed curve, where the way over its ends counts too; default: it is open.

    Returns
    -------
    array, (m, 2)
        Numbers of points, the later one first.
    """
    s, points = np.ascontiguousarray(s, dtype=float), np.ascontiguousarray(points, dtype=float)
    integer, real, array = ctypes.c_int64, ctypes.c_double, ctypes.c_void_p
    call = function("rod_crossings", integer, integer, array, array, real, real, real, integer, array)
    curve = s.size, begin_of(s), begin_of(points), near, apart, whole
    pairs = np.empty((_MOST_CROSSINGS, 2), dtype=np.int64)
    count = call(*curve, len(pairs), begin_of(pairs))
    if count > len(pairs):
        pairs = np.empty((count, 2), dtype=np.int64)
        count = call(*curve, count, begin_of(pairs))
    if count < 0:
        raise MemoryError
    return pairs[:count]
