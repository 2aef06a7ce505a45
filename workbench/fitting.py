"""A fit: the measured points that it reads, its dataset for the figure, and the files that it writes.

The dataset holds the fitted curve, the measured points and the fitted values; the files are the fitted case as a study
and the fitted values as a table.
"""

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from solver import solve
from solver.fits.data import COLUMNS, DISTANCE
from solver.fits.fit_result import Fit
from solver.numerics.arrays import whole_turns
from solver.problem.errors import InputError
from studies.language import case_tables
from studies.language.case_input import CaseInput, field_values

from .branches.ends_study import study_text, text_of_solution
from .run import atomic
from .stored import quantity_variables
from .words import caution_words, escaping, labels, unit_habits

STATIONS = 801
UNDETERMINED = "undetermined"  # in place of an unbounded interval


def as_dataset(found: Fit, units: dict[str, str], points: dict[str, Any] | None, wrapped: bool = False) -> xr.Dataset:
    """The dataset of a fit that has a solution.

    Dimensions: `field`, of the fitted fields, twice for matrices; `datum`, of the data; `u`, of the fitted curve;
    `point`, of measured points.
    """
    names = list(found.values)
    ds = xr.Dataset(
        {
            "value": ("field", list(found.values.values())),
            "low": ("field", [found.intervals[name][0] for name in names]),
            "high": ("field", [found.intervals[name][1] for name in names]),
            "covariance": (("field", "other_field"), found.covariance),
            "share": (("field", "datum"), np.array([found.shares[name] for name in names])),
            "group": ("datum", list(found.groups)),
            "other_minimum": (("minimum", "field"), _others(found, names)),
        },
        coords={"field": names, "unit": ("field", [quantity_variables.labels(name, units)["units"] for name in names])},
        attrs={
            "title": f"Fit: {_said(found, units)}",
            "rule": found.rule,
            "freedom": found.freedom,
            "outcome": found.outcome,
            "length_unit": units["length"],
            "exact": found.exact,
        },
    )
    seed = None if found.case.kind == "start" else found.solution
    curve = solve(found.case, stations=STATIONS, seed=seed)
    ds["alpha"], ds["z"], ds["s"] = (("u", np.asarray(getattr(curve, name))) for name in ("alpha", "z", "s"))
    ds["rho"], ds["a"] = float(found.case.rho), float(found.case.rod.a)
    ds["caution"] = str(caution_words.of_cases(curve, units=units))
    if points is not None and {"alpha", "z"} <= set(points):
        ds = ds.assign(_of_points(found, points, wrapped))
    return ds


def _said(found: Fit, units: dict[str, str]) -> str:
    """``E = 10700 N/cm² (10591 to 10812)`` or ``E undetermined`` for each field; angles in degrees."""
    parts = []
    for name, value in found.values.items():
        if np.isinf(found.intervals[name][1]):
            parts.append(f"{labels.symbol_of(name)} {UNDETERMINED}")
            continue
        unit = quantity_variables.labels(name, units)["units"]
        unit, factor = ("°", np.degrees(1.0)) if unit == "rad" else unit_habits.unit_and_size(unit, name)
        shown = unit if unit == "°" else f" {labels.unit(unit)}".rstrip()
        low, high = (f"{factor * end:.5g}" for end in found.intervals[name])
        known = "" if np.isnan(found.intervals[name][0]) else f" ({low} to {high})"
        parts.append(f"{labels.symbol_of(name)} = {factor * value:.5g}{shown}{known}")
    return labels.minus_signs(", ".join(parts))


def _others(found: Fit, names: list[str]) -> Any:
    """The other minima that the data do not exclude."""
    rows = [[minimum.values[name] for name in names] for minimum in found.minima if minimum.as_good]
    return np.array(rows).reshape(-1, len(names))


def _of_points(found: Fit, points: dict[str, Any], wrapped: bool) -> dict[str, Any]:
    """The measured points, where the rod has them, and the s there."""
    count = np.asarray(points["z"]).size
    assert found.feet is not None
    s, alpha, z = found.feet
    measured = np.asarray(points["alpha"])
    if wrapped:  # drawn on the turn of the rod that it belongs to
        measured = measured + whole_turns(alpha - measured)
    share = np.array([_by_point(found, name, count) for name in found.values])
    return {
        "measured_alpha": ("point", measured),
        "measured_z": ("point", np.asarray(points["z"])),
        "foot_s": ("point", s),
        "foot_alpha": ("point", alpha),
        "foot_z": ("point", z),
        "point_share": (("field", "point"), share),
    }


def _by_point(found: Fit, name: str, count: int) -> Any:
    """The share of each point in what is known of a field, its columns together."""
    of_points = np.array([group in ("alpha", "z", "beta", DISTANCE) for group in found.groups])
    return found.shares[name][of_points].reshape(-1, count).sum(axis=0)


POINT_COLUMNS = ("s", *COLUMNS, *(f"sigma_{name}" for name in COLUMNS))


def read_points(path: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    """The columns of measured points in a CSV or Parquet file, and their standard deviations, angles in rad.

    Raises `InputError` with the line and the column.
    """
    columns = case_tables.read(path, known=POINT_COLUMNS, of="column of measured points", row="point")
    points = {name: values for name, values in columns.items() if not name.startswith("sigma_")}
    sigma = {name.removeprefix("sigma_"): values for name, values in columns.items() if name.startswith("sigma_")}
    for name in sigma:
        if name not in points:
            raise InputError(f"{path.name} has the column sigma_{name} and no column {name}")
    return points, sigma


def study_of(found: Fit, asked: CaseInput) -> str:
    """The TOML text of a study of the fitted case; of an ends problem it names the equilibrium that was fitted."""
    title = f"Fitted {', '.join(found.values)}"
    if found.solution is None:
        return study_text(title, asked.units, field_values(found.case))
    return text_of_solution(title, asked.units, found.solution)


def table_of(found: Fit, asked: CaseInput) -> str:
    """The fitted values as CSV: field, value, low and high of its 95 % interval, unit; angles in rad."""
    names = list(found.values)
    lines: list[list[Any]] = [["field", "value", "low", "high", "unit", *(f"covariance_{name}" for name in names)]]
    for name, row in zip(names, np.asarray(found.covariance).tolist(), strict=True):
        unit = quantity_variables.labels(name, asked.units)["units"]
        lines.append([name, found.values[name], *found.intervals[name], unit, *row])
    return escaping.in_csv(lines, "\n")


def write(found: Fit, asked: CaseInput, path: Path) -> None:
    """Write the study (.toml) or the table (.csv). Raises `InputError` where the disk refuses."""
    text = study_of(found, asked) if path.suffix.lower() == ".toml" else table_of(found, asked)
    atomic.write_text(path, text)
