"""STL and OBJ: the rod as a closed surface of triangles."""

from pathlib import Path
from typing import Any

import numpy as np

from solver.problem.errors import InputError

from ..geometry import tube as tubes
from ..geometry.centreline import Array, Centreline
from ..geometry.tube import Mesh
from .base import Format, Rod

LEAST_SIDES = 12
MOST_TRIANGLES = 20_000_000  # an STL file of 1 GB
LONGEST = 2.0  # radii between rings, so that the colours change where the push does
NEAR = 1e-3  # of the rod's radius: the default tolerance


def near(line: Centreline) -> float:
    """The default tolerance of a mesh [length]."""
    return NEAR * line.a


def tube(line: Centreline, tolerance: float) -> tuple[Mesh, Array]:
    """The tube about the whole rod, nowhere farther than the tolerance [length] from the true surface.

    A rod with an inner radius has its bore. Its sections are polygons with the area of the circle, so that the volume
    is the rod's. Returns with it the arc
    length of each point, (m,). Raises `InputError` for a rod that would need more than `MOST_TRIANGLES`.
    """
    # a polygon of the circle's area leaves it by a x^2/12 at its corners, x the angle of a side
    sides = max(int(np.ceil(2 * np.pi / np.sqrt(6 * tolerance / line.a))), LEAST_SIDES)
    s, x = _rings(line, tolerance / 2, sides), 2 * np.pi / sides
    larger = np.sqrt(x / np.sin(x))
    if line.bore:
        mesh = tubes.hollow(line.frame(s), line.a * larger, line.bore * larger, sides)
        return mesh, np.tile(np.repeat(s, sides), 2)
    mesh = tubes.mesh(line.frame(s), line.a * larger, sides, sharp=False)
    return mesh, tubes.at_points(s, sides, sharp=False)


def write(path: Path, rod: Rod) -> dict[str, Any]:
    """Write binary STL (single precision) or OBJ (full precision, with normals), by the suffix; neither has units."""
    import pyvista as pv

    mesh, _ = tube(rod.line, rod.tolerance)
    surface = pv.PolyData(mesh.points, faces=np.insert(mesh.triangles, 0, 3, axis=1).ravel())
    surface.point_data.active_normals = mesh.normals
    surface.save(path)
    return {"triangles": len(mesh.triangles)}


def _rings(line: Centreline, tolerance: float, sides: int) -> Array:
    """Where the rings stand, (n,): so dense that chords are within the tolerance of the bent and twisted tube."""
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


FORMAT = Format((".stl", ".obj"), write, "surface", near)
