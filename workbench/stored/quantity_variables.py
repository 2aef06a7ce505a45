"""The variables of files by the quantities that they are: names, dimensions, units, labels. Needs no xarray."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from solver.problem.quantities import quantity, unit_of
from studies.grammar.axes import SAMPLE, WORDS, quantity_of
from studies.language.study import OUTPUTS

if TYPE_CHECKING:
    import xarray as xr

    from studies import Study

LOADS = ("FZ", "MZ", "M3")
COMPONENTS = {"xyz": ("x", "y", "z"), "director": ("d1", "d2", "d3")}
INNER = {"position": ("xyz",)}  # dimensions after u, of an output that is not one number at each station
# The name in the file -> the output. Forces along the rod never take the name of an axis: F1 is the force at the start.
CURVES = {f"{name}_along" if name in ("F1", "F2", "F3") else name: name for name in OUTPUTS}


def curve_name(output: str) -> str:
    """The name in the file of an output along the rod: ``beta``, ``F1_along``."""
    return output if output in CURVES else f"{output}_along"


def dimension(field: str) -> str:
    """The dimension of an axis: the quantity that the study's field is, so that `beta` of a start problem is beta0."""
    return quantity_of(field).name


def inner_shape(output: str) -> tuple[int, ...]:
    """How many numbers an output has at each station, as a shape: () for one."""
    return tuple(len(COMPONENTS[dim]) for dim in INNER.get(output, ()))


def own_dimension(study: "Study", field: str) -> str:
    """The dimension along which a field of the study varies: its own, or that of the samples."""
    return SAMPLE if field in study.sampled else dimension(field)


def field_of(study: "Study", name: str) -> str:
    """The study's field of an axis or quantity that the dataset names; any other name as it is."""
    return next((field for field in study.fields if field not in WORDS and dimension(field) == name), name)


def labels(name: str, units: Mapping[str, str]) -> dict[str, str]:
    """The attributes of a variable of that quantity: units (not of texts and flags), long_name, symbol."""
    row = quantity(name)
    words = {"long_name": row.long_name, "symbol": row.symbol}
    return words if row.dimension == "text" else {"units": unit_of(name, units), **words}


def variables(
    columns: Mapping[str, Any], dims: tuple[str, ...], units: Mapping[str, str], prefix: str = "", words: str = ""
) -> "dict[str, xr.Variable]":
    """Numbers by the names of their quantities as variables over these dimensions, labelled.

    prefix: of their names in the dataset. words: added to their long names.
    """
    import xarray as xr

    variables = {}
    for name, values in columns.items():
        label = labels(name, units)
        label["long_name"] += words
        variables[f"{prefix}{name}"] = xr.Variable(dims, np.asarray(values), label)
    return variables
