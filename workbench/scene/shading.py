"""How much of the light from all around reaches the surfaces of a scene near one another. NumPy and SciPy only.

Contact is seen by its shadow. It is computed from the geometry and not from the pixels of a picture, so it has no
noise, no bands, and does not depend on the resolution.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..figures.colours import DEPTH, REACH
from ..geometry.centreline import Array

APART = np.pi  # radii along the rod: nearer points are the same stretch


def on_wall(points: Array, centreline: Array, a: float) -> Array:
    """The light on points of the wall, (n,) between 0 and 1, beside a rod of radius a that touches it.

    A round bar on a plane covers at a distance d from its line of contact all directions up to the angle 2 atan(a/d),
    which leaves d^2/(d^2 + a^2) of diffuse light. `centreline`, (m, 3), is dense.
    """
    away, _ = cKDTree(centreline).query(points, distance_upper_bound=REACH * a)
    flat = np.maximum(np.minimum(away, REACH * a) ** 2 - a**2, 0.0)  # squared distance from the line of contact
    light = flat / (flat + a**2)
    far = (REACH**2 - 1) / REACH**2
    return 1 - DEPTH * (1 - np.minimum(light / far, 1.0))


def on_tube(s: Array, place: Array, normals: Array, outward: Array, a: float, inside: bool) -> Array:
    """The light on the points of the rings of a rod, (rings, sides) between 0 and 1.

    Inside a cylinder the wall is cut open before the rod, so it takes no light.

    Parameters
    ----------
    s, place
        Arc length and centre of each ring, (rings,) and (rings, 3) [length].
    normals
        At the points, (rings, sides, 3).
    outward
        From the cylinder's axis, (rings, 3). The wall covers a half of all directions.
    inside
        Whether the rod is inside the cylinder.
    """
    covered = _by_other_stretches(s, place, normals, a)
    if not inside:
        covered += 0.5 * (0.5 - 0.5 * np.einsum("rsi,ri->rs", normals, outward))
    return 1 - DEPTH * np.clip(covered, 0.0, 1.0)


def _by_other_stretches(s: Array, place: Array, normals: Array, a: float) -> NDArray[np.float64]:
    """The share of all directions that other stretches of the rod cover, as spheres at every radius along them."""
    dense = np.linspace(s[0], s[-1], int(np.clip((s[-1] - s[0]) / a, 2, 200_000)) + 1)
    spheres = np.stack([np.interp(dense, s, coordinate) for coordinate in place.T], axis=-1)
    weight = (dense[1] - dense[0]) / (2 * a)  # two spheres stand for a stretch as long as they are wide
    near = cKDTree(place).sparse_distance_matrix(cKDTree(spheres), 3.5 * a, output_type="ndarray")
    ring, other = near["i"], near["j"]
    apart = np.abs(s[ring] - dense[other]) > APART * a
    ring, other = ring[apart], other[apart]
    covered = np.zeros(normals.shape[:2])
    if ring.size:
        toward = spheres[other][:, None] - place[ring][:, None] - a * normals[ring]
        away = np.maximum(np.linalg.norm(toward, axis=-1), a)
        facing = np.maximum(np.einsum("nsi,nsi->ns", toward, normals[ring]), 0.0) / away
        np.add.at(covered, ring, weight * facing * (a / away) ** 2)
    return covered
