"""Writes a study as TOML: the keys that were given, without the defaults."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import tomli_w
from numpy.typing import NDArray

from .model import Study
from .paired import SOURCES


def dumps(study: Study, axes: Mapping[str, Mapping[str, Any]] | None = None) -> str:
    """A TOML text that loads as the same study. axes: tables, as of `told`, that replace those of the study.

    Comments of the original text are lost.
    """
    said = study.model_dump(by_alias=True, exclude_unset=True, exclude_none=True)
    return tomli_w.dumps({**said, "axes": {**said["axes"], **axes}} if axes else said)


def dumps_paired(study: Study, fields: Mapping[str, NDArray[np.float64]]) -> str:
    """A TOML text of the study with these samples, field -> values, as lists of [zip]."""
    said = study.model_dump(by_alias=True, exclude_unset=True, exclude_none=True, exclude={*SOURCES})
    return tomli_w.dumps({**said, "zip": {name: values.tolist() for name, values in fields.items()}})


def dumps_table(study: Study, file: str, fields: Sequence[str]) -> str:
    """A TOML text of the study whose samples are these columns of a table of cases."""
    said = study.model_dump(by_alias=True, exclude_unset=True, exclude_none=True, exclude={*SOURCES})
    return tomli_w.dumps({**said, "table": {"file": file, "columns": [*fields]}})


def axis_table(values: NDArray[np.float64]) -> dict[str, Any]:
    """The table of an axis with exactly these values, (n,): from, to and count if these reproduce them, else a list."""
    first, last, count = float(values[0]), float(values[-1]), values.size
    if count > 2:
        even = {"from": first, "to": last, "count": count}
        if np.array_equal(np.linspace(first, last, count), values):
            return even
        if first * last > 0 and np.array_equal(np.geomspace(first, last, count), values):
            return {**even, "spacing": "geometric"}
    return {"values": [float(value) for value in values]}
