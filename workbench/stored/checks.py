"""Validate a dataset before it is used or stored: the layout and the numbers that the tables of the writer allow.

A file of the workbench that has changed since is refused by its checksums (`file_checks`). These checks are for the
others, which another program stored: they refuse what would be another number than it says, or none that can be. What
else a foreign file makes a command raise is a sentence of `cli`. Texts are not judged: the reader makes them printable.

A check yields what is wrong with a dataset, each a sentence without its beginning, the name of the file.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from solver.problem.case import SIDES
from solver.problem.declared_fields import FIELDS
from solver.problem.errors import InputError
from solver.problem.quantities import QUANTITIES, unit_of
from studies import names
from studies.grammar.axes import SAMPLE

from ..words.escaping import show
from . import bounds, file_kinds, quantity_variables, refined, schema
from .boxes import AT_ONCE, pieces
from .quantity_variables import CURVES, INNER, JUDGED, LOADS

MARKS = ("title", "study_name", "laws")  # texts that every study has, and no other file
OF_CASES = ("outcome", "solved", "caution", *JUDGED)  # variables that every study has
BLOCK_ALONG = 2**20  # stations of curves that are read at a time


def check(ds: xr.Dataset, path: str | Path, along: bool = True) -> None:
    """Raise `InputError`, a sentence that begins with the path, for the first thing that is wrong with a dataset.

    Where a check cannot be made, because something is missing or of another kind, that is what is wrong. along: whether
    arrays along the rod are read and judged too, block by block.
    """
    is_study = file_kinds.kind_of(ds) is file_kinds.STUDY
    if is_study:
        check_kind(ds, path)
    try:
        looks = (layout(ds), fields(ds)) if is_study else (fields(ds), drawable(ds))
        wrong = next((wrong for look in (*looks, numbers(ds, along)) for wrong in look), "")
    except InputError as error:
        wrong = f": {str(error).removeprefix(': ')}"
    except Exception as error:
        wrong = f" is not as the workbench stores it: {show(error)}"
    if wrong:
        raise InputError(f"{path}{wrong}")


def check_kind(ds: xr.Dataset, path: str | Path) -> None:
    """Raise `InputError` unless it is a study's dataset of this version's format; a study is cheap to solve again."""
    kind = file_kinds.kind_of(ds)
    if kind is not file_kinds.STUDY:
        raise file_kinds.other_kind(path, kind, f"this command reads {file_kinds.STUDY.what}")
    missing = [name for name in MARKS if name not in ds.attrs]
    if missing := missing or [name for name in OF_CASES if name not in ds.variables]:
        raise InputError(f"{path} is not a study's dataset: it has no {', '.join(missing)}")
    version = schema.number_of(ds, "format", path) if "format" in ds.attrs else 1
    if version != schema.FORMAT:
        study = str(ds.attrs["study_name"])
        again = f"; make it again with: workbench run {study if study in names() else 'STUDY'} --out {path}"
        other = f"{path} is of format {version:g}, but this version reads format {schema.FORMAT}"
        raise InputError(other + (again if version < schema.FORMAT else ""))


def layout(ds: xr.Dataset) -> Iterator[str]:
    """Whether axes and samples have their numbers, and each variable dimensions of cases and stations and its unit."""
    axes, units = schema.axes_of(ds), {kind: schema.text_of(ds, f"{kind}_unit") for kind in ("length", "force")}
    for name in axes:
        if why := bounds.wrong_axis(ds.coords[name].values) if name in ds.coords else "has no values":
            yield f": the axis {show(name)} {why}"
    for field in schema.fields_of_samples(ds):
        name = quantity_variables.dimension(field) if field in FIELDS else field
        if name not in ds.coords or ds[name].dims != (SAMPLE,) or not np.isfinite(ds[name].values).all():
            yield f": the sampled field {show(field)} has no values, or some that are not finite"
    if refined.REFINED in ds.attrs:
        refined.describe(ds)
    order = [*axes, "u", *sum(INNER.values(), ())]
    for name, variable in {str(name): variable for name, variable in ds.variables.items()}.items():
        dims = [*map(str, variable.dims)]
        if dims != [dim for dim in order if dim in dims]:
            yield f": {show(name)} has the dimensions {show(dims)}, which do not fit the axes"
        row, unit = QUANTITIES.get(CURVES.get(name, name)), variable.attrs.get("units")
        if row is None or row.dimension == "text" or "expression" in variable.attrs:
            continue
        if unit not in (None, unit_of(row.name, units)):
            yield f": {name} is in {show(unit)}, but in the units of the file it is in {unit_of(row.name, units)}"


def drawable(ds: xr.Dataset) -> Iterator[str]:
    """Whether no number but an error or a condition number is so large that the ticks of an axis overflow."""
    for name, variable in ds.variables.items():
        if variable.dtype.kind == "f" and name not in JUDGED:
            size = np.abs(variable.values.astype(float))
            if ((size > bounds.MOST_DRAWN) & (size < np.inf)).any():
                yield f": {show(name)} holds numbers beyond {bounds.MOST_DRAWN:g}"


def fields(ds: xr.Dataset) -> Iterator[str]:
    """Whether the fields of rod and cylinder are in their ranges and fit, and the stations rise from end to end."""
    number = {name: ds.variables[name] for name in (*bounds.FIELDS, "u", "s") if name in ds.variables}
    yield from (f": {name} {why}" for name, why in bounds.unfit_fields(number))
    side = ds.attrs.get("side")  # a file that is no study's may have none
    if side is not None and side not in SIDES:
        yield f": the side must be outside or inside, got {show(side)}"
        return
    if side is None or not {"R", "a", "rho"} <= {*number}:
        return
    if np.any(abs(number["rho"] - number["R"] - SIDES[side] * number["a"]) > bounds.SAME * number["R"]):
        yield ": rho must be R + a outside, and R - a inside"


def numbers(ds: xr.Dataset, along: bool) -> Iterator[str]:
    """Whether the numbers of each solved case can be (`bounds.unfit`), block by block; along: the curves too."""
    if "solved" not in ds:
        return
    solved = ds.variables["solved"].dims
    of_cases = [name for name, each in ds.data_vars.items() if each.dims == solved and each.dtype.kind in "iuf"]
    yield from _unfit(ds, [*dict.fromkeys([*of_cases, *(name for name in LOADS if name in ds.variables)])], AT_ONCE)
    if along:
        curves = [key for key in CURVES if key in ds.data_vars and "u" in ds.variables[key].dims]
        yield from _unfit(ds, curves, max(1, BLOCK_ALONG // ds.sizes.get("u", 1)))


def _unfit(ds: xr.Dataset, names: Sequence[Any], most: int) -> Iterator[str]:
    """What is wrong with these numbers of solved cases; most: cases that are read at a time."""
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


def _of_solved(variable: xr.Variable, solved: xr.Variable) -> Any:
    """The numbers of the solved cases, (cases, ...)."""
    inner = {dim: size for dim, size in variable.sizes.items() if dim not in solved.dims}
    over_cases = variable.set_dims({**solved.sizes, **inner}).transpose(*solved.dims, ...)
    return over_cases.values[solved.values]
