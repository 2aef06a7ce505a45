"""Validate untrusted HDF5 files. Needs no xarray.

Links out of a file are not followed, filter plug-ins are not loaded, claimed sizes are compared with the bytes that are
stored, and nothing read from a file is executed. Each refusal is an `InputError` of one sentence.

A file has checksums of its attributes, and of its numbers and texts of each case, in the attribute `checksums`: some
digits for each attribute and variable. A variable of another shape is a selection that another program has stored, and
is not compared. Arrays along the rod have none: HDF5 guards what it has compressed, and a number that is lost in a
solved case is refused.
"""

import hashlib
import json
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from solver.problem.errors import InputError

from .schema import blocks, show

# What h5py, h5netcdf, xarray and pydantic raise on files that are not HDF5, not netCDF, cut short or damaged.
UNREADABLE = (
    OSError, ValueError, KeyError, RuntimeError, TypeError, AttributeError, EOFError, MemoryError,
)  # fmt: skip

FILTERS = {h5py.h5z.FILTER_DEFLATE, h5py.h5z.FILTER_SHUFFLE, h5py.h5z.FILTER_FLETCHER32}  # HDF5's own, no plug-ins
DEFLATED = 1032  # the best ratio of deflate; an array that claims a better one is not all stored
MOST_VARIABLES = 1000

SUMS = "checksums"
UNSUMMED = {SUMS, "DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME", "_Netcdf4Dimid", "_Netcdf4Coordinates",
            "_NCProperties", "_nc3_strict", "_FillValue", "coordinates"}  # fmt: skip
_SIZE = 4  # bytes
_READ = 2**16  # texts at a time


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
    except UNREADABLE as error:
        if is_held(error):
            raise InputError(f"cannot read {path}: another program holds it open; close it there") from None
        why = "it is damaged, cut short, or another kind of file"
        raise InputError(f"{path} cannot be read as HDF5: {why}") from None


def is_held(error: Exception) -> bool:
    """Whether HDF5 could not open a file because another program writes it: by its lock, or by the mark of a writer."""
    return isinstance(error, BlockingIOError) or "unable to lock file" in str(error) or "already open for" in str(error)


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


def store_sums(file: h5py.File) -> None:
    """Store the checksums of a complete file that is open for writing."""
    file.attrs[SUMS] = json.dumps({place: _sum(file, place) for place in _places(file)})


def check_sums(file: h5py.File, path: object, arrays: bool = True) -> None:
    """Raise `InputError` where something has changed since `store`. arrays: whether variables are compared too.

    Nothing is compared in a file without checksums, as other programs store it.
    """
    if SUMS not in file.attrs:
        return
    try:
        stored = {str(place): str(summed) for place, summed in json.loads(file.attrs[SUMS]).items()}
    except (ValueError, TypeError, AttributeError, RecursionError):
        raise InputError(f"{path}: the attribute {SUMS} is damaged") from None
    for place in (place for place in _places(file) if arrays or "@" in place):
        shape, _, _ = stored.get(place, "added:").partition(":")
        if shape == _shape(file, place) and _sum(file, place) != stored[place]:
            variable, _, key = place.partition("@")
            what = f"the attribute {key}{variable and f' of {variable}'}" if key else variable
            raise InputError(
                f"{path}: {what} has changed since it was stored; delete the attribute {SUMS} to read it as it is"
            )


def _places(file: h5py.File) -> Iterator[str]:
    """``@title`` of the file, ``E@units`` and ``outcome`` of variables."""
    most = file["outcome"].ndim if "outcome" in file else 0
    for name, held in (("", file), *file.items()):
        yield from (f"{name}@{key}" for key in held.attrs if key not in UNSUMMED)
        if name and (held.ndim <= most or not held.id.get_create_plist().get_nfilters()):
            yield name


def _shape(file: h5py.File, place: str) -> str:
    name, at, key = place.partition("@")
    shape = file[name or "/"].attrs.get_id(key).shape if at else file[name].shape
    return "x".join(map(str, shape))


def _sum(file: h5py.File, place: str) -> str:
    """``9x3:0f3c11d2``: the shape, and a digest of the content."""
    name, at, key = place.partition("@")
    summed = hashlib.blake2b(digest_size=_SIZE)
    if not at and h5py.check_string_dtype(file[name].dtype) and file[name].ndim:
        for where in blocks(file[name].shape, _READ):
            summed.update(b"\0".join(file[name][where].ravel().tolist()) + b"\0")
    else:
        value: Any = file[name or "/"].attrs[key] if at else file[name][()]
        value = value.encode() if isinstance(value, str) else value
        summed.update(value if isinstance(value, bytes) else np.asarray(value).tobytes())
    return f"{_shape(file, place)}:{summed.hexdigest()}"
