"""Where a rod passes through itself, as places along it."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from .self_contact import APART, MOST

Array = NDArray[np.float64]

DENSE = 4  # points for each radius of the rod
SAME = 2.9  # steps along both stretches: nearer pairs are of one place


def places(s: Array, points: Array, a: float) -> list[tuple[float, float]] | None:
    """The places where two stretches of a rod overlap: of each the two arc lengths whose points are nearest.

    Parameters
    ----------
    s : array (n,)
        Arc length, rising [length].
    points : array (n, 3)
        The centreline there [length].
    a : float
        Radius of the rod [length].

    Returns
    -------
    list of (s, s)
        The smaller arc length first, in rising order; None for a rod longer than `MOST` points can follow.
    """
    count = int(np.ceil(DENSE * (s[-1] - s[0]) / a)) + 1
    if count > MOST:
        return None
    at = np.linspace(s[0], s[-1], count)
    dense = CubicSpline(s, points)(at)
    pairs: Any = cKDTree(dense).query_pairs(2 * a, output_type="ndarray")
    pairs = pairs[np.abs(at[pairs[:, 1]] - at[pairs[:, 0]]) > APART * a]
    if not len(pairs):
        return []
    pairs = np.sort(pairs, axis=1)
    near = cKDTree(pairs).query_pairs(SAME, output_type="ndarray")
    graph = coo_array((np.ones(len(near)), (near[:, 0], near[:, 1])), shape=(len(pairs), len(pairs)))
    place = connected_components(graph, directed=False)[1]
    gaps = np.linalg.norm(dense[pairs[:, 0]] - dense[pairs[:, 1]], axis=1)
    order = np.lexsort((gaps, place))
    first = order[np.unique(place[order], return_index=True)[1]]
    return sorted((float(at[i]), float(at[j])) for i, j in pairs[first])
