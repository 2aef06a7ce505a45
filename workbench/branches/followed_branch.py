"""One followed branch of equilibria as a dataset, point by point."""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from solver import Branch
from solver.equilibria import MOST_LISTED
from solver.follow import solutions_of
from solver.problem.errors import whole_number
from studies.grammar.axes import quantity_of

from ..stored import quantity_variables
from .equilibria_dataset import ALONG, all_units, numbers_of, of_solution, stability

POINT_NUMBERS = ("energy", "height", "turns_around", "bends", "amplitude", "kappa_max", "push_min", "push_max")
POINT = "point"


def as_dataset(branch: Branch, stations: int, units: Mapping[str, str]) -> xr.Dataset:
    """The branch over (point) and (point, u); see `Branch.to_dataset`."""
    stations = whole_number("stations", stations, 2, MOST_LISTED)
    units, sol, name = all_units(units), solutions_of(branch, stations), branch.field
    numbers = numbers_of(sol, (*POINT_NUMBERS, "dbeta0")) | {"index": branch.index}
    numbers |= numbers_of(sol, quantity_variables.LOADS) | {"rho": np.broadcast_to(sol.case.rho, sol.case.shape)}
    ds = of_solution(sol, (POINT,), np.linspace(0, 1, stations), ALONG, units)
    ds = ds.assign(quantity_variables.variables({k: v for k, v in numbers.items() if k != name}, (POINT,), units))
    kinds = np.full(len(branch), "", dtype=object)
    kinds[[point.position for point in branch.special]] = [point.kind for point in branch.special]
    ds["special"] = POINT, kinds.astype(str), {"long_name": "kind of special point, empty for none"}
    number = {"long_name": "number of the point along the branch"}
    field = xr.Variable((POINT,), branch.values, quantity_variables.labels(quantity_of(name).name, units))
    ds = ds.assign_coords({POINT: xr.Variable((POINT,), np.arange(len(branch)), number), name: field})
    return ds.assign_attrs(_attributes(branch))


def _attributes(branch: Branch) -> dict[str, Any]:
    keys = ("kind", "value", "before", "after", "position")
    special = [{key: getattr(point, key) for key in keys} for point in branch.special]
    return {
        "title": f"A branch of equilibria over {quantity_of(branch.field).symbol}",
        "field": branch.field,
        "begin": f"{branch.begin.reason} at {branch.field} = {branch.begin.value:.10g}",
        "end": f"{branch.end.reason} at {branch.field} = {branch.end.value:.10g}",
        "begin_kind": branch.begin.kind,
        "end_kind": branch.end.kind,
        "special_points": json.dumps(special),
        "start": branch.start,
        "stability": stability(branch.points[0].case),
    }
