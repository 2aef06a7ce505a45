"""The dataset of a study without the numbers of its cases: coordinates, fields of the case, attributes.

The writer puts into it what it solves, and whoever wants one case of a study that was never run chooses from it.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver import Case
from solver.problem.errors import choices
from studies import Study
from studies.grammar.axes import SAMPLE, Dimensions, quantity_of
from studies.language.loader import dumps
from studies.language.refine_table import LEVEL

from . import bounds, case_solving, provenance, quantity_variables, schema

# How exact the observables are, in words.
RESOLVED = "the observables are those of the whole rod, taken from its orbit: each has its own error"
AT_STATIONS = (
    "this method knows the rod at its stations only, and the observables are those of polynomials between them: their "
    "errors are what every other station changes, NaN where there are too few"
)
MOST_LENGTHS = 10_000  # lengths of rods of which s is stored where no array along the rod is


def frame_of(
    study: Study, over: Dimensions, remarks: Mapping[str, str] | None = None, case: Case | None = None
) -> xr.Dataset:
    """The dataset without the variables of each case: coordinates, fields of the case, attributes."""
    axes = tuple(map(quantity_variables.dimension, over.names))
    units = study.unit_system
    case = study.case_of(over.open()) if case is None else case
    coords = _coordinates(study, over)
    data = {}
    for name, value in quantity_variables.numbers_of_case(case).items():
        if name not in coords:
            data[name] = xr.Variable(*_own_dims(value, axes), quantity_variables.labels(name, units))
    for field, value in study.constants_of_laws.items():
        if quantity_variables.dimension(field) not in (*coords, *data, *quantity_variables.LOADS):
            data[quantity_variables.dimension(field)] = xr.Variable((), float(value), _axis_labels(study, field))
    u = np.linspace(0.0, 1.0, study.stations)
    coords["u"] = xr.Variable(("u",), u, quantity_variables.labels("u", units))
    dims, length = _own_dims(case.rod.L, axes)
    if study.outputs or length.size < MOST_LENGTHS:
        coords["s"] = xr.Variable((*dims, "u"), length[..., None] * u, quantity_variables.labels("s", units))
    if any(name in quantity_variables.INNER for name in study.outputs):
        coords["xyz"] = xr.Variable(
            ("xyz",), list(quantity_variables.COMPONENTS["xyz"]), {"long_name": "component; z is the axis"}
        )
    ds = xr.Dataset(coords=coords, attrs={**_attributes(study, case), **(remarks or {})})
    return ds.assign(data)  # the axes come first, in order


def _coordinates(study: Study, over: Dimensions) -> dict[str, Any]:
    """The coordinates of the dimensions: the values of each axis; the numbers of the samples, and their fields."""
    coords: dict[str, Any] = {}
    for each in over.each:
        dim = quantity_variables.dimension(each.name)
        coords[dim] = xr.Variable((dim,), each.coordinate, _axis_labels(study, each.name))
        for field, values in each.fields.items():
            coords[quantity_variables.dimension(field)] = xr.Variable((dim,), values, _axis_labels(study, field))
    if study.refine is not None:
        lattice = study.refine.lattice(study.axes)
        levels = lattice.levels(lattice.places(over.fields))
        labels_ = {"units": "1", "long_name": "level of refinement", "symbol": "level"}
        coords[LEVEL] = xr.Variable((SAMPLE,), levels, labels_)
    return coords


def _axis_labels(study: Study, name: str) -> dict[str, str]:
    row = quantity_of(name)
    words = quantity_variables.labels(row.name, study.unit_system)
    if meaning := study.meaning(name):
        words["long_name"] += f" ({meaning})"
        words["reading"] = meaning
    return words


def _own_dims(value: Any, axes: tuple[str, ...]) -> tuple[tuple[str, ...], NDArray[np.float64]]:
    """The dimensions along which a field varies, and its values there."""
    array = np.asarray(value, dtype=float)
    dims = axes[len(axes) - array.ndim :]
    kept = tuple(dim for dim, size in zip(dims, array.shape, strict=True) if size > 1)
    return kept, array.reshape([size for size in array.shape if size > 1])


def _attributes(study: Study, case: Case) -> dict[str, Any]:
    followed = study.variation.followed
    sampling = {
        "sampled": " ".join(study.variation.sampled),
        "sampling": _origin_of_samples(study),
        "sampling_caution": study.sample.caution if study.sample is not None else "",
    }
    return {
        "Conventions": schema.CONVENTIONS,
        "format": schema.FORMAT,
        "title": study.title,
        "study_name": study.name,
        "study": bounds.fit_lines(study.text or dumps(study)),
        "reading": study.reading or "",
        **quantity_variables.attributes_of_case(case, study.unit_system),
        **({"contact": "unilateral"} if study.let_go else {}),
        "tolerance": study.tol,
        "method": study.method,
        "observed": RESOLVED if case_solving.knows_orbit(study.method) else AT_STATIONS,
        "laws": schema.laws_text(study),
        **provenance.provenance(),
        **{name: sentence for name, sentence in sampling.items() if sentence},
        **({} if followed is None else {"followed": quantity_variables.dimension(followed)}),
    }


def _origin_of_samples(study: Study) -> str:
    """Where the samples come from, in one sentence; empty where there are none."""
    given = study.variation.given
    if given is None or study.refine is not None:
        return ""
    count = f"{given.size} sample{'s' * (given.size != 1)} of {choices(given.fields)}"
    if study.sample is not None:
        return f"{count}: {study.sample.sentence}"
    return f"{count}, from {study.table.file if study.table is not None else 'the lists of zip'}"


def without_results(study: Study) -> xr.Dataset:
    """A dataset of a study that follows no equilibrium, without results: a case is chosen in it as in a stored one."""
    over = study.variation.dimensions
    unknown = np.broadcast_to(np.array("", dtype=object), over.shape)
    return frame_of(study, over).assign(outcome=(tuple(map(quantity_variables.dimension, over.names)), unknown))
