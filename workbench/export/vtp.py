"""VTP: the centreline as a polyline of VTK with every quantity as point data."""

from pathlib import Path
from typing import Any

import numpy as np

from solver.orbits import frames

from .csv_table import columns
from .file_format import ExportedRod, Format


def write(path: Path, rod: ExportedRod) -> dict[str, Any]:
    """Write every quantity, the frame and the radius as point data; units, title and versions as field data."""
    import pyvista as pv

    (table, facts), line = columns(rod), rod.line
    shape = pv.PolyData(line.place, lines=np.concatenate([[line.s.size], np.arange(line.s.size)]))
    for column in table:
        shape.point_data[column.name] = column.values
    shape.point_data["radius"] = np.full(line.s.size, line.a)  # for a tube filter
    shape.point_data["tangent"] = line.tangent
    shape.point_data["outward"] = frames.outward(line.alpha)
    shape.field_data["units"] = [f"{c.name}: {c.unit}" for c in table]
    for name, value in (("title", rod.title), ("versions", str(rod.stored.attrs["versions"]))):
        shape.field_data[name] = [value.encode("ascii", "backslashreplace").decode()]  # VTK takes no other
    writer = pv.XMLPolyDataWriter(path, shape).writer
    writer.SetDataModeToBinary()
    writer.WriteToOutputStringOn()  # on a full disk VTK would write its own report, or leave an empty file
    writer.Write()
    path.write_text(writer.GetOutputString(), encoding="ascii")
    return facts


FORMAT = Format(write)
