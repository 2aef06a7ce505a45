"""Stored files at the door: what a file is, looked at with care before anything in it is believed.

A file may come from anyone. Links out of it are not followed, filters that HDF5 would load from elsewhere are not
loaded, claimed sizes are held against the bytes that are there, and nothing read from it is executed. What is refused
is refused with `InputError`, in one sentence.
"""

import json
import os
import stat
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr

from solver.errors import InputError
from studies.laws import Law
from studies.model import OUTPUTS

from .dataset import FORMAT, INNER

# The attributes that say a dataset is a study's, and those that say how to read it.
NEEDED = ("title", "study_name", "laws")
TEXTS = (*NEEDED, "study", "reading", "side", "stiffness", "length_unit", "force_unit", "method", "versions")

# What h5py, h5netcdf, xarray and pydantic raise on files that are not HDF5, not netCDF, cut short or damaged.
UNREADABLE = (
    OSError, ValueError, KeyError, RuntimeError, TypeError, AttributeError, EOFError, MemoryError,
)  # fmt: skip

FILTERS = {h5py.h5z.FILTER_DEFLATE, h5py.h5z.FILTER_SHUFFLE, h5py.h5z.FILTER_FLETCHER32}  # HDF5's own, no plug-ins
DEFLATED = 1032  # deflate packs no better than that; an array larger than this times its bytes is not all there
MOST_VARIABLES = 1000
MOST_TEXT = 64_000_000  # bytes of an attribute


def opened(path: str | Path) -> xr.Dataset:
    """A study's dataset, opened lazily: numbers are read when they are asked for. To be closed after use.

    Raises `InputError` where the file is missing, damaged, of a newer version, or no study's dataset.
    """
    ds = raw(path)
    try:
        with refusing(path):
            _check_study(ds, path)
    except InputError:
        ds.close()
        raise
    return ds


def raw(path: str | Path) -> xr.Dataset:
    """Any netCDF4 file of plain arrays, opened lazily; `InputError` where it is not one."""
    path = Path(path)
    _check_file(path)
    with refusing(path):
        with h5py.File(path, "r") as file:
            _check_inside(file, path)
        return xr.open_dataset(path, engine="h5netcdf", phony_dims="access", cache=False)


@contextmanager
def refusing(path: str | Path) -> Iterator[None]:
    """Whatever reading the file raises inside is an `InputError` that names it."""
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
    """As `refusing`, for numbers that are read after the file was opened: only what HDF5 itself raises."""
    try:
        yield
    except (OSError, RuntimeError, UnicodeDecodeError):
        raise InputError(f"{path} cannot be read to its end: it is damaged or cut short") from None


def _check_file(path: Path) -> None:
    """A regular file that may be read; a pipe would keep a reader waiting for ever."""
    try:
        mode = os.stat(path).st_mode
    except FileNotFoundError:
        raise InputError(f"there is no file {path}") from None
    except PermissionError:
        raise InputError(f"cannot read {path}: permission denied") from None
    except (OSError, ValueError) as error:
        said = getattr(error, "strerror", None) or error
        raise InputError(f"cannot read {str(path)!r}: {said}") from None
    if stat.S_ISDIR(mode):
        raise InputError(f"{path} is a folder, not a dataset")
    if not stat.S_ISREG(mode):
        raise InputError(f"{path} is no regular file")


def _check_inside(file: h5py.File, path: Path) -> None:
    """Plain arrays in one folder, all of them in this file."""
    if len(file) > MOST_VARIABLES:
        raise InputError(f"{path} holds {len(file)} variables; a study's dataset has at most {MOST_VARIABLES}")
    for name in file:
        what = f"{path}: {_shown(name)}"
        link = file.get(name, getlink=True)
        if not isinstance(link, h5py.HardLink):
            raise InputError(f"{what} is a link to elsewhere, which is not followed")
        variable = file[name]
        if not isinstance(variable, h5py.Dataset):
            raise InputError(f"{what} is no array, but a study's dataset holds nothing else")
        _check_stored(variable, what)


def _check_stored(variable: h5py.Dataset, what: str) -> None:
    if variable.is_virtual or variable.external:
        raise InputError(f"{what} is stored in another file, which is not followed")
    text = h5py.check_string_dtype(variable.dtype) is not None
    if not text and variable.dtype.kind not in "iufS":
        raise InputError(f"{what} holds neither numbers nor text, but {variable.dtype}")
    if variable.shape is None or 0 in variable.shape:
        raise InputError(f"{what} is empty: its shape is {variable.shape}")
    made = variable.id.get_create_plist()
    unknown = {made.get_filter(i)[0] for i in range(made.get_nfilters())} - FILTERS
    if unknown:
        raise InputError(
            f"{what} is packed by the filter {min(unknown)}, but only gzip, shuffle and fletcher32 are read"
        )
    without_values = variable.attrs.get("NAME", b"")
    if bytes(without_values).startswith(b"This is a netCDF dimension but not a netCDF variable"):
        return
    stored = variable.id.get_storage_size()
    if variable.nbytes > DEFLATED * stored:
        raise InputError(f"{what} should hold {variable.nbytes} bytes, but only {stored} packed ones are there")


