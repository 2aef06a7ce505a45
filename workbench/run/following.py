"""Run a study that follows one equilibrium over the angle at its far end, up to its fold."""

import numpy as np
import xarray as xr

from solver import solve
from solver.end_angle_branch import to_fold
from studies import Study
from studies.dimensions import Dimensions

from ..data import dataset, schema
from .block import columns

AXIS = "betaL"


def run_followed(study: Study, tol: float, method: str) -> xr.Dataset:
    """The dataset of a followed study, over betaL [rad] from the base rod's own value to the fold or the limit.

    Besides what every study stores: `dbeta0` over betaL; `fold` and `fold_dbeta0`, where the equilibrium
    ceases to exist, NaN where the limit comes first; attribute `fold_note`, the same in words. Raises
    `InputError`.
    """
    axis = study.follow
    assert axis is not None
    branch = to_fold(study.case(), axis.limit, axis.size)
    sol = solve(branch.ends, tol=tol, method=method, stations=study.stations, seed=branch.dbeta0)
    as_run = study.model_copy(update={"tol": tol, "method": sol.method})
    ds = dataset.make(as_run, Dimensions.of({AXIS: branch.betaL}), columns(study, sol))
    units = study.unit_system
    ds["dbeta0"] = xr.Variable((AXIS,), branch.dbeta0, schema.labels("dbeta0", units))
    for name, row, value in (("fold", "betaL", branch.fold), ("fold_dbeta0", "dbeta0", branch.fold_dbeta0)):
        labels = schema.labels(row, units)
        labels["long_name"] += " where the equilibrium ceases to exist"
        ds[name] = xr.Variable((), np.nan if value is None else value, labels)
    ds.attrs["fold_note"] = _note(branch.fold, branch.fold_dbeta0, axis.limit, study.units.length)
    return ds


def _note(fold: float | None, dbeta0: float | None, limit: float, length: str) -> str:
    if fold is None or dbeta0 is None:
        return f"the equilibrium is followed to beta(L) = {np.rad2deg(limit):.4g} deg and has no fold before it"
    at = f"beta(L) = {fold:.6g} rad ({np.rad2deg(fold):.4g} deg)"
    return f"the equilibrium ceases to exist at {at}, where beta'(0) = {dbeta0:.6g} rad/{length}"
