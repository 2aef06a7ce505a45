"""The command solve: one case from a file or from options."""

from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np

from solver import Case, Ends, InputError, Solution
from solver.boundary.selection import checked
from solver.observe.observables import observe
from solver.problem.errors import choices, no_such
from solver.problem.quantities import quantity, unit_of
from studies import Study, load
from studies.axes import FORCES, LENGTHS, Which, quantity_of
from studies.readings import DEFAULT, parse

from ..data import cautions
from ..run.block import solve_one
from ..run.fidelity import Fidelity, fidelity
from . import console
from .own_case import own_case, with_fields

TABLE_UNITS = {"length": "cm", "force": "N"}
LOADS = ("FZ", "MZ", "M3")


@dataclass(frozen=True)
class Asked:
    """What is to be solved, in which units, and where each number comes from.

    source: where the case comes from. assumed: name -> value of what nobody gave.
    """

    case: Case
    units: dict[str, str]
    source: str
    assumed: dict[str, Any] = field(default_factory=dict)
    study: Study | None = None


def solve_case(
    file: Path | None,
    options: dict[str, Any],
    tol: float | None,
    method: str | None,
    json: bool,
    level: str | None = None,
    table1: bool = False,
    reading: str | None = None,
    units: dict[str, str] | None = None,
    choose: str | None = None,
) -> int:
    """Solve and print; 0, or 1 where it is not solved. Raises `InputError`, also for a file with axes.

    level: the name of a fidelity; a tolerance beside it replaces the fidelity's own. table1: the rod of Table 1, read
    as `reading` says, with the options as changes; so it is also where nothing at all is given. units: of length and
    force, where the options say them. choose: of the equilibria between two ends which one, in place of what the
    file says.
    """
    chosen = fidelity(level or "standard")
    asked = read_case(file, options, table1, reading, units or {})
    stations, which = 201, None
    if asked.study is not None:
        stations, which = asked.study.stations, asked.study.equilibrium
        tol = asked.study.tol if tol is None and level is None else tol
        method = asked.study.method if method is None else method
    tol = chosen.tol if tol is None else tol
    method = "auto" if method is None else method
    if choose is not None:
        which = which_of(choose)
        if not isinstance(asked.case.given, Ends):
            raise InputError("--choose takes one of the equilibria between two ends; a rod given by its start has one")
    sol = solve_one(asked.case, which, tol, method, chosen.stations or stations)
    told = described(sol, asked.units, chosen)
    told |= {
        "source": asked.source,
        "assumed": asked.assumed,
        "which": f"{sol.selection} (workbench equilibria lists all)" if sol.selection is not None else "",
        "selection": None if sol.selection is None else {**asdict(sol.selection), "rule": sol.selection.rule},
        "caution": cautions.said(cautions.of_cases(sol, {})),
    }
    if json:
        console.print_json(told)
    else:
        _print(told)
    return 0 if sol.solved else 1


def read_case(
    file: Path | None, options: dict[str, Any], table1: bool, reading: str | None, units: dict[str, str]
) -> Asked:
    """A case from a file, from Table 1, or from options alone. Raises `InputError`.

    options: fields of the case, name -> value; they change the file's or Table 1's. units: of length and force, for a
    rod of options alone. reading: how Table 1 is read.
    """
    changed = f", but for {choices(options)}" if options else ""
    if file is not None:
        if table1:
            raise InputError(f"--table1 and {file.name} exclude each other: each is a rod of its own")
        if units:
            raise InputError(f"the units are those of {file.name}: change them there")
        study = _study(file).under(reading)
        return Asked(with_fields(study.case(), options), study.unit_system, f"{file.name}{changed}", study=study)
    if table1 or reading is not None or not (options or units):
        if units:
            raise InputError("Table 1 is in cm and N: leave out the units")
        read = DEFAULT if reading is None else parse(reading)
        return Asked(with_fields(read.case(), options), dict(TABLE_UNITS), f"Table 1, read {read.name}{changed}")
    case, assumed = own_case(options)
    left = {f"unit of {kind}": unit for kind, unit in TABLE_UNITS.items() if kind not in units}
    for kind, known in (("length", LENGTHS), ("force", FORCES)):
        if units.get(kind, known[0]) not in known:
            raise no_such(f"unit of {kind}", units[kind], known)
    return Asked(case, {**TABLE_UNITS, **units}, "the options", {**assumed, **left})


def _study(file: Path) -> Study:
    if file.suffix != ".toml":
        raise InputError(f"a case is read from a .toml file, got {str(file)!r}")
    study = load(file)
    if study.axes:
        raise InputError(f"{file.name} has the axes {', '.join(study.axes)}: workbench run solves it")
    return study


def which_of(text: str) -> Which:
    """``nearest``, ``lowest`` or a Morse index as a study's [equilibrium]. Raises `InputError`."""
    try:
        rule = checked(int(text) if text.isdecimal() else text)
    except InputError:
        raise InputError(f"--choose must be nearest, lowest or a Morse index (0, 1, 2, ...), got {text!r}") from None
    return Which(index=rule) if isinstance(rule, int) else Which.model_validate({"choose": rule})


def described(sol: Solution, units: dict[str, str], level: Fidelity) -> dict[str, Any]:
    """The case, how well it was solved, its loads, and the observables and arrays of a fidelity, as plain data."""
    case = sol.case
    asked = {
        field.name: getattr(part, field.name)
        for part in (case.rod, case.cylinder, case.given)
        for field in fields(part)
        if getattr(part, field.name) is not None
    }
    return {
        "case": {name: value if isinstance(value, str) else float(value) for name, value in asked.items()},
        "given": type(case.given).__name__,
        "units": units,
        "outcome": str(sol.outcome),
        "method": sol.method,
        "tolerance": sol.tol,
        "error": float(sol.error),
        "condition": float(sol.condition),
        "loads": {name: float(getattr(sol, name)) for name in LOADS},
        "observables": {name: np.asarray(value).item() for name, value in observe(sol, level.observables).items()},
        "along": {name: getattr(sol, name).tolist() for name in level.along},
    }


def _print(told: dict[str, Any]) -> None:
    console.say(f"the rod of {told['source']}")
    if told["assumed"]:
        console.say(f"assumed: {', '.join(f'{name} = {value}' for name, value in told['assumed'].items())}")
    console.say("")
    rows = []
    for name, value in told["case"].items():
        if isinstance(value, str):
            rows.append([name, value, "", ""])
        else:
            row = quantity_of(name)
            rows.append([name, value, _unit(row.name, told), row.long_name])
    console.print_table(["given", "value", "unit", ""], rows)
    found = {**told["loads"], **told["observables"]}
    console.say("")
    console.print_table(
        ["found", "value", "unit", ""],
        [[name, value, _unit(name, told), quantity(name).long_name] for name, value in found.items()],
    )
    console.say("")
    console.say(
        f"{told['outcome']} ({told['method']}, tolerance {told['tolerance']:g}: "
        f"error {told['error']:.1e}, condition {told['condition']:.3g})"
    )
    if told["which"]:
        console.say(told["which"])
    if told["caution"]:
        console.say(f"caution: {told['caution']}")


def _unit(name: str, told: dict[str, Any]) -> str:
    unit = unit_of(name, told["units"])
    return "" if unit == "1" else unit
