"""The command doctor: try every part of the workbench on this machine."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from solver.problem.errors import InputError

from . import console, tables
from .present import Result, presents

DRAWING = ("matplotlib", "typer", "rich", "pydantic", "pyvista", "vtk")  # packages of the tables and pictures


@dataclass(frozen=True)
class Extra:
    """An optional part: the extra of pip for it, a trial that raises if it does not work, or a module, and its use."""

    what: str
    extra: str
    packages: tuple[str, ...]
    trial: Callable[[], None] | str
    use: str


@presents()
def doctor() -> Result:
    """Check what works on this machine.

    Tries HDF5, OpenGL, fonts, optional parts and Chromium, and prints versions. Exit status is always 0.
    """
    import platform

    from ..stored import provenance

    packages = {**provenance.versions(), **{name: provenance.version_of(name) for name in DRAWING}}
    report = {"system": platform.platform(), "checks": examine(), "versions": packages}
    return Result(lambda: report, lambda: _print(report))


def _print(found: dict[str, Any]) -> None:
    words = {True: "works", False: "does not work", None: "not installed"}
    rows = [[f["what"], words[f["works"] if f["installed"] else None], f["said"]] for f in found["checks"]]
    tables.print_table(["", "", ""], rows)
    console.say("")
    tables.print_table(["version", ""], [["system", found["system"]], *map(list, found["versions"].items())])


def examine(extras: "Sequence[Extra] | None" = None, opengl: bool = True) -> list[dict[str, Any]]:
    """What works: rows of what, works, installed, said. extras: default: all. opengl: also draw a scene."""
    drawn = [_opengl()] if opengl else []
    return [_core(), _hdf5(), *drawn, _font(), *map(_extra, EXTRAS if extras is None else extras), _chromium()]


def _row(what: str, works: bool, said: str, installed: bool = True) -> dict[str, Any]:
    return {"what": what, "works": works, "installed": installed, "said": said}


def _core() -> dict[str, Any]:
    """Whether the compiled core of the solver is there."""
    from solver.core.library import MissingCore, widest

    try:
        return _row("compiled core", True, f"start problems are solved by swing, {widest()} rods at a time")
    except MissingCore as error:
        return _row("compiled core", False, str(error), False)


def _hdf5() -> dict[str, Any]:
    """Whether a compressed dataset can be stored and read."""
    import tempfile

    import h5py
    import numpy as np
    import xarray as xr

    from ..run import writing

    try:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "doctor.h5"
            ds = xr.Dataset({"x": ("u", np.arange(1000.0))})
            writing.write_new(ds, path)
            works = xr.load_dataset(path, engine="h5netcdf").identical(ds)
    except (OSError, ValueError) as error:
        return _row("HDF5", False, f"storing failed: {error}")
    return _row("HDF5", works, f"HDF5 {h5py.version.hdf5_version}, stored and read a dataset")


def _opengl() -> dict[str, Any]:
    from ..scene import opengl

    able, advice = opengl.probe()
    return _row("OpenGL", able, advice or "drew a scene off-screen", installed=advice != opengl.MISSING)


def _font() -> dict[str, Any]:
    """Whether the default font of Matplotlib has the Greek letters of the labels."""
    from matplotlib.font_manager import FontProperties, findfont, get_font

    path = findfont(FontProperties())
    missing = [letter for letter in "βκρ₀→" if ord(letter) not in get_font(path).get_charmap()]
    said = f"lacks {' '.join(missing)}" if missing else "has the Greek letters of the labels"
    return _row("fonts", not missing, f"{Path(path).name} {said}")


def _extra(part: Extra) -> dict[str, Any]:
    """Whether an optional part is installed and its trial succeeds."""
    from importlib import metadata

    what = f"{part.what} ({part.extra})"
    try:
        versions = ", ".join(f"{name} {metadata.version(name)}" for name in part.packages)
    except ImportError as error:
        advice = f"pip install 'rod-workbench[{part.extra}]' ({error.name} is missing)"
        return _row(what, False, f"{part.use}: {advice}", installed=False)
    try:
        import_module(part.trial) if isinstance(part.trial, str) else part.trial()
    except (ImportError, InputError, OSError) as error:
        return _row(what, False, str(error).partition("\n")[0])
    return _row(what, True, f"{part.use}: {versions}")


def _cad() -> None:
    from ..export.step import kernel

    kernel()


def _film() -> None:
    """A film of two white frames."""
    import tempfile

    import numpy as np

    from ..scene.film import write

    with tempfile.TemporaryDirectory() as folder:
        white = np.full((16, 16, 3), 255, dtype=np.uint8)
        write([Path(folder) / "trial.mp4"], iter([white, white]), 3.0)


EXTRAS = (
    Extra("Open Cascade", "cad", ("cadquery-ocp-novtk",), _cad, "STEP files"),
    Extra("live page", "explore", ("aiohttp",), "aiohttp", "workbench explore"),
    Extra("films", "animate", ("imageio", "imageio-ffmpeg"), _film, "workbench scene -o film.mp4"),
    Extra("Uno", "contact", ("unopy",), "unopy", "workbench solve --let-go"),
    Extra("heyoka", "taylor", ("heyoka",), "heyoka", "method for comparison"),
    Extra("Parquet", "parquet", ("pyarrow",), "pyarrow.parquet", "workbench run --cases TABLE.parquet"),
    Extra("SALib", "global", ("SALib",), "SALib.analyze.sobol", "workbench sensitivity --global"),
    Extra("Dask", "cluster", ("dask", "distributed"), "distributed", "workbench run --scheduler"),
)


def _chromium() -> dict[str, Any]:
    """The browser in which the tests use the live page and the report."""
    import shutil
    import subprocess

    what, missing = "Chromium", [name for name in ("chromium", "chromedriver") if shutil.which(name) is None]
    if missing:
        return _row(what, False, "tests of the pages: apt-get install chromium chromium-driver", False)
    try:
        answer = subprocess.run(["chromium", "--version"], capture_output=True, text=True, timeout=60, check=True)
    except (OSError, subprocess.SubprocessError) as error:
        return _row(what, False, f"chromium --version: {error}")
    return _row(what, True, f"tests of the pages: {answer.stdout.strip()}")
