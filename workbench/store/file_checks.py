"""Validate untrusted HDF5 files. Needs no xarray.

Links out of a file are not followed, filter plug-ins are not loaded, claimed sizes are compared with the bytes that are
stored, and nothing read from a file is executed. Each refusal is an `InputError` of one sentence.
"""

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py

from solver.problem.errors import InputError

from .attributes import show

# What h5py, h5netcdf, xarray and pydantic raise on files that are not HDF5, not netCDF, cut short or damaged.
UNREADABLE = (
    OSError, ValueError, KeyError, RuntimeError, TypeError, AttributeError, EOFError, MemoryError,
)  # fmt: skip

FILTERS = {h5py.h5z.FILTER_DEFLATE, h5py.h5z.FILTER_SHUFFLE, h5py.h5z.FILTER_FLETCHER32}  # HDF5's own, no plug-ins
DEFLATED = 1032  # the best ratio of deflate; an array that claims a better one is not all stored
MOST_VARIABLES = 1000


@contextmanager
def open_valid(path: str | Path) -> Iterator[h5py.File]:
    """An HDF5 file of plain arrays, open for reading; `InputError` where it is not one."""
    path = Path(path)
    _check_file(path)
    with refusing(path), h5py.File(path, "r") as file:
        _check_inside(file, path)
        yield file


@contextmanager
def refusing(path: str | Path) -> Iterator[None]:
    """Turn whatever the body raises on reading the file into an `InputError` that names it."""
    try:
        yield
    except InputError:
        raise
    except PermissionError:
        raise InputError(f"cannot read {path}: permission denied") from None
    except UNREADABLE:
        why = "it is damaged, cut short, or another kind of file"
        raise InputError(f"{path} cannot be read as HDF5: {why}") from None


@contextmanager
def reading(path: str | Path) -> Iterator[None]:
    """As `refusing`, for numbers read after the file was opened: only what HDF5 itself raises."""
    try:
        yield
    except (OSError, RuntimeError, UnicodeDecodeError):
        raise InputError(f"{path} cannot be read to its end: it is damaged or cut short") from None


def _check_file(path: Path) -> None:
    """Raise `InputError` unless it is a regular file that may be read; a pipe would block for ever."""
    try:
        mode = os.stat(path).st_mode
    except FileNotFoundError:
        raise InputError(f"file not found: {path}") from None
    except PermissionError:
        raise InputError(f"cannot read {path}: permission denied") from None
    except (OSError, ValueError) as error:
        said = getattr(error, "strerror", None) or error
        raise InputError(f"cannot read {str(path)!r}: {said}") from None
    if stat.S_ISDIR(mode):
        raise InputError(f"{path} is a folder, not a dataset")
    if path.suffix.lower() == ".toml":
        raise InputError(f"{path} is a study, not a dataset; make the dataset with: workbench run {path}")
    if not stat.S_ISREG(mode):
        raise InputError(f"{path} is not a regular file")


def _check_inside(file: h5py.File, path: Path) -> None:
    """Raise `InputError` unless the file holds plain arrays in one group and nothing else."""
    _check_attributes(file, f"{path}:")
    if len(file) > MOST_VARIABLES:
        raise InputError(f"{path} holds {len(file)} variables; a study's dataset has at most {MOST_VARIABLES}")
    for name in file:
        what = f"{path}: {show(name)}"
        link = file.get(name, getlink=True)
        if not isinstance(link, h5py.HardLink):
            raise InputError(f"{what} is a link to another place; links are not followed")
        variable = file[name]
        if not isinstance(variable, h5py.Dataset):
            raise InputError(f"{what} is not an array; a study's dataset holds only arrays")
        _check_stored(variable, what)
        _check_attributes(variable, what)


def _check_attributes(held: h5py.File | h5py.Dataset, what: str) -> None:
    for key in held.attrs:
        if (shape := held.attrs.get_id(key).shape) is None or 0 in shape:
            raise InputError(f"{what} the attribute {show(key)} is empty")


def _check_stored(variable: h5py.Dataset, what: str) -> None:
    if variable.is_virtual or variable.external:
        raise InputError(f"{what} is stored in another file; links are not followed")
    text = h5py.check_string_dtype(variable.dtype) is not None
    if not text and variable.dtype.kind not in "iufS":
        raise InputError(f"{what} must hold numbers or text, got {variable.dtype}")
    if variable.shape is None or 0 in variable.shape:
        raise InputError(f"{what} is empty: its shape is {variable.shape}")
    filters = variable.id.get_create_plist()
    unknown = {filters.get_filter(i)[0] for i in range(filters.get_nfilters())} - FILTERS
    if unknown:
        raise InputError(f"{what} is compressed with filter {min(unknown)}; only gzip, shuffle and fletcher32 are read")
    without_values = variable.attrs.get("NAME", b"")
    if bytes(without_values).startswith(b"This is a netCDF dimension but not a netCDF variable"):
        return
    stored = variable.id.get_storage_size()
    if variable.nbytes > DEFLATED * stored:
        raise InputError(f"{what} claims {variable.nbytes} bytes, but only {stored} compressed bytes are stored")
