"""The observables of one case as rows of text: long name and value with its unit."""

import numpy as np
import xarray as xr

from ...words import labels

SHOWN = (
    "turns", "bend_number", "amplitude", "wraps", "height", "kappa_mean", "kappa_max", "contact_size_mean", "push_min",
    "push_max", "attached", "overlaps", "energy", "index",
)  # fmt: skip


def rows(case: xr.Dataset) -> list[tuple[str, str]]:
    """Long name and value of each observable of a dataset of one case; of those that it has and that are finite."""
    return [_row(case, name) for name in SHOWN if name in case and np.isfinite(case[name])]


def _row(case: xr.Dataset, name: str) -> tuple[str, str]:
    value = float(case[name])
    if name == "overlaps":
        return "passes through itself", "yes" if value else "no"
    words = "Morse index, 0 where stable" if name == "index" else labels.long_name(case[name])
    return words, labels.value(value, case[name])
