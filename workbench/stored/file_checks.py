"""What an HDF5 file of plain arrays holds, read in one pass, and whether that has changed. Needs no xarray.

Links out of a file are not followed, filter plug-ins are not loaded, claimed sizes are compared with the bytes that are
stored, and nothing read from a file is executed. Each refusal is an `InputError` of one sentence.

Two guards tell of damage. HDF5 itself checks each chunk of an array when it reads it (fletcher32). The attribute
`checksums` has a digest of every attribute, and of every text and number of each case, as JSON. A variable of another
shape is a selection that another program has stored, and is not compared.
"""

import hashlib
import json
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from solver.problem.errors import InputError

from ..words.escaping import is_line, show
from .bounds import LABEL
from .boxes import blocks

FILTERS = {h5py.h5z.FILTER_DEFLATE, h5py.h5z.FILTER_SHUFFLE, h5py.h5z.FILTER_FLETCHER32}  # HDF5's own, no plug-ins
DEFLATED = 1032  # the best ratio of deflate; an array that claims a better one is not all stored
MOST_VARIABLES = 1000
MOST_DIMENSIONS = 32  # of an array of HDF5
MOST_CHUNK = 2**28  # bytes: HDF5 unpacks a chunk as a whole
AT_ONCE = 2**13  # values of an array that are read when the file is opened

SUMS = "checksums"
# Attributes by which HDF5 and netCDF keep dimensions, and those that change when another program stores the same.
HIDDEN = {"DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME", "_Netcdf4Dimid", "_Netcdf4Coordinates",
          "_NCProperties", "_nc3_strict"}  # fmt: skip
UNSUMMED = {SUMS, "coordinates"}
SCALED = {"scale_factor", "add_offset", "missing_value", "_Unsigned", "_Encoding", "_FillValue"}
NO_VALUES = b"This is a netCDF dimension but not a netCDF variable"
_SIZE = 4  # bytes of a digest
_READ = 2**16  # texts at a time


@dataclass(frozen=True, eq=False)
class FileArray:
    """An array of a file: the names of its dimensions, and its attributes and values as HDF5 holds them.

    values: an `h5py.Dataset` where there are more than `AT_ONCE`. is_guarded: whether HDF5 packs it, and so checks it.
    """

    dims: tuple[str, ...]
    attrs: dict[str, Any]
    values: Any
    dtype: np.dtype[Any]
    is_guarded: bool


@dataclass(frozen=True, eq=False)
class Contents:
    """What a file holds: its attributes, and its arrays by their names."""

    attrs: dict[str, Any]
    arrays: dict[str, FileArray]


@contextmanager
def open_valid(path: str | Path) -> Iterator[tuple[h5py.File, Contents]]:
    """An HDF5 file of plain arrays, open for reading, and what it holds; `InputError` where it is not one."""
    check_file(Path(path))
    with refusing(path), h5py.File(path, "r") as file:
        yield file, contents(file, path)


@contextmanager
def refusing(path: str | Path) -> Iterator[None]:
    """Turn whatever the body raises on reading the file into an `InputError` that names it."""
    try:
        yield
    except InputError:
        raise
    except PermissionError:
        raise InputError(f"cannot read {path}: permission denied") from None
    except Exception as error:
        said = str(error)  # a lock, or the mark of a writer
        if isinstance(error, BlockingIOError) or "unable to lock file" in said or "already open for" in said:
            raise InputError(f"cannot read {path}: another program holds it open; close it there") from None
        why = "it is damaged, cut short, or another kind of file"
        raise InputError(f"{path} cannot be read as HDF5: {why}") from error


def check_file(path: Path) -> None:
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
        files = sorted(path.glob("*.h5"))
        choice = f": give one of its files, such as {files[0]}" if files else ""
        raise InputError(f"{path} is a folder, not a dataset{choice}; plot alone takes the folder that reproduce wrote")
    if path.suffix.lower() == ".toml":
        raise InputError(f"{path} is a study, not a dataset; make the dataset with: workbench run {path}")
    if not stat.S_ISREG(mode):
        raise InputError(f"{path} is not a regular file")


def contents(file: h5py.File, path: object) -> Contents:
    """What an open file holds. Raises `InputError` where it holds more than plain arrays in one group."""
    if len(file) > MOST_VARIABLES:
        raise InputError(f"{path} holds {len(file)} variables; a study's dataset has at most {MOST_VARIABLES}")
    attrs, arrays = _attributes(file, f"{path}:"), {}
    for name in file:
        what = f"{path}: {show(name)}"
        if not is_line(name, LABEL):
            raise InputError(f"{what} is no name of one line")
        if not isinstance(file.get(name, getlink=True), h5py.HardLink):
            raise InputError(f"{what} is a link to another place; links are not followed")
        if not isinstance(array := file[name], h5py.Dataset):
            raise InputError(f"{what} is not an array; a study's dataset holds only arrays")
        if bytes(np.asarray(array.attrs.get("NAME", b""))[()]).startswith(NO_VALUES):
            continue
        if wrong := _wrong_array(array):
            raise InputError(f"{what} {wrong}")
        dims = (name,) if h5py.h5ds.is_scale(array.id) and array.ndim == 1 else _dimensions(array, name)
        values = array[()] if array.size <= AT_ONCE else array
        arrays[name] = FileArray(dims, _attributes(array, what), values, array.dtype, array.compression is not None)
    return Contents(attrs, arrays)


