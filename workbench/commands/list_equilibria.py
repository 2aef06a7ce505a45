"""The command equilibria: every shape between two ends; listed, drawn, followed over an axis, written as cases."""

from collections.abc import Mapping
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np

from solver import Case, Ends, InputError, solve
from solver import equilibria as every_equilibrium
from solver.boundary.selection import selection
from solver.equilibria import Equilibrium, meant
from solver.problem.errors import choices
from studies import Study, load
from studies.angles import angle
from studies.axes import CYLINDER, ENDS, ROD, WORDS, quantity_of
from studies.loader import loads

from ..data import writing
from ..run.sweep import rule_of
from . import console, output_file
from .own_case import own_case, with_fields
from .solve import which_of

DEFAULT = "fig7_4_end_angle"
OWN = "equilibria"  # the name of a study made of options
TABLE_UNITS = {"length": "cm", "force": "N"}
MOST = 401  # values of an axis
NAMES = tuple(name for name in (*ROD, *CYLINDER, *ENDS) if name not in (*WORDS, "alpha", "gamma"))
COLUMNS = ("dbeta0", "energy", "turns", "index", "stray", "attached")


def run(
    file: Path | None,
    options: dict[str, Any],
    axis: str | None,
    plot: Path | None,
    out: Path | None,
    export: Path | None,
    json: bool,
    force: bool = False,
    units: dict[str, str] | None = None,
    choose: str | None = None,
) -> int:
    """List, draw, store or export; 0, or 1 where there is none or the list is a part only.

    units: of length and force, where the options say them: then the rod is that of the options alone. choose: the rule
    of `solve` whose equilibrium is marked in the list; by default the study's own. Raises `InputError`.
    """
    study, case = _asked(file, options, units or {})
    if axis is not None and export is not None:
        raise InputError("--export writes the equilibria of one case, so it does not go with --axis")
    picture = output_file.check(plot, (".png", ".pdf", ".svg"), force) if plot else None
    if out is not None and not force:
        writing.check_free(out, "equilibria")
    if axis is not None:
        return _over(study, case, axis, picture, out, json, force)
    rule = rule_of(study.equilibrium) if choose is None else which_of(choose).rule
    assert rule is not None
    found = every_equilibrium(case)
    taken = meant(found, rule)
    rows = [{**row(one), "taken": one is taken} for one in found]
    how = selection(rule, np.array([one.index for one in found], dtype=int), len(found), found.complete)
    if json:
        chosen = {**asdict(how), "rule": how.rule}
        said = {"case": told(case), "units": study.unit_system, "selection": chosen, "equilibria": rows}
        console.print_json({**said, "complete": found.complete, "remark": found.remark})
    else:
        shown = [f"rad/{study.units.length}", f"{study.units.force} {study.units.length}", "", "", "rad", ""]
        heads = [f"{name} ({unit})" if unit else name for name, unit in zip(COLUMNS, shown, strict=True)]
        marks = [f"{i} *" if r["taken"] else f"{i}" for i, r in enumerate(rows, 1)]
        lines = zip(marks, rows, strict=True)
        console.print_table(["", *heads], [[mark, *(r[c] for c in COLUMNS)] for mark, r in lines])
        stable = sum(r["index"] == 0 for r in rows)
        console.say(f"{len(rows)} equilibria, {stable} stable with the end angles held and the loads dead")
        if not found.complete:
            console.say(f"not known to be all of them: {found.remark}")
        if found:
            console.say(f"* {how.rule}" if taken else f"none has index {rule}")
        console.say(f"of {_source(study, file, options, units)}")
    if picture or out:
        from ..figures import canvas
        from ..figures import equilibria as equilibria_figure

        ds = equilibria_figure.dataset_of(study, case, found)
        if out:
            writing.write(ds, out, force)
        if picture:
            canvas.save(equilibria_figure.figure(ds), picture)
    if export:
        write_cases(study, case, found, export)
        if not json:
            console.say(f"{len(found)} cases in {export}")
    return 0 if found and found.complete else 1


def _asked(file: Path | None, options: dict[str, Any], units: dict[str, str]) -> tuple[Study, Case]:
    """The rod of a file or of Table 1 with some fields changed; or, where the options say units, theirs alone."""
    if not units:
        study = load(DEFAULT if file is None else str(file))
        return study, with_fields(ends_of(study), options)
    if file is not None:
        raise InputError(f"the units are those of {file.name}: change them there")
    case, assumed = own_case(options, Ends)
    both = {**TABLE_UNITS, **units}
    said = both | {name: value for name, value in (assumed | options).items() if value is not None}
    return loads(_toml("a rod of the options", both, {k: v for k, v in said.items() if k not in both}), OWN), case


def _source(study: Study, file: Path | None, options: dict[str, Any], units: dict[str, str] | None) -> str:
    if units:
        return f"the options, in {study.units.length} and {study.units.force}"
    changed = f", but for {choices(options)}" if options else ""
    return f"{study.title if file else 'the rod of Table 1, held at its own far end'}{changed}"


