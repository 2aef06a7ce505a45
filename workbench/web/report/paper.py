"""The paper that the report reproduces: how it is cited, and its Table 1 as the reading uses it."""

from typing import Any

from solver.problem.quantities import unit_of
from studies import TABLE_1
from studies.axes import quantity_of
from studies.readings import Reading

from ...data import labels

TITLE = (
    "Physical modeling and geometric shape simulation for one-dimensional flexible objects with cylindrical surface "
    "constraints"
)
AUTHORS = "Y. M., H. D., Q. J. and W. X."  # as the paper's list of contributions has them
JOURNAL, YEAR, DOI = "Scientific Reports 13", "2023", "10.1038/s41598-023-32064-y"
UNITS = {"length": "cm", "force": "N"}
PRINTED = {"alpha": "α₀", "beta": "β₀", "gamma": "γ₀", "dbeta": "β₀′", "dgamma": "γ₀′", "F1": "F₁₀", "F3": "F₃₀"}
VALUES = {"E": "1.07 × 10⁴", "beta": "π/6"}  # as printed, where a decimal number would not be
FROM_TEXT = "from the text below eq. (47), not from the table"


def citation() -> dict[str, str]:
    """Title, authors, journal, year and DOI."""
    return {"title": TITLE, "authors": AUTHORS, "journal": JOURNAL, "year": YEAR, "doi": DOI}


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
