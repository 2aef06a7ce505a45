"""Run a study in memory."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import xarray as xr

from solver import InputError
from studies import Study

from ..words import branch_numbers
from . import dataset, law_verdicts, refined
from .block import block_of, join
from .plan import Plan, bytes_a_case, first_of, plan
from .rounds import Rounds
from .schema import Columns

MOST_IN_MEMORY = 2_000_000_000


@dataclass(frozen=True, eq=False)
class StudyResult:
    """A study that was run: its dataset, the verdicts on its laws, and its files.

    verdicts: rows of `law_verdicts.verdicts`. path: the stored file. pictures: name -> file.
    """

    study: Study
    ds: xr.Dataset
    verdicts: list[dict[str, Any]]
    path: Path | None = None
    pictures: dict[str, Path] = field(default_factory=dict)


def run(study: Study, tol: float | None = None, method: str | None = None) -> xr.Dataset:
    """Solve every case of a study and return the dataset.

    A case that fails has an outcome that says why and does not affect the others.

    Parameters
    ----------
    study : Study
    tol : float, optional
        In place of the tolerance of the study.
    method : str, optional
        In place of the method of the study.

    Returns
    -------
    xr.Dataset
        One dimension for each axis, then u = s/L.

    Raises
    ------
    InputError
        For an invalid study, and for one that needs too much memory; `study_store.run_to_file` stores such a study as
        it is solved.

    Examples
    --------
    >>> from studies import load
    >>> from workbench.store import in_memory
    >>> ds = in_memory.run(load("fig7_1_modulus"))
    >>> ds["turns"].values
    array([8, 7, 6, 6, 6, 5, 5, 5, 5])
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
    if study.refine is not None:
        return _refine(work)
    found = _columns(work, 0)
    if work.study.sweeps:
        found["branch"] = branch_numbers.number(found["branch"], found["branch"])
    return dataset.make(work.study, work.dimensions, found, first_of(work))


def _columns(work: Plan, first: int) -> Columns:
    """The columns of the cases from `first` on."""
    return join([block_of(work.study, part) for part in work.chunk(first, work.size).blocks(work.block)])


def _refine(work: Plan) -> xr.Dataset:
    """The dataset of a refined study."""
    rounds, parts = Rounds(work.study), []
    for part, start, _ in rounds:
        parts.append(_columns(part, start))
        rounds.take(parts[-1])
    whole = rounds.plan()
    ds = dataset.make(whole.study, whole.dimensions, join(parts))
    return ds.assign_attrs(refined.attributes(whole.study, rounds.refinement))


def result(study: Study, ds: xr.Dataset, path: Path | None = None) -> StudyResult:
    """A dataset with the verdicts of its laws."""
    return StudyResult(study, ds, law_verdicts.verdicts(ds), path)
