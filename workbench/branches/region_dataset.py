"""A region map as a dataset: fold curves and cusps, a raster of regions, the numbers and stable shapes of each."""

import json
from itertools import product
from typing import Any

import numpy as np
import xarray as xr

from solver.problem.case_fields import value_of
from solver.problem.dimensionless import fields_held
from solver.region_map import Region, RegionMap
from studies import Study

from ..stored import quantity_variables
from .equilibria_dataset import ALONG, attributes, with_case


def as_dataset(study: Study, found: RegionMap, checked: tuple[int, int] | None = None) -> xr.Dataset:
    """The dataset of a region map.

    Parameters
    ----------
    study
        The study of the case; the dataset takes its units and stores its text.
    found
        The map.
    checked
        How many random points were checked, and at how many the equilibria are not those of the map.

    Returns
    -------
    Over (second field, first field) `region`, the number of the region; over `region` its numbers; over (region,
    stable, u) its stable shapes; over (curve, point) and `cusp` the curves.
    """
    units, folds = study.unit_system, found.folds
    names = [quantity_variables.dimension(name) for name in folds.names]
    labels = {name: quantity_variables.labels(name, units) for name in names}
    label = {"long_name": "number of the region, the largest 0; -1: too small to be a region", "units": "1"}
    data = {"region_at": xr.Variable(names[::-1], found.labels, label)}
    data |= _of_regions(found.regions, names, units) | _of_curves(found, names, units)
    coords = {name: xr.Variable(name, ticks, labels[name]) for name, ticks in zip(names, found.ticks, strict=True)}
    stations = data["stable_alpha"].sizes["u"]
    coords["u"] = xr.Variable("u", np.linspace(0, 1, stations), quantity_variables.labels("u", units))
    symbols = " and ".join(label["symbol"] for label in labels.values())
    is_searched = folds.case.rod.weight is not None or bool(fields_held(folds.case))
    number = "The number of equilibria" + " found" * is_searched
    ds = xr.Dataset(data, coords, attributes(study, folds.case, f"{number} over {symbols}"))
    ds.attrs |= {"study_name": "folds", "fields": json.dumps(names), "remark": found.remark}
    ds.attrs |= {"low": folds.low.tolist(), "high": folds.high.tolist()}
    ds.attrs["given"] = [value_of(folds.case, name) for name in folds.names]
    if checked is not None:
        ds.attrs["checked_points"], ds.attrs["failed_points"] = checked
    ds = with_case(ds, folds.case, units, names)
    return ds.drop_dims([dim for dim, size in ds.sizes.items() if not size])  # a file holds no empty array


def _of_regions(regions: list[Region], names: list[str], units: dict[str, str]) -> dict[str, xr.Variable]:
    """The numbers of each region, and its stable shapes, NaN beyond their number."""
    most = max((region.stable for region in regions), default=0)
    stations = regions[0].equilibria[0].solution.s.size if regions and regions[0].equilibria else 2
    shapes = {name: np.full((len(regions), most, stations), np.nan) for name in ALONG}
    for k, region in enumerate(regions):
        stable = [equilibrium.solution for equilibrium in region.equilibria if equilibrium.index == 0]
        for (i, solution), name in product(enumerate(stable), ALONG):
            shapes[name][k, i] = getattr(solution, name)
    data = quantity_variables.variables(shapes, ("region", "stable", "u"), units, "stable_")
    numbers: dict[str, tuple[Any, list[Any], str]] = {
        "count": (np.int64, [region.count for region in regions], "number of equilibria"),
        "count_stable": (np.int64, [region.stable for region in regions], "number of stable equilibria"),
        "area": (float, [region.area for region in regions], "share of the rectangle"),
    }
    for name, (kind, values, words) in numbers.items():
        data[name] = xr.Variable("region", np.array(values, dtype=kind), {"long_name": words, "units": "1"})
    complete = np.array([region.equilibria.complete for region in regions], dtype=bool)
    data["complete"] = xr.Variable("region", complete, {"long_name": "whether the equilibria pass the test"})
    places = {name: np.array([region.values[k] for region in regions]) for k, name in enumerate(names)}
    where = ", of the point where the equilibria were computed"
    return data | quantity_variables.variables(places, ("region",), units, "region_", where)


def _of_curves(region_map: RegionMap, names: list[str], units: dict[str, str]) -> dict[str, xr.Variable]:
    """The curves over (curve, point), NaN beyond their ends, and the cusps."""
    curves, names = region_map.folds.curves, [*names, "dbeta0"]
    points = [np.column_stack([curve.values, curve.dbeta0]) for curve in curves]
    cusps = [np.column_stack([curve.cusps, curve.cusp_dbeta0]) for curve in curves]
    most = max(map(len, points), default=0)
    padded = [np.pad(rows, ((0, most - len(rows)), (0, 0)), constant_values=np.nan) for rows in points]
    along = np.array(padded).reshape(len(curves), most, 3)
    data = quantity_variables.variables(
        {name: along[..., k] for k, name in enumerate(names)}, ("curve", "point"), units, "curve_"
    )
    every = np.concatenate([np.zeros((0, 3)), *cusps])
    data |= quantity_variables.variables({name: every[:, k] for k, name in enumerate(names)}, ("cusp",), units, "cusp_")
    owner = np.repeat(np.arange(len(curves)), list(map(len, cusps)))
    data["cusp_curve"] = xr.Variable("cusp", owner.astype(np.int64), {"long_name": "number of its curve"})
    lower = {"long_name": "lower Morse index of the two equilibria that meet", "units": "1"}
    data["curve_index"] = xr.Variable("curve", np.array([curve.lower for curve in curves], dtype=np.int64), lower)
    data["curve_kind"] = xr.Variable("curve", np.array([curve.kind for curve in curves], dtype=str))
    ends = np.array([" ".join(curve.ends) for curve in curves], dtype=str)
    data["curve_ends"] = xr.Variable("curve", ends, {"long_name": "how the curve ends at either side"})
    return data
