"""STL and OBJ: the rod as a closed surface of triangles."""

from pathlib import Path
from typing import Any

import numpy as np

from solver.problem.errors import InputError

from ..geometry import tube as tubes
from ..geometry.centreline import Array, Centreline
from ..geometry.tube import Mesh
from ..geometry.tube_tolerance import place_rings
from .file_format import ExportedRod, Format

LEAST_SIDES = 12
MOST_TRIANGLES = 20_000_000  # an STL file of 1 GB
LONGEST = 2.0  # radii between rings, so that the colours change where the push does
STL_HEADER = b"rod workbench"  # not the word solid, with which an STL file of text begins
STL_PART = 100_000  # triangles that are written at a time
NEAR = 1e-3  # of the rod's radius: the default tolerance
# how often rings are set closer, where diagonals cut off more than is allowed, and by how much
ROUNDS, CLOSER = 9, 0.85
BETWEEN = 9  # places from ring to ring at which it is read how much the rod bends


def near(line: Centreline) -> float:
    """The default tolerance of a mesh [length]."""
    return NEAR * line.a


def tube(rod: ExportedRod) -> tuple[Mesh, Array, float]:
    """The tube about the whole rod, nowhere farther than its tolerance [length] from the true surface.

    A rod with an inner radius has its bore. Its sections are polygons with the area of the circle, so that the volume
    is the rod's. Returns with it the arc length of each point, (m,), and what `off_by` says of it. Raises `InputError`
    for a rod that would need more than `MOST_TRIANGLES`.
    """
    line, (s, sides) = rod.line, _rings(rod.line, rod.tolerance, rod.options.triangles)
    larger, off = _larger(sides), off_by(line, s, sides)
    if line.bore:
        mesh = tubes.hollow(line.frame(s), line.a * larger, line.bore * larger, sides)
        return mesh, np.tile(np.repeat(s, sides), 2), off
    mesh = tubes.mesh(line.frame(s), line.a * larger, sides, sharp=False)
    return mesh, tubes.at_points(s, sides, sharp=False), off


def _larger(sides: int) -> float:
    """The radius of the corners of a polygon with the area of a circle, in its radii."""
    x = 2 * np.pi / sides
    return float(np.sqrt(x / np.sin(x)))


def off_by(line: Centreline, s: Array, sides: int) -> float:
    """A bound on the distance of a mesh from the true surface [length], from its rings s (n,) and its sides.

    A chord of h on a surface line of curvature c is off by c h^2/8 at most: inward on the outer side of a bend, where
    the diagonals cut off most, and outward on its inner side, beside the corners.
    """
    h, x, beyond = np.diff(s), 2 * np.pi / sides, line.a * (_larger(sides) - 1)
    share = np.linspace(0, 1, BETWEEN)[:, None]
    kappa = line.kappa((s[:-1] + h * share).ravel()).reshape(BETWEEN, -1)
    green = np.minimum(share, share.T) * (1 - np.maximum(share, share.T)) / (BETWEEN - 1)  # of a chord, 1/8 in all
    chord, outer = ((green @ bent).max(axis=0) * h**2 for bent in (kappa, kappa * (1 + kappa * line.a)))
    _, _, out, across = line.frame(s)
    turned = np.arcsin(np.clip(np.einsum("ij,ij->i", out[1:], across[:-1]), -1, 1))
    around = np.maximum(np.maximum(np.abs(x + turned), np.abs(turned)), x)  # a diagonal, an edge along, one across
    inward = outer + (line.a + beyond) * around**2 / 8 - beyond
    return float(max(inward.max(), chord.max() + beyond)) + line.error


