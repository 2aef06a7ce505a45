"""The input of a fit: the case of a study at a place of its grid, measured points of a file, and values as text."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from solver.inverse.data import COLUMNS
from solver.problem.errors import InputError, choices
from solver.problem.quantities import QUANTITIES
from studies import Study
from studies.grammar.axes import in_rad, quantity_of
from studies.language import tables

from ..store import dataset, schema, selection
from ..store.case_input import CaseInput, with_fields

POINT_COLUMNS = ("s", *COLUMNS, *(f"sigma_{name}" for name in COLUMNS))


def places(study: Study) -> xr.Dataset:
    """The axes and samples of a study as a dataset without results, in which a case can be selected."""
    over = study.dimensions()
    ds = dataset.frame(study.at_stations(2).model_copy(update={"outputs": []}), over)
    empty = np.broadcast_to(np.array(""), over.shape)
    return ds.assign(outcome=(tuple(map(schema.dimension, over.names)), empty))


def case_at(
    study: Study, ds: xr.Dataset, at: Mapping[str, float], values: Mapping[str, Any]
) -> tuple[CaseInput, dict[str, float]]:
    """A case of a study, and the place on each axis where it was taken.

    Parameters
    ----------
    study, ds
        The study, and its `places`.
    at
        Values of axes; an axis that is not named stays where the laws or Table 1 put it.
    values
        Fields that replace those of the case.

    Raises
    ------
    InputError
        For a value that is not on its axis, a study that is followed, and an unknown or invalid field.
    """
    if study.follow is not None:
        raise InputError(
            f"{study.name} follows one equilibrium along {study.followed}: fit takes a study of single cases"
        )
    over = study.dimensions()
    where = selection.case(ds, at)
    place = [where[schema.dimension(name)] for name in over.names]
    flat = np.ravel_multi_index(place, over.shape) if place else 0
    taken = {name: float(found[0]) for name, found in over.at(np.array([flat], dtype=np.int64)).items()}
    changed = f", except {choices(values)}" if values else ""
    case = with_fields(study.case_of(taken), values)
    return CaseInput(case, study.unit_system, f"{study.title}{changed}", study=study), taken


def read_points(path: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    """The columns of measured points in a CSV or Parquet file, and their standard deviations, angles in rad.

    Raises `InputError` with the line and the column.
    """
    found = tables.read(path, known=POINT_COLUMNS, of="column of measured points", row="point")
    points = {name: values for name, values in found.items() if not name.startswith("sigma_")}
    sigma = {name.removeprefix("sigma_"): values for name, values in found.items() if name.startswith("sigma_")}
    for name in sigma:
        if name not in points:
            raise InputError(f"{path.name} has the column sigma_{name} and no column {name}")
    return points, sigma


def pairs(option: str, texts: Sequence[str]) -> dict[str, str]:
    """``["height=10", "wraps=2"]`` by name. Raises `InputError` for another form or a name that is given twice."""
    found: dict[str, str] = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals and value):
            raise InputError(f"{option} takes NAME=VALUE, got {text!r}")
        if name in found:
            raise InputError(f"{option} {text}: {name} is given twice")
        found[name] = value
    return found


def numbers(option: str, texts: Sequence[str]) -> dict[str, float]:
    """The pairs with their values as numbers, angles in rad also from forms like 30deg. Raises `InputError`."""
    return {name: _number(f"{option} {name}", name, value) for name, value in pairs(option, texts).items()}


def bounds(texts: Sequence[str]) -> dict[str, tuple[float, float]]:
    """``["F1=1:9"]`` as name -> (low, high), angles in rad. Raises `InputError`."""
    found = {}
    for name, text in pairs("--bounds", texts).items():
        ends = text.split(":")
        if len(ends) != 2:
            raise InputError(f"--bounds takes NAME=LOW:HIGH, got {name}={text!r}")
        low, high = (_number(f"--bounds {name}", name, end) for end in ends)
        found[name] = (low, high)
    return found


def is_angle(name: str) -> bool:
    """Whether a field or an observable is an angle [rad]."""
    row = quantity_of(name) if name in ("alpha", "beta", "gamma", "dbeta") else QUANTITIES.get(name)
    return row is not None and row.dimension == "rad"


def _number(what: str, name: str, text: str) -> float:
    try:
        value = float(in_rad(text)) if is_angle(name) else float(text)
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        forms = "a number in rad, or a form like 30deg" if is_angle(name) else "a finite number"
        raise InputError(f"{what} must be {forms}, got {text!r}")
    return value