def _attributes(held: h5py.File | h5py.Dataset, what: str) -> dict[str, Any]:
    attrs = {key: held.attrs[key] for key in held.attrs if key not in HIDDEN}
    fill = np.asarray(attrs.get("_FillValue", 0.0))
    if (fill != fill).all():  # NaN, which stands for no other number
        del attrs["_FillValue"]
    for key, value in attrs.items():
        is_text = all(isinstance(part, str | bytes) for part in np.ravel(np.asarray(value, dtype=object)))
        is_number = np.asarray(value).dtype.kind in "iufb"  # a reference, say, cannot be copied
        if not (is_text or is_number) or np.size(value) == 0 or not is_line(key, LABEL):
            raise InputError(f"{what} the attribute {show(key)} must hold numbers or text")
        # a label of any length leaves a picture no room
        if isinstance(held, h5py.Dataset) and is_text and np.size(value) == 1 and len(np.ravel(value)[0]) > LABEL:
            raise InputError(f"{what} the attribute {show(key)} must be one line of text, got {show(value)}")
        if key in SCALED and isinstance(held, h5py.Dataset):
            raise InputError(f"{what} has the attribute {key}, by which other programs mean other numbers")
    return attrs


def _wrong_array(array: h5py.Dataset) -> str:
    """Why an array is not read; "" where it is. A small file cannot ask for much memory."""
    dtype, shape, plist = array.dtype, array.shape, array.id.get_create_plist()
    if array.is_virtual or array.external:
        return "is stored in another file; links are not followed"
    if h5py.check_string_dtype(dtype) is None and dtype.kind not in "iufS":
        return f"must hold numbers or text, got {dtype}"
    if unknown := {plist.get_filter(i)[0] for i in range(plist.get_nfilters())} - FILTERS:
        return f"is compressed with filter {min(unknown)}; only gzip, shuffle and fletcher32 are read"
    stored, claimed = array.id.get_storage_size(), prod(shape) * dtype.itemsize
    if claimed > DEFLATED * stored:
        return f"claims {claimed} bytes, but only {stored} compressed bytes are stored"
    large = prod(array.chunks or ()) * dtype.itemsize > MOST_CHUNK
    return f"has chunks of {array.chunks}, which take more than {MOST_CHUNK} bytes" if large else ""


def _dimensions(array: h5py.Dataset, name: str) -> tuple[str, ...]:
    """The names of the dimensions of an array; one that has none in the file gets one that no other array has."""
    lists = array.attrs.get("DIMENSION_LIST", [[]] * array.ndim)
    places = [h5py.h5r.get_name(scales[-1], array.id) if len(scales) else None for scales in lists]
    return tuple(f"{name} {i}" if place is None else place.decode().lstrip("/") for i, place in enumerate(places))


def store_sums(file: h5py.File) -> None:
    """Store the checksums of a complete file that is open for writing."""
    file.attrs[SUMS] = json.dumps(dict(_sums(contents(file, file.filename))))


def check_sums(held: Contents, path: object, arrays: bool = True) -> None:
    """Raise `InputError` where something has changed since `store_sums`. arrays: whether arrays are compared too.

    Nothing is compared in a file without checksums, as other programs store it.
    """
    if SUMS not in held.attrs:
        return
    try:
        stored = dict(json.loads(held.attrs[SUMS]))
    except (ValueError, TypeError, RecursionError):
        raise InputError(f"{path}: the attribute {SUMS} is damaged") from None
    for place, summed in _sums(held, arrays):
        was = str(stored.get(place, summed))
        if was != summed and was.partition(":")[0] == summed.partition(":")[0]:
            variable, _, key = place.partition("@")
            what = f"the attribute {key}{variable and f' of {variable}'}" if key else variable
            raise InputError(
                f"{path}: {what} has changed since it was stored; delete the attribute {SUMS} to read it as it is"
            )


def is_as_stored(path: str | Path) -> bool:
    """Whether everything in a file is as its checksums say."""
    try:
        with open_valid(path) as (_, held):
            return dict(_sums(held)) == json.loads(held.attrs[SUMS])
    except InputError:
        return False


def _sums(held: Contents, arrays: bool = True) -> Iterator[tuple[str, str]]:
    """``@title`` of the file, ``E@units``, ``E@`` (its dimensions) and ``outcome`` of arrays, and the sum of each.

    Arrays along the rod are left to HDF5, which would not notice a chunk that it takes for one that is not packed.
    """
    most = len(held.arrays["outcome"].dims) if "outcome" in held.arrays else MOST_DIMENSIONS
    parts: dict[str, Contents | FileArray] = {"": held, **held.arrays}
    for name, each in parts.items():
        yield from ((f"{name}@{key}", _sum(value)) for key, value in each.attrs.items() if key not in UNSUMMED)
        if isinstance(each, FileArray):
            yield f"{name}@", _sum(np.array(each.dims, dtype=object))
            if arrays and (len(each.dims) <= most or not each.is_guarded):
                yield name, _sum(each.values)


def _sum(value: Any) -> str:
    """``9x3:0f3c11d2``: the shape of an attribute or array, and a digest of its content."""
    summed = hashlib.blake2b(digest_size=_SIZE)
    for where in blocks(np.shape(value), _READ):
        part = value[where] if where else value[()] if isinstance(value, h5py.Dataset) else value
        if np.ndim(part) and part.dtype.kind in "OS":
            texts = part.ravel().tolist()
            parts = texts if {*map(type, texts)} == {bytes} else map(_bytes, texts)
            part = b"\0".join([*parts, b""])
        summed.update(_bytes(part))
    return f"{'x'.join(map(str, np.shape(value)))}:{summed.hexdigest()}"


def _bytes(value: Any) -> bytes:
    if isinstance(value, str):
        return value.encode(errors="surrogateescape")
    return value if isinstance(value, bytes) else np.asarray(value).tobytes()
