"""The numbers of one equilibrium and their rates, variations of orbits, and how what is measured along rods answers
them, by the compiled core: `orbit_rates.c`, `variations.c` and `measure_rates.c`."""

import ctypes
from collections.abc import Collection, Mapping
from typing import Any

import numpy as np

from ..numerics.arrays import Array
from .branches import NO_ORBIT, NUMBERS, PARTS, RATES, Grid, Level
from .library import Cutting, address, cut, fine, functions, on_grid, points, share_out, widest
from .measures import NUMBERS as MEASURED
from .measures import RATED, rods_of
from .orbits import reading


def orbit_rates(
    numbers: Array, path: Any, n: int, how: tuple[Cutting, Cutting]
) -> tuple[Array, Array, Array, Array] | None:
    """The values (11,), rows (11, 5), derivatives by the length (11,), and length () of one equilibrium.

    None where it is not possible: for a helix, and a gap that floats cannot express.

    Parameters
    ----------
    numbers : lam, mu, phi, span, beta(0), beta(L)
    path : `line_point.Path`
    n, how
        As of `orbits.orbits`; how panels are cut for the length, and for the orbit.
    """
    if path.helix:
        return None
    out = np.full(RATES, np.nan)
    level = Level(path.pin, path.sign, path.y, path.leaving, path.turns)
    status = functions().rod_orbit_rates(
        (ctypes.c_double * 6)(*numbers), ctypes.byref(level), ctypes.byref(Grid(*on_grid())), points(n),
        cut(how[0], True), cut(how[1], False), address(out),
    )  # fmt: skip
    return split(out) if status == NO_ORBIT or fine(status) else None


def start_rates(numbers: Array, n: int, how: Cutting) -> tuple[Array, Array, Array, Array] | None:
    """The same of the orbit of a start problem, at its far end; y has no value and no row.

    Parameters
    ----------
    numbers : lam, mu, phi, span, beta(0), beta_t(0)
    n, how
        As of `orbit_rates`; how panels of the orbit are cut.
    """
    out = np.full(RATES, np.nan)
    status = functions().rod_start_rates(
        (ctypes.c_double * 6)(*numbers), ctypes.byref(Grid(*on_grid())), points(n), cut(how, False), address(out)
    )
    return split(out) if fine(status) else None


def split(records: Array) -> tuple[Array, Array, Array, Array]:
    """Values (..., 11), rows (..., 11, 5), derivatives by the length (..., 11) and lengths (...) of (..., `RATES`)."""
    values, rows, by_span, length = np.split(records, np.cumsum([NUMBERS, NUMBERS * PARTS, NUMBERS]), axis=-1)
    return values, rows.reshape(*records.shape[:-1], NUMBERS, PARTS), by_span, length[..., 0]


PAIRS = 10  # elements of M that are kept
_SUMS = PAIRS + 3  # with the integrals of sin, cos and sin cos of beta
_SERIES = 9 + _SUMS  # of a panel
KEPT = ("least", "M", "jump", "closing", "series", "gain")


class _VariedOrbits(ctypes.Structure):
    """`varied_orbits` in variations.h."""

    _fields_ = [*((name, ctypes.c_void_p) for name in KEPT), ("lanes", ctypes.c_int64)]


def variations(orbit: Any, origin: Array) -> dict[str, Array]:
    """The arrays of `orbit.variations.Variations` by their names.

    orbit: B orbits, none of them a helix, whose series of beta count from angles; origin: (P,), these, without whole
    turns.
    """
    problem, (of, kept), n = orbit.problem, reading(orbit), orbit.panels.series.shape[2] - 1
    P, B = origin.size, problem.size
    loads, origin = np.stack([problem.lam, problem.mu, problem.phi], axis=1), np.ascontiguousarray(origin)
    shapes = (P,), (P, PAIRS, n), (P, PAIRS), (2 * B, PAIRS)
    out = dict(zip(KEPT, map(np.empty, (*shapes, (P, _SERIES, n + 1), (B, 2, _SUMS))), strict=True))
    fine(functions().rod_variations(
        ctypes.c_int64(B), address(loads), ctypes.byref(of), address(origin), points(n),
        ctypes.byref(_VariedOrbits(*(address(a) for a in out.values()), lanes=widest())),
    ))  # fmt: skip
    del kept
    return out


