"""Stored datasets opened lazily, after their file (`file_checks`), layout and values (`value_checks`) are validated."""

import json
import os
import warnings
from pathlib import Path

import h5py
import numpy as np
import xarray as xr

from solver.problem.errors import InputError
from studies import names
from studies.grammar.axes import FIELDS
from studies.grammar.dimensions import SAMPLE
from studies.laws.law import Law

from ..words import escaping
from . import checksums, file_checks, file_kinds, netcdf, refined, value_checks
from .file_checks import open_valid, refusing, show
from .schema import CURVES, FORMAT, INNER, dimension, fields_of_samples

# The attributes that mark a study's dataset, and all that are text.
NEEDED = ("title", "study_name", "laws")
TEXTS = (*NEEDED, "study", "reading", "side", "stiffness", "length_unit", "force_unit", "method", "versions")

EACH = ("solved", "caution", "error", "condition")  # of every case, beside the outcome
WORDS = ("outcome", "caution", "xyz")  # the variables that are text; `solved` is boolean, all others are numbers
SCALED = ("scale_factor", "add_offset", "missing_value", "_Unsigned")  # attributes by which xarray changes numbers

MOST_TEXT = 64_000_000  # bytes of an attribute


def open_study(path: str | Path, whole: bool = False) -> xr.Dataset:
    """A study's dataset, opened lazily; to be closed after use. whole: arrays along the rod are validated too.

    Raises `InputError` where the file is missing, damaged, of another format, or not a study's dataset.
    """
    ds = raw(path)
    try:
        with refusing(path):
            _check_study(ds, path)
            check_sums(path)
            if whole:
                value_checks.curves(ds, path)
    except InputError:
        ds.close()
        raise
    return ds


def raw(path: str | Path) -> xr.Dataset:
    """Any netCDF4 file of plain arrays, opened lazily; `InputError` where it is not one."""
    with open_valid(path):
        pass
    with refusing(path), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of xarray, on files that are refused below
        ds = netcdf.open_file(path, decode_times=False)
    ds.attrs.pop(checksums.KEY, None)  # a selection that is stored has others
    return ds


def check_sums(path: str | Path) -> None:
    """Raise `InputError` where an attribute, a text or a single number is not what was stored."""
    with refusing(path), h5py.File(path, "r") as file:
        checksums.check(file, path)


def _check_study(ds: xr.Dataset, path: str | Path) -> None:
    """Raise `InputError` unless it has the attributes, dimensions and kinds that every command relies on."""
    file_kinds.check_study(ds, path)
    missing = [name for name in NEEDED if name not in ds.attrs]
    if missing or "outcome" not in ds:
        raise InputError(f"{path} is not a study's dataset: it has no {', '.join(missing) or 'outcome'}")
    _check_format(ds, path)
    for name in TEXTS:
        value = ds.attrs.get(name)
        if not isinstance(value, str) or len(value) > MOST_TEXT:
            kind = "missing" if value is None else f"not text of at most {MOST_TEXT} characters"
            raise InputError(f"{path}: the attribute {name} is {kind}")
    if not 0 < number(ds, "tolerance", path) < 1:
        raise InputError(f"{path}: the attribute tolerance is not between 0 and 1")
    axes = [str(dim) for dim in ds["outcome"].dims]
    of_laws = [*axes, *(refined.axes_of(ds) if refined.is_refined(ds) else [])]
    for law in laws(ds, path):
        if not {law.axis, *law.at} <= {*of_laws}:
            raise InputError(f"{path}: a law is about {show([law.axis, *law.at])}, but the axes are {show(of_laws)}")
    for axis in axes:
        _check_axis(ds, axis, path)
    _check_samples(ds, path)
    value_checks.texts(ds, path)
    for key, variable in ds.variables.items():
        _check_variable(str(key), variable, axes, path)
    for name in EACH:
        if name not in ds or list(ds[name].dims) != axes:
            raise InputError(f"{path} has no {name} for each of its cases")
    value_checks.fields(ds, path)
    value_checks.each(ds, path)


def _check_format(ds: xr.Dataset, path: str | Path) -> None:
    """Only the format of this version is read; a study is cheap to solve again."""
    found = np.asarray(ds.attrs.get("format", 1))
    if found.size != 1 or found.dtype.kind not in "iu":
        raise InputError(f"{path}: the attribute format must be a whole number, got {show(ds.attrs['format'])}")
    if found.item() > FORMAT:
        raise InputError(f"{path} is of format {found.item()}, but this version reads format {FORMAT}")
    if found.item() < FORMAT:
        study = str(ds.attrs["study_name"])
        study = study if study in names() else "STUDY"
        again = f"make it again with: workbench run {study} --out {path}"
        raise InputError(f"{path} is of format {found.item()}, but this version reads format {FORMAT}; {again}")


def _check_axis(ds: xr.Dataset, name: str, path: str | Path) -> None:
    """Raise `InputError` unless the axis has finite, different numbers; those of the samples are whole."""
    if name not in ds.coords or ds[name].dtype.kind not in ("iu" if name == SAMPLE else "f"):
        raise InputError(f"{path}: the axis {show(name)} has no values")
    values = ds[name].values
    if not np.isfinite(values).all():
        raise InputError(f"{path}: the axis {show(name)} holds values that are not finite")
    if np.unique(values).size < values.size:
        raise InputError(f"{path}: the axis {show(name)} holds a value twice")


