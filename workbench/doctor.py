"""The command doctor: what works on this machine, found by trying it."""

import platform
import tempfile
from pathlib import Path
from typing import Any

from . import console, dataset


def examine(json: bool) -> int:
    """Try everything and print what works; always 0, as examining is what was asked."""
    findings = [_hdf5(), _opengl(), _font()]
    packages = {**dataset.versions(), **_drawing_versions()}
    if json:
        console.print_json({"system": platform.platform(), "checks": findings, "versions": packages})
        return 0
    rows = [[f["what"], "works" if f["works"] else "does not work", f["said"]] for f in findings]
    console.print_table(["", "", ""], rows)
    console.say("")
    console.print_table(["version", ""], [["system", platform.platform()], *map(list, packages.items())])
    return 0


def _finding(what: str, works: bool, said: str) -> dict[str, Any]:
    return {"what": what, "works": works, "said": said}


def _hdf5() -> dict[str, Any]:
    """Store a small dataset and read it back with compression."""
    import h5py
    import numpy as np
    import xarray as xr

    try:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "doctor.h5"
            ds = xr.Dataset({"x": ("u", np.arange(1000.0))})
            packed = {"zlib": True, "complevel": 1, "shuffle": True}
            ds.to_netcdf(path, engine="h5netcdf", encoding={"x": packed})
            works = xr.load_dataset(path, engine="h5netcdf").identical(ds)
    except (OSError, ValueError) as error:
        return _finding("HDF5", False, f"storing failed: {error}")
    return _finding("HDF5", works, f"HDF5 {h5py.version.hdf5_version}, a dataset stored and read back")


def _opengl() -> dict[str, Any]:
    from . import gl

    able, advice = gl.probe()
    return _finding("OpenGL", able, advice or "a scene was drawn off-screen")


def _font() -> dict[str, Any]:
    """Whether the font that Matplotlib would use has the Greek letters of the labels."""
    from matplotlib.font_manager import FontProperties, findfont, get_font

    path = findfont(FontProperties())
    missing = [letter for letter in "βκρ₀→" if ord(letter) not in get_font(path).get_charmap()]
    said = f"lacks {' '.join(missing)}" if missing else "has the Greek letters of the labels"
    return _finding("fonts", not missing, f"{Path(path).name} {said}")


def _drawing_versions() -> dict[str, str]:
    from importlib.metadata import version

    return {name: version(name) for name in ("pyvista", "vtk", "matplotlib", "typer", "rich", "pydantic")}
