"""Run a study that follows the equilibrium of a start problem over one field, up to its fold."""

import numpy as np
import xarray as xr

from solver import solve
from solver.end_angle_branch import EndAngleBranch, to_fold
from studies import Study
from studies.grammar.axes import is_angle, quantity_of
from studies.grammar.dimensions import Dimensions

from . import dataset, schema
from .block import columns


def run_followed(study: Study, tol: float, method: str) -> xr.Dataset:
    """The dataset of a followed study, over the axis from the base rod's own value to the fold or the limit.

    Besides what every study stores: `dbeta0` over the axis; `fold` and `fold_dbeta0`, where the equilibrium
    ceases to exist, NaN where the limit comes first; attribute `fold_note`, the same in words. Raises
    `InputError`.
    """
    axis, field = study.follow, study.followed
    assert axis is not None
    assert field is not None
    name = quantity_of(field).name
    branch = to_fold(study.case(), axis.limit, axis.size, name)
    sol = solve(branch.ends, tol=tol, method=method, stations=study.stations, seed=branch.dbeta0)
    as_run = study.model_copy(update={"tol": tol, "method": sol.method})
    ds = dataset.make(as_run, Dimensions.of({field: branch.values}), columns(study, sol), case=branch.ends)
    units = study.unit_system
    data = {"dbeta0": xr.Variable((schema.dimension(field),), branch.dbeta0, schema.labels("dbeta0", units))}
    for key, row, value in (("fold", name, branch.fold), ("fold_dbeta0", "dbeta0", branch.fold_dbeta0)):
        labels = schema.labels(row, units)
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