def _check_samples(ds: xr.Dataset, path: str | Path) -> None:
    """Raise `InputError` unless each sampled field is a coordinate of finite numbers along the samples."""
    fields = fields_of_samples(ds)
    if bool(fields) != (SAMPLE in ds["outcome"].dims):
        raise InputError(f"{path}: the attribute sampled and the dimension {SAMPLE} belong together: one is missing")
    for field in fields:
        name = dimension(field) if field in FIELDS else field
        if name not in ds.coords or ds[name].dims != (SAMPLE,) or ds[name].dtype.kind != "f":
            raise InputError(f"{path}: the sampled field {show(field)} has no values")
        if not np.isfinite(ds[name].values).all():
            raise InputError(f"{path}: the sampled field {show(field)} holds values that are not finite")
    if refined.is_refined(ds):
        try:
            refined.describe(ds)
        except InputError as error:
            raise InputError(f"{path}: {error}") from None


def _check_variable(name: str, variable: xr.Variable, axes: list[str], path: str | Path) -> None:
    along = name in CURVES or name in ("u", "s")
    known = [*axes, "u", *dict.fromkeys(dim for dims in INNER.values() for dim in dims)]
    expected = [*axes, "u", *INNER.get(CURVES.get(name, name), ())]
    dims = [str(dim) for dim in variable.dims]
    fits = dims == [dim for dim in known if dim in dims] and (not along or name in ("u", "s") or dims == expected)
    if not fits or (name in ("u", "s") and dims[-1:] != ["u"]):
        raise InputError(f"{path}: {show(name)} has the dimensions {show(dims)}, which do not fit the axes")
    scaled = [key for key in SCALED if key in variable.encoding]
    if scaled:
        raise InputError(f"{path}: {show(name)} has the attribute {scaled[0]}, which the format does not allow")
    fill = np.asarray(variable.encoding.get("_FillValue", np.nan))
    if fill.size != 1 or fill.dtype.kind not in "iuf":
        raise InputError(f"{path}: the attribute _FillValue of {show(name)} must be a number")
    wanted, kinds = ("text", "OUST") if name in WORDS else ("numbers", "iuf")
    if name == "solved":
        wanted, kinds = "booleans", "b"
    if variable.dtype.kind not in kinds:
        raise InputError(f"{path}: {show(name)} must hold {wanted}, got {variable.dtype}")


def text(ds: xr.Dataset, name: str) -> str:
    """An attribute that is text, of a dataset that was not opened here; `InputError` otherwise."""
    value = ds.attrs.get(name)
    if not isinstance(value, str):
        raise InputError(f"the dataset's attribute {name} is {'missing' if value is None else 'not text'}")
    return value


def number(ds: xr.Dataset, name: str, path: str | Path = "the dataset") -> float:
    """An attribute that is one number; `InputError` otherwise."""
    value = np.asarray(ds.attrs.get(name))
    if value.size != 1 or value.dtype.kind not in "iuf":
        raise InputError(f"{path}: the attribute {name} must be a number, got {show(ds.attrs.get(name))}")
    return float(value.item())


def laws(ds: xr.Dataset, path: str | Path = "the dataset") -> list[Law]:
    """The laws that the dataset's study states; `InputError` where the attribute is not a list of laws."""
    try:
        found = [Law.model_validate(row) for row in json.loads(ds.attrs["laws"])]
    except (KeyError, ValueError, TypeError, RecursionError):
        raise InputError(f"{path}: the attribute laws is not a list of laws in JSON") from None
    for law in found:
        for name, said in law.model_dump().items():
            if isinstance(said, str) and not escaping.is_line(said, value_checks.LINE):
                raise InputError(f"{path}: {name} of a law must be one line of text, got {show(said)}")
    return found


def versions(ds: xr.Dataset, path: str | Path = "the dataset") -> dict[str, str]:
    """The versions the dataset was made with, by package; `InputError` where the attribute is not such a table."""
    try:
        found = json.loads(ds.attrs["versions"])
    except (KeyError, ValueError, TypeError, RecursionError):
        found = None
    if not isinstance(found, dict) or not all(
        escaping.is_line(f"{a} {b}", value_checks.LABEL) for a, b in found.items()
    ):
        raise InputError(f"{path}: the attribute versions is not a table in JSON")
    return {str(name): str(number) for name, number in found.items()}


def read(path: str | Path, study: bool = True) -> xr.Dataset:
    """A study's dataset (or, where `study` is False, any that the workbench wrote), all in memory.

    Raises `InputError` where the file is missing, damaged, foreign or too large, or holds invalid values.
    """
    with open_study(path) if study else raw(path) as ds:
        if ds.nbytes > _memory():
            held = f"{path} holds {ds.nbytes / 1e9:.3g} GB, more than this machine's memory of {_memory() / 1e9:.3g} GB"
            raise InputError(f"{held}; open it with xarray.open_dataset and select from it")
        with file_checks.refusing(path):
            ds.load()
        if not study:
            value_checks.texts(ds, path)
            value_checks.fields(ds, path)
            check_sums(path)
        if "solved" in ds:
            value_checks.each(ds, path)
            value_checks.curves(ds, path)
        return ds


def _memory() -> int:
    """The memory of this machine [bytes]."""
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
