"""Checksums: the digest by which anything stored is known again, and those of a file.

A file has checksums of its attributes, and of its numbers and texts of each case, in the attribute `checksums`: some
digits for each attribute and variable. A variable of another shape is a selection that another program has stored, and
is not compared. Arrays along the rod have none: HDF5 guards what it has compressed, and a number that is lost in a
solved case is refused.
"""

import hashlib
import json
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from solver.problem.errors import InputError

from .grid_io import blocks

if TYPE_CHECKING:
    import h5py

KEY = "checksums"
UNSUMMED = {KEY, "DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME", "_Netcdf4Dimid", "_Netcdf4Coordinates",
            "_NCProperties", "_nc3_strict", "_FillValue", "coordinates"}  # fmt: skip
_SIZE = 4  # bytes
_READ = 2**16  # texts at a time


def digest(*content: bytes | memoryview, size: int) -> bytes:
    """The digest of the content, of so many bytes."""
    summed = hashlib.blake2b(digest_size=size)
    for part in content:
        summed.update(part)
    return summed.digest()


def store(file: "h5py.File") -> None:
    """Store the checksums of a complete file that is open for writing."""
    file.attrs[KEY] = json.dumps({place: _sum(file, place) for place in _places(file)})


def check(file: "h5py.File", path: object, arrays: bool = True) -> None:
    """Raise `InputError` where something has changed since `store`. arrays: whether variables are compared too.

    Nothing is compared in a file without checksums, as other programs store it.
    """
    if KEY not in file.attrs:
        return
    try:
        stored = {str(place): str(summed) for place, summed in json.loads(file.attrs[KEY]).items()}
    except (ValueError, TypeError, AttributeError, RecursionError):
        raise InputError(f"{path}: the attribute {KEY} is damaged") from None
    for place in (place for place in _places(file) if arrays or "@" in place):
        shape, _, _ = stored.get(place, "added:").partition(":")
        if shape == _shape(file, place) and _sum(file, place) != stored[place]:
            variable, _, key = place.partition("@")
            what = f"the attribute {key}{variable and f' of {variable}'}" if key else variable
            raise InputError(
                f"{path}: {what} has changed since it was stored; delete the attribute {KEY} to read it as it is"
            )


def _places(file: "h5py.File") -> Iterator[str]:
    """``@title`` of the file, ``E@units`` and ``outcome`` of variables."""
    most = file["outcome"].ndim if "outcome" in file else 0
    for name, held in (("", file), *file.items()):
        yield from (f"{name}@{key}" for key in held.attrs if key not in UNSUMMED)
        if name and (held.ndim <= most or not held.id.get_create_plist().get_nfilters()):
            yield name


def _shape(file: "h5py.File", place: str) -> str:
    name, at, key = place.partition("@")
    shape = file[name or "/"].attrs.get_id(key).shape if at else file[name].shape
    return "x".join(map(str, shape))


def _sum(file: "h5py.File", place: str) -> str:
    """``9x3:0f3c11d2``: the shape, and a digest of the content."""
    return f"{_shape(file, place)}:{digest(*_content(file, place), size=_SIZE).hex()}"


def _content(file: "h5py.File", place: str) -> Iterator[bytes]:
    import h5py

    name, at, key = place.partition("@")
    if not at and h5py.check_string_dtype(file[name].dtype) and file[name].ndim:
        yield from (b"\0".join(file[name][where].ravel().tolist()) + b"\0" for where in blocks(file[name].shape, _READ))
        return
    value: Any = file[name or "/"].attrs[key] if at else file[name][()]
    value = value.encode() if isinstance(value, str) else value
    yield value if isinstance(value, bytes) else np.asarray(value).tobytes()
