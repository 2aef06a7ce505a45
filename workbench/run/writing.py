"""Datasets written in HDF5 (netCDF4-compatible), by an atomic replacement."""

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from io import BytesIO
from pathlib import Path
from typing import Any

import h5netcdf
import h5py
import numpy as np
import xarray as xr
from xarray.backends import H5NetCDFStore

from solver.problem.errors import InputError

from ..stored import checks, file_checks, schema
from ..stored.boxes import Columns, Where, chunk_shape, extent
from . import atomic


class _Arrays(h5py.File):  # type: ignore[misc]
    """An HDF5 file that remembers its arrays: h5netcdf asks for each about fifty times, half of its time."""

    def __init__(self, path: str | BytesIO, mode: str) -> None:
        super().__init__(path, mode, track_order=True)  # as h5netcdf wants it
        self._found: dict[str, Any] = {}

    def __getitem__(self, name: Any) -> Any:
        if not isinstance(name, str):
            return super().__getitem__(name)  # a reference
        if name == "/":
            return self
        if name not in self._found:
            self._found[name] = super().__getitem__(name)
        return self._found[name]

    def __delitem__(self, name: str) -> None:
        super().__delitem__(name)
        self._found.clear()


class File(h5netcdf.File):  # type: ignore[misc]
    """Such a file as netCDF; it is closed with its arrays."""

    def __init__(self, arrays: _Arrays, mode: str) -> None:
        self._arrays = arrays
        super().__init__(arrays, mode)

    def close(self) -> None:
        super().close()
        self._arrays.close()


def _open(path: str | Path | BytesIO, mode: str) -> File:
    """A netCDF4 file: "a" gets more variables, "w" is new."""
    return File(_Arrays(path if isinstance(path, BytesIO) else str(path), mode), mode)


def write_new(ds: xr.Dataset, path: str | Path | BytesIO) -> None:
    """Write a dataset to a new file, as `Dataset.to_netcdf` does.

    How a file was packed that it was read from does not count: a longer text would be cut to the length of that file.
    """
    with _open(path, "w") as target:
        ds.drop_encoding().dump_to_store(H5NetCDFStore(target, mode="w"), encoding=encodings(ds))


def write(ds: xr.Dataset, path: str | Path, force: bool = False) -> Path:
    """Store a dataset under `path` and return the path.

    An existing file is replaced only if it is a dataset of the same study, or with `force`. Raises `InputError` where
    it is something else, where the folder cannot be written, and for a dataset that no command would read; the existing
    file then stays as it was.
    """
    path, ds = Path(path), ds.assign_attrs(Conventions=schema.CONVENTIONS)
    check_free(path, str(ds.attrs["study_name"]), force)
    checks.check(ds.drop_encoding(), f"cannot write {path}")  # whatever is written is read
    image = BytesIO()  # HDF5 does not survive a full disk, so it writes to memory
    write_new(ds, image)
    with h5py.File(image, "a") as file:
        file_checks.store_sums(file)
    return atomic.write(path, lambda aside: aside.write_bytes(image.getbuffer()))


def write_cases(
    frame: xr.Dataset, path: Path, size: int, variables: schema.CaseVariables, windows: Iterable[tuple[Where, Columns]]
) -> None:
    """Write a dataset to a new file, and into it the variables of each case, box by box.

    size: bytes of the whole file at most, which are reserved: HDF5 does not survive a full disk. Raises `OSError`.
    """
    created: dict[str, Any] = {}
    try:
        atomic.reserve(path, size)
        write_new(frame, path)
        atomic.reserve(path, size)
        with _open(path, "a") as file:
            for where, columns in windows:
                for name, (dims, attrs) in variables.items():
                    values = columns[name]
                    if name not in created:
                        shape = (*(frame.sizes[dim] for dim in dims[: len(where)]), *values.shape[1:])
                        created[name] = _create(file, name, dims, attrs, shape, values.dtype)
                    values = values.astype({"U": object, "b": np.int8}.get(values.dtype.kind, values.dtype), copy=False)
                    created[name][(*where, ...)] = values.reshape(extent(where) + values.shape[1:])
    except RuntimeError as error:  # HDF5 closing a file for which the disk has no room
        raise OSError(f"HDF5: {error}") from None


def _create(
    file: File, name: str, dims: Sequence[str], attrs: Mapping[str, Any], shape: tuple[int, ...], dtype: np.dtype[Any]
) -> Any:
    kind: dict[str, Any] = {"dtype": {"U": h5py.string_dtype(), "b": np.dtype(np.int8)}.get(dtype.kind, dtype)}
    if dtype.kind == "f":
        kind["fillvalue"] = np.nan
    if shape:
        kind |= {"chunks": chunk_shape(shape), **schema.compression(len(shape), dtype)}
    variable = file.create_variable(name, dims, **kind)
    # netCDF has no booleans: as xarray stores them
    for key, text in {**attrs, **({"dtype": "bool"} if dtype.kind == "b" else {})}.items():
        variable.attrs[key] = text
    return variable


def check_new(path: Path, force: bool) -> None:
    """Raise `InputError` where `check_parent` does, and without `force` for an existing file."""
    check_parent(path)
    if path.exists() and not force:
        raise InputError(f"{path} exists; give --force to replace it")


def check_free(path: Path, study_name: str, force: bool) -> None:
    """Raise `InputError` where `check_parent` does, and without `force` for all but a dataset of the study of that
    name."""
    check_parent(path)
    if force or not path.exists():
        return
    try:
        with file_checks.open_valid(path) as (_, held):
            stored = held.attrs.get("study_name")
    except InputError:
        stored = None
    if stored is None:
        raise InputError(f"{path} exists and is not a study's dataset; give --force to replace it")
    if stored != study_name:
        raise InputError(f"{path} holds the study {stored!r}, not {study_name!r}; give --force to replace it")


def check_parent(path: str | Path) -> None:
    """Raise `InputError` unless the folder of a file exists and can be written, and as `atomic.check_name`."""
    folder = atomic.check_name(path).parent
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


@contextmanager
def folder_of_results(folder: Path) -> Iterator[None]:
    """A folder as of `check_folder`; one that is new, and still empty where the body raises, is removed again."""
    is_new = not folder.exists()
    check_folder(folder)
    try:
        yield
    except BaseException:
        if is_new:
            with suppress(OSError):  # it is not empty
                folder.rmdir()
        raise


def encodings(ds: xr.Dataset) -> dict[str, dict[str, Any]]:
    """How each variable is packed. An axis has no number for missing values: the CF conventions forbid it."""
    packed = {str(name): schema.compression(v.ndim, v.dtype) for name, v in ds.variables.items()}
    for name in ds.coords:
        if ds[name].dtype.kind == "f":
            packed[str(name)]["_FillValue"] = None
    return {name: options for name, options in packed.items() if options}
