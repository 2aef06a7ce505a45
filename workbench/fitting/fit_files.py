"""The files of a fit: measured points that it reads, the fitted case as a study, the fitted values as a table."""

import csv
import io
from pathlib import Path
from typing import Any

import numpy as np

from solver import Ends, observe
from solver.inverse.data import COLUMNS
from solver.inverse.fit_result import Fit
from solver.problem.errors import InputError
from studies.language import tables

from ..branches.ends_study import study_text
from ..store import atomic, schema
from ..store.case_input import CaseInput, field_values

POINT_COLUMNS = ("s", *COLUMNS, *(f"sigma_{name}" for name in COLUMNS))


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


def study(found: Fit, asked: CaseInput) -> str:
    """The TOML text of a study of the fitted case; of an ends problem it names the equilibrium that was fitted."""
    title = f"Fitted {', '.join(found.values)}"
    text = study_text(title, asked.units, field_values(found.case))
    if not isinstance(found.case.given, Ends):
        return text
    assert found.solution is not None
    energy = float(observe(found.solution, ["energy"])["energy"])
    dbeta0 = float(found.solution.dbeta[0])
    return f"{text}\n[equilibrium]\ndbeta0 = {dbeta0!r}\nenergy = {energy!r}\n"


def table(found: Fit, asked: CaseInput) -> str:
    """The fitted values as CSV: field, value, low and high of its 95 % interval, unit; angles in rad."""
    names = list(found.values)
    lines = io.StringIO()
    writer = csv.writer(lines, lineterminator="\n")
    writer.writerow(["field", "value", "low", "high", "unit", *(f"covariance_{name}" for name in names)])
    for name, row in zip(names, np.asarray(found.covariance).tolist(), strict=True):
        unit = schema.labels(name, asked.units)["units"]
        writer.writerow([name, found.values[name], *found.intervals[name], unit, *row])
    return lines.getvalue()


def write(found: Fit, asked: CaseInput, path: Path) -> None:
    """Write the study (.toml) or the table (.csv). Raises `InputError` where the disk refuses."""
    text = study(found, asked) if path.suffix.lower() == ".toml" else table(found, asked)
    atomic.write(path, lambda aside: aside.write_text(text, encoding="utf-8"))
