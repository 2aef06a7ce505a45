"""Which of a dataset's cases are drawn: the nearest to asked values, or a line along an axis."""

import json
from collections.abc import Mapping

import numpy as np
import xarray as xr

from solver.problem.errors import InputError, no_such
from studies import TABLE_1

from .dataset import axes_of


def case(ds: xr.Dataset, at: Mapping[str, float] | None = None) -> dict[str, int]:
    """The indices of the stored case nearest to `at`; axes left out are taken where the laws or Table 1 put them.

    Raises `InputError` for a name that is no axis, or a value outside one.
    """
    at = dict(at or {})
    axes = axes_of(ds)
    for name in at:
        if name not in axes:
            raise no_such("axis", name, axes) if axes else InputError(f"no axis {name!r}: the study has none")
    return {name: _nearest(ds[name], at[name]) if name in at else _base(ds, name) for name in axes}


def line(ds: xr.Dataset, axis: str, at: Mapping[str, float] | None = None) -> list[dict[str, int]]:
    """The indices of each case along an axis in its rising order, the other axes as in `case`."""
    if axis not in axes_of(ds):
        raise no_such("axis", axis, axes_of(ds))
    here = case(ds, at)
    return [{**here, axis: int(i)} for i in np.argsort(ds[axis].values, kind="stable")]


def spread(found: list[dict[str, int]], count: int) -> list[dict[str, int]]:
    """At most so many of them, evenly chosen, both ends among them."""
    if len(found) <= count:
        return found
    return [found[i] for i in np.linspace(0, len(found) - 1, count).round().astype(int)]


def _nearest(axis: xr.DataArray, value: float) -> int:
    values = axis.values.astype(float)
    slack = 1e-9 * np.abs(values).max()
    if not values.min() - slack <= value <= values.max() + slack:
        listed = ", ".join(f"{v:.6g}" for v in values)
        raise InputError(f"{axis.name} = {value:g} is outside the axis; its values are {listed}")
    return int(np.abs(values - value).argmin())


def _base(ds: xr.Dataset, name: str) -> int:
    """The index nearest to where the laws or Table 1 put an axis; else its middle."""
    values = ds[name].values.astype(float)
    for row in json.loads(ds.attrs.get("laws", "[]")):
        if name in row.get("at", {}):
            return int(np.abs(values - row["at"][name]).argmin())
    base = TABLE_1.get(name) if ds.attrs.get("reading") else None
    return values.size // 2 if base is None else int(np.abs(values - base).argmin())
