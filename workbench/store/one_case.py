"""The one case that a user means, of a study or of a stored file, and its solution."""

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from solver import Ends, Solution
from solver.problem.errors import choices
from studies import Study, load
from studies.grammar.axes import FIELDS, WORDS, Which, in_words
from studies.language.case_input import CaseInput, from_values, with_fields

from . import file_kinds, in_memory, reading, schema, selection, stored_case
from .case_solutions import between, solve_one
from .plan import plan


def is_study(file: Path) -> bool:
    """Whether the path means a study, by its name or its TOML file, and not a stored dataset."""
    return file.suffix == ".toml" or not (file.exists() or file.is_symlink() or file.suffix)


def outline(study: Study) -> xr.Dataset:
    """A dataset of the study's dimensions without any result, in which a case is chosen as in a stored one."""
    over = study.dimensions()
    coords = {schema.dimension(dimension.name): dimension.coordinate.astype(float) for dimension in over.each}
    dims = tuple(coords)
    ds = xr.Dataset({"outcome": (dims, np.broadcast_to(np.array("", dtype=object), over.shape))}, coords)
    return ds.assign_attrs(laws=schema.laws_text(study), reading=study.reading or "", sampled=" ".join(study.sampled))


def place_of(study: Study, at: Mapping[str, selection.Value] | None = None) -> dict[str, float]:
    """The values of the fields that vary, of the case at these values; at: as of `selection.case`."""
    where = selection.case(outline(study), at)
    over = study.dimensions().each
    return {field: float(v[where[schema.dimension(dim.name)]]) for dim in over for field, v in dim.fields.items()}


def of_dataset(ds: xr.Dataset, at: Mapping[str, selection.Value] | None = None) -> Solution:
    """A case of a study's dataset, solved again as it was run; at: as of `selection.case`. Raises `InputError`."""
    case = ds.isel(selection.case(ds, at))
    return stored_case.solve_at(case, stored_case.study_of(case), {})


def of_study(study: Study, at: Mapping[str, selection.Value] | None = None) -> Solution:
    """A case of a study that is not stored. Raises `InputError`.

    Only this case is solved; along a followed axis also those from which it continues.
    """
    if study.follow is not None:
        return of_dataset(in_memory.run(study), at)
    values = place_of(study, at)
    case = study.case_of(values)
    if not study.sweeps:
        return solve_one(case, study.equilibrium, study.tol, study.method, study.stations)
    work = plan(study)
    return between(work.study, case, partial(work.spine.nearest, values), study.stations)


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
    place = {} if study.follow is not None else place_of(study, at)
    changed = f", except {choices(values)}" if values else ""
    case = study.case() if study.follow is not None else study.case_of(place)
    source = f"{named or study.title}{changed}"
    which = study.equilibrium
    return CaseInput(with_fields(case, values), study.unit_system, source, study=study, which=which, place=place)


def open_case(file: Path, values: Mapping[str, Any]) -> CaseInput:
    """The case of any study or stored file: of several the one at which the laws or Table 1 put it, named in `source`.

    values: fields that replace those of the case. Raises `InputError` for a file that holds neither the cases of a
    study nor equilibria.
    """
    if is_study(file):
        study = load(str(file))
        return case_at(study, {}, values, _part(file.name, study))
    with reading.raw(file) as ds:
        kind = file_kinds.kind_of(ds)
        if kind is not file_kinds.STUDY and not kind.scene:
            raise file_kinds.other_kind(file, kind, "explore opens studies, equilibria and closed rods")
        if kind is file_kinds.STUDY or "betaL" not in ds.variables:
            study = stored_case.study_of(ds)
            first = "" if kind is file_kinds.STUDY else f"{file.name}, the first of {ds.sizes['equilibrium']}"
            return case_at(study, {}, values, first or _part(file.name, study))
        return _first_equilibrium(ds, file.name, values)


def _part(name: str, study: Study) -> str:
    """What of a study is taken: ``fig7_1_modulus, the case at E = 10910, one of 9``."""
    if study.follow is not None:
        return f"{name}, the case from which {study.followed} is followed"
    place = ", ".join(in_words(field, value) for field, value in place_of(study).items())
    return f"{name}, the case at {place}, one of {study.size}" if place else name


def _first_equilibrium(ds: xr.Dataset, name: str, values: Mapping[str, Any]) -> CaseInput:
    """The first equilibrium of a stored list, that of the lowest energy, with its own case."""
    numbers = {field: float(ds[field]) for field in FIELDS if field in ds.variables and not ds[field].ndim}
    given = [field for field in WORDS if field in ds.attrs and not (field == "stiffness" and "EI" in numbers)]
    words = {field: str(ds.attrs[field]) for field in given}
    case, _ = from_values(numbers | words, Ends)
    which = Which(index=None, dbeta0=float(ds["dbeta0"][0]), energy=float(ds["energy"][0]))
    units = {kind: str(ds.attrs[f"{kind}_unit"]) for kind in ("length", "force")}
    source = f"{name}, the equilibrium of the lowest energy, one of {ds.sizes['equilibrium']}"
    if values:
        return CaseInput(with_fields(case, values), units, f"{source}, except {choices(values)}")
    return CaseInput(case, units, source, which=which)
