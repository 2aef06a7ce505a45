"""The command export: one stored rod as a file that other programs open. Nothing is solved."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from solver.problem.errors import InputError, choices

from ..data import atomic, selection, writing
from ..geometry import centreline, self_contact
from ..geometry.centreline import Centreline
from . import console
from .plot_and_scene import chosen

CAD, SURFACES, GLTF, TABLES = (".step", ".stp"), (".stl", ".obj"), (".glb", ".gltf"), (".vtp", ".csv")
KINDS = (*CAD, *SURFACES, *GLTF, *TABLES)
# The most that a file may miss the rod where nothing is said: of rho for CAD, of the rod's own radius for triangles
NEAR_CAD, NEAR_MESH = 1e-6, 1e-3


@dataclass(frozen=True)
class Wish:
    """What is asked of an export.

    out: the file, its kind by its suffix. at: values of axes, as stored. tolerance: the most
    that the file may miss the rod [length], None for the kind's own. centreline: STEP without the solid. overlap: the
    solid also where turns pass through each other. force: replace a file that is there.
    """

    out: Path
    at: Mapping[str, float]
    tolerance: float | None = None
    centreline: bool = False
    overlap: bool = False
    force: bool = False


@dataclass(frozen=True)
class Exported:
    """A file that was written: numbers about it, and what does not hold of the rod in it."""

    path: Path
    at: dict[str, float]
    told: dict[str, Any]
    warnings: list[str]


def export_file(
    file: Path, at: list[str], out: Path, tolerance: float | None, line: bool, overlap: bool, force: bool, json: bool
) -> int:
    """Export a case of a stored dataset; 0, or 1 where the rod in it cannot be built. Raises `InputError`."""
    _kind(out)
    ds = writing.read(file)
    done = export(ds, Wish(out, chosen(ds, at), tolerance, line, overlap, force))
    status = 1 if done.warnings else 0
    for warning in done.warnings:
        console.warn(warning)
    if json:
        told = {"file": str(done.path), "at": done.at, **done.told, "warnings": done.warnings, "status": status}
        console.print_json(told)
        return status
    where = ", ".join(f"{name}={value:g}" for name, value in done.at.items())
    facts = ", ".join(f"{key} {value:g}" if isinstance(value, float) else f"{key} {value}"
                      for key, value in done.told.items())  # fmt: skip
    console.say(f"{done.path}{f' at {where}' if where else ''}: {facts}")
    return status


def export(ds: xr.Dataset, wish: Wish) -> Exported:
    """Write one case of a dataset to a file. Nothing is left where it fails.

    Raises `InputError` for a name, value or file that cannot be, a case without a shape, stations that are too few,
    and a solid that the rod cannot be.
    """
    kind = _kind(wish.out)
    if wish.centreline and kind not in CAD:
        raise InputError(f"--centreline is for {choices(CAD)}, got {wish.out.name!r}")
    if wish.tolerance is not None and not 0 < wish.tolerance < np.inf:
        raise InputError(f"--tolerance must be positive and finite, got {wish.tolerance:g}")
    where = selection.case(ds, wish.at)
    line = centreline.read(ds, where)
    at = {name: float(ds[name].values[i]) for name, i in where.items()}
    unit = str(ds.attrs["length_unit"])
    found = [] if kind in TABLES or wish.centreline else self_contact.findings(line, unit)
    if kind in CAD:
        _refuse(found, wish)
    title = _title(ds, at)
    told: dict[str, Any] = {}

    def work(path: Path) -> None:
        told.update(_written(path, kind, ds, where, line, wish, title))

    put(wish.out, work, wish.force)
    return Exported(wish.out, at, told, [finding.said for finding in found])


def put(path: Path, work: Callable[[Path], None], force: bool) -> None:
    """Have `work` write beside `path` under a name of the same suffix, and move that there once it is whole.

    Raises `InputError` where something is there and not `force`, or where the folder cannot be written.
    """
    if path.is_dir():
        raise InputError(f"{path} is a folder; give the name of a file")
    if path.exists() and not force:
        raise InputError(f"{path} exists; give --force to replace it")
    writing.check_parent(path)
    atomic.write(path, work)


def _kind(out: Path) -> str:
    kind = out.suffix.lower()
    if kind not in KINDS:
        raise InputError(f"cannot export to {out.name!r}: choose a name that ends in {choices(KINDS)}")
    return kind


def _refuse(found: list[self_contact.Finding], wish: Wish) -> None:
    """Raise `InputError` where no solid can be made of the rod, or not without being told to."""
    for finding in found:
        if finding.tight or not wish.overlap:
            also = "" if finding.tight else ", --overlap the solid all the same"
            raise InputError(f"no solid: {finding.said}; --centreline writes the curve alone{also}")


def _written(
    path: Path, kind: str, ds: xr.Dataset, where: dict[str, int], line: Centreline, wish: Wish, title: str
) -> dict[str, Any]:
    """Write a file of that kind; returns what is told of it."""
    unit = str(ds.attrs["length_unit"])
    if kind in TABLES:
        from ..export import tables

        found = tables.columns(ds, where, line)
        if kind == ".csv":
            tables.write_csv(path, found)
        else:
            tables.write_vtp(path, found, line, {"title": title, "versions": str(ds.attrs["versions"])})
        return {"stations": line.s.size, "quantities": len(found)}
    tolerance = wish.tolerance or (NEAR_CAD * line.rho if kind in CAD else NEAR_MESH * line.a)
    line.check(tolerance / 2 if kind in CAD else tolerance / 10)
    if kind in CAD:
        from ..export import step

        told = step.write(path, line, unit, title, tolerance / 2, not wish.centreline)
    else:
        from ..export import meshes

        mesh = meshes.tube(line, tolerance)
        if kind in GLTF:
            meshes.write_gltf(path, mesh, _push(ds, where, line, mesh.s), title, unit)
        else:
            meshes.write_surface(path, mesh)
        told = {"triangles": len(mesh.triangles)}
    return {**told, "tolerance": tolerance, "unit": "m" if kind in GLTF else unit}


def _push(ds: xr.Dataset, where: dict[str, int], line: Centreline, s: centreline.Array) -> centreline.Array:
    """The cylinder's push at s, negative where it would have to pull."""
    from solver.mechanics.contact import push_from

    from ..export.tables import computed

    return np.interp(s, line.s, push_from(computed(line)["contact"], line.side))


def _title(ds: xr.Dataset, at: Mapping[str, float]) -> str:
    """The study and where on its axes, in ASCII."""
    chosen = [f"{name}={value:.6g}" for name, value in at.items()]
    return " ".join([str(ds.attrs["study_name"]), *chosen])
