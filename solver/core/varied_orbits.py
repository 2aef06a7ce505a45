"""The numbers of one equilibrium and their rates, and variations of orbits, by the compiled core: `orbit_rates.c` and
`variations.c`."""

from typing import Any

import numpy as np

from ..numerics.arrays import Array
from .branches import NO_ORBIT, NUMBERS, PARTS, RATES, Level
from .library import AT, INT, Cutting, cut, fine, on_grid, points, run, structure, widest
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
    ways = cut(how[0], True), cut(how[1], False)
    status = run("rod_orbit_rates", np.ascontiguousarray(numbers), level, on_grid(), points(n), *ways, out)
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
    status = run("rod_start_rates", np.ascontiguousarray(numbers), on_grid(), points(n), cut(how, False), out)
    return split(out) if fine(status) else None


def split(records: Array) -> tuple[Array, Array, Array, Array]:
    """Values (..., 11), rows (..., 11, 5), derivatives by the length (..., 11) and lengths (...) of (..., `RATES`)."""
    values, rows, by_span, length = np.split(records, np.cumsum([NUMBERS, NUMBERS * PARTS, NUMBERS]), axis=-1)
    return values, rows.reshape(*records.shape[:-1], NUMBERS, PARTS), by_span, length[..., 0]


PAIRS = 10  # elements of M that are kept
_SUMS = PAIRS + 3  # with the integrals of sin, cos and sin cos of beta
_SERIES = 9 + _SUMS  # of a panel, one coefficient of all after the other
KEPT = ("least", "M", "jump", "closing", "series", "gain")


_VariedOrbits = structure("varied_orbits", (AT, " ".join(KEPT)), (INT, "lanes"))  # variations.h


def variations(orbit: Any, origin: Array) -> dict[str, Array]:
    """The arrays of `orbit.variations.Variations` by their names.

    orbit: B orbits, none of them a helix, whose series of beta count from angles; origin: (P,), these, without whole
    turns.
    """
    problem, n = orbit.problem, orbit.panels.series.shape[2] - 1
    P, B = origin.size, problem.size
    loads, origin = np.stack([problem.lam, problem.mu, problem.phi], axis=1), np.ascontiguousarray(origin)
    shapes = (P,), (P, PAIRS, n), (P, PAIRS), (2 * B, PAIRS)
    out = dict(zip(KEPT, map(np.empty, (*shapes, (P, n + 1, _SERIES), (B, 2, _SUMS))), strict=True))
    varied = _VariedOrbits(**out, lanes=widest())
    fine(run("rod_variations", B, loads, reading(orbit), origin, points(n), varied))
    return out


def arguments_of(varied: Any) -> tuple[Any, Any]:
    """Orbits and their variations as arguments of the core. varied: `orbit.variations.Variations`."""
    return varied.reading, _VariedOrbits(**varied.kept, lanes=widest())


def places(varied: Any, t: Array) -> Array:
    """The states of varied orbits at t (B, n), (B, n, 24): v, H, c, the shifts (4), gammas (4), M (10)
    and the integrals of sin, cos and sin cos of beta."""
    out = np.empty((*t.shape, 11 + _SUMS))
    run("rod_variations_places", *arguments_of(varied), *t.shape, np.ascontiguousarray(t), out)
    return out


def directions(varied: Any) -> Array:
    """The parts of a unit of beta(0), beta_t(0), lam, mu and phi of varied orbits, (B, 5, 5)."""
    out = np.empty((varied.orbit.problem.size, PARTS, PARTS))
    run("rod_variations_directions", *arguments_of(varied), len(out), out)
    return out


def changes(varied: Any, t: Array, parts: Array) -> Array:
    """The changes of varied orbits at t (B, n) by F directions with the parts (B, 5, F): (5, B, F, n), of beta, of
    beta_t and of the integrals of H_q d beta up to t."""
    (B, n), F = t.shape, parts.shape[2]
    out = np.empty((5, B, F, n))
    given = np.ascontiguousarray(t), np.ascontiguousarray(parts.swapaxes(1, 2))
    run("rod_variations_changes", *arguments_of(varied), B, n, F, *given, out)
    return out