def _toml(title: str, units: Mapping[str, str], fields_: Mapping[str, Any]) -> str:
    """A study of one case as text."""
    base = "\n".join(f'{k} = "{v}"' if isinstance(v, str) else f"{k} = {v!r}" for k, v in fields_.items())
    return f'title = "{title}"\n\n[units]\nlength = "{units["length"]}"\nforce = "{units["force"]}"\n\n[base]\n{base}\n'


def ends_of(study: Study) -> Case:
    """The study's case by its ends; a rod given at its start keeps its loads and ends at its own far angle.

    Raises `InputError` for a grid, or a rod that is not solved.
    """
    if any(not axis.follow for axis in study.axes.values()):
        raise InputError(f"{study.name} has the axes {', '.join(study.axes)}: equilibria takes one case")
    case = study.case()
    if isinstance(case.given, Ends):
        return case
    sol = solve(case, tol=1e-12, stations=2)
    if not sol.solved:
        raise InputError(f"{study.name}: the rod given at its start is not solved: {sol.outcome}")
    g = case.given
    return Case(case.rod, case.cylinder, Ends(g.beta, float(sol.beta[-1]), *case.loads, g.alpha, g.gamma))


def row(one: Equilibrium) -> dict[str, Any]:
    """An equilibrium as plain data."""
    return {
        "dbeta0": one.dbeta0, "energy": one.energy, "turns": one.turns, "index": one.index, "stray": one.stray,
        "attached": one.attached,
        "outcome": str(one.solution.outcome), "error": float(one.solution.error),
    }  # fmt: skip


def told(case: Case) -> dict[str, Any]:
    """The fields of a case by name, as plain data."""
    out: dict[str, Any] = {}
    for part in (case.rod, case.cylinder, case.given):
        for field in fields(part):
            value = getattr(part, field.name)
            out[field.name] = value if isinstance(value, str) else float(value)
    return out


def write_cases(study: Study, case: Case, found: list[Equilibrium], folder: Path) -> None:
    """Each equilibrium as a TOML case that `workbench solve` and `run` read. Raises `InputError`."""
    writing.check_folder(folder)
    width = len(str(len(found)))
    for i, one in enumerate(found, 1):
        title = f"Equilibrium {i} of {len(found)}: index {one.index}, {one.turns} bends"
        text = (
            f"{_toml(title, study.unit_system, told(case))}\n"
            f"[equilibrium] # which of the {len(found)}: the one next to both\n"
            f"dbeta0 = {one.dbeta0!r}\nenergy = {one.energy!r}\n"
        )
        (folder / f"equilibrium_{i:0{width}d}.toml").write_text(text, encoding="utf-8")


def parse_axis(text: str) -> tuple[str, np.ndarray]:
    """``betaL=-90deg:60deg:41`` as a name and values, angles in rad. Raises `InputError`."""
    name, equals, said = text.partition("=")
    if name not in NAMES:
        raise InputError(f"no axis {name!r}; choose from {choices(NAMES)}")
    parts = said.split(":")
    if not equals or len(parts) != 3:
        raise InputError(f"--axis takes NAME=FROM:TO:COUNT, got {text!r}")
    try:
        ends = [_number(part, quantity_of(name).dimension == "rad") for part in parts[:2]]
        count = int(parts[2])
    except ValueError:
        raise InputError(f"--axis takes NAME=FROM:TO:COUNT with numbers, got {text!r}") from None
    if not 2 <= count <= MOST or ends[0] == ends[1] or not np.isfinite(ends).all():
        raise InputError(f"--axis needs two different ends and a count from 2 to {MOST}, got {text!r}")
    return name, np.linspace(min(ends), max(ends), count)


def _number(text: str, is_angle: bool) -> float:
    return angle(text) if is_angle else float(text)


def _over(study: Study, case: Case, axis: str, picture: Path | None, out: Path | None, json: bool, force: bool) -> int:
    from ..branches import branch_dataset
    from ..figures import bifurcation, canvas

    name, values = parse_axis(axis)
    with console.progress(values.size) as step:
        ds = branch_dataset.sweep(study, case, name, values, step)
    if out:
        writing.write(ds, out, force)
    if picture:
        canvas.save(bifurcation.figure(ds), picture)
    rows = branch_dataset.branches(ds)
    if json:
        console.print_json(
            {"axis": name, "units": study.unit_system, "branches": rows, "folds": branch_dataset.folds(ds)}
        )
    else:
        unit = "deg" if ds[name].attrs["units"] == "rad" else ds[name].attrs["units"]
        heads = [f"{key} ({unit})" if key in ("from", "to") else key for key in rows[0]] if rows else ["branch"]
        console.print_table(heads, [list(r.values()) for r in rows])
        console.say(f"{len(rows)} branches, {ds.sizes['fold']} folds over {values.size} values of {name}")
    return 0 if rows else 1
