"""A dataset without the numbers of rods of which its diagrams should not tell, such as rods that turn back."""

from typing import TYPE_CHECKING

import numpy as np

from solver.problem.errors import InputError, no_such

from ..words import cautions

if TYPE_CHECKING:
    import xarray as xr

PARTS = ("curve", "fold", "special", "shape")  # of a dataset of branches; each may have `<part>_<BACK>`
BACK = "turned_back"


def without(ds: "xr.Dataset", key: str) -> "xr.Dataset":
    """The dataset with NaN in place of the numbers of each rod whose caution has a word.

    key: of `cautions.WORDS`. Raises `InputError` for another one, and for a dataset that does not tell.
    """
    if key not in cautions.WORDS:
        raise no_such("caution", key, cautions.WORDS)
    if "caution" in ds and "outcome" in ds and ds["caution"].dims == ds["outcome"].dims:
        return _without_numbers(ds, ds["caution"].copy(data=cautions.has_key(ds["caution"], key)), "")
    parts = [part for part in PARTS if f"{part}_{BACK}" in ds]
    if not parts or key != cautions.TURNED:
        raise InputError(f"this file does not tell which of its rods are {key!r}")
    for part in parts:
        ds = _without_numbers(ds, ds[f"{part}_{BACK}"], f"{part}_")
    return ds


def _without_numbers(ds: "xr.Dataset", where: "xr.DataArray", prefix: str) -> "xr.Dataset":
    """The dataset with NaN in the numbers of a name with the prefix where an array says so."""
    names = [
        name
        for name, array in ds.data_vars.items()
        if array.dims == where.dims
        and str(name).startswith(prefix)
        and array.dtype.kind in "iuf"
        and "branch" not in str(name)
    ]
    return ds.assign(
        {name: ds[name].astype(float).where(~where, np.nan).assign_attrs(ds[name].attrs) for name in names}
    )
