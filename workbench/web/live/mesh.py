"""The rod and its cylinder as triangles for the live page and the report: single precision, rings at the stations."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from matplotlib.colors import to_rgb
from numpy.typing import NDArray

from solver import Solution
from solver.mechanics import frames

from ...figures import style
from ...geometry import tube
from ...scene.colours import SURFACE

SIDES = (20, 10)  # of the tube, and of one of more than `MANY` rings
MANY = 801
AROUND = 72  # sides of the cylinder
HIGH = 500  # pixels of the scene on the page, about
COARSE = 1.5  # pixels that the coarse tube's centreline may be off
TALLEST = 9.0  # diameters; a taller scene is drawn compressed along the axis, or the rod would be too thin to see

Floats = NDArray[np.float32]
Indices = NDArray[np.uint32]


@dataclass(frozen=True, eq=False)
class Drawn:
    """A surface as vtk.js takes it.

    Attributes
    ----------
    points, normals, colours
        (m, 3), colours in bytes.
    polygons
        3, i, j, k, 3, ...
    key
        Surfaces of the same key have the same polygons.
    squeeze
        The factor by which the axis is compressed, at most 1.
    coarse
        Fewer polygons between the same points, for as long as a slider moves.
    """

    points: Floats
    normals: Floats
    colours: NDArray[np.uint8]
    polygons: Indices
    key: str
    squeeze: float
    coarse: Indices | None = None


def rod(sol: Solution) -> Drawn:
    """The tube of one case, with rings at its stations, in the colours of a push and of lift-off."""
    case = sol.case
    a, rho = float(case.rod.a), float(case.rho)
    reach = max(float(case.cylinder.R), rho + a)
    squeeze = min(1.0, TALLEST * 2 * reach / max(float(np.ptp(sol.z)), 1e-300))
    beta = np.arctan2(np.sin(sol.beta), squeeze * np.cos(sol.beta)) if squeeze < 1 else sol.beta
    centre = frames.position(rho, sol.alpha, squeeze * sol.z)
    directions = frames.tangent(sol.alpha, beta), frames.outward(sol.alpha), frames.binormal(sol.alpha, beta)
    n = sol.s.size
    sides = sides_of(n)
    points, normals = tube.surface((centre, *directions), a, sides)
    shades = np.array([_bytes(style.PUSHED), _bytes(style.LIFTED)])
    every = _coarse_rings(centre, a, reach)
    return Drawn(
        points.astype(np.float32),
        normals.astype(np.float32),
        tube.at_points(shades[(sol.push < 0).astype(int)], sides),
        tube_polygons(n),
        f"tube {n} {every}",
        squeeze,
        tube_polygons(n, every, 2),
    )


def _coarse_rings(centre: NDArray[np.float64], a: float, reach: float) -> int:
    """Every how many rings the coarse tube may have one, so that it is off by `COARSE` pixels at most.

    The arc over k even steps rises above its chord by k^2 |second difference| / 8, on the outer side of the bend by
    1 + kappa a times that.
    """
    bend = float(np.sqrt((np.diff(centre, 2, axis=0) ** 2).sum(axis=-1)).max())
    step = float(np.sqrt((np.diff(centre, axis=0) ** 2).sum(axis=-1)).max())
    error = COARSE * max(2 * reach, float(np.ptp(centre[:, 2]))) / HIGH
    rise = bend * (1 + a * bend / max(step, 1e-300) ** 2)
    return int(np.clip(np.sqrt(8 * error / max(rise, 1e-300)), 1, 16))


def sides_of(rings: int) -> int:
    """The number of sides of a tube of so many rings."""
    return SIDES[int(rings > MANY)]


def cylinder(sol: Solution, squeeze: float) -> Drawn:
    """The cylinder of a solution, a little longer than the rod."""
    R = float(sol.case.cylinder.R)
    beyond = float(sol.case.rod.a) + 0.35 * R
    low, high = squeeze * float(sol.z.min()) - beyond, squeeze * float(sol.z.max()) + beyond
    return wall(R, sol.case.cylinder.side, low, high, squeeze)


def wall(R: float, side: str, low: float, high: float, squeeze: float = 1.0) -> Drawn:
    """The cylinder's wall between two heights, with flat ends where the rod lies outside."""
    along, out, across = (np.tile(way, (2, 1)) for way in ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]))
    frame = np.array([[0.0, 0.0, low], [0.0, 0.0, high]]), along, out, across
    points, normals = (values.astype(np.float32) for values in tube.surface(frame, R, AROUND))
    colours = np.broadcast_to(_bytes(SURFACE), points.shape).astype(np.uint8)
    polygons = _listed(tube.triangles(2, AROUND)[: None if side == "outside" else 2 * AROUND])
    return Drawn(points, normals, colours, polygons, f"cylinder {side}", squeeze)


def _bytes(colour: str) -> NDArray[np.uint8]:
    return np.round(255 * np.array(to_rgb(colour))).astype(np.uint8)


@lru_cache(maxsize=32)
def tube_polygons(n: int, every: int = 1, skip: int = 1) -> Indices:
    """The polygons of a tube of n rings, between every so many rings and sides."""
    return _listed(tube.triangles(n, sides_of(n), True, every, skip))


def _listed(triangles: NDArray[np.int64]) -> Indices:
    return np.insert(triangles, 0, 3, axis=1).ravel().astype(np.uint32)
