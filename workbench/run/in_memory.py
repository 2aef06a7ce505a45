"""Run a study in memory."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np
import xarray as xr

from solver import InputError, solve
from solver.follow import EndAngleBranch, to_fold
from studies import Study
from studies.grammar.axes import Dimensions, is_angle, quantity_of
from studies.laws.law_verdict import LawVerdicts

from ..stored import quantity_variables
from ..stored.boxes import Columns
from ..stored.empty_dataset import without_results
from ..stored.stored_study import StoredStudy
from ..words import outcome_counts
from . import dataset_assembly
from .block import block_of, columns
from .plan import bytes_a_case, plan, remarks, rounds
from .shards import join

MOST_IN_MEMORY = 2_000_000_000


@dataclass(frozen=True, eq=False)
class StudyResult:
    """A study that was run: its dataset, the verdicts on its laws, and its files.

    path: the stored file. pictures: name -> file. caption: the sentences of the diagram.
    """

    study: Study
    ds: xr.Dataset
    verdicts: LawVerdicts
    path: Path | None = None
    pictures: dict[str, Path] = field(default_factory=dict)
    caption: Sequence[str] = ()

    @cached_property
    def stored(self) -> StoredStudy:
        """The dataset, as figures, scenes and pages take it."""
        return StoredStudy(self.ds)


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
        For an invalid study, and for one that needs too much memory; `run_to_file` stores such a study as
        it is solved.

    Examples
    --------
    >>> from studies import load
    >>> from workbench.run import in_memory
    >>> ds = in_memory.run(load("fig7_1_modulus"))
    >>> ds["bends"].values
    array([8, 7, 6, 6, 6, 5, 5, 5, 5])
    """
    if given := {name: value for name, value in (("tol", tol), ("method", method)) if value is not None}:
        study = study.with_values(**given)
    if study.variation.from_base:
        return run_followed(study)
    work = plan(study)
    if (needed := work.size * bytes_a_case(study)) > MOST_IN_MEMORY:
        raise InputError(
            f"{work.size} cases take {needed / 1e9:.3g} GB in memory, more than the limit of {MOST_IN_MEMORY / 1e9:g} "
            "GB; workbench run stores them as they are solved"
        )
    parts: list[Columns] = []
    for so_far, start, stop in rounds(work, lambda *_: parts[-1]):
        if start < stop:
            blocks = so_far.chunk(start, stop).blocks(so_far.block)
            parts.append(join([block_of(so_far.study, part) for part in blocks]))
    columns = join(parts)
    if study.sweeps:
        columns["branch"] = outcome_counts.number_branches(columns["branch"], columns["branch"])
    return dataset_assembly.make(so_far.study, so_far.dimensions, columns, remarks(so_far))


def outline(study: Study) -> xr.Dataset:
    """A dataset of the study without any result, in which a case is chosen and solved as in a stored one.

    That of a study which follows an equilibrium is solved, as its values are found on the way.
    """
    return without_results(study) if not study.variation.from_base else run(study)


def result(study: Study, ds: xr.Dataset, path: Path | None = None) -> StudyResult:
    """A dataset with the verdicts of its laws."""
    return StudyResult(study, ds, StoredStudy(ds).verdicts, path)


def run_followed(study: Study) -> xr.Dataset:
    """The dataset of a followed study, over the axis from the base rod's own value to the fold or the limit.

    Besides what every study stores: `dbeta0` over the axis; `fold` and `fold_dbeta0`, where the equilibrium
    ceases to exist, NaN where the limit comes first; attribute `fold_note`, the same in words. Raises
    `InputError`.
    """
    field = study.variation.followed
    assert field is not None
    axis, name = study.axes[field], quantity_of(field).name
    branch = to_fold(study.case(), axis.limit, axis.size, name)
    sol = solve(branch.ends, tol=study.tol, method=study.method, stations=study.stations, seed=branch.dbeta0)
    as_run = study.model_copy(update={"method": sol.method})
    ds = dataset_assembly.make(as_run, Dimensions.of({field: branch.values}), columns(study, sol), case=branch.ends)
    units = study.unit_system
    data = {
        "dbeta0": xr.Variable(
            (quantity_variables.dimension(field),), branch.dbeta0, quantity_variables.labels("dbeta0", units)
        )
    }
    for key, row, value in (("fold", name, branch.fold), ("fold_dbeta0", "dbeta0", branch.fold_dbeta0)):
        labels = quantity_variables.labels(row, units)
        labels["long_name"] += " where the equilibrium ceases to exist"
        data[key] = xr.Variable((), np.nan if value is None else value, labels)
    return ds.assign(data).assign_attrs(fold_note=_note(study, branch, axis.limit))


def _note(study: Study, branch: EndAngleBranch, limit: float) -> str:
    units = study.units
    name = "beta(L)" if branch.field == "betaL" else branch.field
    angle = is_angle(branch.field)
    if branch.fold is None or branch.fold_dbeta0 is None:
        last = f"{np.rad2deg(limit):.4g} deg" if angle else f"{limit:.6g}"
        return f"the equilibrium is followed to {name} = {last} and has no fold before it"
    at = f"{name} = {branch.fold:.6g}" + (f" rad ({np.rad2deg(branch.fold):.4g} deg)" if angle else "")
    return f"the equilibrium ceases to exist at {at}, where beta'(0) = {branch.fold_dbeta0:.6g} rad/{units.length}"
