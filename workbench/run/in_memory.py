"""Run a study in memory."""

import numpy as np
import xarray as xr

from solver import InputError, solve
from solver.follow import EndAngleBranch, to_fold
from studies import Study
from studies.grammar.axes import Dimensions, is_angle, quantity_of

from ..stored import quantity_variables
from ..stored.boxes import Columns
from ..stored.empty_dataset import without_results
from . import dataset_assembly
from .block import block_of, columns
from .plan import bytes_a_case, plan, rounds
from .shards import join

MOST_IN_MEMORY = 2_000_000_000


def run(study: Study) -> xr.Dataset:
    """Solve every case of a study and return the dataset.

    A case that fails has an outcome that says why and does not affect the others.

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
    return dataset_assembly.make_as_planned(so_far, join(parts))


def outline(study: Study) -> xr.Dataset:
    """A dataset of the study without any result, in which a case is chosen and solved as in a stored one.

    That of a study which follows an equilibrium is solved, as its values are found on the way.
    """
    return without_results(study) if not study.variation.from_base else run(study)


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
    data = quantity_variables.variables({"dbeta0": branch.dbeta0}, (quantity_variables.dimension(field),), units)
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
