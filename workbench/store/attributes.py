"""The attributes of a dataset that programs read: texts, numbers, laws, versions. Needs no xarray."""

import json
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from solver.problem.errors import InputError
from studies.grammar.axes import LONGEST_LINE
from studies.laws.verdicts import Law

from ..words import escaping

if TYPE_CHECKING:
    import xarray as xr

LINE, LABEL = LONGEST_LINE, 1000  # characters of an attribute of a file, and of a variable


def show(value: object) -> str:
    """A value from a file as a message may show it: on one line, at most 60 characters."""
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def text(ds: "xr.Dataset", name: str) -> str:
    """An attribute that is text, of a dataset that was not read from a file; `InputError` otherwise."""
    value = ds.attrs.get(name)
    if not isinstance(value, str):
        raise InputError(f"the dataset's attribute {name} is {'missing' if value is None else 'not text'}")
    return value


def number(ds: "xr.Dataset", name: str, path: str | Path = "the dataset") -> float:
    """An attribute that is one number; `InputError` otherwise."""
    value = np.asarray(ds.attrs.get(name))
    if value.size != 1 or value.dtype.kind not in "iuf":
        raise InputError(f"{path}: the attribute {name} must be a number, got {show(ds.attrs.get(name))}")
    return float(value.item())


def laws(ds: "xr.Dataset", path: str | Path = "the dataset") -> list[Law]:
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


def versions(ds: "xr.Dataset", path: str | Path = "the dataset") -> dict[str, str]:
    """The versions the dataset was made with, by package; `InputError` where the attribute is not such a table."""
    try:
        table = json.loads(ds.attrs["versions"])
    except (KeyError, ValueError, TypeError, RecursionError):
        table = None
    if not isinstance(table, dict) or not all(escaping.is_line(f"{a} {b}", LABEL) for a, b in table.items()):
        raise InputError(f"{path}: the attribute versions is not a table in JSON")
    return {str(name): str(number) for name, number in table.items()}
