"""The commands list, run and check."""

from pathlib import Path
from typing import Any

import xarray as xr

from solver.quantities import unit_of
from studies import load, names
from studies.axes import Axis, quantity_of

from . import check, console, runner, store
from .fidelity import fidelity


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
        laws = ", ".join(f"{v['claim']} {v['observable']} {v['direction']} along {v['axis']}" for v in row["laws"])
        told.append([row["study"], row["title"], axes or "-", laws or "-"])
    console.print_table(["study", "title", "axes", "laws"], told)


def run_study(
    name: str,
    out: Path | None,
    reading: str | None,
    tol: float | None,
    method: str | None,
    force: bool,
    json: bool,
    level: str | None = None,
    stations: int | None = None,
) -> int:
    """Run a study, store it and print its verdicts; 0, or 1 where a law fails or a case is unsolved.

    level: the name of a fidelity; a tolerance or stations beside it replace the fidelity's own.
    """
    study = load(name).under(reading)
    if level is not None:
        study = fidelity(level).of(study)
    if stations is not None:
        study = study.at_stations(stations)
    path = out or Path(f"{study.name}.h5")
    if not force:
        store.check_free(path, study.name)
    store.check_parent(path)
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
        counts["caution"] = ds.attrs.get("caution", "")
        console.print_json({**told, **counts, "laws": check.verdicts(ds), "status": status})
        return status
    reading = f", {ds.attrs['reading']}" if ds.attrs["reading"] else ""
    console.say(f"{ds.attrs['title']}{reading}")
    if rows := verdict_rows(ds):
        console.print_table(["claim", "law", "measured", "verdict"], rows)
    console.say(f"{path}: {check.counted(ds['outcome'].size, 'case')}, {check.unsolved(ds)} unsolved")
    for text in outcomes:
        if text != "solved":
            console.say(f"  {int((ds['outcome'].values == text).sum())} x {text}")
    if ds.attrs.get("caution"):
        console.say(f"caution: {ds.attrs['caution']}")
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
