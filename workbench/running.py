"""The commands list, run and check."""

from pathlib import Path
from typing import Any

import xarray as xr

from studies import load, names
from studies.axes import Axis

from . import check, console, runner, store
from .fidelity import fidelity


def listed() -> list[dict[str, Any]]:
    """The shipped studies: name, title, axes and laws, in words."""
    rows = []
    for name in names():
        study = load(name)
        axes = ", ".join(_told(field, axis) for field, axis in study.axes.items())
        laws = ", ".join(f"{v.claim} {v.observable} {v.direction} along {v.axis}" for v in study.laws)
        rows.append({"study": name, "title": study.title, "axes": axes or "-", "laws": laws or "-"})
    return rows


def run_study(
    name: str,
    out: Path | None,
    reading: str | None,
    tol: float | None,
    method: str | None,
    force: bool,
    json: bool,
    level: str | None = None,
) -> int:
    """Run a study, store it and print its verdicts; 0, or 1 where a law fails or a case is unsolved.

    level: the name of a fidelity; a tolerance beside it replaces the fidelity's own.
    """
    study = load(name).under(reading)
    if level is not None:
        study = fidelity(level).of(study)
    path = out or Path(f"{study.name}.h5")
    if not force:
        store.check_free(path, study.name)
    store.check_folder(path.parent)
    with console.progress(1) as step:
        step(study.name)
        ds = runner.run(study, tol, method)
    store.write(ds, path, force)
    return _report(ds, path, json)


def check_file(path: Path, json: bool) -> int:
    """Print the verdicts of a stored dataset; 0, or 1 where a law fails or a case is unsolved."""
    return _report(store.read(path), path, json)


def verdict_rows(ds: xr.Dataset) -> list[list[str]]:
    """Table rows of a dataset's laws, each with its alternatives below it: claim, law, measured, verdict."""
    rows = []
    for row in check.verdicts(ds):
        rows.append([row["claim"], check.stated(row), check.measured(row), check.said(row)])
        for also in row["also"]:
            rows.append(["", f"  or {also['observable']}", check.measured(also), check.said(also)])
    return rows


def _report(ds: xr.Dataset, path: Path, json: bool) -> int:
    status = 0 if check.all_well(ds) else 1
    outcomes = sorted({str(text) for text in ds["outcome"].values.ravel()})
    if json:
        told = {"study": ds.attrs["study_name"], "reading": ds.attrs["reading"], "file": str(path)}
        counts = {"cases": ds["outcome"].size, "unsolved": check.unsolved(ds), "outcomes": outcomes}
        console.print_json({**told, **counts, "laws": check.verdicts(ds), "status": status})
        return status
    reading = f", {ds.attrs['reading']}" if ds.attrs["reading"] else ""
    console.say(f"{ds.attrs['title']}{reading}")
    if rows := verdict_rows(ds):
        console.print_table(["claim", "law", "measured", "verdict"], rows)
    console.say(f"{path}: {ds['outcome'].size} cases, {check.unsolved(ds)} unsolved")
    for text in outcomes:
        if text != "solved":
            console.say(f"  {int((ds['outcome'].values == text).sum())} x {text}")
    return status


def _told(field: str, axis: Axis) -> str:
    if axis.follow:
        return f"{field} followed to {axis.to:g}{axis.unit or ''}"
    first, last = (axis.values[0], axis.values[-1]) if axis.values else (axis.from_, axis.to)
    return f"{field} {first:g}..{last:g}{axis.unit or ''} ({axis.size})"
