"""What the live page shows of a state (a study of one case as plain data): curves, observables, equilibria, files.

Nothing is kept between calls; an invalid state raises `InputError`.
"""

import re
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from solver import Ends, Solution, equilibria, solve
from solver.equilibria import Equilibrium
from solver.mechanics.potential import potential
from solver.observe.observables import OBSERVABLES, observe
from solver.problem.case import TWISTS
from solver.problem.errors import InputError, choices
from solver.problem.quantities import quantity, unit_of
from studies import Study
from studies.axes import WORDS, quantity_of
from studies.dimensions import Dimensions
from studies.loader import loads
from studies.readings import parse
from studies.writer import dumps

from ...branches.equilibria import ends_problem
from ...branches.equilibria import row as equilibrium_row
from ...data import cautions, dataset, labels
from ...export.stored_rod import export
from ...run.block import columns
from ...run.case_input import field_values
from .page_shape import STATIONS, TOL, Shape, refuse_many

KEYS = ("title", "units", "reading", "base", "equilibrium")
HIDDEN = ("alpha", "gamma")  # fields that turn the whole rod and are not shown
POSITIVE = ("E", "a", "L", "R")
COUNTS = ("turns", "bend_number")
LEVELS = 361  # points of the potential


def study_of(state: Any) -> Study:
    """The study of a state. Raises `InputError`, whose message names no file and line."""
    if not isinstance(state, dict):
        raise InputError("the state must be a table")
    for key in state:
        if key not in KEYS:
            raise InputError(f"no key {str(key)[:40]!r} in the state; choose from {choices(KEYS)}")
    data = {key: value for key, value in state.items() if value is not None}
    data.setdefault("title", "From the live page")
    base = data.get("base")
    if isinstance(base, dict):
        data["base"] = {str(name): _plain(name, value) for name, value in base.items()}
    try:
        text = tomli_w.dumps(data)
    except (TypeError, ValueError, AttributeError):
        raise InputError("the state must hold numbers, strings and tables of them") from None
    try:
        return loads(text, "page", "live")
    except InputError as error:
        raise InputError(re.sub(r"^page(, line \d+)?: ", "", str(error))) from None


def _plain(name: object, value: Any) -> Any:
    """A field's value as TOML stores it: numbers as floats. Raises `InputError` for anything else."""
    if name in WORDS:
        return value
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        got = "nothing" if value is None or value == "" else f"{value!r:.40}"
        raise InputError(f"{str(name)[:40]} must be a number, got {got}")
    return float(value)


def field_of(message: str) -> str:
    """The field that an error message is about, or nothing: ``Rod.E must be ...`` is about E."""
    found = re.match(r"(?:Rod|Cylinder|Start|Ends|base)\.(\w+)", message) or re.match(
        r"(\w+) must be a number", message
    )
    return found[1] if found else ""


def curves(one: Shape) -> dict[str, Any]:
    """The diagrams beside the rod, in the units of the study and degrees: arrays by name.

    s, beta, push: along the rod. across, up: its developed curve. angle, potential: G over one rotation of beta; level:
    h.
    """
    sol = one.sol
    rho = float(sol.case.rho)
    angle = np.linspace(-180.0, 180.0, LEVELS)
    return {
        "s": sol.s, "beta": np.degrees(sol.beta), "push": sol.push,
        "across": rho * (sol.alpha - sol.alpha[0]), "up": sol.z,
        "angle": angle, "potential": potential(sol.problem, np.radians(angle)) / rho**2, "level": sol.h[:1],
    }  # fmt: skip


def facts(one: Shape) -> dict[str, Any]:
    """Outcome, error, condition number, loads and notes of a solved rod, as plain data."""
    sol, study = one.sol, one.study
    units = study.unit_system
    notes = []
    if not one.whole:
        notes.append(
            f"Only the first {labels.number(one.shown)} {units['length']} are shown: the rod bends too often for more."
        )
    reading = parse(study.reading) if study.reading else None
    return {
        "outcome": str(sol.outcome), "error": float(sol.error), "condition": float(sol.condition),
        "method": sol.method, "stations": sol.s.size, "notes": notes,
        "loads": [_row(name, float(getattr(sol, name)), units) for name in ("FZ", "MZ", "M3")],
        "meaning": {name: reading.meaning(name) for name in study.fields if reading and reading.meaning(name)},
        "which": _which(sol) if sol.problem.kind == "ends" else None,
    }  # fmt: skip


