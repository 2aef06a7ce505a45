"""The command trade: every method over its ladder on the named cases, stored, drawn, and the cheapest told."""

import json
import os
import platform
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from solver import Ends, InputError
from solver.benchmark import STATIONS, Ladder, Row, cheapest, measure, offered
from solver.methods import MISSING
from solver.problem.errors import no_such

from ..commands import console
from ..data import dataset, writing
from ..figures import canvas, work_precision
from .trade_cases import CASES, chosen, reference

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


def trade(cases: Sequence[str], methods: Sequence[str], out: Path, json: bool) -> int:
    """Measure, store trade.h5, draw trade_seconds.png and trade_evaluations.png in the folder, print the table.

    Interrupted, it stores and draws the cases that are finished as trade_interrupted; trade.h5 stays as it was.
    """
    named, ladders = chosen(_words(cases)), ladders_of(_words(methods))
    writing.check_folder(out)
    writing.check_free(out / "trade.h5", "trade")
    rows: list[Row] = []
    try:
        with console.progress(len(named), lines=True) as step:
            for name, one in named.items():
                step(name)
                rows += measure({name: (one.case, reference(name), one.slope)}, ladders)
    except BaseException as error:
        done = list(dict.fromkeys(row.case for row in rows))
        files = _stored(rows, ladders, out, "trade_interrupted")[1] if rows else []
        console.stopped(error, f"{len(done)} of {len(named)} cases", files)
        raise
    if not rows:
        raise InputError(f"none of {', '.join(ladders)} solves problems of the kind of {', '.join(named)}")
    ds, files = _stored(rows, ladders, out, "trade")
    if json:
        console.print_json(told(ds) | {"file": str(files[0]), "pictures": [str(picture) for picture in files[1:]]})
    else:
        _print(ds, files)
    return 0


def _stored(rows: Sequence[Row], ladders: Mapping[str, Ladder], out: Path, name: str) -> tuple[xr.Dataset, list[Path]]:
    """The dataset of the rows, and the files made of it: NAME.h5 and its pictures."""
    ds = labelled(rows, ladders)
    path = writing.write(ds, out / f"{name}.h5")
    pictures = [out / f"{name}_{cost}.png" for cost in work_precision.COSTS]
    for cost, picture in zip(work_precision.COSTS, pictures, strict=True):
        canvas.save(work_precision.figure(ds, cost), picture)
    return ds, [path, *pictures]


def ladders_of(names: Sequence[str]) -> dict[str, Ladder]:
    """The ladders of these names, or of these methods; all that can run for none. Raises `InputError`."""
    able = offered()
    if not names:
        return able
    picked: dict[str, Ladder] = {}
    for name in names:
        found = {label: ladder for label, ladder in able.items() if name in (label, ladder.method)}
        if not found and name in MISSING:
            raise InputError(MISSING[name])
        if not found:
            raise no_such("method", name, able)
        picked |= found
    return picked


def labelled(rows: Sequence[Row], ladders: Mapping[str, Ladder]) -> xr.Dataset:
    """The rows over (case, ladder, rung); a ladder's rungs are `knob` and `value`, what it never tried is NaN."""
    cases = list(dict.fromkeys(row.case for row in rows))
    methods = [name for name in ladders if any(row.ladder == name for row in rows)]
    longest = max(len(ladders[name].values) for name in methods)
    shape = len(cases), len(methods), longest
    numbers = {name: np.full(shape, np.nan) for name in LABELS}
    outcome = np.full(shape, NOT_OF_KIND, dtype=object)
    for j, name in enumerate(methods):
        outcome[:, j, len(ladders[name].values) :] = "not tried: the ladder ends before"
    for row in rows:
        at = cases.index(row.case), methods.index(row.ladder), ladders[row.ladder].values.index(row.value)
        outcome[at] = row.outcome
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
    data["value"] = xr.Variable(full[1:], value, {"units": "1", "long_name": "value of the knob"})
    data["knob"] = xr.Variable(("ladder",), [ladders[name].knob for name in methods], {"long_name": "knob turned"})
    kinds = ["ends" if isinstance(CASES[name].case.given, Ends) else "start" for name in cases]
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


def _attributes() -> dict[str, Any]:
    return {
        "title": "Accuracy against cost",
        "study_name": "trade",
        "reading": "",
        "laws": "[]",
        "stations": STATIONS,
        "machine": f"{platform.machine()}, {os.cpu_count()} cores, {platform.system()}",
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "versions": json.dumps(dataset.versions()),
    }


def told(ds: xr.Dataset) -> dict[str, Any]:
    """The table and the failures of a stored trade as plain data."""
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
        "solved": int(sum(n for text, n in zip(outcomes, counts, strict=True) if text.startswith("solved"))),
        "failed": int(sum(n for text, n in zip(outcomes, counts, strict=True) if text.startswith("failed"))),
        "not run": int(sum(n for text, n in zip(outcomes, counts, strict=True) if text.startswith("not run"))),
    }


def _print(ds: xr.Dataset, files: Sequence[Path]) -> None:
    data = told(ds)
    rows = [
        [
            row["case"],
            *(f"{b['method']}  {1e3 * b['seconds']:.2g} ms" if b["method"] else "none" for b in row["cheapest"]),
        ]
        for row in data["table"]
    ]
    console.print_table(["cheapest method for", *(f"{level:.0e}" for level in LEVELS)], rows)
    console.say("")
    counts = f"{data['solved']} rungs solved, {data['failed']} failed, {data['not run']} too long to run"
    console.say(f"{counts}; {data['machine']}")
    for file in files:
        console.say(str(file))


def _words(texts: Sequence[str]) -> list[str]:
    """Each option may be given several times, and may hold several names with commas between."""
    return [word.strip() for text in texts for word in text.split(",") if word.strip()]
