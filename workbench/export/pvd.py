"""PVD: a time series for ParaView. One VTP file a value of an axis, and an index in which that value is the time."""

import os
import shutil
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

from solver.problem.errors import InputError

from . import vtp
from .base import Format
from .series import Series

HEAD = '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n  <Collection>\n'
TAIL = "  </Collection>\n</VTKFile>\n"


def check_free(path: Path, force: bool) -> None:
    """Raise `InputError` where the folder of the VTP files is there without `force`, or holds anything else."""
    folder = path.with_suffix("")
    if not folder.exists():
        return
    other = sorted(one.name for one in folder.iterdir() if one.suffix != ".vtp") if folder.is_dir() else ["a file"]
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
        rows = []
        for i, (value, rod) in enumerate(zip(series.values, series.rods, strict=True)):
            name = f"{series.name}_{i:0{digits}}.vtp"
            vtp.write(aside / name, rod)
            rows.append(f'    <DataSet timestep="{value!r}" part="0" file={quoteattr(f"{folder.name}/{name}")}/>\n')
        path.write_text(f"{HEAD}{''.join(rows)}{TAIL}", encoding="utf-8")
        shutil.rmtree(folder, ignore_errors=True)
        aside.replace(folder)
    finally:
        shutil.rmtree(aside, ignore_errors=True)
    return {"axis": series.axis, "files": len(rows), "unsolved": series.skipped}


FORMAT = Format((".pvd",), write, series=True)
