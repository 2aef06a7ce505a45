"""What an earlier release stored, by its names of today."""

import contextlib
import json
import re
from typing import TYPE_CHECKING

from solver.problem.quantities import RENAMED, current, in_current_names, quantity
from studies.grammar.formulas import tables_in_current_names

if TYPE_CHECKING:
    import xarray as xr

_OF_CURVES = re.compile(r"((?:curve_|shape_|special_|fold_)?)(.*)")  # a name in a file of branches


def dataset_in_current_names(ds: "xr.Dataset") -> "xr.Dataset":
    """The dataset with the names of today in place of those that an earlier release stored, with a notice for each."""
    parts = {name: _OF_CURVES.fullmatch(name) for name in map(str, ds.variables)}
    variables = {name: part[1] + current(part[2]) for name, part in parts.items() if part and part[2] in RENAMED}
    if not variables:
        return ds
    ds = ds.rename(variables)
    for key, value in ds.attrs.items():
        with contextlib.suppress(ValueError, TypeError, RecursionError):  # of an attribute that is no JSON
            ds.attrs[key] = json.dumps(tables_in_current_names(json.loads(value), key), ensure_ascii=False)
    for name in variables.values():
        row = quantity(_OF_CURVES.sub(r"\2", name, count=1))
        ds[name].attrs |= {"long_name": row.long_name, "symbol": row.symbol}
    ds.attrs |= {key: current(ds.attrs[key]) for key in ("shown",) if key in ds.attrs}
    for array in ds.variables.values():
        if isinstance(text := array.attrs.get("expression"), str):
            array.attrs["expression"] = in_current_names(text)
    return ds
