"""The schema of stored files: kinds, format, names, dimensions, labels, packing, attributes. Needs no xarray."""

import json
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from solver.observe import observables
from solver.observe.observables import OBSERVABLES
from solver.problem.errors import InputError
from studies.grammar.axes import LONGEST_LINE
from studies.grammar.formulas import parse
from studies.language import expressions
from studies.laws.verdicts import Law

from ..words import escaping
from ..words.outcomes import LEFT
from .quantity_variables import INNER, LOADS, VARYING, curve_name, dimension, inner_shape, labels, own_dimension

if TYPE_CHECKING:
    import xarray as xr

    from studies import Study
    from studies.grammar.axes import Dimensions


FORMAT = 2  # of the file; any other is refused
CONVENTIONS = "CF-1.11"  # of units, names and missing values; every file says so

Where = tuple[slice, ...]  # a box of cases
Columns = dict[str, NDArray[Any]]  # name in the file -> (cases, ...)
CaseVariables = Mapping[str, tuple[tuple[str, ...], Mapping[str, Any]]]  # over all axes: dimensions and attributes

TEXTS = ("outcome", "caution")  # of each case
JUDGED = ("error", "condition")  # of each case
SAMPLING = ("sampling", "sampling_caution", "refinement")  # sentences on the samples of a file
REFINED = "refined"  # the attribute of a refined study, JSON
MOST_TOGETHER = 2**16  # values of an HDF5 chunk: 512 kB
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
    loads = [load for load in LOADS if load not in (*study.varied, *study.recorded)]
    return along | dict.fromkeys([*study.recorded, "solved", *TEXTS, *branch, *JUDGED, *loads, *study.reactions], ())


def leaves(ds: "xr.Dataset") -> bool:
    """Whether the rods of a dataset may leave the cylinder."""
    return ds.attrs.get("contact") == "unilateral"


def loads_vary(ds: "xr.Dataset") -> bool:
    """Whether loads vary along a rod of the dataset: one has weight or friction."""
    return any(bool(np.any(ds[name].values != 0)) for name in VARYING if name in ds.variables)


def packing(ndim: int, dtype: "np.dtype[Any]") -> dict[str, Any]:
    """How an array is compressed in the file; scalars and text are not."""
    return dict(PACKED) if ndim and dtype.kind in "biuf" else {}


# Grids of cases piece by piece: boxes that follow one another in the flat order, the last axis fastest.


def blocks(shape: tuple[int, ...], most: int) -> Iterator[Where]:
    """Slices that together cover an array in its order, each of at most so many numbers."""
    if not shape:
        yield ()
        return
    cut = next(k for k in range(len(shape)) if math.prod(shape[k + 1 :]) <= most or k == len(shape) - 1)
    step = max(1, most // math.prod(shape[cut + 1 :]))
    for outer in np.ndindex(*shape[:cut]):
        for start in range(0, shape[cut], step):
            stop = min(start + step, shape[cut])
            yield (*(slice(i, i + 1) for i in outer), slice(start, stop), *(slice(0, n) for n in shape[cut + 1 :]))


def span(where: Where, shape: tuple[int, ...]) -> tuple[int, int]:
    """The first and the last + 1 of the cases of a box of `blocks`, in flat order."""
    start = int(np.ravel_multi_index([part.start for part in where], shape)) if shape else 0
    return start, start + math.prod(extent(where))


def extent(where: Where) -> tuple[int, ...]:
    """The shape of a box."""
    return tuple(part.stop - part.start for part in where)


def chunk_shape(shape: tuple[int, ...]) -> tuple[int, ...]:
    """The shape of an HDF5 chunk: a stretch of the flat order."""
    sizes, left = [], MOST_TOGETHER
    for size in reversed(shape):
        sizes.append(max(1, min(size, left)))
        left //= size
    return tuple(reversed(sizes))


def axes_of(ds: "xr.Dataset") -> list[str]:
    """The names of the dataset's axes, in order, that of the samples among them."""
    return [str(dim) for dim in ds["outcome"].dims]


def is_refined(ds: "xr.Dataset") -> bool:
    """Whether the dataset is of a refined study."""
    return REFINED in ds.attrs


def over_cases(ds: "xr.Dataset", values: "xr.DataArray") -> "xr.DataArray":
    """The values over all axes of the cases, in their order."""
    return values.broadcast_like(ds["outcome"]).transpose(*ds["outcome"].dims)


def fields_of_samples(ds: "xr.Dataset") -> list[str]:
    """The fields of the study that are coordinates along the samples."""
    return str(ds.attrs.get("sampled", "")).split()


def axes_left(ds: "xr.Dataset", study: "Study") -> list[str]:
    """The study's dimensions that the dataset still has; one on which a value was selected is gone."""
    return [dim for dim in dict.fromkeys(own_dimension(study, name) for name in study.varied) if dim in ds.dims]


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


def observables_of(ds: "xr.Dataset") -> list[str]:
    """The observables and expressions that a dataset stores, in their order."""
    stored = [name for name, row in OBSERVABLES.items() if name in ds.data_vars and not row.holds]
    return [*stored, *(str(name) for name in ds.data_vars if "expression" in ds[name].attrs)]


def is_count(array: "xr.DataArray") -> bool:
    """Whether an observable or expression is a whole number. Raises `InputError` for an invalid expression."""
    text = array.attrs.get("expression")
    return observables.is_count(str(array.name)) if text is None else parse(str(text)).whole


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


LINE, LABEL = LONGEST_LINE, 1000  # characters of an attribute of a file, and of a variable


def show(value: object) -> str:
    """A value from a file as a message may show it: on one line, at most 60 characters."""
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


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
        raise InputError(f"{path}: the attribute {name} must be a number, got {show(ds.attrs.get(name))}")
    return float(value.item())


def laws_of(ds: "xr.Dataset", path: str | Path = "the dataset") -> list[Law]:
    """The laws that the dataset's study states; `InputError` where the attribute is not a list of laws."""
    try:
        laws = [Law.model_validate(row) for row in json.loads(ds.attrs["laws"])]
    except (KeyError, ValueError, TypeError, RecursionError):
        raise InputError(f"{path}: the attribute laws is not a list of laws in JSON") from None
    for law in laws:
        for name, said in law.model_dump().items():
            if isinstance(said, str) and not escaping.is_line(said, LINE):
                raise InputError(f"{path}: {name} of a law must be one line of text, got {show(said)}")
    return laws


def versions_of(ds: "xr.Dataset", path: str | Path = "the dataset") -> dict[str, str]:
    """The versions the dataset was made with, by package; `InputError` where the attribute is not such a table."""
    try:
        table = json.loads(ds.attrs["versions"])
    except (KeyError, ValueError, TypeError, RecursionError):
        table = None
    if not isinstance(table, dict) or not all(escaping.is_line(f"{a} {b}", LABEL) for a, b in table.items()):
        raise InputError(f"{path}: the attribute versions is not a table in JSON")
    return {str(name): str(number) for name, number in table.items()}
