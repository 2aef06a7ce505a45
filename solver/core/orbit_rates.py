"""The numbers of one equilibrium and their rates by the compiled core: `orbit_rates.c`."""

import ctypes
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..numerics.arrays import Array
from .branches import RATES, Grid, Level
from .library import address
from .panels import Cutting, cut, fine, functions, points

_NUMBERS, _PARTS, _NO_ORBIT = 11, 5, 100


def orbit_rates(
    numbers: Sequence[float], path: Any, grid: Any, n: int, how: tuple[Cutting, Cutting], rates: bool
) -> tuple[Array, Array, Array, Array] | None:
    """The values (11,), rows (11, 5), derivatives by the length (11,), and length () of one equilibrium.

    None where it is not possible: for a helix, and a gap that floats cannot express.

    Parameters
    ----------
    numbers : lam, mu, phi, span, beta(0), beta(L)
    path : `line_point.Path`
    grid, n, how
        As of `orbits.orbits`; how panels are cut for the length, and for the orbit.
    rates : bool
        Whether rows and derivatives are wanted; else they are NaN.
    """
    if path.helix:
        return None
    angles, table = grid
    searched, out = Grid(angles.size, address(angles), address(table)), np.full(RATES, np.nan)
    level = Level(path.pin, path.sign, path.y, path.leaving, path.turns)
    status = functions().rod_orbit_rates(
        (ctypes.c_double * 6)(*numbers), ctypes.byref(level), ctypes.byref(searched), points(n), cut(how[0], True),
        cut(how[1], False), int(rates), address(out),
    )  # fmt: skip
    return split(out) if status == _NO_ORBIT or fine(status) else None


def start_rates(
    numbers: Sequence[float], grid: Any, n: int, how: Cutting, rates: bool
) -> tuple[Array, Array, Array, Array] | None:
    """The same of the orbit of a start problem, at its far end; y has no value and no row.

    Parameters
    ----------
    numbers : lam, mu, phi, span, beta(0), beta_t(0)
    grid, n, how, rates
        As of `orbit_rates`; how panels of the orbit are cut.
    """
    angles, table = grid
    searched, out = Grid(angles.size, address(angles), address(table)), np.full(RATES, np.nan)
    status = functions().rod_start_rates(
        (ctypes.c_double * 6)(*numbers), ctypes.byref(searched), points(n), cut(how, False), int(rates), address(out)
    )
    return split(out) if fine(status) else None


def split(records: Array) -> tuple[Array, Array, Array, Array]:
    """Values (..., 11), rows (..., 11, 5), derivatives by the length (..., 11) and lengths (...) of (..., `RATES`)."""
    values, rows, by_span, length = np.split(records, np.cumsum([_NUMBERS, _NUMBERS * _PARTS, _NUMBERS]), axis=-1)
    return values, rows.reshape(*records.shape[:-1], _NUMBERS, _PARTS), by_span, length[..., 0]
