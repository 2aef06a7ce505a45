"""The turntables of the report, one a panel, and beside them the observables of their rod.

A rod of Table 1 is solved again in the browser.
"""

from dataclasses import asdict
from typing import Any

import numpy as np
import xarray as xr

from solver.problem.errors import InputError
from solver.problem.quantities import QUANTITIES
from studies.language.readings import DROPPED, TABLE_1, Reading

from ...store.schema import axes_of
from ...words import labels
from ..live.presets import PRESETS, Preset
from ..turntable.stored import turntable_of_dataset

MOST_BYTES = 400_000  # of the stations of a panel
SHOWN = (
    "turns", "bend_number", "amplitude", "wraps", "height", "kappa_mean", "kappa_max", "contact_size_mean", "push_min",
    "push_max", "attached", "overlaps", "energy", "index",
)  # fmt: skip
FIELDS = ("E", "R", "beta", "F1", "dgamma", "F3")  # those that the reading uses get a slider


def figure_of(ds: xr.Dataset) -> dict[str, Any] | None:
    """The plain data of a panel's turntable; None where no case has a shape."""
    if not axes_of(ds) and (solving := _solve(ds)):
        return solving
    try:
        return turntable_of_dataset(ds, most_bytes=MOST_BYTES, facts=facts_of).data
    except InputError:
        return None


def _solve(ds: xr.Dataset) -> dict[str, Any] | None:
    """The data of the rod of Table 1, which the page solves itself; None for any other rod."""
    reading, preset = str(ds.attrs.get("reading", "")), PRESETS[0]
    if not reading or any(abs(float(ds[name]) - TABLE_1[name]) > 1e-9 for name in ("E", "R", "a", "L")):
        return None
    read = Reading(*reading.split("/"))
    fields = [name for name in FIELDS if name != DROPPED.get(read.twist)]
    state = _state(preset, reading)
    return {
        "state": state,
        "fields": fields,
        "spans": asdict(preset)["spans"],
        "quantities": {name: [row.symbol, _short(row.long_name), row.dimension] for name, row in QUANTITIES.items()},
        "letters": {name: row.symbol for name, row in QUANTITIES.items()} | {"beta": "β₀", "dbeta": "β₀′"},
        "push": labels.unit(f"{ds.attrs['force_unit']}/{ds.attrs['length_unit']}"),
    }


def _state(preset: Preset, reading: str) -> dict[str, Any]:
    return {**preset.state, "base": dict(preset.state["base"]), "reading": reading}


def _short(words: str) -> str:
    return words.partition(" (")[0]


def facts_of(case: xr.Dataset) -> list[tuple[str, str]]:
    """Long name and value of each observable of a dataset of one case; of those that it has and that are finite."""
    return [_row(case, name) for name in SHOWN if name in case and np.isfinite(case[name])]


def _row(case: xr.Dataset, name: str) -> tuple[str, str]:
    value = float(case[name])
    if name == "overlaps":
        return "passes through itself", "yes" if value else "no"
    words = "Morse index, 0 where stable" if name == "index" else labels.long_name(case[name])
    return words, labels.value(value, case[name])
