"""PVD: a time series for ParaView. One VTP file for each rod along an axis, and an index with the value as the time."""

import os
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

from solver.problem.errors import InputError

from ..stored.stored_study import StoredStudy
from . import vtp
from .file_format import ExportedRod, ExportOptions, Format

HEAD = '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n  <Collection>\n'
TAIL = "  </Collection>\n</VTKFile>\n"


@dataclass(frozen=True, eq=False)
class Series:
    """The solved rods along an axis and their values there; skipped: how many cases have no shape."""

    name: str
    axis: str
    values: list[float]
    rods: list[ExportedRod]
    skipped: int

    @property
    def at(self) -> dict[str, float]:
        """The values of the other axes."""
        stored, where = self.rods[0].stored, self.rods[0].where
        return {name: float(stored[name].values[i]) for name, i in where.items() if name != self.axis}


def along(stored: StoredStudy, name: str, options: ExportOptions) -> Series:
    """The rods along the one axis that the options do not name. name: of the file, without its ending.

    Raises `InputError` where no axis or more than one remains, or no case along it is solved.
    """
    axis = stored.axis_left(options.at, "these files go", "name all but one with --at")
    cases = stored.places(axis, options.at)
    rods = []
    for case in cases:
        if stored["solved"].isel(case):
            title = f"{stored.attrs['study_name']} {axis}={float(stored[axis][case[axis]]):.6g}"
            rods.append(ExportedRod(stored, case, stored.select(case).centreline, title, options))
    if not rods:
        raise InputError(f"no case along {axis} is solved: there is nothing to export")
    values = [float(stored[axis][rod.where[axis]]) for rod in rods]
    return Series(name, axis, values, rods, len(cases) - len(rods))


def check_free(path: Path, force: bool) -> None:
    """Raise `InputError` where the folder of the VTP files is there without `force`, or holds anything else."""
    folder = path.with_suffix("")
    if not folder.exists():
        return
    other = sorted(file.name for file in folder.iterdir() if file.suffix != ".vtp") if folder.is_dir() else ["a file"]
    if other:
        raise InputError(f"{folder} is not a folder of VTP files only, it is or holds {other[0]}: choose another name")
    if not force:
        raise InputError(f"{folder} exists; give --force to replace it")


def write(path: Path, series: Series) -> dict[str, Any]:
    """Write the VTP files into the folder `series.name` beside `path`, in place of what it holds, and the index."""
    folder = path.with_name(series.name)
    aside = path.with_name(f".{series.name}.{os.getpid()}.part")
    digits = len(str(len(series.rods) - 1))
    try:
        aside.mkdir()
        rows, facts = [], dict[str, Any]()
        for i, (value, rod) in enumerate(zip(series.values, series.rods, strict=True)):
            name = f"{series.name}_{i:0{digits}}.vtp"
            facts |= vtp.write(aside / name, rod)
            rows.append(f'    <DataSet timestep="{value!r}" part="0" file={quoteattr(f"{folder.name}/{name}")}/>\n')
        path.write_text(f"{HEAD}{''.join(rows)}{TAIL}", encoding="utf-8")
        shutil.rmtree(folder, ignore_errors=True)
        aside.replace(folder)
    finally:
        shutil.rmtree(aside, ignore_errors=True)
    without = {name: said for name, said in facts.items() if name == "without"}
    return {"axis": series.axis, "files": len(rows), "unsolved": series.skipped, **without}


FORMAT = Format(write, series=True)
