"""Datasets written to HDF5 (netCDF4-compatible) by an atomic replacement."""

import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr

from solver.problem.errors import InputError

from . import atomic, checksums, file_checks, grid_io, netcdf, schema


def write(ds: xr.Dataset, path: str | Path, force: bool = False) -> Path:
    """Store a dataset under `path` and return the path.

    An existing file is replaced only if it is a dataset of the same study, or with `force`. Raises `InputError` where
    it is something else, or where the folder cannot be written; the existing file then stays as it was.
    """
    path = Path(path)
    check_parent(path)
    ds = ds.assign_attrs(Conventions=schema.CONVENTIONS)
    if not force:
        check_free(path, str(ds.attrs["study_name"]))
    image = BytesIO()  # HDF5 does not survive a full disk, so it writes to memory
    netcdf.write(ds, image, encoding(ds))
    with h5py.File(image, "a") as file:
        checksums.store(file)
    return atomic.write(path, lambda aside: aside.write_bytes(image.getbuffer()))


@contextmanager
def append_to(frame: xr.Dataset, path: Path, size: int) -> Iterator[netcdf.File]:
    """Write a dataset to a new file, and yield the file for further variables.

    size: bytes of the whole file at most, which are reserved: HDF5 does not survive a full disk. Raises `OSError`.
    """
    try:
        atomic.reserve(path, size)
        netcdf.write(frame, path, encoding(frame))
        atomic.reserve(path, size)
        with netcdf.file(path, "a") as file:
            yield file
    except RuntimeError as error:  # HDF5 closing a file for which the disk has no room
        raise OSError(f"HDF5: {error}") from None


def write_cases(
    file: netcdf.File, variables: Sequence[schema.CaseVariable], shape: tuple[int, ...],
    windows: Iterable[tuple[grid_io.Where, schema.Columns]],
) -> None:  # fmt: skip
    """Write the variables over the axes into an open file, box by box; shape: of the grid."""
    created: dict[str, Any] = {}
    for where, columns in windows:
        for variable in variables:
            values = (
                columns[variable.name]
                if variable.dtype is None
                else columns[variable.name].astype(variable.dtype, copy=False)
            )
            if variable.name not in created:
                created[variable.name] = _create(file, variable, shape + values.shape[1:], values.dtype)
            values = values.astype({"U": object, "b": np.int8}.get(values.dtype.kind, values.dtype), copy=False)
            created[variable.name][(*where, ...)] = values.reshape(grid_io.extent(where) + values.shape[1:])


def _create(file: netcdf.File, case_variable: schema.CaseVariable, shape: tuple[int, ...], dtype: np.dtype[Any]) -> Any:
    kind: dict[str, Any] = {"dtype": {"U": h5py.string_dtype(), "b": np.dtype(np.int8)}.get(dtype.kind, dtype)}
    if dtype.kind == "f":
        kind["fillvalue"] = np.nan
    if shape:
        kind |= {"chunks": grid_io.packing(shape), **schema.packing(len(shape), dtype)}
    variable = file.create_variable(case_variable.name, case_variable.dims, **kind)
    for key, text in case_variable.attrs.items():
        variable.attrs[key] = text
    if dtype.kind == "b":  # which netCDF has not: as xarray stores it
        variable.attrs["dtype"] = "bool"
    return variable


def check_free(path: str | Path, study_name: str) -> None:
    """Raise `InputError` unless nothing is at `path`, or a dataset of the study of that name."""
    path = Path(path)
    if path.is_dir():
        raise InputError(f"{path} is a folder; give the name of a file")
    if not path.exists():
        return
    try:
        with file_checks.open_valid(path) as file:
            stored = file.attrs.get("study_name")
    except InputError:
        stored = None
    if stored is None:
        raise InputError(f"{path} exists and is not a study's dataset; give --force to replace it")
    if stored != study_name:
        raise InputError(f"{path} holds the study {stored!r}, not {study_name!r}; give --force to replace it")


def check_parent(path: str | Path) -> None:
    """Raise `InputError` unless the folder of a file exists and can be written, or where a link leads nowhere."""
    atomic.check_link(Path(path))
    folder = Path(path).parent
    if not folder.is_dir():
        raise InputError(f"cannot write {path}: folder not found: {folder}")
    check_folder(folder)


def check_folder(folder: str | Path) -> Path:
    """The folder, made if need be; `InputError` where it cannot be written."""
    folder = Path(folder)
    if folder.exists() and not folder.is_dir():
        raise InputError(f"cannot write into the folder {folder}: it is a file")
    probe = folder / f".probe.{os.getpid()}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe.write_bytes(b"")
        probe.unlink()
    except OSError as error:
        raise InputError(f"cannot write into the folder {folder}: {error.strerror or error}") from None
    return folder


def encoding(ds: xr.Dataset) -> dict[str, dict[str, Any]]:
    """How each variable is packed. An axis has no number for missing values: the CF conventions forbid it."""
    packed = {str(name): schema.packing(v.ndim, v.dtype) for name, v in ds.variables.items()}
    for name in ds.coords:
        if ds[name].dtype.kind == "f":
            packed[str(name)]["_FillValue"] = None
    return {name: options for name, options in packed.items() if options}