def places(varied: Any, t: Array) -> Array:
    """The states of varied orbits at t (B, n), (B, n, 24): v, H, c, the shifts (4), gammas (4), M (10)
    and the integrals of sin, cos and sin cos of beta."""
    out = np.empty((*t.shape, 11 + _SUMS))
    given = [np.ascontiguousarray(a) for a in (varied.kept["series"], varied.kept["gain"], t)]
    functions().rod_variations_places(
        ctypes.byref(varied.reading[0]), *(ctypes.c_int64(k) for k in t.shape), *map(address, given), address(out)
    )
    return out


def directions(varied: Any) -> Array:
    """The parts of a unit of beta(0), beta_t(0), lam, mu and phi of varied orbits, (B, 5, 5)."""
    out = np.empty((varied.orbit.problem.size, PARTS, PARTS))
    given = [np.ascontiguousarray(a) for a in (varied.kept["series"], varied.kept["gain"])]
    functions().rod_variations_directions(
        ctypes.byref(varied.reading[0]), ctypes.c_int64(len(out)), *map(address, given), address(out)
    )
    return out


def changes(varied: Any, t: Array, parts: Array) -> Array:
    """The changes of varied orbits at t (B, n) by F directions with the parts (B, 5, F): (5, B, F, n), of beta, of
    beta_t and of the integrals of H_q d beta up to t."""
    (B, n), F = t.shape, parts.shape[2]
    out = np.empty((5, B, F, n))
    given = [np.ascontiguousarray(a) for a in (varied.kept["series"], varied.kept["gain"], t, parts.swapaxes(1, 2))]
    functions().rod_variations_changes(
        ctypes.byref(varied.reading[0]), *(ctypes.c_int64(k) for k in (B, n, F)), *map(address, given), address(out)
    )
    return out


_SERIES_GOAL = 1e-14  # of the series of which the places of extremes are found, relative


class _Changes(ctypes.Structure):
    """`changes` in measure_rates.c."""

    _fields_ = [
        *((name, ctypes.c_int64) for name in ("directions", "wanted")),
        *((name, ctypes.c_void_p) for name in ("parts", "later", "lifts", "peak", "base")),
    ]


def measure_rates(
    varied: Any, pieces: Any, sign: Array, parts: Array, later: Array, names: Collection[str], seen: Mapping[str, Array]
) -> dict[str, Array]:
    """How some of `RATED` along B rods, none of them a helix, answer F changes of their orbits, (B, F) each.

    Parameters
    ----------
    varied : orbit.variations.Variations
        The variations of their orbits.
    pieces, sign
        Of the rods, as of `measures.measure`.
    parts : (B, 5, F)
        Of the changes, as of `changes`.
    later : (B, F)
        The changes of the length in t.
    names : collection of str
    seen : mapping
        "lifts" and "peak" where they are among the names, (B,) each: the t that is observed.
    """
    B, F = later.shape
    rods, arrays = rods_of(pieces, {"sign": sign, "error": 0 * sign}, _SERIES_GOAL, 0)
    none = np.zeros(B)
    given = [np.ascontiguousarray(a, dtype=float) for a in (
        parts.swapaxes(1, 2), later, seen.get("lifts", none), seen.get("peak", none), varied.base,
    )]  # fmt: skip
    bits = sum(1 << RATED[name] for name in names)
    by, out = _Changes(F, bits, *(address(a) for a in given)), np.full((B, F, len(MEASURED) + 1), np.nan)
    orbits = _VariedOrbits(*(address(varied.kept[name]) for name in KEPT), lanes=widest())
    of, n = varied.reading[0], points(varied.orbit.panels.series.shape[2] - 1)

    def part(a: int, b: int) -> None:
        fine(functions().rod_measure_rates(
            ctypes.byref(rods), ctypes.byref(of), n, ctypes.byref(orbits), ctypes.byref(by), address(out),
            ctypes.c_int64(a), ctypes.c_int64(b), widest(),
        ))  # fmt: skip

    share_out(part, B)
    del arrays
    return {name: out[..., RATED[name]] for name in names}
