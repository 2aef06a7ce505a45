"""Accuracy against cost: every method over a ladder of its knob on the named cases, as a dataset."""

from collections.abc import Callable, Generator, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from solver import InputError
from solver.benchmark import STATIONS, Row, available_ladders, cheapest, measure
from solver.methods import METHODS
from solver.methods.base import Ladder
from solver.problem.errors import choices, no_such

from ..store import dataset
from .trade_cases import CASES, Named, reference

LEVELS = (1e-3, 1e-6, 1e-9, 1e-12)
NOT_OF_KIND = "not tried: it solves another kind of problem"
LABELS = {
    "seconds": ("s", "time of the whole call, least of the repeats, warm-up not counted"),
    "evaluations": ("1", "evaluations of the equation, those that measure the error among them"),
    "error_beta": ("rad", "largest error of the angle"),
    "error_position": ("1", "largest error of position over the larger of rho and L"),
    "error_contact": ("1", "largest error of contact over its largest size"),
    "error": ("1", "the larger of the errors of angle and position"),
    "estimate": ("1", "the error that the method itself states"),
    "condition": ("1", "the condition number that the method itself states"),
    "drift_h": ("1", "largest change of the first integral h rho^2 along the rod"),
    "drift_FZ": ("1", "largest difference of axial force from its load, over A/rho^2"),
    "drift_MZ": ("1", "largest difference of axial moment from its load, over A/rho"),
}


def rows_of(
    cases: Mapping[str, Named], ladders: Mapping[str, Ladder], step: Callable[[str], None]
) -> Generator[list[Row]]:
    """The measurements of each case in turn, so that an interrupted comparison keeps the cases before.

    Parameters
    ----------
    cases, ladders
        By name; a ladder of the other kind of problem gives no row.
    step
        Called with the name of each case before it is measured.
    """
    for name, entry in cases.items():
        step(name)
        yield measure({name: (entry.case, reference(name), entry.slope)}, ladders)


def check_kinds(cases: Mapping[str, Named], ladders: Mapping[str, Ladder]) -> None:
    """Raise `InputError` if no ladder solves the kind of problem of any case."""
    kinds = {entry.case.kind for entry in cases.values()}
    if not any(kinds & set(METHODS[ladder.method].problems) for ladder in ladders.values()):
        raise InputError(f"none of {choices(ladders)} solves problems of the kind of {choices(cases)}")


def ladders_of(names: Sequence[str]) -> dict[str, Ladder]:
    """The ladders of these names, or of the methods of these names; default: all that can run here.

    Raises `InputError` for an unknown name, and for a method that is not installed.
    """
    able = available_ladders()
    if not names:
        return able
    picked: dict[str, Ladder] = {}
    for name in names:
        matches = {label: ladder for label, ladder in able.items() if name in (label, ladder.method)}
        if not matches and name in METHODS:
            METHODS[name].with_knobs({})  # says that its package is not installed
        if not matches:
            raise no_such("method", name, able)
        picked |= matches
    return picked


def dataset_of(rows: Sequence[Row], ladders: Mapping[str, Ladder]) -> xr.Dataset:
    """The measurements, at least one, over (case, ladder, rung); NaN: not tried.

    `knob` (ladder) names the knob of each ladder and `value` (ladder, rung) holds its values.
    """
    cases = list(dict.fromkeys(row.case for row in rows))
    methods = [name for name in ladders if any(row.ladder == name for row in rows)]
    longest = max(len(ladders[name].values) for name in methods)
    shape = len(cases), len(methods), longest
    numbers = {name: np.full(shape, np.nan) for name in LABELS}
    outcome, answered = np.full(shape, NOT_OF_KIND, dtype=object), np.full(shape, "", dtype=object)
    for j, name in enumerate(methods):
        outcome[:, j, len(ladders[name].values) :] = "not tried: the ladder ends before"
    for row in rows:
        at = cases.index(row.case), methods.index(row.ladder), ladders[row.ladder].values.index(row.value)
        outcome[at], answered[at] = row.outcome, row.answered
        for name, values in numbers.items():
            values[at] = getattr(row, name)
    value = np.full(shape[1:], np.nan)
    for j, name in enumerate(methods):
        value[j, : len(ladders[name].values)] = ladders[name].values
    full = ("case", "ladder", "rung")
    data: dict[str, Any] = {
        name: xr.Variable(full, values, {"units": LABELS[name][0], "long_name": LABELS[name][1]})
        for name, values in numbers.items()
    }
    data["outcome"] = xr.Variable(full, outcome.astype(str), {"long_name": "solved, or why not"})
    data["answered"] = xr.Variable(full, answered.astype(str), {"long_name": "the method whose answer it is"})
    data["value"] = xr.Variable(full[1:], value, {"units": "1", "long_name": "value of the knob"})
    data["knob"] = xr.Variable(("ladder",), [ladders[name].knob for name in methods], {"long_name": "knob turned"})
    kinds = [CASES[name].case.kind for name in cases]
    data["kind"] = xr.Variable(("case",), kinds, {"long_name": "what is given"})
    data["about"] = xr.Variable(("case",), [CASES[name].about for name in cases], {"long_name": "the case in words"})
    known = [reference(name).condition for name in cases]
    words = "growth of a change of the start, of the reference"
    data["reference_condition"] = xr.Variable(("case",), known, {"units": "1", "long_name": words})
    return xr.Dataset(
        data | _best(rows, cases), {"case": cases, "ladder": methods, "level": list(LEVELS)}, _attributes()
    )


