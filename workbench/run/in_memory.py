"""From a study to a dataset in memory."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import xarray as xr

from solver import InputError
from studies import Study

from ..data import branch_numbers, dataset, law_verdicts
from .block import block_of, joined
from .plan import bytes_a_case, first_of, plan

MOST_IN_MEMORY = 2_000_000_000


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
    """Solve every case of a study, in memory, and label the answer; tol and method, where given, replace the study's.

    A case that fails keeps its outcome and leaves its neighbours alone. Raises `InputError` for what cannot
    be asked, and for a study that is better stored as it is solved (`storing.run_to_file`).
    """
    if study.follow is not None:
        from .following import run_followed

        return run_followed(study, study.tol if tol is None else tol, study.method if method is None else method)
    work = plan(study, tol, method)
    if (needed := work.size * bytes_a_case(study)) > MOST_IN_MEMORY:
        raise InputError(
            f"{work.size} cases take {needed / 1e9:.3g} GB in memory, more than the limit of {MOST_IN_MEMORY / 1e9:g} "
            "GB; workbench run stores them as they are solved"
        )
    parts = [block_of(work.study, part) for part in work.chunk(0, work.size).blocks(work.block)]
    found = joined(parts)
    if work.study.sweeps:
        found["branch"] = branch_numbers.numbered(found["branch"], found["branch"])
    return dataset.make(work.study, work.coordinates, found, first_of(work))


def result(study: Study, ds: xr.Dataset, path: Path | None = None) -> StudyResult:
    """A dataset with the verdicts of its laws."""
    return StudyResult(study, ds, law_verdicts.verdicts(ds), path)
