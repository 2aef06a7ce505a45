"""Validate a dataset before it is used or stored: the layout and the numbers that the tables of the writer allow.

A check yields what is wrong with a dataset, each a sentence without its beginning, the name of the file. Checks change
nothing. Those of `STUDY` are asked for every study; they read no array along the rod. `curves` does, block by block: of
a dataset that is read whole, for its summary and for its check. Texts are not judged: the reader makes them printable.
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

from ..words.escaping import show
from . import bounds, file_kinds, quantity_variables, refined, schema
from .boxes import AT_ONCE, pieces
from .quantity_variables import CURVES, INNER, JUDGED, LOADS, SECTION
from .schema import FORMAT, TEXTS

Check = Callable[[xr.Dataset], Iterator[str]]

MARKS = ("title", "study_name", "laws")  # texts that every study has, and no other file
WORDS: Mapping[str, Any] = {
    **CHOICES,
    "stiffness": quantity_variables.SECTIONS,
    "length_unit": LENGTHS,
    "force_unit": FORCES,
}
# What the values of a variable are, and their kinds in NumPy; of all others numbers.
KINDS = {
    **dict.fromkeys((*TEXTS, "xyz"), ("text", "OUST")),
    **dict.fromkeys((*bounds.FIELDS, "u", "s"), ("floating-point numbers", "f")),
    "solved": ("booleans", "b"),
    SAMPLE: ("numbers", "iu"),
}
BLOCK_ALONG = 2**20  # stations of curves that are read at a time


def check(ds: xr.Dataset, path: str | Path, checks: Sequence[Check]) -> None:
    """Raise `InputError`, a sentence that begins with the path, for the first thing that is wrong with a dataset.

    Where a check cannot be made, because something is missing or of another kind, that is what is wrong.
    """
    try:
        wrong = next((wrong for look in checks for wrong in look(ds)), "")
    except InputError as error:
        wrong = f": {str(error).removeprefix(': ')}"
    except Exception as error:
        wrong = f" is not as the workbench stores it: {show(error)}"
    if wrong:
        raise InputError(f"{path}{wrong}")


def check_all(ds: xr.Dataset, path: str | Path) -> None:
    """Raise `InputError` where anything is wrong with a dataset, of whichever kind."""
    is_study = file_kinds.kind_of(ds) is file_kinds.STUDY
    if is_study:
        check_kind(ds, path)
    of_kind = STUDY if is_study else (words, fields, drawable, *([cases] if "solved" in ds else []))
    check(ds, path, [*of_kind, *([curves] if "solved" in ds else [])])


def check_kind(ds: xr.Dataset, path: str | Path) -> None:
    """Raise `InputError` unless it is a study's dataset of this version's format; a study is cheap to solve again."""
    kind = file_kinds.kind_of(ds)
    if kind is not file_kinds.STUDY:
        raise file_kinds.other_kind(path, kind, f"this command reads {file_kinds.STUDY.what}")
    missing = [name for name in MARKS if name not in ds.attrs]
    if missing or "outcome" not in ds:
        raise InputError(f"{path} is not a study's dataset: it has no {', '.join(missing) or 'outcome'}")
    version = schema.number_of(ds, "format", path) if "format" in ds.attrs else 1
    if version != FORMAT:
        study = str(ds.attrs["study_name"])
        again = f"; make it again with: workbench run {study if study in names() else 'STUDY'} --out {path}"
        other = f"{path} is of format {version:g}, but this version reads format {FORMAT}"
        raise InputError(other + (again if version < FORMAT else ""))


def words(ds: xr.Dataset) -> Iterator[str]:
    """Whether the words of rod, cylinder and units are known."""
    for key in (key for key in WORDS if key in ds.attrs):
        if not isinstance(value := ds.attrs[key], str) or value not in WORDS[key]:
            yield f": the attribute {key} is {show(value)}; it can be {choices(WORDS[key])}"


def layout(ds: xr.Dataset) -> Iterator[str]:
    """Whether each variable has the kind of values, the dimensions and the unit that it is known for."""
    axes, units = schema.axes_of(ds), {kind: ds.attrs[f"{kind}_unit"] for kind in ("length", "force")}
    of_cases = ("solved", "caution", *JUDGED)
    yield from (f" has no {name} for each of its cases" for name in of_cases if name not in ds.variables)
    fixed = dict.fromkeys(of_cases, axes) | {key: [*axes, "u", *INNER.get(CURVES[key], ())] for key in CURVES}
    free = [*axes, "u", *sum(INNER.values(), ())]  # the order of the dimensions of any other variable
    for name, variable in {str(name): variable for name, variable in ds.variables.items()}.items():
        kind, allowed = KINDS.get(name, ("numbers", "f" if name in axes else "iuf"))
        if variable.dtype.kind not in allowed:
            yield f": {show(name)} must hold {kind}, got {variable.dtype}"
        dims = [*map(str, variable.dims)]
        if dims != fixed.get(name, [dim for dim in free if dim in dims]):
            yield f": {show(name)} has the dimensions {show(dims)}, which do not fit the axes"
        row, unit = QUANTITIES.get(CURVES.get(name, name)), variable.attrs.get("units")
        if row is None or row.dimension == "text" or "expression" in variable.attrs:
            continue
        if unit not in (None, unit_of(row.name, units)):
            yield f": {name} is in {show(unit)}, but in the units of the file it is in {unit_of(row.name, units)}"


def axes(ds: xr.Dataset) -> Iterator[str]:
    """Whether each axis has different numbers that are not too large, as each sampled field has finite ones."""
    names, fields = schema.axes_of(ds), schema.fields_of_samples(ds)
    if bool(fields) != (SAMPLE in names):
        yield f": the attribute sampled and the dimension {SAMPLE} belong together: one is missing"
    for name in names:
        if why := bounds.wrong_axis(ds.coords[name].values) if name in ds.coords else "has no values":
            yield f": the axis {show(name)} {why}"
    for field in fields:
        name = quantity_variables.dimension(field) if field in FIELDS else field
        if name not in ds.coords or ds[name].dims != (SAMPLE,) or not np.isfinite(ds[name].values).all():
            yield f": the sampled field {show(field)} has no values, or some that are not finite"
    if refined.REFINED in ds.attrs:
        refined.describe(ds)


def fields(ds: xr.Dataset) -> Iterator[str]:
    """Whether rod, cylinder and stations are finite, positive, in order and consistent."""
    number = {name: ds.variables[name] for name in (*bounds.FIELDS, "u", "s") if name in ds.variables}
    word = ds.attrs.get("stiffness")
    allowed = DIRECT if word == GIVEN else (*ELASTIC, *(["inner_radius"] if word == "solid" else []))
    for name in (name for name in SECTION if name in number and name not in allowed):
        yield f": the attribute stiffness is {show(word)}, which excludes {name}"
    if ds.attrs.get("side") in SIDES:
        number["side"] = xr.Variable((), SIDES[ds.attrs["side"]])
    yield from (f": {name} {why}" for name, why in bounds.unfit_fields(number))


def drawable(ds: xr.Dataset) -> Iterator[str]:
    """Whether no number but an error or a condition number is so large that the ticks of an axis overflow."""
    for name, variable in ds.variables.items():
        if variable.dtype.kind == "f" and name not in JUDGED:
            size = np.abs(variable.values.astype(float))
            if ((size > bounds.MOST_DRAWN) & (size < np.inf)).any():
                yield f": {show(name)} holds numbers beyond {bounds.MOST_DRAWN:g}"


def cases(ds: xr.Dataset) -> Iterator[str]:
    """Whether the errors, loads and observables of each solved case can be, block by block."""
    variables, dims = ds.variables, ds.variables["solved"].dims
    each = [str(name) for name in ds.data_vars if variables[name].dims == dims and variables[name].dtype.kind in "iuf"]
    yield from _numbers(ds, [*dict.fromkeys([*each, *(name for name in LOADS if name in variables)])], AT_ONCE)


def curves(ds: xr.Dataset) -> Iterator[str]:
    """Whether the curves of solved cases are finite, and z no longer than the rod."""
    keys = [key for key in CURVES if key in ds.data_vars and "u" in ds.variables[key].dims]
    yield from _numbers(ds, keys, max(1, BLOCK_ALONG // ds.sizes.get("u", 1)))


def _numbers(ds: xr.Dataset, names: Sequence[str], most: int) -> Iterator[str]:
    """Whether these numbers of solved cases can be (`bounds.unfit`); most: cases that are read at a time."""
    counted = [name for name in names if name in bounds.COUNTED or quantity_variables.is_count(ds[name])]
    section = schema.stiffness_fields(ds)
    for block in pieces(ds.variables, [*names, *section, "rho", "L"], most):
        rod: dict[str, xr.Variable] = {name: block[name] for name in ("L", "rho") if name in block}
        if {*section} <= {*block}:
            rod["A"] = quantity_variables.bending_stiffness(str(ds.attrs["stiffness"]), block)
        columns, of_rod = (
            {name: _of_solved(variable, block["solved"]) for name, variable in row.items()}
            for row in ({name: block[name] for name in names}, rod)
        )
        for name, why, bad in bounds.unfit(columns, counted, of_rod):
            if bad.any():
                got = f", got {columns[name][bad][0]:g}" if columns[name].ndim == 1 else ""
                yield f": {name} of a solved case {why}{got}"


def _of_solved(variable: xr.Variable, solved: xr.Variable) -> NDArray[Any]:
    """The numbers of the solved cases, (cases, ...)."""
    inner = {dim: size for dim, size in variable.sizes.items() if dim not in solved.dims}
    over_cases = variable.set_dims({**solved.sizes, **inner}).transpose(*solved.dims, ...)
    return np.asarray(over_cases.values[solved.values])


STUDY = (words, layout, axes, fields, cases)
