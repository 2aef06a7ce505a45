"""Validate a dataset before it is used or stored: its layout, texts and numbers.

A check yields what is wrong with a dataset, each a sentence without its beginning, the name of the file; a dataset with
which nothing is wrong is valid. Checks change nothing. Those of `STUDY` are asked for every study; they read no array
along the rod. `curves` does, block by block: of a dataset that is read whole, for its summary and for its check. What
numbers can be stands in `bounds`.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver.problem.case import DIRECT, ELASTIC, GIVEN, SIDES
from solver.problem.declared_fields import CHOICES, FIELDS
from solver.problem.errors import InputError, choices
from solver.problem.quantities import QUANTITIES, unit_of
from solver.problem.units import FORCES, LENGTHS
from studies import names
from studies.grammar.axes import SAMPLE

from ..words import escaping
from ..words.escaping import show
from . import bounds, file_kinds, law_verdicts, quantity_variables, refined, schema
from .bounds import LABEL, LINE
from .boxes import pieces
from .quantity_variables import CURVES, INNER, JUDGED, LOADS, SECTION
from .schema import FORMAT, TEXTS

Check = Callable[[xr.Dataset], Iterator[str]]

OF_STUDY = ("title", "study_name", "laws", "study", "reading", "side", "stiffness", "length_unit", "force_unit",
            "method", "versions")  # attributes of every study; the first three mark its file  # fmt: skip
LONG = ("study", "laws", "versions", "recipe", "statistics", "branches", "rows")  # of many lines, or JSON; not printed
MOST_TEXT = 64_000_000  # characters of such a text
WORDS: Mapping[str, Any] = {
    **CHOICES,
    "stiffness": quantity_variables.SECTIONS,
    "length_unit": LENGTHS,
    "force_unit": FORCES,
}
LABELS = ("units", "long_name", "symbol", "reading")  # attributes of variables that are text
# What the values of a variable are, and their kinds in NumPy; of all others numbers.
KINDS = {**dict.fromkeys((*TEXTS, "xyz"), ("text", "OUST")), "solved": ("booleans", "b")}
SCALED = ("scale_factor", "add_offset", "missing_value", "_Unsigned")  # attributes by which xarray changes numbers
BLOCK_ALONG = 2**20  # stations of curves that are read at a time


def check(ds: xr.Dataset, path: str | Path, checks: Sequence[Check]) -> None:
    """Raise `InputError`, a sentence that begins with the path, for the first thing that is wrong with a dataset."""
    for look in checks:
        for wrong in look(ds):
            raise InputError(f"{path}{wrong}")


def check_all(ds: xr.Dataset, path: str | Path) -> None:
    """Raise `InputError` where anything is wrong with a dataset, of whichever kind."""
    if file_kinds.kind_of(ds) is not file_kinds.STUDY:
        return check(ds, path, of_any(ds))
    check_kind(ds, path)
    return check(ds, path, [*STUDY, curves])


def of_any(ds: xr.Dataset) -> Sequence[Check]:
    """The checks of what datasets of all kinds have."""
    return (texts, fields, *((cases, curves) if "solved" in ds else ()))


def check_kind(ds: xr.Dataset, path: str | Path) -> None:
    """Raise `InputError` unless it is a study's dataset of this version's format; a study is cheap to solve again."""
    kind = file_kinds.kind_of(ds)
    if kind is not file_kinds.STUDY:
        raise file_kinds.other_kind(path, kind, f"this command reads {file_kinds.STUDY.what}")
    missing = [name for name in OF_STUDY[:3] if name not in ds.attrs]
    if missing or "outcome" not in ds:
        raise InputError(f"{path} is not a study's dataset: it has no {', '.join(missing) or 'outcome'}")
    version = np.asarray(ds.attrs.get("format", 1))
    if version.size != 1 or version.dtype.kind not in "iu":
        raise InputError(f"{path}: the attribute format must be a whole number, got {show(ds.attrs['format'])}")
    if version.item() != FORMAT:
        study = str(ds.attrs["study_name"])
        again = f"; make it again with: workbench run {study if study in names() else 'STUDY'} --out {path}"
        other = f"{path} is of format {version.item()}, but this version reads format {FORMAT}"
        raise InputError(other + (again if version.item() < FORMAT else ""))


def is_nan(value: Any) -> bool:
    """Whether a value of an attribute is one NaN."""
    array = np.asarray(value)
    return array.size == 1 and array.dtype.kind == "f" and bool(np.isnan(array).all())


def texts(ds: xr.Dataset) -> Iterator[str]:
    """Whether every text is printable, every word one of its choices, and no number is stored as another one."""
    for key, value in ds.attrs.items():
        yield from _line(str(key), "the name of an attribute")
        if key in WORDS and (not isinstance(value, str) or value not in WORDS[key]):
            yield f": the attribute {key} is {show(value)}; it can be {choices(WORDS[key])}"
        if key in LONG and isinstance(value, str) and (len(value) > MOST_TEXT or bounds.CONTROL.search(value)):
            yield f": the attribute {key} holds control characters, or more than {MOST_TEXT} letters"
        elif key not in LONG and isinstance(value, str):
            yield from _line(value, f"the attribute {key}", LINE)
    for name, variable in ds.variables.items():
        yield from _line(str(name), "the name of a variable")
        for key, value in variable.attrs.items():
            if isinstance(value, str):
                yield from _line(value, f"the attribute {show(key)} of {show(name)}")
            elif key in LABELS:
                yield f": the attribute {show(key)} of {show(name)} is not text"
        for key in SCALED:
            if key in variable.encoding:
                yield f": {show(name)} has the attribute {key}, which the format does not allow"
        if not is_nan(variable.encoding.get("_FillValue", np.nan)):  # a number that is there would be lost
            yield f": the attribute _FillValue of {show(name)} must be NaN"


def _line(text: str, what: str, most: int = LABEL) -> Iterator[str]:
    if not escaping.is_line(text, most):
        yield f": {what} must be one line of text, got {show(text)}"


def study_texts(ds: xr.Dataset) -> Iterator[str]:
    """Whether it has the attributes that every command relies on, and laws about its axes."""
    for name in OF_STUDY:
        if not isinstance(value := ds.attrs.get(name), str):
            yield f": the attribute {name} is {'missing' if value is None else 'not text'}"
    known = [*schema.axes_of(ds), *refined.axes_of(ds)]
    try:
        if not 0 < schema.number_of(ds, "tolerance", "") < 1:
            yield ": the attribute tolerance is not between 0 and 1"
        schema.versions_of(ds, "")
        about = [[law.axis, *law.at] for law in law_verdicts.laws_of(ds, "")]
    except InputError as error:
        yield str(error)
        return
    for axes in about:
        if not {*axes} <= {*known}:
            yield f": a law is about {show(axes)}, but the axes are {show(known)}"


def kinds(ds: xr.Dataset) -> Iterator[str]:
    """Whether each variable holds the kind of values that it is known for."""
    for name, variable in ds.variables.items():
        words, allowed = KINDS.get(str(name), ("numbers", "iuf"))
        if variable.dtype.kind not in allowed:
            yield f": {show(name)} must hold {words}, got {variable.dtype}"


def layout(ds: xr.Dataset) -> Iterator[str]:
    """Whether each variable has the dimensions and the unit that it is known for."""
    axes, variables = schema.axes_of(ds), {str(name): variable for name, variable in ds.variables.items()}
    known = [*axes, "u", *dict.fromkeys(dim for dims in INNER.values() for dim in dims)]
    expressions = {name for name, variable in variables.items() if "expression" in variable.attrs}
    for name, variable in variables.items():
        expected, dims = [*axes, "u", *INNER.get(CURVES.get(name, name), ())], list(map(str, variable.dims))
        fits = dims == [dim for dim in known if dim in dims] and (name not in CURVES or dims == expected)
        if not fits or (name in ("u", "s") and dims[-1:] != ["u"]):
            yield f": {show(name)} has the dimensions {show(dims)}, which do not fit the axes"
        measured = name.removesuffix("_error")
        if measured in variables and variable.dims != variables[measured].dims:
            yield f": {show(name)} has other dimensions than {show(measured)}"
        row, said = QUANTITIES.get(CURVES.get(name, name)), variable.attrs.get("units")
        if row is None or row.dimension == "text" or said is None or measured in expressions:
            continue
        if said != (unit := unit_of(row.name, {kind: ds.attrs[f"{kind}_unit"] for kind in ("length", "force")})):
            yield f": {name} is in {show(said)}, but in the units of the file it is in {unit}"
    for name in ("solved", "caution", *JUDGED):
        if name not in ds or list(ds[name].dims) != axes:
            yield f" has no {name} for each of its cases"


def axes(ds: xr.Dataset) -> Iterator[str]:
    """Whether each axis has different numbers that are not too large, and each sampled field is along the samples."""
    for name in schema.axes_of(ds):
        if name not in ds.coords or ds.variables[name].dtype.kind not in ("iu" if name == SAMPLE else "f"):
            yield f": the axis {show(name)} has no values"
        if why := bounds.wrong_axis(ds.variables[name].values):
            yield f": the axis {show(name)} {why}"
    fields = schema.fields_of_samples(ds)
    if bool(fields) != (SAMPLE in schema.axes_of(ds)):
        yield f": the attribute sampled and the dimension {SAMPLE} belong together: one is missing"
    for field in fields:
        name = quantity_variables.dimension(field) if field in FIELDS else field
        if name not in ds.coords or ds[name].dims != (SAMPLE,) or ds[name].dtype.kind != "f":
            yield f": the sampled field {show(field)} has no values"
        if not np.isfinite(ds[name].values).all():
            yield f": the sampled field {show(field)} holds values that are not finite"
    try:
        if refined.REFINED in ds.attrs:
            refined.describe(ds)
    except InputError as error:
        yield f": {error}"


# What fields and stations must be together: the names, what is wrong otherwise, and the rule.
TOGETHER: Sequence[tuple[tuple[str, ...], str, Callable[..., Any]]] = (
    (("inner_radius", "a"), "inner_radius is not less than a", lambda inner, a: inner < a),
    (
        ("rho", "R", "a", "side"),
        "rho is not R + a, or inside a hole R - a",
        lambda rho, R, a, side: abs(rho - R - side * a) <= bounds.SAME * (R + a),
    ),
    (("L", "rho"), f"L is more than {bounds.MOST:g} times rho", lambda L, rho: L / rho < bounds.MOST),
    (
        ("u",),
        "u must rise from 0 to 1",
        lambda u: (u >= 0) & (u <= 1) & bool((np.diff(np.atleast_1d(u.values)) > 0).all()),
    ),
    (
        ("s", "u", "L"),
        "s must be u L",  # an axis of one value is none of a field's
        lambda s, u, L: (
            (abs(s - u * L) <= bounds.SAME * L) & ({*(u * L).squeeze().dims} <= {*s.dims} <= {*(u * L).dims})
        ),
    ),
)


def fields(ds: xr.Dataset) -> Iterator[str]:
    """Whether rod, cylinder and stations are finite, positive, in order and consistent."""
    number = {name: ds.variables[name] for name in (*bounds.FIELDS, "u", "s") if name in ds.variables}
    for name, variable in number.items():
        if variable.dtype.kind != "f":
            yield f": {name} must be a floating-point number, got {variable.dtype}"
        if name in bounds.FIELDS and (why := bounds.wrong_field(name, variable.values)):
            yield f": {name} {why}"
    word, side = ds.attrs.get("stiffness"), ds.attrs.get("side")
    allowed = DIRECT if word == GIVEN else (*ELASTIC, *(["inner_radius"] if word == "solid" else []))
    for name in (name for name in SECTION if name in number and name not in allowed):
        yield f": the attribute stiffness is {show(word)}, which excludes {name}"
    if side in SIDES:
        number["side"] = xr.Variable((), SIDES[side])
    for needed, wrong, holds in TOGETHER:
        with np.errstate(all="ignore"):  # of infinite numbers a rule has no value, and does not hold
            if {*needed} <= {*number} and not np.all(holds(*(number[name] for name in needed)).values):
                yield f": {wrong}"
    along = [name for name in CURVES if name in ds.data_vars and "u" in ds.variables[name].dims]
    if along and "u" in number and "s" not in number:
        yield f": {along[0]} is an array along the rod, but s is missing"


def cases(ds: xr.Dataset) -> Iterator[str]:
    """Whether the texts, errors, loads and observables of each case are valid, block by block."""
    variables, dims = ds.variables, ds.variables["solved"].dims
    each = [str(name) for name in ds.data_vars if variables[name].dims == dims and variables[name].dtype.kind in "iuf"]
    numbers = [*dict.fromkeys([*each, *(name for name in LOADS if name in variables)])]
    for block in pieces(variables, [*TEXTS, *numbers, *schema.stiffness_fields(ds), "rho", "L"]):
        for name in (name for name in TEXTS if name in block):
            for text in dict.fromkeys(block[name].values.ravel().tolist()):
                yield from _line(str(text), f"one of {name}")
        yield from _numbers(ds, block, numbers)


def curves(ds: xr.Dataset) -> Iterator[str]:
    """Whether the curves of solved cases are finite, and no chord is longer than its arc."""
    keys = [key for key in CURVES if key in ds.data_vars and "u" in ds.variables[key].dims]
    for block in pieces(ds.variables, [*keys, "s", "rho"], max(1, BLOCK_ALONG // ds.sizes.get("u", 1))):
        yield from _numbers(ds, block, keys)
        if {"s", "rho", "u"} <= {*block, *ds.dims}:
            yield from _chords(ds, block)


def _chords(ds: xr.Dataset, block: Mapping[str, xr.Variable]) -> Iterator[str]:
    """Whether no solved rod moves farther than it is long; places of rods that may leave the cylinder have an error."""
    s, rho = block["s"], block["rho"]
    with np.errstate(all="ignore"):
        arc = _steps(s) * (1 + bounds.STRAIGHT) + bounds.STRAIGHT * rho
        moved = {
            f"{name} of a solved case moves": abs(_steps(block[name])) * scale
            for name, scale in (("alpha", rho), ("z", 1.0))
            if name in block
        }
        if schema.leaves(ds):
            if not {"radius", "alpha", "z"} <= {*block}:
                return
            r, alpha, z = (block[name] for name in ("radius", "alpha", "z"))
            chord = (_steps(r * np.cos(alpha)) ** 2 + _steps(r * np.sin(alpha)) ** 2 + _steps(z) ** 2) ** 0.5
            arc = _steps(s) + float(ds.attrs["tolerance"]) * s.isel(u=-1)
            moved = {"radius, alpha and z of a solved case move": chord}
        for words, far in moved.items():
            if ((far > arc) & block["solved"]).values.any():
                yield f": {words} farther than the rod is long"


def _steps(along: xr.Variable) -> xr.Variable:
    """Differences from one station to the next."""
    return along.isel(u=slice(1, None)) - along.isel(u=slice(None, -1))


def _numbers(ds: xr.Dataset, block: Mapping[str, xr.Variable], names: Sequence[str]) -> Iterator[str]:
    """Whether numbers of the solved cases of a block can be (`bounds.unfit`)."""
    solved = block["solved"]

    def of_solved(variable: xr.Variable) -> NDArray[Any]:
        inner = {dim: size for dim, size in variable.sizes.items() if dim not in solved.dims}
        over_cases = variable.set_dims({**solved.sizes, **inner}).transpose(*solved.dims, ...)
        return np.asarray(over_cases.values[solved.values])

    rod = {name: of_solved(block[name]) for name in ("L", "rho") if name in block}
    if {*schema.stiffness_fields(ds)} <= {*block}:
        rod["A"] = of_solved(quantity_variables.bending_stiffness(str(ds.attrs["stiffness"]), block))
    columns = {name: of_solved(block[name]) for name in names}
    counted = [name for name in names if name in bounds.COUNTED or quantity_variables.is_count(ds[name])]
    for name, why, bad in bounds.unfit(columns, counted, rod):
        if bad.any():
            got = f", got {columns[name][bad][0]:g}" if columns[name].ndim == 1 else ""
            yield f": {name} of a solved case {why}{got}"


STUDY = (kinds, study_texts, texts, layout, axes, fields, cases)