def _rings(line: Centreline, tolerance: float, budget: int | None) -> tuple[Array, int]:
    """Where the rings of a mesh stand, (n,), and the number of its sides, for a tolerance [length].

    With a budget of triangles rings stand apart as far as the tolerance lets them.
    """
    # a polygon of the circle's area leaves it by a x^2/12 at its corners, x the angle of a side
    sides = max(int(np.ceil(2 * np.pi / np.sqrt(6 * tolerance / line.a))), LEAST_SIDES)

    def check(count: int) -> None:
        if _triangles(line, count + 1, sides) > MOST_TRIANGLES:
            raise InputError(
                f"this rod would need {_triangles(line, count + 1, sides)} triangles, more than {MOST_TRIANGLES}: give "
                "a larger --tolerance"
            )

    longest = LONGEST * line.a * (1.0 if budget is None else max(np.sqrt(tolerance / near(line)), 1.0))
    ends = float(line.s[0]), float(line.s[-1])
    s = place_rings(line, ends, tolerance / 2, check, longest=longest)
    for repeated in range(1, ROUNDS):
        if off_by(line, s, sides) <= tolerance:
            break
        s = place_rings(line, ends, tolerance * CLOSER**repeated / 2, check, longest=longest)
    return s, sides


def _triangles(line: Centreline, rings: int, sides: int) -> int:
    """The triangles of a closed tube: of its wall and its two ends; with a bore of two walls and two flat rings."""
    return 4 * sides * rings if line.bore else 2 * sides * rings


def triangles_of(line: Centreline, tolerance: float, budget: int | None = None) -> int:
    """The number of triangles of the mesh of a rod with a tolerance [length]. Raises `InputError` as `tube`."""
    s, sides = _rings(line, tolerance, budget)
    return _triangles(line, s.size, sides)


def within(line: Centreline, budget: int) -> float:
    """The tolerance [length] of a mesh of at most so many triangles: the default one, or the least larger one.

    Raises `InputError` where a mesh that is sure to be within the rod's radius takes more.
    """
    fine, coarse = near(line), line.a
    if (least := triangles_of(line, coarse, budget)) > budget:
        raise InputError(
            f"a mesh of {budget} triangles is not sure to be within the radius {line.a:g} of this rod: give "
            f"--triangles {least} or more"
        )
    if triangles_of(line, fine, budget) <= budget:
        return fine
    while coarse > 1.01 * fine:
        middle = float(np.sqrt(fine * coarse))
        fine, coarse = (fine, middle) if triangles_of(line, middle, budget) <= budget else (middle, coarse)
    return coarse


def write(path: Path, rod: ExportedRod) -> dict[str, Any]:
    """Write binary STL (single precision) or OBJ (full precision, with normals), by the suffix; neither has units."""
    mesh, _, off = tube(rod)
    (_write_stl if path.suffix.lower() == ".stl" else _write_obj)(path, mesh)
    return {"triangles": len(mesh.triangles), "tolerance": off}


def _write_stl(path: Path, mesh: Mesh) -> None:
    """A header of 80 bytes, the number of triangles, and of each triangle its normal and its corners."""
    with path.open("wb") as file:
        file.write(STL_HEADER.ljust(80, b"\0") + len(mesh.triangles).to_bytes(4, "little"))
        for i in range(0, len(mesh.triangles), STL_PART):
            corners = mesh.points[mesh.triangles[i : i + STL_PART]]
            across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            size = np.linalg.norm(across, axis=1, keepdims=True)
            rows = np.zeros(len(corners), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("unused", "<u2")])
            rows["normal"], rows["corners"] = across / np.where(size > 0, size, 1), corners
            file.write(rows.tobytes())


def _write_obj(path: Path, mesh: Mesh) -> None:
    """Have VTK write the mesh. It does not say where the disk takes only a part, so the end of the file is compared."""
    import pyvista as pv

    surface = pv.PolyData(mesh.points, faces=np.insert(mesh.triangles, 0, 3, axis=1).ravel())
    surface.point_data.active_normals = mesh.normals
    surface.save(path)
    last = " ".join(["f", *(f"{i}//{i}" for i in mesh.triangles[-1] + 1)]).encode()
    with path.open("rb") as file:
        file.seek(-min(len(last) + 2, path.stat().st_size), 2)
        if not file.read().rstrip().endswith(last):
            raise OSError("the disk did not take the whole file")


FORMAT = Format(write, "surface", near, triangle_bytes={".stl": 50, ".obj": 105})
