"""The rod as a closed surface of triangles: STL, OBJ and glTF."""

import json
from base64 import b64encode
from dataclasses import dataclass
from pathlib import Path
from struct import pack
from typing import Any

import numpy as np
from matplotlib.colors import to_rgb
from numpy.typing import NDArray

from solver.problem.errors import InputError

from ..figures import style
from ..geometry.centreline import Array, Centreline

LEAST_SIDES = 12
MOST_TRIANGLES = 20_000_000  # an STL file of 1 GB
LONGEST = 2.0  # radii between rings, so that the colours change where the push does
METRES = {"nm": 1e-9, "um": 1e-6, "mm": 1e-3, "cm": 1e-2, "dm": 0.1, "m": 1.0, "km": 1e3, "in": 0.0254, "ft": 0.3048}


@dataclass(frozen=True, eq=False)
class Mesh:
    """A closed surface. points, normals: (m, 3); triangles: (k, 3), seen from outside counterclockwise; s: the arc
    length of each point, (m,)."""

    points: Array
    normals: Array
    triangles: NDArray[np.int64]
    s: Array


def tube(line: Centreline, tolerance: float) -> Mesh:
    """The tube about the whole rod, nowhere farther than the tolerance [length] from the true surface.

    Its sections are polygons with the area of the circle, so that the volume is the rod's. Raises `InputError` for a
    rod that would need more than `MOST_TRIANGLES`.
    """
    # a polygon of the circle's area leaves it by a x^2/12 at its corners, x the angle of a side
    sides = max(int(np.ceil(2 * np.pi / np.sqrt(6 * tolerance / line.a))), LEAST_SIDES)
    s = _rings(line, tolerance / 2, sides)
    place, along, out, across = line.frame(s)
    angle = np.linspace(0.0, 2 * np.pi, sides, endpoint=False)[:, None]
    x = 2 * np.pi / sides
    normals = np.cos(angle) * out[:, None] + np.sin(angle) * across[:, None]
    points = place[:, None] + line.a * np.sqrt(x / np.sin(x)) * normals
    n = s.size
    index = np.arange(n * sides).reshape(n, sides)
    beside = np.roll(index, -1, axis=1)
    walls = np.stack([index[:-1], beside[1:], beside[:-1], index[:-1], index[1:], beside[1:]], axis=-1)
    first, last = np.full(sides, n * sides), np.full(sides, n * sides + 1)
    ends = np.stack([index[0], beside[0], first], axis=-1), np.stack([beside[-1], index[-1], last], axis=-1)
    return Mesh(
        np.concatenate([points.reshape(-1, 3), place[[0, -1]]]),
        np.concatenate([normals.reshape(-1, 3), [-along[0], along[-1]]]),
        np.concatenate([walls.reshape(-1, 3), *ends]),
        np.concatenate([np.repeat(s, sides), s[[0, -1]]]),
    )


def _rings(line: Centreline, tolerance: float, sides: int) -> Array:
    """Where the rings stand: as dense as a chord's distance from the bent and twisted tube asks."""
    s = np.linspace(line.s[0], line.s[-1], 16 * line.s.size)
    _, beta, _ = line.at(s)
    kappa, turning = line.kappa(s), np.sin(2 * beta) / (2 * line.rho)
    dense = np.sqrt((kappa * (1 + kappa * line.a) + line.a * turning**2) / (8 * tolerance))
    count = np.concatenate([[0.0], np.cumsum(np.diff(s) * (dense[1:] + dense[:-1]) / 2)])
    count = np.maximum(count, 0) + (s - s[0]) / (LONGEST * line.a)
    n = max(int(np.ceil(count[-1])), 2)
    if 2 * sides * n > MOST_TRIANGLES:
        raise InputError(f"this rod would need {2 * sides * n} triangles, more than {MOST_TRIANGLES}: give a larger "
                         "--tolerance")  # fmt: skip
    return np.interp(np.linspace(0, count[-1], n + 1), count, s)


def write_surface(path: Path, mesh: Mesh) -> None:
    """STL (binary, single precision) or OBJ (full precision, with normals), by the name's ending; neither has units."""
    import pyvista as pv

    faces = np.insert(mesh.triangles, 0, 3, axis=1).ravel()
    surface = pv.PolyData(mesh.points, faces=faces)
    surface.point_data.active_normals = mesh.normals
    surface.save(path)


def write_gltf(path: Path, mesh: Mesh, push: Array, title: str, unit: str) -> None:
    """glTF 2.0, as one binary file where the name ends in .glb, else as JSON with the data inside.

    push: at each point, negative where the cylinder would have to pull, NaN where not known; coloured as in the
    scenes. In metres and with y up, as the format has it: the cylinder's axis is y.
    """
    lifted = np.asarray(push)[:, None] < 0
    colours = np.where(lifted, _linear(style.LIFTED), _linear(style.PUSHED))
    turned = mesh.points[:, [1, 2, 0]], mesh.normals[:, [1, 2, 0]]
    arrays = [*turned, np.concatenate([colours, np.ones_like(lifted, dtype=float)], axis=1)]
    parts = [array.astype("<f4").tobytes() for array in arrays] + [mesh.triangles.astype("<u4").tobytes()]
    data = b"".join(parts)
    asset = _asset(turned[0].astype("<f4"), [len(part) for part in parts], mesh.triangles.size)
    asset["nodes"] = [{"mesh": 0, "name": title, "scale": 3 * [METRES[unit]]}]
    if path.suffix.lower() == ".gltf":
        asset["buffers"][0]["uri"] = "data:application/octet-stream;base64," + b64encode(data).decode("ascii")
        path.write_text(json.dumps(asset), encoding="utf-8")
        return
    said = json.dumps(asset).encode("utf-8")
    said += b" " * (-len(said) % 4)
    chunks = pack("<II", len(said), 0x4E4F534A) + said + pack("<II", len(data), 0x004E4942) + data
    path.write_bytes(pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)


def _asset(points: NDArray[np.float32], sizes: list[int], corners: int) -> dict[str, Any]:
    """The glTF description of one mesh whose points, normals, colours and triangles follow each other."""
    count = len(points)
    ends = np.concatenate([[0], np.cumsum(sizes)])
    views = [
        {"buffer": 0, "byteOffset": int(start), "byteLength": size, "target": 34963 if i == 3 else 34962}
        for i, (start, size) in enumerate(zip(ends[:-1], sizes, strict=True))
    ]
    kinds = ((5126, count, "VEC3"), (5126, count, "VEC3"), (5126, count, "VEC4"), (5125, corners, "SCALAR"))
    accessors: list[dict[str, Any]] = [
        {"bufferView": i, "componentType": kind, "count": n, "type": shape} for i, (kind, n, shape) in enumerate(kinds)
    ]
    accessors[0] |= {"min": points.min(axis=0).tolist(), "max": points.max(axis=0).tolist()}
    drawn = {"attributes": {"POSITION": 0, "NORMAL": 1, "COLOR_0": 2}, "indices": 3, "material": 0}
    return {
        "asset": {"version": "2.0", "generator": "rod workbench"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "meshes": [{"primitives": [drawn]}],
        "materials": [{"pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.55}}],
        "buffers": [{"byteLength": int(ends[-1])}],
        "bufferViews": views,
        "accessors": accessors,
    }


def _linear(colour: str) -> Array:
    """A colour of the screen (sRGB) as the light it stands for, (3,), which is what glTF stores."""
    c = np.array(to_rgb(colour))
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
