"""The command solve: one case from a file, from options or from Table 1."""

import math
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, Any

from . import console
from .case_options import Given, takes_case
from .case_report import print_case
from .option_checks import parse_choose
from .options import CaseFile, Choose, Fidelity, Json, Method, Reading, Tol, flag

if TYPE_CHECKING:
    from solver import Solution

    from ..store.fidelity import Fidelity as Level

LOADS = ("FZ", "MZ", "M3")


@takes_case()
def solve(
    file: CaseFile = None,
    table1: Annotated[bool, flag("Take the rod of Table 1; options replace its fields.", "--table1")] = False,
    reading: Reading = None,
    *,
    given: Given,
    tol: Tol = None,
    method: Method = None,
    level: Fidelity = None,
    choose: Choose = None,
    every: Annotated[bool, flag("Print every number that is found, not only ten.", "--all")] = False,
    json: Json = False,
) -> int:
    """Solve one case and print it.

    The case comes from a TOML file, from Table 1 (--table1, --reading, or no option at all), or from options alone.
    Options alone must give E, nu, a, L and R; for a start problem also beta, dbeta and one of F1, dgamma and M3; for an
    ends problem also beta0 or M10, and betaL or M1L (a moment of 0 is a hinge). In an ends problem height, azimuth and
    rotation can hold the far end in place of the loads FZ, MZ and M3; the command then finds these loads. A cable that
    is wound on a drum has tension and lay in place of all of these.

    An ends problem has many equilibria: --choose selects one, by default the stable equilibrium whose beta goes least
    beyond its end angles. The command equilibria lists all.

    With --weight, --inclination or --friction the loads vary along the rod. The answer then continues from the straight
    rod, and the command says where the rod is straight, sinusoidal or helical. The model leaves out joints, and
    clearance at the ends.

    Angles: a number in rad, or a form like 30deg or pi/6. Exit status 1 if the case is unsolved.
    """

    from ..store.case_input import read_case
    from ..store.case_solutions import solve_one
    from ..store.fidelity import fidelity
    from ..words import cautions, left_out, pipe_numbers, pipe_state

    chosen = fidelity(level or "standard")
    asked = read_case(file, given.values, given.units, table1, reading)
    stations, which = 201, asked.which
    if asked.study is not None:
        stations = asked.study.stations
        tol = asked.study.tol if tol is None and level is None else tol
        method = asked.study.method if method is None else method
    tol = chosen.tol if tol is None else tol
    if choose is not None:
        which = parse_choose(choose, asked.case.given)
    sol = solve_one(asked.case, which, tol, "auto" if method is None else method, chosen.stations or stations)
    whole = every or json or not asked.case.varies
    rows = pipe_numbers.profile(sol, asked.units)
    found = _find(sol, asked.units, chosen, whole) | {
        "source": asked.source,
        "assumed": asked.assumed,
        "which": _which(sol, asked.which is not None and asked.study is None and choose is None),
        "selection": None if sol.selection is None else {**asdict(sol.selection), "rule": sol.selection.rule},
        "caution": cautions.said(cautions.of_cases(sol, unit=asked.units["length"])),
        "left_out": left_out.note(asked.case),
        "pipe": pipe_state.sentences(sol, asked.units),
        "profile": [row._asdict() for row in rows],
        "warnings": pipe_state.warnings(sol, asked.units, rows),
        "lift_offs": sol.lift_offs,
    }
    if json:
        console.print_json(found)
    else:
        print_case(found, every, whole)
    return 0 if sol.solved else 1


def _which(sol: "Solution", wound: bool) -> str:
    """Which equilibrium was taken; wound: the helix of a tension and a lay was asked for."""
    from solver import observe

    if not wound or not sol.solved:
        return f"{sol.selection} (use workbench equilibria to list all)" if sol.selection is not None else ""
    index = int(observe(sol, ["index"])["index"])
    ways = f"unstable in {index} way{'s' * (index != 1)} under dead loads: it needs more tension, or a guide"
    return f"shown: the helix of this tension and lay, {ways if index else 'which is stable'}"


def _find(sol: "Solution", units: dict[str, str], level: "Level", whole: bool) -> dict[str, Any]:
    """The case, its loads, its accuracy, and the observables and arrays of a fidelity, as plain data.

    whole: whether the outcome says which observables are not defined.
    """
    import numpy as np

    from solver.observe.observables import observe, why_unknown

    from ..store.case_input import field_values, with_unit

    seen = observe(sol, level.observables(sol.case.rod))
    remarks = [words for name in seen for words, here in why_unknown(name, seen[name]) if here and sol.solved and whole]
    return {
        "case": field_values(sol.case),
        "given": type(sol.case.given).__name__,
        "units": units,
        "solved": bool(sol.solved),
        "outcome": "; ".join([with_unit(str(sol.outcome), sol.case, units), *remarks]),
        "method": sol.method,
        "tolerance": sol.tol,
        "error": float(sol.error),
        "condition": float(sol.condition),
        "loads": {name: float(getattr(sol, name)) for name in LOADS},
        "held": list(sol.held),
        "reactions": {name: float(value) for name, value in sol.reactions.items()},
        "begun": sol.begun or "",
        "indices": _indices(sol),
        "observables": {name: np.asarray(value).item() for name, value in seen.items()}
        | _held_energy(sol, "energy" in seen),
        "along": {name: getattr(sol, name).tolist() for name in level.along},
    }


def _held_energy(sol: "Solution", wanted: bool) -> dict[str, float]:
    """The energy by which the equilibria of held ends are listed; empty under dead loads."""
    from solver.held_equilibria import held_energy

    return {"held_energy": held_energy(sol)} if wanted and sol.held and sol.solved and not sol.case.varies else {}


def _indices(sol: "Solution") -> dict[str, int]:
    """The Morse index under held ends and under dead loads; empty unless both are decided."""
    from solver.observe.observables import observe

    if not sol.held or sol.case.varies or not sol.solved or not math.isfinite(sol.held_index):
        return {}
    dead = float(observe(sol, ["index"])["index"])
    return {"held ends": int(sol.held_index)} | ({"dead loads": int(dead)} if math.isfinite(dead) else {})
