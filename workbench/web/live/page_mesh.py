"""The rod and its cylinder as triangles for the page: single precision, rings at the stations."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from matplotlib.colors import to_rgb
from numpy.typing import NDArray

from solver import Solution
from solver.mechanics import frames

from ...figures import style

SIDES = (20, 10)  # of the tube, and of one of more than `MANY` rings
MANY = 801
AROUND = 72  # sides of the cylinder
HIGH = 500  # pixels of the scene on the page, about
ROUGH = 1.5  # pixels that the light tube's centreline may be off
TALLEST = 9.0  # diameters; a taller scene is drawn compressed along the axis, or the rod would be a hair

Floats = NDArray[np.float32]
Indices = NDArray[np.uint32]


@dataclass(frozen=True, eq=False)
class Drawn:
    """Points and normals (m, 3), colours (m, 3) of bytes, and polygons as vtk.js has them (3, i, j, k, 3, ...).

    key: meshes of the same key have the same polygons. squeeze: by what the axis is compressed, at most 1. light: fewer
    polygons between the same points, for as long as a slider moves.
    """

    points: Floats
    normals: Floats
    colours: NDArray[np.uint8]
    polygons: Indices
    key: str
    squeeze: float
    light: Indices | None = None


def rod(sol: Solution) -> Drawn:
    """The tube of one case, at its stations; its two colours say where the cylinder pushes."""
    case = sol.case
    a, rho = float(case.rod.a), float(case.rho)
    reach = max(float(case.cylinder.R), rho + a)
    squeeze = min(1.0, TALLEST * 2 * reach / max(float(np.ptp(sol.z)), 1e-300))
    s = np.sin(sol.beta)
    beta = np.arctan2(s, squeeze * np.cos(sol.beta)) if squeeze < 1 else sol.beta
    centre = frames.position(rho, sol.alpha, squeeze * sol.z)
    out, across = frames.outward(sol.alpha), frames.binormal(sol.alpha, beta)
    along = frames.tangent(sol.alpha, beta)[[0, -1]] * np.array([[-1.0], [1.0]])
    n = sol.s.size
    sides = sides_of(n)
    angle = np.linspace(0.0, 2 * np.pi, sides, endpoint=False)[:, None]
    normals = np.cos(angle) * out[:, None] + np.sin(angle) * across[:, None]
    points = centre[:, None] + a * normals
    lids = points[[0, -1]].reshape(-1, 3)  # once more, for the flat ends' own normals
    shades = np.array([_bytes(style.PUSHED), _bytes(style.LIFTED)])
    colours = shades[np.repeat((sol.push < 0).astype(int), sides)]
    return Drawn(
        np.concatenate([points.reshape(-1, 3), lids]).astype(np.float32),
        np.concatenate([normals.reshape(-1, 3), np.repeat(along, sides, axis=0)]).astype(np.float32),
        np.concatenate([colours, colours[:sides], colours[-sides:]]),
        tube_polygons(n),
        f"tube {n} {(stride := _stride(centre, a, reach))}",
        squeeze,
        tube_polygons(n, stride, 2),
    )


def _stride(centre: NDArray[np.float64], a: float, reach: float) -> int:
    """Every how many rings a tube may have one, so that it is off by `ROUGH` pixels at most; (n, 3) and lengths.

    The arc over k even steps rises above its chord by k^2 |second difference| / 8, on the outer side of the bend by
    1 + kappa a times that.
    """
    bend = float(np.sqrt((np.diff(centre, 2, axis=0) ** 2).sum(axis=-1)).max())
    step = float(np.sqrt((np.diff(centre, axis=0) ** 2).sum(axis=-1)).max())
    off = ROUGH * max(2 * reach, float(np.ptp(centre[:, 2]))) / HIGH
    rise = bend * (1 + a * bend / max(step, 1e-300) ** 2)
    return int(np.clip(np.sqrt(8 * off / max(rise, 1e-300)), 1, 16))


def sides_of(rings: int) -> int:
    """How many sides a tube of so many rings has."""
    return SIDES[int(rings > MANY)]


def cylinder(sol: Solution, squeeze: float) -> Drawn:
    """The cylinder of a solution, a little longer than the rod."""
    R = float(sol.case.cylinder.R)
    beyond = float(sol.case.rod.a) + 0.35 * R
    low, high = squeeze * float(sol.z.min()) - beyond, squeeze * float(sol.z.max()) + beyond
    return wall(R, sol.case.cylinder.side, low, high, squeeze)


def wall(R: float, side: str, low: float, high: float, squeeze: float = 1.0) -> Drawn:
    """The cylinder's wall between two heights, and its lids where the rod lies outside."""
    angle = np.linspace(0.0, 2 * np.pi, AROUND, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle), np.zeros(AROUND)], axis=-1)
    ends = [R * ring + [0, 0, height] for height in (low, high)]
    flat = np.repeat([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]], AROUND, axis=0)
    points = np.concatenate([*ends, *ends]).astype(np.float32)
    normals = np.concatenate([ring, ring, flat]).astype(np.float32)
    colours = np.broadcast_to(_bytes(style.SURFACE), points.shape).astype(np.uint8)
    return Drawn(points, normals, colours, _cylinder_polygons(side == "outside"), f"cylinder {side}", squeeze)


def _bytes(colour: str) -> NDArray[np.uint8]:
    return np.round(255 * np.array(to_rgb(colour))).astype(np.uint8)


@lru_cache(maxsize=32)
def tube_polygons(n: int, stride: int = 1, skip: int = 1) -> Indices:
    """The polygons of a tube of n rings, between every stride-th ring and every skip-th side."""
    sides = sides_of(n)
    index = np.arange(n * sides).reshape(n, sides)[np.append(np.arange(0, n - 1, stride), n - 1), ::skip]
    beside = np.roll(index, -1, axis=1)
    walls = np.stack([index[:-1], beside[1:], beside[:-1], index[:-1], index[1:], beside[1:]], axis=-1).reshape(-1, 3)
    corner = np.arange(0, sides, skip)
    fan = np.stack([np.zeros(corner.size - 2, dtype=int), corner[1:-1], corner[2:]], axis=-1)
    return _listed(np.concatenate([walls, n * sides + fan, (n + 1) * sides + fan[:, ::-1]]))


@lru_cache(maxsize=2)
def _cylinder_polygons(lids: bool) -> Indices:
    low = np.arange(AROUND)
    beside = np.roll(low, -1)
    walls = np.stack([low, beside, AROUND + beside, low, AROUND + beside, AROUND + low], axis=-1).reshape(-1, 3)
    fan = np.stack([np.zeros(AROUND - 2, dtype=int), np.arange(1, AROUND - 1), np.arange(2, AROUND)], axis=-1)
    flat = [2 * AROUND + fan[:, ::-1], 3 * AROUND + fan] if lids else []
    return _listed(np.concatenate([walls, *flat]))


def _listed(triangles: NDArray[np.int64]) -> Indices:
    return np.insert(triangles, 0, 3, axis=1).ravel().astype(np.uint32)
