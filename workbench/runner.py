"""From a study to a dataset: the whole grid is one case, solved in one call."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import xarray as xr

from solver import Case, Solution, equilibria, solve
from solver.equilibria import nearest
from studies import Study
from studies.axes import Which

from . import check, dataset


@dataclass(frozen=True, eq=False)
class StudyResult:
    """A study that was run: its dataset, its laws' verdicts, and where things are.

    verdicts: rows of `check.verdicts`. path: the stored file. pictures: name -> file.
    """

    study: Study
    ds: xr.Dataset
    verdicts: list[dict[str, Any]]
    path: Path | None = None
    pictures: dict[str, Path] = field(default_factory=dict)


def run(study: Study, tol: float | None = None, method: str | None = None) -> xr.Dataset:
    """Solve every case of a study and label the answer; tol and method, where given, replace the study's.

    A case that fails keeps its outcome and leaves its neighbours alone. Raises `InputError` for what cannot
    be asked.
    """
    tol = study.tol if tol is None else tol
    method = study.method if method is None else method
    if study.follow is not None:
        from .following import run_followed

        return run_followed(study, tol, method)
    sol = solve_one(study.case(), study.equilibrium, tol, method, study.stations)
    return dataset.make(study, study.coordinates(), sol)


def solve_one(case: Case, which: Which | None, tol: float, method: str, stations: int) -> Solution:
    """The solution of a case, or of a grid; where a study says which equilibrium, that one. Raises `InputError`."""
    if which is None:
        return solve(case, tol=tol, method=method, stations=stations)
    found = nearest(equilibria(case, tol, stations), which.dbeta0, which.energy).solution
    return found if method in ("auto", found.method) else solve(case, tol, method, stations, seed=found)


def result(study: Study, ds: xr.Dataset, path: Path | None = None) -> StudyResult:
    """A dataset with the verdicts of its laws."""
    return StudyResult(study, ds, check.verdicts(ds), path)
