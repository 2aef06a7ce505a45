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
from .boxes import pieces
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
KINDS = {**dict.fromkeys((*TEXTS, "xyz"), ("text", "OUST")), "solved": ("booleans", "b")}
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
    if file_kinds.kind_of(ds) is not file_kinds.STUDY:
        return check(ds, path, of_any(ds))
    check_kind(ds, path)
    return check(ds, path, [*STUDY, curves])


def of_any(ds: xr.Dataset) -> Sequence[Check]:
    """The checks of what datasets of all kinds have."""
    return (words, fields, cases, curves) if "solved" in ds else (words, fields, drawable)


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
    dims_of = dict.fromkeys(("solved", "caution", *JUDGED), axes)
    dims_of |= {name: [*axes, "u", *INNER.get(CURVES[name], ())] for name in CURVES}
    for name in ("solved", "caution", *JUDGED):
        if name not in ds.variables:
            yield f" has no {name} for each of its cases"
    for name, variable in {str(name): variable for name, variable in ds.variables.items()}.items():
        kind, allowed = KINDS.get(name, ("numbers", "iuf"))
        if variable.dtype.kind not in ("iu" if name == SAMPLE else "f" if name in axes else allowed):
            yield f": {show(name)} must hold {kind}, got {variable.dtype}"
        dims, known = [*map(str, variable.dims)], dims_of.get(name, [*axes, "u", *sum(INNER.values(), ())])
        if dims != (known if name in dims_of else [dim for dim in known if dim in dims]):
            yield f": {show(name)} has the dimensions {show(dims)}, which do not fit the axes"
        row, unit = QUANTITIES.get(CURVES.get(name, name)), variable.attrs.get("units")
        if row is None or row.dimension == "text" or unit is None or "expression" in variable.attrs:
            continue
        if unit != unit_of(row.name, units):
            yield f": {name} is in {show(unit)}, but in the units of the file it is in {unit_of(row.name, units)}"


def axes(ds: xr.Dataset) -> Iterator[str]:
    """Whether each axis has different numbers that are not too large, as each sampled field has finite ones."""
    for name in schema.axes_of(ds):
        if name not in ds.coords:
            yield f": the axis {show(name)} has no values"
        if why := bounds.wrong_axis(ds.variables[name].values):
            yield f": the axis {show(name)} {why}"
    fields = schema.fields_of_samples(ds)
    if bool(fields) != (SAMPLE in schema.axes_of(ds)):
        yield f": the attribute sampled and the dimension {SAMPLE} belong together: one is missing"
    for field in fields:
        name = quantity_variables.dimension(field) if field in FIELDS else field
        if name not in ds.coords or ds[name].dims != (SAMPLE,) or not np.isfinite(ds[name].values).all():
            yield f": the sampled field {show(field)} has no values, or some that are not finite"
    if refined.REFINED in ds.attrs:
        refined.describe(ds)


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
    (("s", "u", "L"), "s must be u L", lambda s, u, L: abs(s - u * L) <= bounds.SAME * L),
)


def fields(ds: xr.Dataset) -> Iterator[str]:
    """Whether rod, cylinder and stations are finite, positive, in order and consistent."""
    number = {name: ds.variables[name] for name in (*bounds.FIELDS, "u", "s") if name in ds.variables}
    for name, variable in number.items():
        if variable.dtype.kind != "f":
            yield f": {name} must be a floating-point number, got {variable.dtype}"
        if name in bounds.FIELDS and (why := bounds.wrong_field(name, variable.values)):
            yield f": {name} {why}"
    word = ds.attrs.get("stiffness")
    allowed = DIRECT if word == GIVEN else (*ELASTIC, *(["inner_radius"] if word == "solid" else []))
    for name in (name for name in SECTION if name in number and name not in allowed):
        yield f": the attribute stiffness is {show(word)}, which excludes {name}"
    if ds.attrs.get("side") in SIDES:
        number["side"] = xr.Variable((), SIDES[ds.attrs["side"]])
    for needed, wrong, holds in TOGETHER:
        with np.errstate(all="ignore"):  # of infinite numbers a rule has no value, and does not hold
            if {*needed} <= {*number} and not np.all(holds(*(number[name] for name in needed)).values):
                yield f": {wrong}"


def drawable(ds: xr.Dataset) -> Iterator[str]:
    """Whether no number but an error or a condition number is so large that the ticks of an axis overflow."""
    for name, variable in ds.variables.items():
        values = variable.values
        if (
            name not in JUDGED
            and variable.dtype.kind == "f"
            and (np.isfinite(values) & (np.abs(values.astype(float)) > bounds.MOST_DRAWN)).any()
        ):
            yield f": {show(name)} holds numbers beyond {bounds.MOST_DRAWN:g}"


def cases(ds: xr.Dataset) -> Iterator[str]:
    """Whether the errors, loads and observables of each solved case can be, block by block."""
    variables, dims = ds.variables, ds.variables["solved"].dims
    each = [str(name) for name in ds.data_vars if variables[name].dims == dims and variables[name].dtype.kind in "iuf"]
    numbers = [*dict.fromkeys([*each, *(name for name in LOADS if name in variables)])]
    for block in pieces(variables, [*numbers, *schema.stiffness_fields(ds), "rho", "L"]):
        yield from _numbers(ds, block, numbers)


def curves(ds: xr.Dataset) -> Iterator[str]:
    """Whether the curves of solved cases are finite, and z no longer than the rod."""
    keys = [key for key in CURVES if key in ds.data_vars and "u" in ds.variables[key].dims]
    for block in pieces(ds.variables, [*keys, "L"], max(1, BLOCK_ALONG // ds.sizes.get("u", 1))):
        yield from _numbers(ds, block, keys)


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


STUDY = (words, layout, axes, fields, cases)
