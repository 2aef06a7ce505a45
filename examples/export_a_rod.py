"""
Export to Blender and FreeCAD
=============================

A solved rod becomes a file of another program. Blender opens glTF (``.glb``); FreeCAD opens STEP (``.step``), which
needs the extra ``cad``. On the command line this is ``workbench export FILE --out rod.step``.
"""

from importlib.util import find_spec
from pathlib import Path

import numpy as np
import trimesh

from solver import Case, Cylinder, Rod, Start, solve
from workbench.export.stored_rod import ExportOptions, export
from workbench.stored.stored_study import StoredStudy

rod = Rod(E=1e4, nu=0.25, a=0.25, L=20.0)  # cm and N
start = Start(beta="10deg", dbeta=0.0, M3=0.0, F3=-10.0)
sol = solve(Case(rod, Cylinder(R=1.5, side="inside"), start), stations=401)
ds = sol.to_dataset(length="cm", force="N")
formats = ["glb", "step"] if find_spec("OCP") else ["glb"]
for name in formats:
    written = export(StoredStudy(ds), Path(f"rod.{name}"), ExportOptions(tolerance=0.005), force=True)
    print(written.path, written.facts)
sol.scene(length="cm", force="N").save("export_a_rod.html")

# sphinx_gallery_thumbnail_path = "_static/thumbnails/export_a_rod.png"

# %%
# glTF is in metres. Read back, the mesh is closed, and its volume is that of the rod: π a² L.

mesh = trimesh.load_scene("rod.glb").to_mesh()
print(f"volume {mesh.volume * 1e6:.3f} cm³")
assert mesh.is_watertight
np.testing.assert_allclose(mesh.volume * 1e6, np.pi * 0.25**2 * 20.0, rtol=0.01)
