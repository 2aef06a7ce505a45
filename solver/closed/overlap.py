"""Self-intersection of a closed rod, whose two ends are neighbours."""

import numpy as np
import scipy

from ..mechanics.frames import position
from ..orbit.periodic_orbit import Orbit

_DENSE, _MOST = 4.0, 200_000  # points for each radius of the rod, and the largest number of points


def meets_itself(orbit: Orbit, a: float, tightest: float) -> bool | None:
    """Whether a closed rod comes closer to itself than two radii, or bends more tightly than its radius.

    Points pi a apart or less along the closed rod are neighbours, as in `observe.self_contact`. a: the radius, and
    tightest: the largest curvature, in units of rho. None for a rod with more points than can be compared.
    """
    if a * tightest >= 1:
        return True
    span = float(orbit.problem.span[0])
    count = int(np.ceil(_DENSE * span / a))
    if count > _MOST:
        return None
    t = np.arange(count) * (span / count)
    _, _, alpha, z = orbit.at(t[None])
    points = position(1.0, alpha[0], z[0])
    pairs = scipy.spatial.cKDTree(points).query_pairs(2 * a, output_type="ndarray")
    apart = np.abs(t[pairs[:, 0]] - t[pairs[:, 1]])
    return bool((np.minimum(apart, span - apart) > np.pi * a).any())