def _which(sol: Solution) -> dict[str, float]:
    return {"dbeta0": float(sol.dbeta[0]), "energy": float(observe(sol, ["energy"])["energy"])}


def numbers(one: Shape) -> dict[str, Any]:
    """Every observable as a row, and sentences on what a real rod could not do."""
    found = observe(one.sol, list(OBSERVABLES))
    keys = str(cautions.of_cases(one.sol))
    if one.sol.method == "difference":  # followed to 1e-6 only: where beta is level, bends may be errors
        found |= dict.fromkeys(COUNTS, np.nan)
    warnings = [f"The rod {cautions.phrase(key)}." for key in cautions.keys(keys)]
    units = one.study.unit_system
    return {
        "rows": [_row(name, np.asarray(value).item(), units) for name, value in found.items()],
        "warnings": warnings,
    }


def _row(name: str, value: float, units: dict[str, str]) -> dict[str, Any]:
    q = quantity(name)
    unit, shown = labels.unit(unit_of(name, units)), value
    if unit == "rad":
        unit, shown = "°", float(np.degrees(value))
    text = "not known" if not np.isfinite(shown) else labels.number(shown).replace("-", "−")
    return {"name": name, "symbol": q.symbol, "words": q.long_name, "unit": unit, "value": value, "text": text}


def list_equilibria(study: Study) -> list[dict[str, Any]]:
    """All equilibria of a rod between two ends, lowest energy first, as plain data. Raises `InputError`."""
    case = study.case()
    if not isinstance(case.given, Ends):
        raise InputError("a start problem has one solution only; hold both ends to list equilibria")
    refuse_many(case)
    found: list[Equilibrium] = equilibria(case, TOL, STATIONS)
    return [equilibrium_row(one) for one in found]


def ends_state(study: Study) -> dict[str, Any]:
    """The state of the ends problem with the same loads that names the rod's own equilibrium. Raises `InputError`."""
    case = ends_problem(study)
    base = {name: value for name, value in field_values(case).items() if name not in HIDDEN}
    sol = solve(study.case(), TOL, stations=STATIONS)
    return {"title": study.title, "units": study.unit_system, "base": base, "equilibrium": _which(sol)}


def fields(study: Study) -> list[dict[str, Any]]:
    """The inputs of a state, in order: name, symbol, words, unit as shown, and the kind of its slider."""
    rows = []
    for name in study.fields:
        if name in (*HIDDEN, *WORDS) or (name in TWISTS and not study.reading and name not in study.base.given):
            continue
        q = quantity_of(name)
        unit = labels.unit(unit_of(q.name, study.unit_system))
        kind = "positive" if name in POSITIVE else "ratio" if name == "nu" else "angle" if unit == "rad" else "signed"
        shown = "°" if kind == "angle" else unit
        rows.append({"name": name, "symbol": q.symbol, "words": q.long_name, "unit": shown, "kind": kind})
    return rows


def text(study: Study) -> str:
    """The text of a study file for `workbench run` and `solve`."""
    return dumps(study)


def stored(one: Shape) -> Any:
    """The dataset of a solved rod, as `workbench run` stores it. Raises `InputError` for a part of a rod."""
    if not one.whole:
        raise InputError("only a part of this rod is shown: run it as a study to export it")
    study = one.study.model_copy(
        update={"stations": one.sol.s.size, "outputs": ["beta", "dbeta", "alpha", "z", "contact"]}
    )
    return dataset.make(study, Dimensions(), columns(study, one.sol))


def file(one: Shape, kind: str) -> bytes:
    """The bytes of an exported file with that suffix. Raises `InputError` as `stored_rod.export` does."""
    ds = stored(one)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"rod.{kind}"
        try:
            export(ds, path)
        except InputError as error:
            raise InputError(
                str(error).partition("; --")[0]
            ) from None  # the page has none of the options that the rest names
        return path.read_bytes()
