"""USD: the centreline as a cubic curve with its width, as text (.usda), for modelling programs."""

from pathlib import Path
from typing import Any

import numpy as np

from solver.mechanics import frames

from ..geometry.centreline import Array
from .base import METRES, Format, Rod

HEAD = """#usda 1.0
(
    defaultPrim = "Rod"
    doc = {title}
    metersPerUnit = {metres!r}
    upAxis = "Z"
)

def Xform "Rod" (
    kind = "component"
)
{{
    def BasisCurves "Centreline"
    {{
        uniform token type = "cubic"
        uniform token basis = "bezier"
        uniform token wrap = "nonperiodic"
        int[] curveVertexCounts = [{count}]
"""


def write(path: Path, rod: Rod) -> dict[str, Any]:
    """Write Bézier curves between the stations, with the exact tangents there; width, push and colour at the stations.

    The numbers are in the unit of length of the dataset, which `metersPerUnit` states. The axis of the cylinder is z.
    """
    from ..figures.style import LIFTED, PUSHED  # they load Matplotlib
    from ..scene.colours import linear

    line = rod.line
    points = bezier(line.s, frames.position(line.rho, line.alpha, line.z), frames.tangent(line.alpha, line.beta))
    push = line.push(line.s)
    colours = np.where(push[:, None] < 0, linear(LIFTED), linear(PUSHED))
    low, high = points.min(axis=0) - line.a, points.max(axis=0) + line.a
    rows = {
        "float3[] extent": _vectors(np.stack([low, high])),
        "point3f[] points": _vectors(points),
        "float[] widths": f"[{2 * line.a:.9g}] (\n            interpolation = \"constant\"\n        )",
        "color3f[] primvars:displayColor": _varying(_vectors(colours)),
        "float[] primvars:push": _varying(_numbers(push)),
        "float[] primvars:beta": _varying(_numbers(line.beta)),
        "float[] primvars:s": _varying(_numbers(line.s)),
    }  # fmt: skip
    title = '"' + rod.title.replace("\\", "\\\\").replace('"', '\\"') + '"'
    head = HEAD.format(title=title, metres=METRES[rod.unit], count=len(points))
    body = "".join(f"        {name} = {value}\n" for name, value in rows.items())
    path.write_text(f"{head}{body}    }}\n}}\n", encoding="utf-8")
    return {"stations": line.s.size, "points": len(points), "unit": rod.unit}


def bezier(s: Array, places: Array, tangents: Array) -> Array:
    """The control points of cubic curves through places (n, 3) at arc lengths s (n,), (3 n - 2, 3)."""
    third = np.diff(s)[:, None] / 3
    before, after = places[:-1] + third * tangents[:-1], places[1:] - third * tangents[1:]
    segments = np.stack([places[:-1], before, after], axis=1).reshape(-1, 3)
    return np.concatenate([segments, places[-1:]])


def _numbers(values: Array) -> str:
    return "[" + ", ".join(f"{value:.9g}" for value in values) + "]"


def _vectors(values: Array) -> str:
    return "[" + ", ".join(f"({x:.9g}, {y:.9g}, {z:.9g})" for x, y, z in values) + "]"


def _varying(text: str) -> str:
    return f'{text} (\n            interpolation = "varying"\n        )'


FORMAT = Format((".usda",), write)
