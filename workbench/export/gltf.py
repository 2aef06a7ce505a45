"""glTF 2.0: the rod in metres, in the two colours of a push and of lift-off, or in one. Written by trimesh."""

from pathlib import Path
from typing import Any

import numpy as np

from .file_format import ExportedRod, Format, metres
from .surface_files import near, tube

MATERIAL = {"pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.55}}


def write(path: Path, rod: ExportedRod) -> dict[str, Any]:
    """Write the rod as one binary file for the suffix .glb, else as JSON with the data inside.

    The format has y up: the cylinder's axis is y.
    """
    import trimesh

    mesh, s, off = tube(rod)
    rgba = np.round(255 * np.append(rod.shades(rod.line.push(s)), np.ones((s.size, 1)), axis=1)).astype(np.uint8)
    points, normals = mesh.points[:, [1, 2, 0]], mesh.normals[:, [1, 2, 0]]
    surface = trimesh.Trimesh(points, mesh.triangles, vertex_normals=normals, vertex_colors=rgba, process=False)
    scene = trimesh.Scene()
    scene.add_geometry(surface, node_name=rod.title, transform=np.diag([*3 * [metres(rod.unit)], 1.0]))
    options: Any = {"include_normals": True, "tree_postprocessor": _with_material}
    if path.suffix.lower() == ".glb":
        path.write_bytes(trimesh.exchange.gltf.export_glb(scene, **options))
    else:
        files = trimesh.exchange.gltf.export_gltf(scene, embed_buffers=True, **options)
        path.write_bytes(files["model.gltf"])
    return {"triangles": len(mesh.triangles), "tolerance": off}


def _with_material(tree: dict[str, Any]) -> None:
    """Not a metal, which is what the format takes a surface without a material for."""
    tree["materials"] = [MATERIAL]
    for primitive in (part for mesh in tree["meshes"] for part in mesh["primitives"]):
        primitive["material"] = 0


FORMAT = Format(write, "surface", near, unit="m", coloured=True, triangle_bytes={".glb": 26, ".gltf": 35})
