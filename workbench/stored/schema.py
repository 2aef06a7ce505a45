"""The schema of stored files: kinds, format, names, dimensions, labels, packing, attributes. Needs no xarray."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from solver.problem.declared_fields import VARY_LOADS
from solver.problem.errors import InputError
from studies.language import expressions

from ..words import escaping
from ..words.outcome_counts import LEFT
from .bounds import LABEL
from .quantity_variables import INNER, JUDGED, LOADS, curve_name, dimension, inner_shape, labels, own_dimension

if TYPE_CHECKING:
    import xarray as xr

    from studies import Study
    from studies.grammar.axes import Dimensions


FORMAT = 2  # of the file; any other is refused
CONVENTIONS = "CF-1.11"  # of units, names and missing values; every file says so

CaseVariables = Mapping[str, tuple[tuple[str, ...], Mapping[str, Any]]]  # over all axes: dimensions and attributes

TEXTS = ("outcome", "caution")  # of each case
PACKED: Mapping[str, Any] = {"compression": "gzip", "compression_opts": 1, "shuffle": True, "fletcher32": True}


def case_variables(study: "Study", over: "Dimensions") -> CaseVariables:
    """Every variable that is stored of each case, in order. over: the samples and axes of the study."""
    axes = tuple(map(dimension, over.names))
    outputs = {curve_name(name): name for name in study.outputs}
    dims = {name: (*axes, *(("u", *INNER.get(outputs[name], ())) if name in outputs else ())) for name in shapes(study)}
    return {name: (dims[name], labels_in(study, outputs.get(name, name))) for name in dims}


def shapes(study: "Study") -> dict[str, tuple[int, ...]]:
    """The variables that are stored of each case, in order, and the shape that each has for one case."""
    along = {curve_name(name): (study.stations, *inner_shape(name)) for name in study.outputs}
    branch = ["branch"] if study.has_branches else []
    loads = [load for load in LOADS if load not in (*study.variation.fields, *study.columns)]
    return along | dict.fromkeys([*study.columns, "solved", *TEXTS, *branch, *JUDGED, *loads, *study.reactions], ())


def leaves(ds: "xr.Dataset") -> bool:
    """Whether the rods of a dataset may leave the cylinder."""
    return ds.attrs.get("contact") == "unilateral"


def loads_vary(ds: "xr.Dataset") -> bool:
    """Whether loads vary along a rod of the dataset: one has weight or friction."""
    return any(bool(np.any(ds[name].values != 0)) for name in VARY_LOADS if name in ds.variables)


def compression(ndim: int, dtype: "np.dtype[Any]") -> dict[str, Any]:
    """How an array is compressed in the file; scalars and text are not."""
    return dict(PACKED) if ndim and dtype.kind in "biuf" else {}


def axes_of(ds: "xr.Dataset") -> list[str]:
    """The names of the dataset's axes, in order, that of the samples among them."""
    return [str(dim) for dim in ds["outcome"].dims]


def over_cases(ds: "xr.Dataset", values: "xr.DataArray") -> "xr.DataArray":
    """The values over all axes of the cases, in their order."""
    return values.broadcast_like(ds["outcome"]).transpose(*ds["outcome"].dims)


def fields_of_samples(ds: "xr.Dataset") -> list[str]:
    """The fields of the study that are coordinates along the samples."""
    return str(ds.attrs.get("sampled", "")).split()


def axes_left(ds: "xr.Dataset", study: "Study") -> list[str]:
    """The study's dimensions that the dataset still has; one on which a value was selected is gone."""
    every = dict.fromkeys(own_dimension(study, name) for name in study.variation.fields)
    return [dim for dim in every if dim in ds.dims]


def labels_in(study: "Study", name: str) -> dict[str, str]:
    """The attributes of a variable of a study: those of its quantity, or of its expression."""
    text = study.expressions.get(name.removesuffix("_error"))
    if text is None:
        words = labels(name, study.unit_system)
        return {**words, "long_name": LEFT} if name == "branch" and study.varies else words
    plain = name.removesuffix("_error")
    unit = expressions.unit(study, plain)
    if name != plain:
        return {"units": unit, "long_name": f"estimated error of: {plain}", "symbol": f"δ({plain})"}
    return {"units": unit, "long_name": plain.replace("_", " "), "symbol": plain, "expression": text}


def laws_text(study: "Study") -> str:
    """The study's laws as JSON, in the names of the dataset."""
    rows = [law.model_dump() for law in study.laws]
    for row in rows:
        if not row["turned_back"]:  # as version 0.2.0, which knows no such key, opens the file
            del row["turned_back"]
        row |= {"axis": dimension(row["axis"]), "at": {dimension(name): value for name, value in row["at"].items()}}
    return json.dumps(rows, ensure_ascii=False)


def stiffness_fields(ds: "xr.Dataset") -> tuple[str, ...]:
    """The fields that determine the bending stiffness of the rods of a dataset."""
    if "EI" in ds.variables:
        return ("EI",)
    return ("E", "a", "inner_radius") if "inner_radius" in ds.variables else ("E", "a")


def text_of(ds: "xr.Dataset", name: str) -> str:
    """An attribute that is text, of a dataset that was not read from a file; `InputError` otherwise."""
    value = ds.attrs.get(name)
    if not isinstance(value, str):
        raise InputError(f"the dataset's attribute {name} is {'missing' if value is None else 'not text'}")
    return value


def number_of(ds: "xr.Dataset", name: str, path: str | Path = "the dataset") -> float:
    """An attribute that is one number; `InputError` otherwise."""
    value = np.asarray(ds.attrs.get(name))
    if value.size != 1 or value.dtype.kind not in "iuf":
        raise InputError(f"{path}: the attribute {name} must be a number, got {escaping.show(ds.attrs.get(name))}")
    return float(value.item())


def versions_of(ds: "xr.Dataset", path: str | Path = "the dataset") -> dict[str, str]:
    """The versions the dataset was made with, by package; `InputError` where the attribute is not such a table."""
    try:
        table = json.loads(ds.attrs["versions"])
    except (KeyError, ValueError, TypeError, RecursionError):
        table = None
    if not isinstance(table, dict) or not all(escaping.is_line(f"{a} {b}", LABEL) for a, b in table.items()):
        raise InputError(f"{path}: the attribute versions is not a table in JSON")
    return {str(name): str(number) for name, number in table.items()}
