"""The numbers of one equilibrium and their rates by the compiled core: `orbit_rates.c`."""

import ctypes
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..numerics.arrays import Array
from .branches import Grid, Level
from .library import address
from .panels import Cutting, cut, fine, functions, points

_NUMBERS, _PARTS, _NO_ORBIT = 11, 5, 100


def orbit_rates(
    numbers: Sequence[float], path: Any, grid: Any, n: int, how: tuple[Cutting, Cutting], rates: bool
) -> tuple[Array, Array, Array, float] | None:
    """The values (11,), rows (11, 5), derivatives by the length (11,), and length of one equilibrium.

    None where it is not possible: for a helix, and a gap that floats cannot express.

    Parameters
    ----------
    numbers : lam, mu, phi, span, beta(0), beta(L)
    path : `branch_coordinates.Path`
    grid, n, how
        As of `orbits.orbits`; how panels are cut for the length, and for the orbit.
    rates : bool
        Whether rows and derivatives are wanted; else they are empty.
    """
    if path.helix:
        return None
    angles, table = grid
    searched, length = Grid(angles.size, address(angles), address(table)), ctypes.c_double(np.nan)
    level = Level(path.pin, path.sign, path.y, path.leaving, path.turns)
    values = np.full(_NUMBERS, np.nan)
    rows, by_span = (np.full((_NUMBERS, _PARTS), np.nan), np.full(_NUMBERS, np.nan)) if rates else (None, None)
    status = functions().rod_orbit_rates(
        (ctypes.c_double * 6)(*numbers), ctypes.byref(level), ctypes.byref(searched), points(n), cut(how[0], True),
        cut(how[1], False), address(values), address(rows), address(by_span), ctypes.byref(length),
    )  # fmt: skip
    if status != _NO_ORBIT and not fine(status):
        return None
    none = np.empty(0)
    return values, none if rows is None else rows, none if by_span is None else by_span, length.value
