"""Where the numbers of the report come from: the files of its studies, their versions, the paper and its Table 1."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from solver.problem.quantities import unit_of
from studies import TABLE_1
from studies.grammar.axes import quantity_of
from studies.paper.readings import Reading

from ..stored.stored_study import StoredStudy
from ..words import labels

WORKBENCH = "rod-workbench"
LEAST_ERROR = 1e-16  # rad, that of a float near 1: a smaller bound says nothing


@dataclass(frozen=True, eq=False)
class ReportedStudy:
    """A stored study of the report, and its files.

    path: the stored file. pictures: name -> file. caption: the sentences of the diagram.
    """

    stored: StoredStudy
    path: Path | None = None
    pictures: Mapping[str, Path] = field(default_factory=dict)
    caption: Sequence[str] = ()


def row(result: ReportedStudy) -> dict[str, Any]:
    """The file of a study, its method and its errors."""
    stored = result.stored
    error, condition = (np.asarray(stored[name].values, dtype=float) for name in ("error", "condition"))
    return {
        "name": str(stored.attrs["study_name"]),
        "file": result.path.name if result.path else "",
        "cases": int(stored["outcome"].size),
        "unsolved": stored.unsolved,
        "method": str(stored.attrs["method"]),
        "tolerance": labels.typeset(f"{float(stored.attrs['tolerance']):g}"),
        "error": labels.typeset(f"{np.nanmax(error):.1e}") if np.isfinite(error).any() else "–",
        "condition": labels.typeset(f"{np.nanmax(condition):.3g}") if np.isfinite(condition).any() else "–",
    }


def least_bound(results: Sequence[ReportedStudy]) -> str:
    """The least power of ten above the estimated error [rad] of every solved case: ``10⁻⁷``."""
    errors = [np.nanmax(result.stored["error"].values, initial=0.0) for result in results]
    return labels.power_of_ten(10.0 ** np.ceil(np.log10(max(*errors, LEAST_ERROR))))


def versions(datasets: Sequence[StoredStudy]) -> list[tuple[str, str]]:
    """Every package that the datasets name, with its version; where they differ, with each version and its studies."""
    packages: dict[str, dict[str, list[str]]] = {}
    for stored in datasets:
        for package, version in stored.versions.items():
            packages.setdefault(package, {}).setdefault(version, []).append(str(stored.attrs["study_name"]))
    return [(package, _each(of)) for package, of in packages.items()]


def version(datasets: Sequence[StoredStudy]) -> str:
    """The version of the workbench that made the datasets, or each of its versions and the studies made with it."""
    return dict(versions(datasets)).get(WORKBENCH, "")


def _each(of: dict[str, list[str]]) -> str:
    """``0.2.0``, or ``0.1.0 (fig6) and 0.2.0 (fig7_1_modulus, readings)``."""
    if len(of) == 1:
        return next(iter(of))
    return " and ".join(f"{version} ({', '.join(studies)})" for version, studies in of.items())


UNITS = {"length": "cm", "force": "N"}
PRINTED = {"alpha": "α₀", "beta": "β₀", "gamma": "γ₀", "dbeta": "β₀′", "dgamma": "γ₀′", "F1": "F₁₀", "F3": "F₃₀"}
VALUES = {"E": "1.07 × 10⁴", "beta": "π/6"}  # as printed, where a decimal number would not be
FROM_TEXT = "from the text below eq. (47), not from the table"


def table_1(reading: str) -> list[dict[str, str]]:
    """The rows of Table 1: symbol, quantity, value with unit, and what the reading makes of it.

    reading: as ``force-first/tension/paper``; "" for none.
    """
    read = Reading(*reading.split("/")) if reading else None
    return [_row(name, value, read) for name, value in TABLE_1.items()]


def _row(name: str, value: float, read: Reading | None) -> dict[str, Any]:
    quantity = quantity_of(name)
    unit = labels.unit(unit_of(quantity.name, UNITS))
    meaning = FROM_TEXT if name == "L" else read.meaning(name) if read else ""
    return {
        "symbol": PRINTED.get(name, quantity.symbol),
        "words": labels.typeset(quantity.long_name.partition(" (")[0]),
        "value": f"{VALUES.get(name, labels.minus_signs(labels.number(value)))} {unit}".strip(),
        "meaning": labels.typeset(meaning.replace("F10", "F₁₀").replace("F30", "F₃₀")),
    }
