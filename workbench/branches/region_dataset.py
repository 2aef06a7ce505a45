"""A region map as a dataset: fold curves and cusps, a raster of regions, the numbers and stable shapes of each."""

import json
from typing import Any

import numpy as np
import xarray as xr

from solver import Case
from solver.problem.case_fields import value_of
from solver.problem.reduced import held_of
from solver.region_map import Region, RegionMap
from studies import Study

from ..store import schema
from .equilibria_dataset import attributes, with_case

ALONG = ("beta", "alpha", "z", "contact")
Checked = tuple[int, int]  # points at which the map was checked, and those at which it failed


def dataset_of(study: Study, found: RegionMap, checked: Checked | None = None) -> xr.Dataset:
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
    x, y = (schema.dimension(name) for name in folds.names)
    labels = [schema.labels(name, units) for name in (x, y)]
    label = {"long_name": "number of the region, the largest 0; -1: too small to be a region", "units": "1"}
    data: dict[str, Any] = {"region_at": xr.Variable((y, x), found.labels, label)}
    data |= _of_regions(found.regions, (x, y), labels, units)
    data |= _of_curves(found, (x, y), labels, units)
    coords: dict[str, Any] = {
        name: xr.Variable((name,), ticks, label) for name, ticks, label in zip((x, y), found.ticks, labels, strict=True)
    }
    stations = data["stable_alpha"].sizes["u"]
    coords["u"] = xr.Variable(("u",), np.linspace(0, 1, stations), schema.labels("u", units))
    symbols = " and ".join(label["symbol"] for label in labels)
    number = "The number of equilibria" + " found" * (folds.case.rod.weight is not None or bool(held_of(folds.case)))
    ds = xr.Dataset(data, coords, attributes(study, folds.case, f"{number} over {symbols}"))
    ds.attrs |= {"study_name": "folds", "fields": json.dumps([x, y]), "remark": found.remark}
    ds.attrs["low"], ds.attrs["high"] = folds.low.tolist(), folds.high.tolist()
    ds.attrs["given"] = [value_of(folds.case, name) for name in folds.names]
    if checked is not None:
        ds.attrs["checked_points"], ds.attrs["failed_points"] = checked
    ds = _with_case(ds, folds.case, units, (x, y))
    return ds.drop_dims([dim for dim, size in ds.sizes.items() if not size])  # a file holds no empty array


def _with_case(ds: xr.Dataset, case: Case, units: dict[str, str], fields: tuple[str, str]) -> xr.Dataset:
    """The dataset with the numbers of the case that do not vary, as scalars."""
    whole = with_case(xr.Dataset(), case, units)
    varied = {*fields, *(("rho",) if {"R", "a"} & set(fields) else ())}
    return ds.assign({name: array for name, array in whole.data_vars.items() if name not in varied})


def _of_regions(regions: list[Region], names: tuple[str, str], labels: list[Any], units: dict[str, str]) -> Any:
    """The numbers of each region, and its stable shapes, NaN beyond their number."""
    most = max((region.stable for region in regions), default=0)
    stations = regions[0].equilibria[0].solution.s.size if regions and regions[0].equilibria else 2
    shapes = {name: np.full((len(regions), most, stations), np.nan) for name in ALONG}
    for k, region in enumerate(regions):
        stable = [equilibrium for equilibrium in region.equilibria if equilibrium.index == 0]
        for i, equilibrium in enumerate(stable):
            for name in ALONG:
                shapes[name][k, i] = getattr(equilibrium.solution, name)
    data: dict[str, Any] = {
        f"stable_{name}": xr.Variable(("region", "stable", "u"), values, schema.labels(name, units))
        for name, values in shapes.items()
    }
    words = {"count": "number of equilibria", "count_stable": "number of stable equilibria"}
    for name, values in (
        ("count", [region.count for region in regions]),
        ("count_stable", [region.stable for region in regions]),
    ):
        data[name] = xr.Variable(
            ("region",), np.array(values, dtype=np.int64), {"long_name": words[name], "units": "1"}
        )
    area = {"long_name": "share of the rectangle", "units": "1"}
    data["area"] = xr.Variable(("region",), np.array([region.area for region in regions]), area)
    complete = np.array([region.equilibria.complete for region in regions], dtype=bool)
    data["complete"] = xr.Variable(("region",), complete, {"long_name": "whether the equilibria pass the test"})
    for k, name in enumerate(names):
        inner = {**labels[k], "long_name": f"{labels[k]['long_name']}, of the point where the equilibria were computed"}
        data[f"region_{name}"] = xr.Variable(("region",), np.array([region.values[k] for region in regions]), inner)
    return data


def _of_curves(region_map: RegionMap, names: tuple[str, str], labels: list[Any], units: dict[str, str]) -> Any:
    """The curves over (curve, point), NaN beyond their ends, and the cusps."""
    curves = region_map.folds.curves
    most = max((curve.values.shape[0] for curve in curves), default=0)
    values = np.full((3, len(curves), most), np.nan)
    for k, curve in enumerate(curves):
        values[:2, k, : curve.dbeta0.size] = curve.values.T
        values[2, k, : curve.dbeta0.size] = curve.dbeta0
    cusps = np.concatenate([np.zeros((0, 2)), *(curve.cusps for curve in curves)])
    slopes = np.concatenate([np.zeros(0), *(curve.cusp_dbeta0 for curve in curves)])
    owner = np.repeat(np.arange(len(curves)), [curve.cusps.shape[0] for curve in curves])
    data: dict[str, Any] = {}
    for k, name in enumerate(names):
        data[f"curve_{name}"] = xr.Variable(("curve", "point"), values[k], labels[k])
        data[f"cusp_{name}"] = xr.Variable(("cusp",), cusps[:, k], labels[k])
    data["curve_dbeta0"] = xr.Variable(("curve", "point"), values[2], schema.labels("dbeta0", units))
    data["cusp_dbeta0"] = xr.Variable(("cusp",), slopes, schema.labels("dbeta0", units))
    data["cusp_curve"] = xr.Variable(("cusp",), owner.astype(np.int64), {"long_name": "number of its curve"})
    lower = {"long_name": "lower Morse index of the two equilibria that meet", "units": "1"}
    data["curve_index"] = xr.Variable(("curve",), np.array([curve.lower for curve in curves], dtype=np.int64), lower)
    data["curve_kind"] = xr.Variable(("curve",), np.array([curve.kind for curve in curves], dtype=str))
    ends = np.array([" ".join(curve.ends) for curve in curves], dtype=str)
    data["curve_ends"] = xr.Variable(("curve",), ends, {"long_name": "how the curve ends at either side"})
    return data
