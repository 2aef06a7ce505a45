"""The view of a stored case that turns in the browser: triangles and vtk.js as text inside the report."""

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

from solver.mechanics.contact import push_from

from ...figures import style
from ...geometry import centreline
from ...geometry.centreline import Array, Centreline
from .. import browser_assets
from ..live import page_mesh

SIDES = page_mesh.SIDES[0]
RINGS = 600  # below explore_mesh.MANY
PLACES = 4  # decimals of a point, whose unit is the scene's largest radius: a tenth of a pixel
BEYOND = 0.3  # radii by which the cylinder is longer than the rod


@dataclass(frozen=True)
class View:
    """Packed texts (gzip, then base64): the scene, and by name what draws it; and the page's own script."""

    scene: str
    scripts: dict[str, str]
    program: str


def view(ds: xr.Dataset) -> View:
    """Of a dataset of one case. Raises `InputError` without a shape, `ImportError` without the extra."""
    scripts = browser_assets.scripts()
    line = centreline.read(ds, {})
    s = np.linspace(0.0, float(ds["L"]), RINGS)
    push = push_from(np.interp(s, ds["s"].values, ds["contact"].values), str(ds.attrs["side"]))
    told = json.dumps(
        scene(line, s, push, float(ds["R"]), float(ds["a"]), str(ds.attrs["side"])), separators=(",", ":")
    )
    return View(
        _packed(told),
        {name: _packed_file(path) for name, path in scripts.items()},
        (files("workbench.web.live") / "page/view.js").read_text(encoding="utf-8"),
    )


def scene(line: Centreline, s: Array, push: Array, R: float, a: float, side: str) -> dict[str, Any]:
    """Parts with points and normals (3 m numbers), polygons (3, i, j, k, ...) and a colour; lengths over the reach.

    s, push: rings and the cylinder's push there, (n,). azimuth: from where one looks [rad].
    """
    place, along, out, across = line.frame(s)
    reach = max(R, float(np.hypot(place[:, 0], place[:, 1]).max()) + a)
    angle = np.linspace(0.0, 2 * np.pi, SIDES, endpoint=False)[:, None]
    normals = np.cos(angle) * out[:, None] + np.sin(angle) * across[:, None]
    points = place[:, None] + a * normals
    lids = points[[0, -1]].reshape(-1, 3)  # once more, for the flat ends' own normals
    points = np.concatenate([points.reshape(-1, 3), lids])
    ends = np.repeat(along[[0, -1]] * [[-1.0], [1.0]], SIDES, axis=0)
    normals = np.concatenate([normals.reshape(-1, 3), ends])
    triangles = page_mesh.tube_polygons(s.size).reshape(-1, 4)[:, 1:]
    held = push[np.minimum(triangles[:, 0] // SIDES, s.size - 1)] >= 0
    beyond = a + BEYOND * R
    wall = page_mesh.wall(R, side, float(place[:, 2].min()) - beyond, float(place[:, 2].max()) + beyond)
    solid = 1.0 if side == "outside" else 0.16
    parts = [_part("wall", wall.points / reach, wall.normals, wall.polygons, style.SURFACE, solid)]
    for name, colour, chosen in (("pushed", style.PUSHED, held), ("lifted", style.LIFTED, ~held)):
        if chosen.any():
            mine, inverse = np.unique(triangles[chosen], return_inverse=True)
            polygons = np.insert(inverse.reshape(-1, 3), 0, 3, axis=1).ravel()
            parts.append(_part(name, points[mine] / reach, normals[mine], polygons, colour, 1.0))
    azimuth = np.angle((place[:, 0] + 1j * place[:, 1]).mean())
    return {"azimuth": float(azimuth), "parts": parts}


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
