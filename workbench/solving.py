"""The command solve: one case from a file or from options."""

from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from solver import Case, Cylinder, InputError, Rod, Solution
from solver.case import from_fields
from solver.observables import observe
from solver.quantities import quantity, unit_of
from studies import load
from studies.axes import quantity_of
from studies.readings import DEFAULT

from . import console
from .fidelity import Fidelity, fidelity
from .runner import solve_one

LOADS = ("FZ", "MZ", "M3")


def solve_case(
    file: Path | None,
    options: dict[str, Any],
    tol: float | None,
    method: str | None,
    json: bool,
    level: str | None = None,
) -> int:
    """Solve and print; 0, or 1 where it is not solved. Raises `InputError`, also for a file with axes.

    level: the name of a fidelity; a tolerance beside it replaces the fidelity's own.
    """
    chosen = fidelity(level or "standard")
    units = {"length": "cm", "force": "N"}
    stations, base, which = 201, DEFAULT.case(), None
    if file is not None:
        if file.suffix != ".toml":
            raise InputError(f"solve reads a case from a .toml file, got {str(file)!r}")
        study = load(file)
        if study.axes:
            raise InputError(f"{file.name} has the axes {', '.join(study.axes)}: workbench run solves it")
        units, stations, base = study.unit_system, study.stations, study.case()
        which = study.equilibrium
        tol = study.tol if tol is None and level is None else tol
        method = study.method if method is None else method
    case = with_fields(base, options)
    tol = chosen.tol if tol is None else tol
    sol = solve_one(case, which, tol, "auto" if method is None else method, chosen.stations or stations)
    told = described(sol, units, chosen)
    if json:
        console.print_json(told)
    else:
        _print(told)
    return 0 if sol.solved else 1


def with_fields(case: Case, changes: dict[str, Any]) -> Case:
    """The same case with some fields changed; F1 and dgamma drop each other. Raises `InputError`."""
    parts: list[Any] = []
    left = dict(changes)
    for part in (case.rod, case.cylinder, case.given):
        kind = type(part)
        own = {field.name: getattr(part, field.name) for field in fields(kind)}
        if kind not in (Rod, Cylinder):  # whatever is left must be one of its fields
            own |= {name: None for name, other in (("F1", "dgamma"), ("dgamma", "F1")) if other in changes}
            parts.append(from_fields(kind, {**{k: v for k, v in own.items() if v is not None}, **left}))
            break
        parts.append(from_fields(kind, {**own, **{name: left.pop(name) for name in own if name in left}}))
    return Case(*parts)


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


def _unit(name: str, told: dict[str, Any]) -> str:
    unit = unit_of(name, told["units"])
    return "" if unit == "1" else unit
