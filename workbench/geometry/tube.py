"""The tube about a curve as triangles: the one mesher of scenes, exports, the report and the live page. NumPy only.

A tube is a row of rings, each with the same number of sides, and two flat ends.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .centreline import Array

Frame = tuple[Array, Array, Array, Array]  # place, tangent, outward normal, normal in the surface; (n, 3) each


@dataclass(frozen=True, eq=False)
class Mesh:
    """A closed surface.

    Attributes
    ----------
    points, normals
        (m, 3): the rings one after the other, then the points of the two ends.
    triangles
        (k, 3) indices of points, counterclockwise as seen from outside.
    """

    points: Array
    normals: Array
    triangles: NDArray[np.int64]


def mesh(frame: Frame, radius: float, sides: int, turned: Array | None = None, sharp: bool = True) -> Mesh:
    """The tube of a radius about a curve.

    Parameters
    ----------
    frame
        The curve and its directions at the rings.
    turned
        The angle by which each ring's first corner is turned about the tangent from the outward normal, (n,) [rad].
        Each square then takes of its two diagonals the one along which the tube turns less, which cuts off less of it.
        Default: no corner is turned, and all squares take the same diagonal.
    sharp
        Each flat end has a ring of its own, so that its edge is drawn sharp; else it shares the last ring's points, and
        the surface is closed also for programs that compare points by index.
    """
    n = len(frame[0])
    points, normals = surface(frame, radius, sides, turned, sharp)
    ahead = np.zeros(n - 1, dtype=bool)
    if turned is not None:
        _, _, out, across = frame
        first, angle = normals[: n * sides : sides], turned[:-1, None]
        ahead = np.einsum("ij,ij->i", first[1:], np.cos(angle) * across[:-1] - np.sin(angle) * out[:-1]) > 0
    index = np.arange(n * sides).reshape(n, sides)
    return Mesh(points, normals, np.concatenate([_walls(index, ahead), _ends(n, sides, sharp)]))


def hollow(frame: Frame, radius: float, bore: float, sides: int) -> Mesh:
    """The tube with a bore: its two flat ends are rings, and share the points of the walls. Parameters as of `mesh`."""
    n = len(frame[0])
    m = n * sides
    (points, normals), (inner, inward) = (surface(frame, r, sides, sharp=False) for r in (radius, bore))
    walls = _walls(np.arange(m).reshape(n, sides), np.zeros(n - 1, dtype=bool))
    rim = np.arange(sides)
    beside, far = np.roll(rim, -1), m - sides
    ends = [_strip(a, b, m + a, m + b) for a, b in ((rim, beside), (far + beside, far + rim))]
    together = np.concatenate([walls, m + walls[:, ::-1], *ends])
    return Mesh(np.concatenate([points[:m], inner[:m]]), np.concatenate([normals[:m], -inward[:m]]), together)


def _strip(one: NDArray[Any], two: NDArray[Any], inner_one: NDArray[Any], inner_two: NDArray[Any]) -> NDArray[np.int64]:
    """Two triangles for each square from an outer to an inner circle."""
    return np.concatenate([np.stack([one, two, inner_two], axis=-1), np.stack([one, inner_two, inner_one], axis=-1)])


def surface(
    frame: Frame, radius: float, sides: int, turned: Array | None = None, sharp: bool = True
) -> tuple[Array, Array]:
    """The points of a tube and the normals there, (m, 3) each, in the order of `Mesh`; parameters as of `mesh`."""
    place, along, out, across = frame
    angle = np.linspace(0.0, 2 * np.pi, sides, endpoint=False) + (0.0 if turned is None else turned[:, None])
    angle = angle[..., None]
    normals = np.cos(angle) * out[:, None] + np.sin(angle) * across[:, None]
    rings = place[:, None] + radius * normals
    flat = along[[0, -1]] * np.array([[-1.0], [1.0]])
    if not sharp:
        ends, flats = place[[0, -1]], flat
    else:
        ends = np.concatenate([np.concatenate([rings[i], place[i][None]]) for i in (0, -1)])
        flats = np.repeat(flat, sides + 1, axis=0)
    return np.concatenate([rings.reshape(-1, 3), ends]), np.concatenate([normals.reshape(-1, 3), flats])


def at_points(values: NDArray[Any], sides: int, sharp: bool = True) -> NDArray[Any]:
    """Values at the rings, (n, ...), as values at the points of the tube, (m, ...)."""
    ends = np.repeat(values[[0, -1]], sides + 1 if sharp else 1, axis=0)
    return np.concatenate([np.repeat(values, sides, axis=0), ends])


def _walls(index: NDArray[np.int64], ahead: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Two triangles for each square between two rings; ahead: the squares after a ring take the other diagonal."""
    beside = np.roll(index, -1, axis=1)
    a, b, c, d = index[:-1], beside[:-1], beside[1:], index[1:]
    ahead = ahead[:, None]
    first = np.stack([a, np.where(ahead, d, c), b], axis=-1)
    second = np.stack([np.where(ahead, d, a), np.where(ahead, c, d), np.where(ahead, b, c)], axis=-1)
    return np.stack([first, second], axis=2).reshape(-1, 3)


def _ends(n: int, sides: int, sharp: bool) -> NDArray[np.int64]:
    """The two flat ends as fans about their centres."""
    rim = np.arange(sides)
    beside, m = np.roll(rim, -1), n * sides
    first, last = (m, m + sides + 1) if sharp else (0, m - sides)  # where each end's ring begins
    centres = (m + sides, m + 2 * sides + 1) if sharp else (m, m + 1)
    low = np.stack([first + rim, first + beside, np.full(rim.size, centres[0])], axis=-1)
    high = np.stack([last + beside, last + rim, np.full(rim.size, centres[1])], axis=-1)
    return np.concatenate([low, high])
