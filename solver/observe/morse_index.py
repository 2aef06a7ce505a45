"""The Morse index of solved cases, by the count that fits how each was solved."""

from typing import Any

import numpy as np

from ..orbits.mesh_index import index_at_stations
from ..orbits.periodic_orbit import jacobi_zeros
from .measurement import MeasuredNumbers


def index(read: MeasuredNumbers) -> Any:
    """Morse index under the ends as they are given, (B,); 0 is stable.

    Of a start problem, and where angles and loads are given: between the shape's own two end angles, under dead loads.

    NaN where the case is not solved, and where the method knows no orbit and the stations do not resolve the shape or
    its condition number leaves too few digits.
    """
    sol, problem, shape = read.sol, read.sol.problem, read.sol.trajectory
    if shape.shapes is not None:
        count = shape.shapes.index
    elif shape.held_index is not None:
        count = shape.held_index
    elif shape.orbit is not None:
        count = jacobi_zeros(shape.orbit.exact)
    else:
        count = index_at_stations(problem, sol.t, shape.beta, shape.dbeta)
        count = np.where((shape.error <= 1e-3) & (shape.condition <= 1e8), count, np.nan)
    return np.where(np.reshape(sol.solved, -1), count, np.nan)