def _best(rows: Sequence[Row], cases: Sequence[str]) -> dict[str, Any]:
    """The cheapest method and its seconds over (case, level); empty and NaN where none reaches the level."""
    method = np.full((len(cases), len(LEVELS)), "", dtype=object)
    seconds = np.full(method.shape, np.nan)
    for k, level in enumerate(LEVELS):
        for name, row in cheapest(rows, level).items():
            if row is not None:
                method[cases.index(name), k], seconds[cases.index(name), k] = row.ladder, row.seconds
    dims = ("case", "level")
    return {
        "cheapest": xr.Variable(dims, method.astype(str), {"long_name": "the method that reaches the level soonest"}),
        "cheapest_seconds": xr.Variable(dims, seconds, {"units": "s", "long_name": "time that it takes"}),
    }


def advice(ds: xr.Dataset) -> list[dict[str, Any]]:
    """For each kind of problem and each level the method that reaches it in the most cases, the fastest of these.

    Rows of kind, level, method (None where none reaches it), reached (cases), cases, and seconds (the median over the
    cases that it reaches). Of two methods that reach as many cases, the one that is faster in the median ratio on the
    cases of both is taken.
    """
    rows = []
    for kind in dict.fromkeys(ds["kind"].values.tolist()):
        of_kind = ds.isel(case=np.flatnonzero(ds["kind"].values == kind))
        good = of_kind["seconds"].where(np.char.startswith(of_kind["outcome"].values.astype(str), "solved"))
        for level in ds["level"].values:
            seconds = good.where(of_kind["error"] <= level).min("rung").transpose("case", "ladder").values
            reached = np.isfinite(seconds).sum(axis=0)
            row = {"kind": str(kind), "level": float(level), "method": None, "reached": 0, "cases": seconds.shape[0],
                   "seconds": None}  # fmt: skip
            if reached.max(initial=0):
                best = np.flatnonzero(reached == reached.max())
                fastest = np.fmin.reduce(seconds[:, best], axis=1, keepdims=True)
                column = best[np.argmin(np.nanmedian(seconds[:, best] / fastest, axis=0))]
                row |= {"method": str(ds["ladder"].values[column]), "reached": int(reached[column]),
                        "seconds": float(np.nanmedian(seconds[:, column]))}  # fmt: skip
            rows.append(row)
    return rows


def _attributes() -> dict[str, Any]:
    return {
        "title": "Accuracy against cost",
        "study_name": "trade",
        "reading": "",
        "laws": "[]",
        "stations": STATIONS,
        **dataset.provenance(measured=True),
    }


def summary_of(ds: xr.Dataset) -> dict[str, Any]:
    """The table of the cheapest methods and the counts of the outcomes of a stored comparison, as plain data."""
    table = [
        {"case": str(case), "about": str(ds["about"].sel(case=case).item()), "cheapest": [
            {"level": float(level), "method": str(ds["cheapest"].sel(case=case, level=level).item()) or None,
             "seconds": float(ds["cheapest_seconds"].sel(case=case, level=level).item())}
            for level in ds["level"].values]}
        for case in ds["case"].values
    ]  # fmt: skip
    outcomes, counts = np.unique(ds["outcome"].values.astype(str), return_counts=True)
    return {
        "title": str(ds.attrs["title"]),
        "machine": str(ds.attrs["machine"]),
        "cases": [str(case) for case in ds["case"].values],
        "methods": [str(method) for method in ds["ladder"].values],
        "table": table,
        "advice": advice(ds),
        "solved": int(sum(n for text, n in zip(outcomes, counts, strict=True) if text.startswith("solved"))),
        "failed": int(sum(n for text, n in zip(outcomes, counts, strict=True) if text.startswith("failed"))),
        "not run": int(sum(n for text, n in zip(outcomes, counts, strict=True) if text.startswith("not run"))),
    }
