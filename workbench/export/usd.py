"""USD: the centreline as a cubic curve with its width, as text (.usda), for modelling programs."""

from pathlib import Path
from typing import Any

import numpy as np

from ..geometry.centreline import Array
from ..geometry.tube_tolerance import push_along
from .file_format import ExportedRod, Format, metres
from .surface_files import near

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


def write(path: Path, rod: ExportedRod) -> dict[str, Any]:
    """Write Bézier curves from place to place, with the exact tangents there; width, push and colour at these places.

    They are the stations, and between them as many as the straight line of the push needs. The numbers are in the unit
    of length of the dataset, which `metersPerUnit` states. The axis of the cylinder is z.
    """
    line = rod.line.cut(push_along(rod.line).parts)
    points = np.concatenate([np.swapaxes(line.cubic.c[:3], 0, 1).reshape(-1, 3), line.cubic.c[3, -1:]])
    push = line.push(line.s)
    low, high = points.min(axis=0) - line.a, points.max(axis=0) + line.a
    rows = {
        "float3[] extent": _vectors(np.stack([low, high])),
        "point3f[] points": _vectors(points),
        "float[] widths": f'[{2 * line.a:.9g}] (\n            interpolation = "constant"\n        )',
        "color3f[] primvars:displayColor": _primvar(_vectors(rod.shades(push))),
        "float[] primvars:push": _primvar(_numbers(push)),
        "float[] primvars:beta": _primvar(_numbers(line.beta)),
        "float[] primvars:s": _primvar(_numbers(line.s)),
    }
    title = '"' + rod.title.replace("\\", "\\\\").replace('"', '\\"') + '"'
    head = HEAD.format(title=title, metres=metres(rod.unit), count=len(points))
    body = "".join(f"        {name} = {value}\n" for name, value in rows.items())
    path.write_text(f"{head}{body}    }}\n}}\n", encoding="utf-8")
    return {"stations": line.s.size, "points": len(points)}


def _numbers(values: Array) -> str:
    return "[" + ", ".join(f"{value:.9g}" for value in values) + "]"


def _vectors(values: Array) -> str:
    return "[" + ", ".join(f"({x:.9g}, {y:.9g}, {z:.9g})" for x, y, z in values) + "]"


def _primvar(text: str) -> str:
    return f'{text} (\n            interpolation = "varying"\n        )'


FORMAT = Format(write, tolerance=near, curve_share=1.0, cubic=True, coloured=True)
