"""Integrals and extremes along rods by the compiled core, `measures.c`, and places where a curve comes near itself,
`crossings.c`."""

import re
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np

from ..numerics.arrays import Array, Integers
from .build import HERE
from .library import INT, fine, run, share_out, structure, widest
from .tuning import BARELY

NODES = 24  # of each piece, at which densities are computed. x10: the core has no room for so many

# the table of measured.h, which needs no library: densities; group, name and rates of the numbers
_HEADER = (HERE / "measured.h").read_text(encoding="utf-8")
DENSITIES = tuple(re.findall(r"ROW\(\w+, (\w+)\)", _HEADER))
_ROWS = re.findall(r"ROW\((\w+), \w+, (\w+), ([01])[,)]", _HEADER)
NUMBERS = tuple(name for _, name, _ in _ROWS)
RATED = {name: k for k, (_, name, rated) in enumerate(_ROWS) if rated == "1"} | {"middle push": len(_ROWS)}
GROUPS = [tuple(name for kind, name, _ in _ROWS if kind == group) for group in dict.fromkeys(row[0] for row in _ROWS)]
_Rods = structure("rods", "stretches.h")


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
    rods = _rods_of(pieces, given, goal, sum(1 << GROUPS.index(group) for group in groups))
    size = pieces.problem.size
    out = np.zeros((size, 2, len(NUMBERS)))

    def part(a: int, b: int) -> None:
        if not fine(run("rod_measure", rods, out, a, b, lanes or widest())):
            raise ValueError(f"a series of {pieces.series.shape[2]} coefficients is too long to be measured")

    share_out(part, size)
    places_of = {name: NUMBERS.index(name) for group in groups for name in group}
    return {name: (out[:, 0, k], out[:, 1, k]) for name, k in places_of.items()}


def station_series(loads: Array, t: Array, beta: Array, rate: Array) -> Array:
    """Chebyshev series of beta and beta_t between neighbouring stations (B, n), (B (n - 1), 2, 6): quintic polynomials
    through the values there and their rates, which the equation gives. loads: (B, 3), lam, mu and phi."""
    given = [np.ascontiguousarray(array, dtype=float) for array in (loads, t, beta, rate)]
    B, n = t.shape
    out = np.empty((B * max(n - 1, 0), 2, 6))
    run("rod_station_series", B, n, *given, out)
    return out


def step_series(width: Array, taylor: Array) -> Array:
    """Chebyshev series of beta and beta_t on the steps of marches, (P, 2, n). width: (P,), how long each lasts. taylor:
    (P, 4, n), powers of the time in it, the first of beta."""
    steps, _, n = taylor.shape
    out = np.empty((steps, 2, n))
    run("rod_step_series", steps, n, *map(np.ascontiguousarray, (width, taylor)), out, widest())
    return out


class _Density(NamedTuple):
    """A density at points (Q, m), in units of A and rho, and its derivatives by beta, |beta_t|, lam, mu and phi.

    size: the sum of the sizes of the terms of a value, whose rounding is that many eps. spread: the largest change of a
    value for a unit change of beta, and of beta_t as it comes with it.
    """

    values: Array
    size: Array
    spread: Array
    beta: Array
    speed: Array
    lam: Array
    mu: Array
    phi: Array

    @property
    def rounding(self) -> Array:
        """A push below this is none: the rounding of its terms and of an angle of 1 rad, as in `measures.c`."""
        return np.asarray(BARELY * (self.size + self.spread))


def densities(kind: str, loads: Array, beta: Array, rate: Array) -> _Density:
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
    out = np.empty((len(_Density._fields), *beta.shape))
    run("rod_densities", DENSITIES.index(kind), *beta.shape, *given, out)
    return _Density(*out)


def _rods_of(pieces: Any, given: Mapping[str, Array], goal: float, groups: int) -> Any:
    """The rods as the core reads them."""
    order = np.argsort(pieces.case, kind="stable")
    first = np.searchsorted(pieces.case[order], np.arange(pieces.problem.size + 1))
    arrays = {name: getattr(pieces, name)[order] for name in ("row", "low", "high", "time", "count", "begin")}
    arrays |= {name: getattr(pieces.problem, name) for name in ("lam", "mu", "phi", "span", "beta0")}
    _, kinds, coefficients = pieces.series.shape
    numbers = coefficients, kinds, int(pieces.monotone), groups, goal
    return _Rods(*numbers, first=first, series=pieces.series, **arrays, **given)


_MOST_CROSSINGS = 64  # for which there is room at once; for more a second call. x10: only memory


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
    curve = s.size, s, points, float(near), float(apart), float(whole)
    pairs = np.empty((_MOST_CROSSINGS, 2), dtype=np.int64)
    count = run("rod_crossings", *curve, len(pairs), pairs, result=INT)
    if count > len(pairs):
        pairs = np.empty((count, 2), dtype=np.int64)
        count = run("rod_crossings", *curve, count, pairs, result=INT)
    if count < 0:
        raise MemoryError
    return pairs[:count]
