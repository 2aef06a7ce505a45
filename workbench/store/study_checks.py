"""Validate the layout of a study's dataset: its attributes, axes, samples and variables; and run checks.

A check yields what is wrong with a dataset, each a sentence without its beginning, the name of the file; a dataset with
which nothing is wrong is valid. Those of texts and numbers are in `value_checks`. Checks change nothing.
"""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from solver.problem.errors import InputError
from studies import names
from studies.grammar.axes import FIELDS, SAMPLE

from . import attributes, file_kinds, refined, schema, value_checks
from .attributes import show
from .schema import CURVES, FORMAT, INNER, JUDGED

Check = Callable[[xr.Dataset], Iterator[str]]

# The attributes that mark a study's dataset, and all that are text.
NEEDED = ("title", "study_name", "laws")
TEXTS = (*NEEDED, "study", "reading", "side", "stiffness", "length_unit", "force_unit", "method", "versions")
EACH = ("solved", "caution", *JUDGED)  # of every case, beside the outcome
WORDS = ("outcome", "caution", "xyz")  # the variables that are text; `solved` is boolean, all others are numbers
SCALED = ("scale_factor", "add_offset", "missing_value", "_Unsigned")  # attributes by which xarray changes numbers
MOST_TEXT = 64_000_000  # bytes of an attribute


def check(ds: xr.Dataset, path: str | Path, checks: Sequence[Check]) -> None:
    """Raise `InputError`, a sentence that begins with the path, for the first thing that is wrong with a dataset."""
    for look in checks:
        for wrong in look(ds):
            raise InputError(f"{path}{wrong}")


def check_kind(ds: xr.Dataset, path: str | Path) -> None:
    """Raise `InputError` unless it is a study's dataset of this version's format; a study is cheap to solve again."""
    kind = file_kinds.kind_of(ds)
    if kind is not file_kinds.STUDY:
        raise file_kinds.other_kind(path, kind, f"this command reads {file_kinds.STUDY.what}")
    missing = [name for name in NEEDED if name not in ds.attrs]
    if missing or "outcome" not in ds:
        raise InputError(f"{path} is not a study's dataset: it has no {', '.join(missing) or 'outcome'}")
    version = np.asarray(ds.attrs.get("format", 1))
    if version.size != 1 or version.dtype.kind not in "iu":
        raise InputError(f"{path}: the attribute format must be a whole number, got {show(ds.attrs['format'])}")
    other = f"{path} is of format {version.item()}, but this version reads format {FORMAT}"
    if version.item() > FORMAT:
        raise InputError(other)
    if version.item() < FORMAT:
        study = str(ds.attrs["study_name"])
        study = study if study in names() else "STUDY"
        raise InputError(f"{other}; make it again with: workbench run {study} --out {path}")


def texts_of_study(ds: xr.Dataset) -> Iterator[str]:
    """Whether it has the attributes that every command relies on, and laws about its axes."""
    for name in TEXTS:
        value = ds.attrs.get(name)
        if not isinstance(value, str) or len(value) > MOST_TEXT:
            kind = "missing" if value is None else f"not text of at most {MOST_TEXT} characters"
            yield f": the attribute {name} is {kind}"
    of_laws = [*schema.axes_of(ds), *(refined.axes_of(ds) if refined.is_refined(ds) else [])]
    try:
        if not 0 < attributes.number(ds, "tolerance", "") < 1:
            yield ": the attribute tolerance is not between 0 and 1"
        about = [[law.axis, *law.at] for law in attributes.laws(ds, "")]
    except InputError as error:
        yield str(error)
        return
    for axes in about:
        if not {*axes} <= {*of_laws}:
            yield f": a law is about {show(axes)}, but the axes are {show(of_laws)}"


def axes(ds: xr.Dataset) -> Iterator[str]:
    """Whether each axis has finite, different numbers; those of the samples are whole."""
    for name in schema.axes_of(ds):
        if name not in ds.coords or ds[name].dtype.kind not in ("iu" if name == SAMPLE else "f"):
            yield f": the axis {show(name)} has no values"
        values = ds[name].values
        if not np.isfinite(values).all():
            yield f": the axis {show(name)} holds values that are not finite"
        if np.unique(values).size < values.size:
            yield f": the axis {show(name)} holds a value twice"


def samples(ds: xr.Dataset) -> Iterator[str]:
    """Whether each sampled field is a coordinate of finite numbers along the samples."""
    fields = schema.fields_of_samples(ds)
    if bool(fields) != (SAMPLE in ds["outcome"].dims):
        yield f": the attribute sampled and the dimension {SAMPLE} belong together: one is missing"
    for field in fields:
        name = schema.dimension(field) if field in FIELDS else field
        if name not in ds.coords or ds[name].dims != (SAMPLE,) or ds[name].dtype.kind != "f":
            yield f": the sampled field {show(field)} has no values"
        if not np.isfinite(ds[name].values).all():
            yield f": the sampled field {show(field)} holds values that are not finite"
    if refined.is_refined(ds):
        try:
            refined.describe(ds)
        except InputError as error:
            yield f": {error}"


def variables(ds: xr.Dataset) -> Iterator[str]:
    """Whether each variable has dimensions and a kind of values that fit."""
    axes = schema.axes_of(ds)
    known = [*axes, "u", *dict.fromkeys(dim for dims in INNER.values() for dim in dims)]
    for name, variable in ((str(key), variable) for key, variable in ds.variables.items()):
        expected = [*axes, "u", *INNER.get(CURVES.get(name, name), ())]
        dims = [str(dim) for dim in variable.dims]
        fits = dims == [dim for dim in known if dim in dims] and (name not in CURVES or dims == expected)
        if not fits or (name in ("u", "s") and dims[-1:] != ["u"]):
            yield f": {show(name)} has the dimensions {show(dims)}, which do not fit the axes"
        for key in SCALED:
            if key in variable.encoding:
                yield f": {show(name)} has the attribute {key}, which the format does not allow"
        fill = np.asarray(variable.encoding.get("_FillValue", np.nan))
        if fill.size != 1 or fill.dtype.kind not in "iuf":
            yield f": the attribute _FillValue of {show(name)} must be a number"
        kind, kinds = ("text", "OUST") if name in WORDS else ("numbers", "iuf")
        if name == "solved":
            kind, kinds = "booleans", "b"
        if variable.dtype.kind not in kinds:
            yield f": {show(name)} must hold {kind}, got {variable.dtype}"
    for name in EACH:
        if name not in ds or list(ds[name].dims) != axes:
            yield f" has no {name} for each of its cases"


STUDY = (
    texts_of_study,
    axes,
    samples,
    value_checks.texts,
    variables,
    value_checks.fields,
    value_checks.each,
)
