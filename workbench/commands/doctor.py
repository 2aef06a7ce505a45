"""The command doctor: what works on this machine, found by trying it."""

import platform
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from typing import Any

from solver.problem.errors import InputError

from ..data import dataset, schema
from . import console

APT = "apt-get install"


def examine(json: bool) -> int:
    """Try everything and print what works; always 0, as examining is what was asked."""
    findings = [_hdf5(), _opengl(), _font(), *(_extra(*row) for row in EXTRAS), _chromium()]
    packages = {**dataset.versions(), **_drawing_versions()}
    if json:
        console.print_json({"system": platform.platform(), "checks": findings, "versions": packages})
        return 0
    words = {True: "works", False: "does not work", None: "not installed"}
    rows = [[f["what"], words[f["works"] if f["installed"] else None], f["said"]] for f in findings]
    console.print_table(["", "", ""], rows)
    console.say("")
    console.print_table(["version", ""], [["system", platform.platform()], *map(list, packages.items())])
    return 0


def _finding(what: str, works: bool, said: str, installed: bool = True) -> dict[str, Any]:
    return {"what": what, "works": works, "installed": installed, "said": said}


def _hdf5() -> dict[str, Any]:
    """Store a small dataset and read it back with compression."""
    import h5py
    import numpy as np
    import xarray as xr

    try:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "doctor.h5"
            ds = xr.Dataset({"x": ("u", np.arange(1000.0))})
            ds.to_netcdf(path, engine="h5netcdf", encoding={"x": schema.PACKED})
            works = xr.load_dataset(path, engine="h5netcdf").identical(ds)
    except (OSError, ValueError) as error:
        return _finding("HDF5", False, f"storing failed: {error}")
    return _finding("HDF5", works, f"HDF5 {h5py.version.hdf5_version}, a dataset stored and read back")


def _opengl() -> dict[str, Any]:
    from ..scene import opengl

    able, advice = opengl.probe()
    return _finding("OpenGL", able, advice or "a scene was drawn off-screen")


def _font() -> dict[str, Any]:
    """Whether the font that Matplotlib would use has the Greek letters of the labels."""
    from matplotlib.font_manager import FontProperties, findfont, get_font

    path = findfont(FontProperties())
    missing = [letter for letter in "βκρ₀→" if ord(letter) not in get_font(path).get_charmap()]
    said = f"lacks {' '.join(missing)}" if missing else "has the Greek letters of the labels"
    return _finding("fonts", not missing, f"{Path(path).name} {said}")


def _extra(what: str, extra: str, packages: tuple[str, ...], trial: Callable[[], None], use: str) -> dict[str, Any]:
    """An optional part: not installed, or whether a trial of it works."""
    what = f"{what} ({extra})"
    try:
        said = ", ".join(f"{name} {version(name)}" for name in packages)
    except ImportError as error:
        return _finding(what, False, f"{use}: pip install 'rod-workbench[{extra}]' ({error.name} is missing)", False)
    try:
        trial()
    except (ImportError, InputError, OSError) as error:
        return _finding(what, False, str(error).partition("\n")[0])
    return _finding(what, True, f"{use}: {said}")


def _cad() -> None:
    from ..export.step import kernel

    kernel()


def _page() -> None:
    from ..web.browser_assets import scripts

    import_module("aiohttp")
    scripts()


def _compiled() -> None:
    import_module("numba").njit(lambda x: x + 1)(1)


def _heyoka() -> None:
    import_module("heyoka")


def _dask() -> None:
    import_module("distributed")


def _film() -> None:
    """A film of two white frames."""
    import numpy as np

    from ..scene.film import write

    with tempfile.TemporaryDirectory() as folder:
        white = np.full((16, 16, 3), 255, dtype=np.uint8)
        write([Path(folder) / "trial.mp4"], iter([white, white]), 3.0)


# what, its extra, its packages, a trial, what it is for
EXTRAS: tuple[tuple[str, str, tuple[str, ...], Callable[[], None], str], ...] = (
    ("Open Cascade", "cad", ("cadquery-ocp-novtk",), _cad, "STEP files"),
    ("live page", "explore", ("aiohttp", "trame-client", "trame-vtk"), _page, "workbench explore"),
    ("films", "animate", ("imageio", "imageio-ffmpeg"), _film, "workbench animate"),
    ("numba", "fast", ("numba",), _compiled, "the compiled method swing"),
    ("heyoka", "taylor", ("heyoka",), _heyoka, "a method to compare with"),
    ("Dask", "cluster", ("dask", "distributed"), _dask, "workbench run --scheduler"),
)


def _chromium() -> dict[str, Any]:
    """The browser in which the tests drive the live page and the report."""
    what, missing = "Chromium", [name for name in ("chromium", "chromedriver") if shutil.which(name) is None]
    if missing:
        return _finding(what, False, f"tests of the pages: {APT} chromium chromium-driver", False)
    try:
        asked = subprocess.run(["chromium", "--version"], capture_output=True, text=True, timeout=60, check=True)
    except (OSError, subprocess.SubprocessError) as error:
        return _finding(what, False, f"chromium --version: {error}")
    return _finding(what, True, f"tests of the pages: {asked.stdout.strip()}")


def _drawing_versions() -> dict[str, str]:
    return {name: version(name) for name in ("pyvista", "vtk", "matplotlib", "typer", "rich", "pydantic")}
