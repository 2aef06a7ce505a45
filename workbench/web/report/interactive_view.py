"""The interactive view of a stored case in the report: triangles and vtk.js as text inside the page."""

import base64
import gzip
import json
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.colors import to_rgb

from ...figures import style
from ...geometry import centreline, tube
from ...geometry.centreline import Array, Centreline
from ...scene.colours import SURFACE
from .. import browser_assets

SIDES, RINGS = 20, 600  # of the tube
AROUND = 72  # sides of the cylinder
PLACES = 4  # decimals of a point, whose unit is the scene's largest radius: a tenth of a pixel
BEYOND = 0.3  # radii by which the cylinder is longer than the rod


@dataclass(frozen=True)
class View:
    """The scene and the scripts that draw it by name, compressed (gzip, then base64); and the page's own script."""

    scene: str
    scripts: dict[str, str]
    program: str


def view(ds: xr.Dataset) -> View:
    """The view of a dataset of one case. Raises `InputError` without a shape, `ImportError` without the extra."""
    scripts = browser_assets.scripts()
    line = centreline.read(ds, {})
    s = np.linspace(0.0, float(ds["L"]), RINGS)
    return View(
        _packed(json.dumps(scene(line, s), separators=(",", ":"))),
        {name: _packed_file(path) for name, path in scripts.items()},
        (files("workbench.web.report") / "view.js").read_text(encoding="utf-8"),
    )


def scene(line: Centreline, s: Array) -> dict[str, Any]:
    """The parts of the view as plain data; s: the rings, (n,) [length].

    Each part has points and normals (3 m numbers), polygons (3, i, j, k, ...) and a colour; lengths are shares of the
    scene's largest radius. azimuth: the direction from which one looks [rad].
    """
    frame = line.frame(s)
    place, R = frame[0], line.R
    reach = max(R, float(np.hypot(place[:, 0], place[:, 1]).max()) + line.a)
    points, normals = tube.surface(frame, line.a, SIDES)
    triangles = tube.triangles(s.size, SIDES)
    pushed = tube.at_points(line.push(s) >= 0, SIDES)[triangles[:, 0]]
    beyond = line.a + BEYOND * R
    wall = _wall(R, line.side, float(place[:, 2].min()) - beyond, float(place[:, 2].max()) + beyond)
    opacity = 1.0 if line.side == "outside" else 0.16
    parts = [_part("wall", wall[0] / reach, *wall[1:], SURFACE, opacity)]
    for name, colour, chosen in (("pushed", style.PUSHED, pushed), ("lifted", style.LIFTED, ~pushed)):
        if chosen.any():
            own, inverse = np.unique(triangles[chosen], return_inverse=True)
            polygons = np.insert(inverse.reshape(-1, 3), 0, 3, axis=1).ravel()
            parts.append(_part(name, points[own] / reach, normals[own], polygons, colour, 1.0))
    azimuth = np.angle((place[:, 0] + 1j * place[:, 1]).mean())
    return {"azimuth": float(azimuth), "parts": parts}


def _wall(R: float, side: str, low: float, high: float) -> tuple[Array, Array, Any]:
    """Points, normals and polygons of the cylinder between two heights, with flat ends where the rod lies outside."""
    along, out, across = (np.tile(way, (2, 1)) for way in ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]))
    points, normals = tube.surface((np.array([[0.0, 0.0, low], [0.0, 0.0, high]]), along, out, across), R, AROUND)
    triangles = tube.triangles(2, AROUND)[: None if side == "outside" else 2 * AROUND]
    return points, normals, np.insert(triangles, 0, 3, axis=1).ravel()


def _part(name: str, points: Any, normals: Any, polygons: Any, colour: str, opacity: float) -> dict[str, Any]:
    return {
        "name": name,
        "points": np.round(np.asarray(points, dtype=float).ravel(), PLACES).tolist(),
        "normals": np.round(np.asarray(normals, dtype=float).ravel(), 3).tolist(),
        "polygons": np.asarray(polygons).tolist(),
        "colour": list(to_rgb(colour)),
        "opacity": opacity,
    }


@cache
def _packed_file(path: Path) -> str:
    return _packed(path.read_text(encoding="utf-8"))


def _packed(text: str) -> str:
    return base64.b64encode(gzip.compress(text.encode("utf-8"), mtime=0)).decode("ascii")
