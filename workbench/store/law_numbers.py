"""The numbers of each case that the formulas of laws use, from a stored dataset; nothing is solved."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from solver.problem.errors import InputError, choices
from studies.language.expressions import unit_names
from studies.laws.law import Law
from studies.laws.verdicts import targets

from . import schema
from .schema import dimension

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray


def known(ds: "xr.Dataset", names: Iterable[str]) -> "dict[str, NDArray[np.float64]]":
    """The numbers of these names over the grid of the dataset. Raises `InputError` for a name that is missing."""
    return {name: _over_cases(ds, name, _find(ds, name)) for name in names}


def of_law(ds: "xr.Dataset", law: Law) -> "dict[str, NDArray[np.float64]]":
    """The numbers that the formulas of a law use. Raises `InputError` for a name that is missing."""
    return known(ds, dict.fromkeys(name for formula in law.formulas.values() for name in formula.names))


def of_line(ds: "xr.Dataset", law: Law, places: "list[dict[str, int]]") -> "dict[str, NDArray[np.float64]]":
    """The numbers with which a law compares its observable, by key, at the places of one line of the grid."""
    outcome = ds["outcome"]
    found = targets(law, outcome.shape, of_law(ds, law))
    index = tuple(np.array([place[str(dim)] for place in places]) for dim in outcome.dims)
    return {key: values[index] for key, (values, _) in found.items()}


def _find(ds: "xr.Dataset", name: str) -> Any:
    """A number by its name in a formula: of a field, a stored variable, a stiffness or a unit."""
    if name in unit_names({key: str(ds.attrs[f"{key}_unit"]) for key in ("length", "force")}):
        return 1.0
    if name == "torsional_stiffness":
        return schema.torsional_stiffness(str(ds.attrs["stiffness"]), ds)
    if name == "bending_stiffness":
        return schema.bending_stiffness(str(ds.attrs["stiffness"]), ds)
    try:
        key = dimension(name)
    except InputError:
        key = name  # an expression
    if key not in ds.variables or not set(ds[key].dims) <= set(ds["outcome"].dims) or ds[key].dtype.kind not in "iufb":
        stored = [str(variable) for variable in ds.variables if set(ds[variable].dims) <= set(ds["outcome"].dims)]
        raise InputError(f"the dataset stores no number {name!r} of each case; available: {choices(stored)}")
    return ds[key]


def _over_cases(ds: "xr.Dataset", name: str, values: Any) -> "NDArray[np.float64]":
    outcome = ds["outcome"]
    if isinstance(values, float):
        return np.full(outcome.shape, values)
    over = values.broadcast_like(outcome).transpose(*outcome.dims)
    return np.asarray(over.values, dtype=float)
