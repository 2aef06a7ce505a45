"""Rods as files of other programs: STEP, meshes, tables."""

# the suffix of a file -> the module that writes it, which has its `FORMAT`; --help lists them
FORMATS = {
    ".step": "step",
    ".stp": "step",
    ".stl": "surface_files",
    ".obj": "surface_files",
    ".glb": "gltf",
    ".gltf": "gltf",
    ".usda": "usd",
    ".vtp": "vtp",
    ".pvd": "pvd",
    ".csv": "csv_table",
}
