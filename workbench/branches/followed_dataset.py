"""A followed branch as a dataset over its points."""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from solver import Branch, Case, InputError
from solver.follow import solutions_of
from solver.observe.observables import observe
from solver.problem.errors import no_such
from solver.problem.held_ends import held_of
from studies.axes import quantity_of

from ..data import schema
from .equilibria_dataset import DEAD_LOADS

ALONG = ("beta", "alpha", "z", "contact")
EACH = ("energy", "height", "wraps", "turns", "amplitude", "kappa_max", "push_min", "push_max")
WORDS = {"length": "length", "force": "force"}
POINT = "point"


def dataset_of(branch: Branch, stations: int, units: Mapping[str, str]) -> xr.Dataset:
    """The branch over (point) and (point, u); see `Branch.to_dataset`."""
    for name in units:
        if name not in WORDS:
            raise no_such("unit", name, WORDS)
    if stations < 2:
        raise InputError(f"stations must be at least 2, got {stations}")
    units, sol, name = {**WORDS, **units}, solutions_of(branch, stations), branch.field
    dims = (POINT,)
    found: dict[str, Any] = observe(sol, EACH) | {"dbeta0": sol.dbeta[:, 0], "index": branch.index}
    data: dict[str, Any] = {
        key: xr.Variable(dims, value, schema.labels(key, units)) for key, value in found.items() if key != name
    }
    for key in ALONG:
        data[key] = xr.Variable((POINT, "u"), getattr(sol, key), schema.labels(key, units))
    for key in ("FZ", "MZ", "M3"):
        if key != name:
            data[key] = xr.Variable(dims, getattr(sol, key), schema.labels(key, units))
    data["rho"] = xr.Variable(dims, np.broadcast_to(sol.case.rho, sol.case.shape), schema.labels("rho", units))
    kinds = np.full(len(branch), "", dtype=object)
    kinds[[one.position for one in branch.special]] = [one.kind for one in branch.special]
    data["special"] = xr.Variable(dims, kinds.astype(str), {"long_name": "kind of special point, empty for none"})
    data["solved"] = xr.Variable(dims, np.asarray(sol.solved, dtype=bool))
    data["outcome"] = xr.Variable(dims, np.asarray(sol.outcome).astype(str))
    coords = {
        POINT: xr.Variable(dims, np.arange(len(branch)), {"long_name": "number of the point along the branch"}),
        name: xr.Variable(dims, branch.values, schema.labels(quantity_of(name).name, units)),
        "u": xr.Variable(("u",), np.linspace(0, 1, stations), schema.labels("u", units)),
        "s": xr.Variable((POINT, "u"), sol.s, schema.labels("s", units)),
    }
    return xr.Dataset(data, coords, _attributes(branch))


def stability(case: Case) -> str:
    """Under which ends the Morse index is meant."""
    held = held_of(case)
    if not held:
        return DEAD_LOADS
    return f"{', '.join(held)} held; what is not held is given: the other end angles, and dead loads"


def _attributes(branch: Branch) -> dict[str, Any]:
    special = [
        {"kind": one.kind, "value": one.value, "before": one.before, "after": one.after, "position": one.position}
        for one in branch.special
    ]
    return {
        "title": f"A branch of equilibria over {quantity_of(branch.field).symbol}", "field": branch.field,
        "begin": f"{branch.begin.reason} at {branch.field} = {branch.begin.value:.10g}",
        "end": f"{branch.end.reason} at {branch.field} = {branch.end.value:.10g}",
        "begin_kind": branch.begin.kind, "end_kind": branch.end.kind,
        "special_points": json.dumps(special), "start": branch.start,
        "stability": stability(branch.points[0].case),
    }  # fmt: skip
