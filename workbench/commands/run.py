"""The commands list, run and check."""

from collections import Counter
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from solver.problem.quantities import unit_of
from studies import load, names
from studies.axes import Axis, quantity_of

from ..data import branch_numbers, cautions, law_verdicts
from ..run import memory
from ..run.block import kind_of
from ..run.fidelity import fidelity
from ..run.resume import look
from ..run.study_store import DEFAULT, Options, Ran, run_to_file
from . import console, progress

if TYPE_CHECKING:  # a finished study is answered without it
    import xarray as xr


def listed() -> list[dict[str, Any]]:
    """The shipped studies as plain data: study, title, axes (axis, from, to, count, unit, follow) and laws.

    from is None where an axis is followed from the base rod's own value; angles in the unit named.
    """
    rows = []
    for name in names():
        study = load(name)
        units = study.unit_system
        axes = [_axis(field, axis, unit_of(quantity_of(field).name, units)) for field, axis in study.axes.items()]
        laws = [{key: getattr(law, key) for key in ("claim", "observable", "direction", "axis")} for law in study.laws]
        rows.append({"study": name, "title": study.title, "axes": axes, "laws": laws})
    return rows


def list_studies(json: bool) -> None:
    """Print the shipped studies."""
    rows = listed()
    if json:
        console.print_json(rows)
        return
    told = []
    for row in rows:
        axes = ", ".join(_told(axis) for axis in row["axes"])
        laws = ", ".join(f"{law['claim']} {law_verdicts.stated(law)}" for law in row["laws"])
        told.append([row["study"], row["title"], axes or "-", laws or "-"])
    console.print_table(["study", "title", "axes", "laws"], told)


def run_study(
    name: str,
    out: Path | None,
    reading: str | None,
    tol: float | None,
    method: str | None,
    force: bool,
    level: str | None = None,
    stations: int | None = None,
    options: Options = DEFAULT,
    json: bool = False,
) -> int:
    """Run a study, store it and print its verdicts; the exit status is that of `check.status`.

    level: the name of a fidelity; a tolerance or stations beside it replace the fidelity's own.
    """
    study = load(name).under(reading)
    if level is not None:
        study = fidelity(level).of(study)
    if stations is not None:
        study = study.at_stations(stations)
    path = out or Path(f"{study.name}.h5")
    asked = {name: value for name, value in (("tol", tol), ("method", method)) if value is not None}
    study = study.model_copy(update=asked)
    _check_free(path, study.name, force)
    memory.keep()
    say = (lambda text: None) if json else console.say
    ran = run_to_file(study, path, options, say, partial(progress.shown, as_json=json))
    told = {"title": study.title, "study": study.name, "reading": study.reading or "", "file": str(path)}
    return _print({**told, **ran.told}, json, ran)


def _check_free(path: Path, name: str, force: bool) -> None:
    """Raise `InputError` unless nothing is at `path` or what may give way; xarray is left alone where that is clear."""
    there = look(path)
    if force or (there is not None and there.name == name):
        return
    from ..data import writing

    writing.check_free(path, name)


def check_file(path: Path, json: bool) -> int:
    """Print the verdicts of a stored dataset; the exit status is that of `check.status`."""
    from ..data import file_checks, reading

    with reading.opened(path) as ds, file_checks.refusing(path):
        told = _told_of(ds, path)
    return _print(told, json)


def _told_of(ds: "xr.Dataset", path: Path) -> dict[str, Any]:
    """What is said of a dataset, from its numbers."""
    from ..data import law_verdicts

    outcomes, caution = ([str(text) for text in np.ravel(ds[name].values)] for name in ("outcome", "caution"))
    counts = branch_numbers.counted(ds["branch"].values) if "branch" in ds else None
    return {
        "title": ds.attrs["title"],
        "study": ds.attrs["study_name"],
        "equilibria": str(ds.attrs.get("equilibria", "")),
        "branches": branch_numbers.sentence(counts) if counts else "",
        "reading": ds.attrs["reading"],
        "file": str(path),
        "unsolved": law_verdicts.unsolved(ds),
        "outcomes": Counter(map(kind_of, outcomes)),
        "cautions": Counter(caution),
        "laws": law_verdicts.verdicts(ds),
    }


def verdict_rows(verdicts: list[dict[str, Any]]) -> list[list[str]]:
    """Table rows of laws, each with its alternatives below it: claim, law, measured, verdict."""
    rows = []
    for row in verdicts:
        rows.append([row["claim"], law_verdicts.stated(row), law_verdicts.measured(row), law_verdicts.said(row)])
        for also in row["also"]:
            rows.append(["", f"  or {also['observable']}", law_verdicts.measured(also), law_verdicts.said(also)])
    return rows


def _print(told: dict[str, Any], as_json: bool, ran: Ran | None = None) -> int:
    """Print what is in a file and, after a run, what that did; the exit status is that of `check.status`."""
    outcomes, cases, unsolved = told["outcomes"], sum(told["outcomes"].values()), told["unsolved"]
    status = law_verdicts.status(unsolved, told["laws"])
    caution = cautions.told(told["cautions"])
    if as_json:
        counts = {"cases": cases, "unsolved": unsolved, "outcomes": sorted(outcomes), "caution": caution}
        run = {} if ran is None else {"solved_now": ran.solved, "seconds": ran.seconds}
        named = {name: told[name] for name in ("study", "reading", "file")}
        named |= {name: told[name] for name in ("equilibria", "branches") if told.get(name)}
        laws = {"verdicts": law_verdicts.tally(told["laws"]), "laws": told["laws"]}
        console.print_json({**named, **counts, **run, **laws, "status": status})
        return status
    console.say(f"{told['title']}, {told['reading']}" if told["reading"] else told["title"])
    if rows := verdict_rows(told["laws"]):
        console.print_table(["claim", "law", "measured", "verdict"], rows)
        console.say(law_verdicts.tallied(told["laws"]))
    console.say(f"{told['file']}: {law_verdicts.counted(cases, 'case')}, {unsolved} unsolved")
    for text, count in sorted(outcomes.items()):
        if text != "solved":
            console.say(f"  {count} x {text}")
    for name in ("equilibria", "branches"):
        if told.get(name):
            console.say(told[name])
    if caution:
        console.say(f"caution: {caution}")
    if ran is not None and ran.finished_before:
        console.say("finished before; --restart solves it again")
    return status


def _axis(field: str, axis: Axis, unit: str) -> dict[str, Any]:
    first, last = (axis.values[0], axis.values[-1]) if axis.values else (axis.from_, axis.to)
    told = {"axis": field, "from": first, "to": last, "count": axis.size, "unit": axis.unit or unit}
    return {**told, "follow": axis.follow}


def _told(axis: dict[str, Any]) -> str:
    unit = "deg" if axis["unit"] == "deg" else ""
    if axis["follow"]:
        return f"{axis['axis']} followed to {axis['to']:g}{unit}"
    return f"{axis['axis']} {axis['from']:g}..{axis['to']:g}{unit} ({axis['count']})"
