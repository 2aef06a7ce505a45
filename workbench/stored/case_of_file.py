"""The one case that a user means, of any study or file."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from solver import Case, Ends, Solution
from solver.problem.declared_fields import FIELDS
from solver.problem.errors import choices
from studies import Study, load
from studies.grammar.axes import WORDS, Which, in_words
from studies.language.case_input import CaseInput, case_of_study, from_values, in_units, with_values

from . import file_kinds, quantity_variables, reading
from .chosen_cases import Value
from .empty_dataset import without_results
from .solved_again import solve_at, study_of
from .stored_study import StoredStudy


def is_study(file: Path) -> bool:
    """Whether the path means a study, by its name or its TOML file, and not a stored dataset."""
    return file.suffix.lower() == ".toml" or not (file.exists() or file.is_symlink() or file.suffix)


def place_of(study: Study, at: Mapping[str, Value] | None = None) -> dict[str, float]:
    """The values of the fields that vary, of the case at these values; at: as of `StoredStudy.place`."""
    cases = StoredStudy(without_results(study))
    place = cases.select(cases.place(at))
    return {field: float(place[quantity_variables.dimension(field)]) for field in study.variation.dimensions.fields}


def solve_case(stored: StoredStudy, at: Mapping[str, Value] | None = None, study: Study | None = None) -> Solution:
    """A case of a stored study, or of an outline, solved as it is run; along a followed axis after those before.

    at: as of `StoredStudy.place`. study: default: that of the file. Raises `InputError`.
    """
    case = stored.select(stored.place(at))
    return solve_at(case.ds, case.study if study is None else study, {})


def case_at(study: Study, at: Mapping[str, Any], values: Mapping[str, Any], named: str = "") -> CaseInput:
    """A case of a study, and in `place` where on its axes it was taken.

    Parameters
    ----------
    study
        Of one case or of several; of one that follows an equilibrium the base case is taken.
    at
        Values of axes; an axis that is not named stays where the laws or Table 1 put it.
    values
        Fields that replace those of the case.
    named
        What the case comes from, in words; default: the title of the study.

    Raises
    ------
    InputError
        For a value that is not on its axis, and for an unknown or invalid field.
    """
    place = {} if study.variation.from_base else place_of(study, at)
    return case_of_study(study, values, named or study.title, place)


def open_case(file: Path, values: Mapping[str, Any]) -> CaseInput:
    """The case of any study or stored file of rods, named in `source`.

    Of several cases of a study it is the one at which the laws or Table 1 put it, of a map or of branches over an axis
    the one in the middle, of several equilibria the first. values: fields that replace those of the case. Raises
    `InputError` for a file that holds no rods.
    """
    if is_study(file):
        study = load(str(file))
        return case_at(study, {}, values, _part(file.name, study))
    with reading.raw(file) as ds:
        kind = file_kinds.kind_of(ds)
        if kind in (file_kinds.STUDY, file_kinds.LOOPS):
            study = study_of(ds)
            first = "" if kind is file_kinds.STUDY else f"{file.name}, the first of {ds.sizes['equilibrium']}"
            return case_at(study, {}, values, first or _part(file.name, study))
        if "L" not in ds.variables:
            raise file_kinds.other_kind(file, kind, "explore opens files with all fields of a rod")
        return _equilibrium_of(ds, file.name, values)


def case_in(file: Path, at: Mapping[str, Value], values: Mapping[str, Any]) -> CaseInput:
    """A case of a study or of a stored study, as of `case_at`. Raises `InputError` for another file too."""
    if is_study(file):
        return case_at(load(str(file)), at, values)
    with reading.raw(file) as ds:
        return case_at(study_of(ds), at, values, file.name)


def _part(name: str, study: Study) -> str:
    """What of a study is taken: ``fig7_1_modulus, the case at E = 10910, one of 9``."""
    if study.variation.from_base:
        return f"{name}, the case from which {study.variation.followed} is followed"
    place = ", ".join(in_words(field, value) for field, value in place_of(study).items())
    return f"{name}, the case at {place}, one of {study.variation.size}" if place else name


def case_of_numbers(ds: xr.Dataset, numbers: Mapping[str, float]) -> Case:
    """The ends problem of these fields and of the words of a dataset. Raises `InputError`."""
    given = [field for field in WORDS if field in ds.attrs and not (field == "stiffness" and "EI" in numbers)]
    return from_values({**numbers, **{field: str(ds.attrs[field]) for field in given}}, Ends)[0]


def _equilibrium_of(ds: xr.Dataset, name: str, values: Mapping[str, Any]) -> CaseInput:
    """The first equilibrium of a list, or of those in the middle of branches or of a map, with its own case."""
    fields = [field for field in FIELDS if field in ds.variables and ds[field].dims in ((), (field,))]
    middle = {field: ds.sizes[field] // 2 for field in fields if ds[field].dims}
    rods = ds.isel(middle)
    numbers = {field: float(rods[field]) for field in fields}
    case = case_of_numbers(ds, numbers)
    places = [in_words(field, numbers[field]) for field in sorted(middle)]
    place = f", in the middle: {', '.join(places)}" if places else ""
    which = None
    if {"dbeta0", "energy"} <= set(rods):
        energies = np.atleast_1d(rods["energy"].values)
        first, count = int(np.nanargmin(energies)), int(np.isfinite(energies).sum())
        which = Which(index=None, dbeta0=float(np.atleast_1d(rods["dbeta0"].values)[first]), energy=energies[first])
        place += f", the equilibrium of the lowest energy, one of {count}" if count > 1 else ""
    units = {kind: str(ds.attrs[f"{kind}_unit"]) for kind in ("length", "force")}
    if values:
        taken = with_values(case, in_units(values, units), units)
        return CaseInput(taken, units, f"{name}{place}, except {choices(values)}")
    return CaseInput(case, units, f"{name}{place}", which=which)
