"""Do the laws of a stored dataset hold? Reads datasets and never solves."""

from typing import TYPE_CHECKING, Any

import numpy as np

from studies.laws import FAILS, HOLDS, Law, decide

if TYPE_CHECKING:
    import xarray as xr


WORDS = {"not-falling": "does not fall", "not-rising": "does not rise"}


def verdicts(ds: "xr.Dataset") -> list[dict[str, Any]]:
    """One row a law of the dataset, in the study's order; see `studies.laws.decide`."""
    rows = []
    for law in laws(ds):
        axes = {str(dim): ds[dim].values for dim in ds["outcome"].dims}
        observed = {name: ds[name].values for name in law.observables if name in ds}
        rows.append(decide(law, observed, axes))
    return rows


def laws(ds: "xr.Dataset") -> list[Law]:
    """The laws that the dataset's study states. Raises `InputError` where they are none."""
    from . import opening

    return opening.laws(ds)


def unsolved(ds: "xr.Dataset") -> int:
    """How many cases were not solved."""
    outcomes = np.atleast_1d(ds["outcome"].values).ravel()
    return sum(not str(text).startswith("solved") for text in outcomes)


def counted(count: int, word: str) -> str:
    """``1 case``, ``9 cases``."""
    return f"{count} {word}{'s' * (count != 1)}"


def all_well(ds: "xr.Dataset") -> bool:
    """Whether every case was solved and every law holds, at least as a trend."""
    return unsolved(ds) == 0 and all(row["verdict"] != FAILS for row in verdicts(ds))


def stated(row: dict[str, Any]) -> str:
    """The law in words: ``turns falls along E``."""
    return f"{row['observable']} {WORDS.get(row['direction'], row['direction'])} along {row['axis']}"


def measured(row: dict[str, Any]) -> str:
    """What was measured at the two ends of the axis: ``8 → 5``, or ranges over the lines of a grid."""
    return f"{_span(row['first'])} → {_span(row['last'])}"


def said(row: dict[str, Any]) -> str:
    """The verdict with what qualifies it: exceptions, lines of a grid, the reason it fails."""
    notes = [row["reason"]] if row["reason"] else []
    if row["at"]:
        notes.append(f"at {', '.join(f'{name} = {value:.4g}' for name, value in row['at'].items())}")
    if row["lines"] > 1:
        notes.append(f"{row['lines_hold']} of {row['lines']} lines hold")
    if row["exceptions"]:
        count = len(row["exceptions"])
        notes.append(f"{count} step{'s' * (count > 1)} the wrong way")
    if row["tau"] is not None and row["verdict"] != HOLDS:
        notes.append(f"tau {row['tau']:.2f}")
    return f"{row['verdict']} ({'; '.join(notes)})" if notes else row["verdict"]


def _span(ends: list[float] | None) -> str:
    if ends is None:
        return "?"
    low, high = ends
    return f"{low:.4g}" if low == high else f"{low:.4g}..{high:.4g}"
