"""Make the labelled dataset of a study: one dimension for each axis, units and long names on every variable."""

import json
import os
import platform
from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver import Case
from studies import Study
from studies.grammar.axes import SAMPLE, Dimensions, quantity_of
from studies.language import refine
from studies.language.loader import dumps

from ..words import cautions
from . import schema

PACKAGES = ("numpy", "scipy", "xarray", "h5netcdf", "h5py", "rod-workbench")
# How exact the observables are, in words.
RESOLVED = "the observables are those of the whole rod, taken from its orbit: each has its own error"
AT_STATIONS = (
    "this method knows the rod at its stations only, and the observables are those of polynomials between them: their "
    "errors are what every other station changes, NaN where there are too few"
)
MOST_LENGTHS = 10_000  # lengths of rods of which s is stored where no array along the rod is


def make(
    study: Study, over: Dimensions, columns: schema.Columns, remarks: Mapping[str, str] | None = None,
    case: Case | None = None,
) -> xr.Dataset:  # fmt: skip
    """The dataset of a study as it was run, from its columns (`store.block.columns`) in the order of the grid.

    over: its samples and axes. remarks: attributes on how it was run (`plan.remarks`). case: the grid as one case,
    where the study does not know it.
    """
    data = {}
    for name, (dims, attrs) in schema.case_variables(study, over).items():
        values = columns[name]
        data[name] = xr.Variable(dims, values.reshape((*over.shape, *values.shape[1:])), attrs)
    ds = frame(study, over, remarks, case).assign(data)  # all at once: xarray aligns at each assignment
    return ds.assign_attrs(caution=cautions.sentence(ds))


def frame(
    study: Study, over: Dimensions, remarks: Mapping[str, str] | None = None, case: Case | None = None
) -> xr.Dataset:
    """The dataset without the variables of each case: coordinates, fields of the case, attributes."""
    axes = tuple(map(schema.dimension, over.names))
    units = study.unit_system
    case = study.case_of(over.open()) if case is None else case
    coords = _coordinates(study, over)
    data = {}
    for name, value in schema.numbers_of_case(case).items():
        if name not in coords:
            data[name] = xr.Variable(*_own_dims(value, axes), schema.labels(name, units))
    for field, value in study.constants_of_laws.items():
        if schema.dimension(field) not in (*coords, *data, *schema.LOADS):
            data[schema.dimension(field)] = xr.Variable((), float(value), _axis_labels(study, field))
    u = np.linspace(0.0, 1.0, study.stations)
    coords["u"] = xr.Variable(("u",), u, schema.labels("u", units))
    dims, length = _own_dims(case.rod.L, axes)
    if study.outputs or length.size < MOST_LENGTHS:
        coords["s"] = xr.Variable((*dims, "u"), length[..., None] * u, schema.labels("s", units))
    if any(name in schema.INNER for name in study.outputs):
        coords["xyz"] = xr.Variable(("xyz",), list(schema.COMPONENTS["xyz"]), {"long_name": "component; z is the axis"})
    ds = xr.Dataset(coords=coords, attrs={**_attributes(study, case), **(remarks or {})})
    return ds.assign(data)  # the axes come first, in order


def _coordinates(study: Study, over: Dimensions) -> dict[str, Any]:
    """The coordinates of the dimensions: the values of each axis; the numbers of the samples, and their fields."""
    coords: dict[str, Any] = {}
    for each in over.each:
        dim = schema.dimension(each.name)
        coords[dim] = xr.Variable((dim,), each.coordinate, _axis_labels(study, each.name))
        for field, values in each.fields.items():
            coords[schema.dimension(field)] = xr.Variable((dim,), values, _axis_labels(study, field))
    if study.refine is not None:
        lattice = study.lattice
        levels = lattice.levels(lattice.places(over.fields))
        labels_ = {"units": "1", "long_name": "level of refinement", "symbol": "level"}
        coords[refine.LEVEL] = xr.Variable((SAMPLE,), levels, labels_)
    return coords


def versions() -> dict[str, str]:
    """Python and the packages that numbers and files depend on."""
    return {"python": platform.python_version(), **{package: schema.version_of(package) for package in PACKAGES}}


def provenance(measured: bool = False) -> dict[str, str]:
    """When and with what a file is made, as attributes; measured: on which machine too."""
    machine = f"{platform.machine()}, {os.cpu_count()} cores, {platform.system()}"
    attributes = {"created": datetime.now(UTC).isoformat(timespec="seconds"), "versions": json.dumps(versions())}
    return {"machine": machine, **attributes} if measured else attributes


def _axis_labels(study: Study, name: str) -> dict[str, str]:
    row = quantity_of(name)
    words = schema.labels(row.name, study.unit_system)
    if meaning := study.meaning(name):
        words["long_name"] += f" ({meaning})"
        words["reading"] = meaning
    return words


def variables(
    columns: Mapping[str, Any], dims: tuple[str, ...], units: Mapping[str, str], prefix: str = "", words: str = ""
) -> dict[str, xr.Variable]:
    """Numbers by the names of their quantities as variables over these dimensions, labelled.

    prefix: of their names in the dataset. words: added to their long names.
    """
    variables = {}
    for name, values in columns.items():
        label = schema.labels(name, units)
        label["long_name"] += words
        variables[f"{prefix}{name}"] = xr.Variable(dims, np.asarray(values), label)
    return variables


def _own_dims(value: Any, axes: tuple[str, ...]) -> tuple[tuple[str, ...], NDArray[np.float64]]:
    """The dimensions along which a field varies, and its values there."""
    array = np.asarray(value, dtype=float)
    dims = axes[len(axes) - array.ndim :]
    kept = tuple(dim for dim, size in zip(dims, array.shape, strict=True) if size > 1)
    return kept, array.reshape([size for size in array.shape if size > 1])


def _attributes(study: Study, case: Case) -> dict[str, Any]:
    sampling = {
        "sampled": " ".join(study.sampled),
        "sampling": study.samples_sentence,
        "sampling_caution": study.sample.caution if study.sample is not None else "",
    }
    return {
        "Conventions": schema.CONVENTIONS,
        "format": schema.FORMAT,
        "title": study.title,
        "study_name": study.name,
        "study": study.text or dumps(study),
        "reading": study.reading or "",
        **schema.attributes_of_case(case, study.unit_system),
        "tolerance": study.tol,
        "method": study.method,
        "observed": RESOLVED if _knows_orbit(study.method) else AT_STATIONS,
        "laws": schema.laws_text(study),
        **provenance(),
        **{name: sentence for name, sentence in sampling.items() if sentence},
        **({} if study.followed is None else {"followed": schema.dimension(study.followed)}),
    }


def _knows_orbit(method: str) -> bool:
    from solver.methods import METHODS

    return method in METHODS and METHODS[method].knows_orbit
