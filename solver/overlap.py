"""Where the rod would pass through itself: turns whose centrelines come closer than two radii."""

from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from .reduced import Array, flat
from .solution import Solution

# A bend as tight as the rod itself (radius a) brings back points that are pi a apart along it; nearer neighbours
# are close because they are neighbours, not because the rod meets itself.
_NEIGHBOUR = np.pi


def overlaps(sol: Solution) -> Any:
    """1 where the rod would pass through itself, else 0, (*cases).

    Two points farther apart along the rod than pi a and closer in space than 2 a, or curvature above 1/a. Judged on
    the stations, so they should be no farther apart than about a.
    """
    shape = sol.case.shape
    n = sol.s.shape[-1]
    a = flat(sol.case.rod.a, shape)
    points, s, kappa = sol.position.reshape(-1, n, 3), sol.s.reshape(-1, n), sol.kappa.reshape(-1, n)
    found = [_meets(points[i], s[i], a[i]) or bool(kappa[i].max() * a[i] > 1) for i in range(a.size)]
    return np.array(found, dtype=int).reshape(shape)[()]


def _meets(points: Array, s: Array, a: float) -> bool:
    if not np.isfinite(points).all():
        return False
    pairs = cKDTree(points).query_pairs(2 * a, output_type="ndarray")
    return bool((np.abs(s[pairs[:, 0]] - s[pairs[:, 1]]) > _NEIGHBOUR * a).any()) if len(pairs) else False
