"""Stored cases, and stations along their rods, as tables of pandas."""

from collections.abc import Mapping, Sequence
from itertools import product
from math import prod
from typing import TYPE_CHECKING

import xarray as xr

from solver.problem.errors import InputError

from . import schema

if TYPE_CHECKING:
    import pandas as pd

MOST = 500_000_000  # numbers of a table: 4 GB


def cases(ds: xr.Dataset) -> "pd.DataFrame":
    """One row a case: everything that is stored of it, and what all cases share. The axes are the index."""
    axes = _axes(ds)
    return _table({str(name): ds[name] for name in ds.variables if set(ds[name].dims) <= {*axes}}, ds, axes)


def stations(ds: xr.Dataset, arrays: Sequence[xr.DataArray]) -> "pd.DataFrame":
    """One row a station: s and the arrays along the rod. The axes and u are the index.

    A component is a column of its own: ``position_x``.
    """
    columns = {"s": ds["s"]} if "s" in ds.coords else {}
    for array in arrays:
        inner = [str(dim) for dim in array.dims if dim in schema.COMPONENTS]
        for which in product(*(range(array.sizes[dim]) for dim in inner)):
            words = [schema.COMPONENTS[dim][i] for dim, i in zip(inner, which, strict=True)]
            columns["_".join([str(array.name), *words])] = array.isel(dict(zip(inner, which, strict=True)), drop=True)
    axes = _axes(ds)
    fields = {str(name): ds[name] for name in ds.coords if ds[name].dims and set(ds[name].dims) <= {*axes}}
    return _table({**fields, **columns}, ds, [*axes, *(["u"] if "u" in ds.dims else [])])


def _axes(ds: xr.Dataset) -> list[str]:
    """The axes of a stored study. Raises `InputError` where it is none."""
    if "outcome" not in ds:
        raise InputError("the dataset is not a stored study: it has no outcome")
    return schema.axes_of(ds)


def _table(columns: Mapping[str, xr.DataArray], ds: xr.Dataset, dims: Sequence[str]) -> "pd.DataFrame":
    """The columns over the product of the dimensions, in their order; ``attrs`` holds units and long names.

    Raises `InputError` for more than `MOST` numbers.
    """
    size = len(columns) * prod(ds.sizes[dim] for dim in dims)
    if size > MOST:
        raise InputError(f"the table would have {size:,} numbers, more than {MOST:,}: select from the dataset first")
    data = xr.Dataset({name: array.variable for name, array in columns.items() if name not in dims})
    row = [] if dims else ["row"]
    table = data.assign_coords({dim: ds[dim] for dim in dims}).expand_dims(row).to_dataframe(dim_order=[*dims, *row])
    table = table if dims else table.reset_index(drop=True)
    known = {**{dim: ds[dim] for dim in dims}, **columns}
    table.attrs["units"] = {name: array.attrs["units"] for name, array in known.items() if "units" in array.attrs}
    table.attrs["long_names"] = {
        name: array.attrs["long_name"] for name, array in known.items() if "long_name" in array.attrs
    }
    return table
