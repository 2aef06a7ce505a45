"""From a solution to a labelled dataset: one dimension an axis, units and long names on everything."""

import json
import platform
from collections.abc import Mapping
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver import Solution
from solver.observables import observe
from solver.quantities import quantity, unit_of
from studies import Study
from studies.axes import quantity_of

from . import cautions

FORMAT = 1  # of the file: a reader refuses one with a higher number
PACKAGES = ("numpy", "scipy", "xarray", "h5netcdf", "h5py", "rod-workbench")
INNER = {"position": ("xyz",)}  # dimensions after u, of what is not one number a station
SCALARS = ("R", "a", "L", "rho", "E", "nu")
LOADS = ("FZ", "MZ", "M3")


def make(study: Study, coordinates: Mapping[str, NDArray[np.float64]], sol: Solution) -> xr.Dataset:
    """The dataset of a study's solution; coordinates: the values of each axis, in the case's order.

    Only the study's outputs and observables are computed. Cases that were not solved are NaN, and keep their
    outcome. An output along the rod whose name is an axis's is stored as that name and `_along` (see
    `along`).
    """
    axes = tuple(coordinates)
    units = study.unit_system
    data: dict[str, Any] = {}

    def put(name: str, dims: tuple[str, ...], values: Any, row: str = "") -> None:
        data[name] = xr.Variable(dims, values, labels(row or name, units))

    for name in study.outputs:
        stored = f"{name}_along" if name in axes else name
        put(stored, (*axes, "u", *INNER.get(name, ())), _where_solved(getattr(sol, name), sol), name)
    observed = observe(sol, study.wanted)
    for name, values in observed.items():
        put(name, axes, _where_solved(values, sol))
    put("outcome", axes, np.asarray(sol.outcome).astype(str))
    put("caution", axes, cautions.of_cases(sol, observed))
    put("error", axes, np.asarray(sol.error, dtype=float))
    put("condition", axes, np.asarray(sol.condition, dtype=float))
    for name in SCALARS:
        if name not in axes:
            owner = {"R": sol.case.cylinder, "rho": sol.case}.get(name, sol.case.rod)
            put(name, *_own_dims(getattr(owner, name), axes))
    for name in LOADS:
        if name not in axes:
            put(name, axes, np.asarray(getattr(sol, name), dtype=float))
    u = np.linspace(0.0, 1.0, sol.s.shape[-1])
    coords: dict[str, Any] = {
        name: xr.Variable((name,), values, _axis_labels(study, name)) for name, values in coordinates.items()
    }
    coords["u"] = xr.Variable(("u",), u, labels("u", units))
    coords["s"] = xr.Variable(*_arc(sol, axes, u), labels("s", units))
    if any(name in INNER for name in study.outputs):
        coords["xyz"] = xr.Variable(("xyz",), ["x", "y", "z"], {"long_name": "component; z is the axis"})
    ds = xr.Dataset(data, coords, _attributes(study, sol))
    return ds.assign_attrs(caution=cautions.sentence(ds))


def along(ds: xr.Dataset, name: str) -> xr.DataArray:
    """An output along the rod, whether or not an axis has taken its name."""
    return ds[f"{name}_along"] if f"{name}_along" in ds else ds[name]


def axes_of(ds: xr.Dataset) -> list[str]:
    """The study's axes, in order."""
    return [str(dim) for dim in ds["outcome"].dims]


def versions() -> dict[str, str]:
    """Python and the packages that numbers and files depend on."""
    found = {"python": platform.python_version()}
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "not installed"
    return found


def labels(name: str, units: Mapping[str, str]) -> dict[str, str]:
    """The attributes that a variable of that quantity carries: units, long_name, symbol."""
    row = quantity(name)
    return {"units": unit_of(name, units), "long_name": row.long_name, "symbol": row.symbol}


def _axis_labels(study: Study, name: str) -> dict[str, str]:
    row = quantity_of(name)
    told = labels(row.name, study.unit_system)
    if meaning := study.meaning(name):
        told["long_name"] += f" ({meaning})"
        told["reading"] = meaning
    return told


def _where_solved(values: Any, sol: Solution) -> NDArray[Any]:
    """The values, NaN where the case is not solved; whole numbers stay whole where all are."""
    values = np.asarray(values)
    if values.dtype.kind == "b":
        values = values.astype(np.int64)
    solved = np.asarray(sol.solved)
    if solved.all():
        return values
    kept = solved.reshape(solved.shape + (1,) * (values.ndim - solved.ndim))
    return np.where(kept, values.astype(float), np.nan)


def _own_dims(value: Any, axes: tuple[str, ...]) -> tuple[tuple[str, ...], NDArray[np.float64]]:
    """The dimensions along which a field varies, and its values there."""
    array = np.asarray(value, dtype=float)
    dims = axes[len(axes) - array.ndim :]
    kept = tuple(dim for dim, size in zip(dims, array.shape, strict=True) if size > 1)
    return kept, array.reshape([size for size in array.shape if size > 1])


def _arc(sol: Solution, axes: tuple[str, ...], u: NDArray[np.float64]) -> tuple[tuple[str, ...], NDArray[np.float64]]:
    """s over u alone where every case has the same length, else over the whole grid."""
    L = np.asarray(sol.case.rod.L, dtype=float)
    if L.size == 1:
        return ("u",), L.item() * u
    return (*axes, "u"), np.broadcast_to(L, sol.case.shape)[..., None] * u


def _attributes(study: Study, sol: Solution) -> dict[str, Any]:
    return {
        "format": FORMAT,
        "title": study.title,
        "study_name": study.name,
        "study": study.text,
        "reading": study.reading or "",
        "side": sol.case.cylinder.side,
        "stiffness": sol.case.rod.stiffness,
        "length_unit": study.units.length,
        "force_unit": study.units.force,
        "tolerance": sol.tol,
        "method": sol.method,
        "laws": json.dumps([law.model_dump() for law in study.laws], ensure_ascii=False),
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "versions": json.dumps(versions()),
    }