def _check_study(ds: xr.Dataset, path: str | Path) -> None:
    """The attributes, dimensions and kinds that every command relies on."""
    missing = [name for name in NEEDED if name not in ds.attrs]
    if missing or "outcome" not in ds:
        raise InputError(f"{path} is not a study's dataset: it has no {', '.join(missing) or 'outcome'}")
    _check_format(ds.attrs.get("format", FORMAT), path)
    for name in TEXTS:
        value = ds.attrs.get(name)
        if not isinstance(value, str) or len(value) > MOST_TEXT:
            kind = "missing" if value is None else f"no text of at most {MOST_TEXT} characters"
            raise InputError(f"{path}: the attribute {name} is {kind}")
    if not 0 < number(ds, "tolerance", path) < 1:
        raise InputError(f"{path}: the attribute tolerance is not between 0 and 1")
    for name in ("title", "study_name", "reading", "method"):
        if not ds.attrs[name].isprintable():
            raise InputError(f"{path}: the attribute {name} is no line of text, but {_shown(ds.attrs[name])}")
    axes = [str(dim) for dim in ds["outcome"].dims]
    for law in laws(ds, path):
        if not {law.axis, *law.at} <= {*axes}:
            raise InputError(f"{path}: a law is about {_shown([law.axis, *law.at])}, but the axes are {_shown(axes)}")
    if ds["outcome"].dtype.kind not in "OUST":
        raise InputError(f"{path}: outcome holds no text, but {ds['outcome'].dtype}")
    for axis in axes:
        _check_axis(ds, axis, path)
    _check_texts(ds.attrs, path)
    for key, variable in ds.variables.items():
        _check_texts(variable.attrs, path)
        _check_variable(str(key), variable, axes, path)
    for name in ("error", "condition"):
        if name not in ds or list(ds[name].dims) != axes:
            raise InputError(f"{path} has no {name} for each of its cases")


def _check_texts(attrs: Mapping[Any, Any], path: str | Path) -> None:
    """That texts are of letters: bytes that are none cannot be written again, nor printed."""
    for text in (str(part) for pair in attrs.items() for part in pair if isinstance(part, str)):
        try:
            text.encode()
        except UnicodeEncodeError:
            raise InputError(f"{path}: {_shown(text)} is no text in UTF-8") from None


def _check_format(found: Any, path: str | Path) -> None:
    value = np.asarray(found)
    if value.size != 1 or value.dtype.kind not in "iu":
        raise InputError(f"{path}: the attribute format is no whole number, but {_shown(found)}")
    if value.item() > FORMAT:
        raise InputError(f"{path} is of format {value.item()}, but this version reads up to format {FORMAT}")


def _check_axis(ds: xr.Dataset, name: str, path: str | Path) -> None:
    """A coordinate of finite, different numbers."""
    if name not in ds.coords or ds[name].dtype.kind != "f":
        raise InputError(f"{path}: the axis {_shown(name)} has no values")
    values = ds[name].values
    if not np.isfinite(values).all():
        raise InputError(f"{path}: the axis {_shown(name)} holds values that are no finite numbers")
    if np.unique(values).size < values.size:
        raise InputError(f"{path}: the axis {_shown(name)} holds a value twice")


def _check_variable(name: str, variable: xr.Variable, axes: list[str], path: str | Path) -> None:
    plain = name.removesuffix("_along")
    along = (plain in OUTPUTS and name not in axes) or name in ("u", "s")
    known = {*axes, "u", *(dim for dims in INNER.values() for dim in dims)}
    expected = [*axes, "u", *INNER.get(plain, ())]
    dims = [str(dim) for dim in variable.dims]
    fits = set(dims) <= known and (not along or name in ("u", "s") or dims == expected)
    if not fits or (name in ("u", "s") and dims[-1:] != ["u"]):
        raise InputError(f"{path}: {_shown(name)} has the dimensions {_shown(dims)}, which do not fit the axes")
    if name not in ("outcome", "caution", "xyz") and variable.dtype.kind not in "iuf":
        raise InputError(f"{path}: {_shown(name)} holds no numbers, but {variable.dtype}")


def text(ds: xr.Dataset, name: str) -> str:
    """An attribute that is text, of a dataset that came by another door; `InputError` otherwise."""
    value = ds.attrs.get(name)
    if not isinstance(value, str):
        raise InputError(f"the dataset's attribute {name} is {'missing' if value is None else 'no text'}")
    return value


def number(ds: xr.Dataset, name: str, path: str | Path = "the dataset") -> float:
    """An attribute that is one number; `InputError` otherwise."""
    value = np.asarray(ds.attrs.get(name))
    if value.size != 1 or value.dtype.kind not in "iuf":
        raise InputError(f"{path}: the attribute {name} is no number, but {_shown(ds.attrs.get(name))}")
    return float(value.item())


def laws(ds: xr.Dataset, path: str | Path = "the dataset") -> list[Law]:
    """The laws that the dataset's study states; `InputError` where the attribute is no list of laws."""
    try:
        return [Law.model_validate(row) for row in json.loads(ds.attrs["laws"])]
    except (KeyError, ValueError, TypeError, RecursionError):
        raise InputError(f"{path}: the attribute laws is no list of laws in JSON") from None


def versions(ds: xr.Dataset, path: str | Path = "the dataset") -> dict[str, str]:
    """What the dataset was made with, package -> version; `InputError` where the attribute says nothing of the kind."""
    try:
        found = json.loads(ds.attrs["versions"])
    except (KeyError, ValueError, TypeError, RecursionError):
        found = None
    if not isinstance(found, dict):
        raise InputError(f"{path}: the attribute versions is no table in JSON")
    return {str(name): str(number) for name, number in found.items()}


def _shown(value: object) -> str:
    """A value from a file as a message may show it: on one line, and not endless."""
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
