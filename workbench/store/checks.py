"""Validate a dataset before it is used: its layout, texts and numbers.

A check yields what is wrong with a dataset, each a sentence without its beginning, the name of the file; a dataset with
which nothing is wrong is valid. Checks change nothing. Those of `STUDY` are asked for every study; they read no array
along the rod. `curves` does, block by block: of a dataset that is read whole, for its summary and for its check.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from solver.problem.case import CONTACTS, DIRECT, ELASTIC, GIVEN, SIDES, SLIDING
from solver.problem.errors import InputError, choices
from studies import names
from studies.grammar.axes import FIELDS, SAMPLE
from studies.grammar.formulas import FORCES, LENGTHS

from ..words import escaping
from . import bounds, refined, schema
from .schema import CURVES, FORMAT, INNER, JUDGED, LABEL, LINE, LOADS, SECTION, pieces, show

Check = Callable[[xr.Dataset], Iterator[str]]

# The attributes that mark a study's dataset, and all that are text.
NEEDED = ("title", "study_name", "laws")
NAMED = (*NEEDED, "study", "reading", "side", "stiffness", "length_unit", "force_unit", "method", "versions")
EACH = ("solved", "caution", *JUDGED)  # of every case, beside the outcome
WORDS = ("outcome", "caution", "xyz")  # the variables that are text; `solved` is boolean, all others are numbers
SCALED = ("scale_factor", "add_offset", "missing_value", "_Unsigned")  # attributes by which xarray changes numbers
MOST_TEXT = 64_000_000  # bytes of an attribute

LONG = ("study", "laws", "versions", "recipe", "statistics", "branches", "rows")  # of many lines, or JSON; not printed
BLOCK = 100_000  # cases that are read at a time
BLOCK_ALONG = 2**20  # stations of their curves
LABELS = ("units", "long_name", "symbol", "reading")
CHOICES: Mapping[str, Any] = {
    "side": SIDES,
    "sliding": SLIDING,
    "contact": CONTACTS,
    "stiffness": schema.SECTIONS,
    "length_unit": LENGTHS,
    "force_unit": FORCES,
}


def check(ds: xr.Dataset, path: str | Path, checks: Sequence[Check]) -> None:
    """Raise `InputError`, a sentence that begins with the path, for the first thing that is wrong with a dataset."""
    for look in checks:
        for wrong in look(ds):
            raise InputError(f"{path}{wrong}")


def check_kind(ds: xr.Dataset, path: str | Path) -> None:
    """Raise `InputError` unless it is a study's dataset of this version's format; a study is cheap to solve again."""
    kind = schema.kind_of(ds)
    if kind is not schema.STUDY:
        raise schema.other_kind(path, kind, f"this command reads {schema.STUDY.what}")
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
    for name in NAMED:
        value = ds.attrs.get(name)
        if not isinstance(value, str) or len(value) > MOST_TEXT:
            kind = "missing" if value is None else f"not text of at most {MOST_TEXT} characters"
            yield f": the attribute {name} is {kind}"
    of_laws = [*schema.axes_of(ds), *refined.axes_of(ds)]
    try:
        if not 0 < schema.number_of(ds, "tolerance", "") < 1:
            yield ": the attribute tolerance is not between 0 and 1"
        about = [[law.axis, *law.at] for law in schema.laws_of(ds, "")]
    except InputError as error:
        yield str(error)
        return
    for axes in about:
        if not {*axes} <= {*of_laws}:
            yield f": a law is about {show(axes)}, but the axes are {show(of_laws)}"


def axes(ds: xr.Dataset) -> Iterator[str]:
    """Whether each axis has different numbers that are not too large; those of the samples are whole."""
    for name in schema.axes_of(ds):
        if name not in ds.coords or ds[name].dtype.kind not in ("iu" if name == SAMPLE else "f"):
            yield f": the axis {show(name)} has no values"
        if why := bounds.wrong_axis(ds[name].values):
            yield f": the axis {show(name)} {why}"


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
    if schema.is_refined(ds):
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
        measured = name.removesuffix("_error")
        if measured != name and measured in ds.variables and variable.dims != ds[measured].dims:
            yield f": {show(name)} has other dimensions than {show(measured)}"
        for key in SCALED:
            if key in variable.encoding:
                yield f": {show(name)} has the attribute {key}, which the format does not allow"
        fill = np.asarray(variable.encoding.get("_FillValue", np.nan))
        if fill.size != 1 or fill.dtype.kind != "f" or not np.isnan(fill).all():  # a number that is there would be lost
            yield f": the attribute _FillValue of {show(name)} must be NaN"
        kind, kinds = ("text", "OUST") if name in WORDS else ("numbers", "iuf")
        if name == "solved":
            kind, kinds = "booleans", "b"
        if variable.dtype.kind not in kinds:
            yield f": {show(name)} must hold {kind}, got {variable.dtype}"
    for name in EACH:
        if name not in ds or list(ds[name].dims) != axes:
            yield f" has no {name} for each of its cases"


def texts(ds: xr.Dataset) -> Iterator[str]:
    """Whether every text is printable and every word is one of its choices."""
    for key, value in ds.attrs.items():
        yield from _text(str(key), LABEL, "the name of an attribute")
        if isinstance(value, str):
            yield from _text(value, None if key in LONG else LINE, f"the attribute {key}")
    for key, known in CHOICES.items():
        if key in ds.attrs and ds.attrs[key] not in (*known,):
            yield f": the attribute {key} is {show(ds.attrs[key])}; it can be {choices(known)}"
    for name, variable in ds.variables.items():
        yield from _text(str(name), LABEL, "the name of a variable")
        for key, value in variable.attrs.items():
            what = f"the attribute {show(key)} of {show(name)}"
            if isinstance(value, str):
                yield from _text(value, LABEL, what)
            elif key in LABELS:
                yield f": {what} is not text"


def _text(text: str, longest: int | None, what: str) -> Iterator[str]:
    """Whether it is a line of at most so many characters; None: lines without control characters."""
    try:
        text.encode()
    except UnicodeEncodeError:
        yield f": {what} is not UTF-8 text: {show(text)}"
    if longest is None:
        if any(map(bounds.is_control, text)):
            yield f": {what} holds control characters"
    elif not escaping.is_line(text, longest):
        yield f": {what} must be one line of text, got {show(text)}"


def fields(ds: xr.Dataset) -> Iterator[str]:
    """Whether rod, cylinder and stations are finite, positive, in order and consistent."""
    number = {name: ds[name] for name in bounds.FIELDS if name in ds.variables}
    for name, variable in number.items():
        if variable.dtype.kind != "f":
            yield f": {name} must be a floating-point number, got {variable.dtype}"
        if why := bounds.wrong_field(name, variable.values):
            yield f": {name} {why}"
    yield from _section(ds, number)
    if {"R", "a", "rho"} <= set(number) and ds.attrs.get("side") in SIDES:
        expected = number["R"] + SIDES[ds.attrs["side"]] * number["a"]
        if bool((np.abs(number["rho"] - expected) > bounds.SAME * (number["R"] + number["a"])).any()):
            yield f": rho is not R {'+-'[ds.attrs['side'] == 'inside']} a"
    if {"L", "rho"} <= set(number) and bounds.is_too_long(number["L"], number["rho"]):
        yield f": L is more than {bounds.MOST:g} times rho"
    yield from _stations(ds, number.get("L"))


def _section(ds: xr.Dataset, number: Mapping[str, xr.DataArray]) -> Iterator[str]:
    """Whether the fields of the section fit the attribute stiffness, and a tube has a wall."""
    word = ds.attrs.get("stiffness")
    allowed = DIRECT if word == GIVEN else (*ELASTIC, *(["inner_radius"] if word == "solid" else []))
    for name in SECTION:
        if name in number and name not in allowed:
            yield f": the attribute stiffness is {show(word)}, which excludes {name}"
    if {"inner_radius", "a"} <= set(number) and not bool((number["inner_radius"] < number["a"]).all()):
        yield ": inner_radius is not less than a"


def _stations(ds: xr.Dataset, L: xr.DataArray | None) -> Iterator[str]:
    """Whether u rises from 0 to 1 and s is u L."""
    if "u" not in ds.variables or ds["u"].dims != ("u",):
        return
    u = ds["u"].values
    if u.dtype.kind != "f" or not np.isfinite(u).all() or u.min() < 0 or u.max() > 1 or not (np.diff(u) > 0).all():
        yield ": u must rise from 0 to 1"
    along = [str(name) for name, variable in ds.data_vars.items() if name in CURVES and "u" in variable.dims]
    if "s" not in ds.variables and along:
        yield f": {along[0]} is an array along the rod, but s is missing"
    if "s" not in ds.variables or L is None:
        return
    expected = L * ds["u"]
    missing = {*expected.dims} - {*ds["s"].dims}  # an axis of one value is none of a field's
    fits = {*ds["s"].dims} <= {*expected.dims} and all(expected.sizes[dim] == 1 for dim in missing)
    if not fits or not bool((np.abs(ds["s"] - expected) <= bounds.SAME * L).all()):
        yield ": s must be u L"


def each(ds: xr.Dataset) -> Iterator[str]:
    """Whether the texts, errors, loads and observables of each case are valid, block by block."""
    for name in (*JUDGED, *LOADS):
        if name in ds.variables and ds[name].dtype.kind not in "iuf":
            yield f": {name} must hold numbers, got {ds[name].dtype}"
    sizes = (*schema.stiffness_fields(ds), "rho", "L")
    dims = ds["outcome"].dims
    numbers = [
        str(name) for name, variable in ds.data_vars.items() if variable.dims == dims and variable.dtype.kind in "iuf"
    ]
    names = [
        name for name in dict.fromkeys(("solved", *schema.TEXTS, *numbers, *LOADS, *sizes)) if name in ds.variables
    ]
    for block in pieces(ds, names, BLOCK):
        for name in schema.TEXTS:
            for text in set(block[name].values.ravel().tolist()) if name in block.data_vars else ():
                yield from _text(str(text), LABEL, f"one of {name}")
        solved = block["solved"].values
        L = schema.over_cases(block, block["L"]).values[solved] if "L" in block.variables else np.inf
        for name in numbers:
            counted = name in bounds.COUNTED or schema.is_count(block[name])
            values = block[name].values[solved]
            if (bad := bounds.bad_numbers(name, values, counted, L)).any():
                yield f": {name} of a solved case cannot be {values[bad][0]:g}"
        yield from _loads(block)


def _loads(ds: xr.Dataset) -> Iterator[str]:
    """Whether the loads of solved cases are finite, and not far too large for their rods."""
    if not {*schema.stiffness_fields(ds), "rho"} <= {*ds.variables}:
        return
    solved = ds["solved"].values
    A, rho = schema.bending_stiffness(str(ds.attrs["stiffness"]), ds), ds["rho"]
    A, rho = (schema.over_cases(ds, number).values[solved] for number in (A, rho))
    for name in (name for name in LOADS if name in ds.variables):
        if bounds.bad_loads(name, schema.over_cases(ds, ds[name]).values[solved], A, rho).any():
            yield f": {name} of a solved case is not finite, or far too large for its rod"


def curves(ds: xr.Dataset) -> Iterator[str]:
    """Whether the curves of solved cases are finite, and no chord is longer than its arc."""
    keys = [key for key in CURVES if key in ds.data_vars and "u" in ds[key].dims]
    dims = ds["solved"].dims
    for key in keys:
        if ds[key].dtype.kind not in "iuf" or ds[key].dims[: len(dims)] != dims:
            yield f": {show(key)} is not an array of numbers along each rod"
    names = [name for name in ("solved", *keys, "s", "rho") if name in ds.variables]
    for block in pieces(ds, names, max(1, BLOCK_ALONG // ds.sizes.get("u", 1))):
        solved = block["solved"].variable
        for key in keys:
            if bounds.bad_curves(key, block[key].values[solved.values]).any():
                yield f": {show(key)} of a solved case is not finite, or beyond {bounds.most_along(key):g}"
        if {"s", "rho"} <= set(block.variables) and "u" in block.dims:
            yield from _chords(block)


def _chords(ds: xr.Dataset) -> Iterator[str]:
    arc = ds["s"].diff("u")
    if schema.leaves(ds):
        yield from _chords_in_space(ds, arc)
        return
    for name, scale in (("alpha", ds["rho"]), ("z", 1.0)):
        if name in ds.data_vars and "u" in ds[name].dims:
            with np.errstate(all="ignore"):
                far = np.abs(ds[name].diff("u") * scale) > arc * (1 + bounds.STRAIGHT) + bounds.STRAIGHT * ds["rho"]
            if bool((far & ds["solved"].variable).any()):
                yield f": {name} of a solved case moves farther than the rod is long"


def _chords_in_space(ds: xr.Dataset, arc: xr.DataArray) -> Iterator[str]:
    """The same of rods that may leave the cylinder, whose places have an error; nothing where no radius is stored."""
    if not all(name in ds.data_vars and "u" in ds[name].dims for name in ("radius", "alpha", "z")):
        return
    r, alpha, z = ds["radius"], ds["alpha"], ds["z"]
    with np.errstate(all="ignore"):
        chord = np.hypot(np.hypot((r * np.cos(alpha)).diff("u"), (r * np.sin(alpha)).diff("u")), z.diff("u"))
        far = chord > arc + float(ds.attrs["tolerance"]) * ds["s"].isel(u=-1)
    if bool((far & ds["solved"].variable).any()):
        yield ": radius, alpha and z of a solved case move farther than the rod is long"


STUDY = (texts_of_study, axes, samples, texts, variables, fields, each)


def check_all(ds: xr.Dataset, path: str | Path) -> None:
    """Raise `InputError` where anything is wrong with a dataset, of whichever kind: of a study, else of any other."""
    if schema.kind_of(ds) is schema.STUDY:
        check_kind(ds, path)
        check(ds, path, [*STUDY, curves])
    else:
        check_any(ds, path)


def check_any(ds: xr.Dataset, path: str | Path) -> None:
    """Raise `InputError` where anything is wrong with what datasets of all kinds have."""
    check(ds, path, [texts, fields, *([each, curves] if "solved" in ds else [])])
