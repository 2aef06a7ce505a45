"""The numbers of a study without a unit that are read in rad, but look like degrees."""

from collections.abc import Iterator, Mapping
from itertools import chain
from typing import Any

import numpy as np

from solver.problem.angles import doubt

from ..grammar.axes import is_angle
from ..grammar.dimensions import Values

Where = tuple[str | int, ...]


def of_study(data: Mapping[str, Any], cases: Mapping[str, Values] | None = None) -> list[tuple[Where, str]]:
    """The key and the notice of each such number.

    data: the tables of a valid study, as the file has them. cases: the columns of its table of cases.
    """
    columns = ((("table", name), values[np.abs(values) > np.pi]) for name, values in (cases or {}).items())
    every = chain(_angles(data), ((where, values) for where, values in columns if is_angle(where[1])))
    said = ((where, doubt(str(where[1]), value)) for where, value in every)
    return [(where, sentence) for where, sentence in said if sentence]


def _angles(data: Mapping[str, Any]) -> Iterator[tuple[Where, Any]]:
    """The key of each angle, and the values that have no key `unit` beside them."""
    for table in ("base", "zip"):
        for name, value in (data.get(table) or {}).items():
            if is_angle(name):
                yield (table, name), value
    for table in ("axes", "sample"):
        for name, value in (data.get(table) or {}).items():
            if is_angle(name) and isinstance(value, dict) and "unit" not in value:
                yield (table, name), [value[key] for key in ("values", "from", "to", "mean", "std") if key in value]
