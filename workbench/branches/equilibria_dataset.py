"""Lists as datasets over `equilibrium`, the equilibria of a case and closed rods; what datasets of branches share."""

import json
from collections.abc import Collection, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from solver import Case, Solution
from solver.equilibria import Equilibrium
from solver.equilibria_result import HeldEquilibria
from solver.loops import Loop
from solver.observe.cautions import turns_back
from solver.observe.observables import observe
from solver.problem.declared_fields import PAIRS
from solver.problem.dimensionless import fields_held
from solver.problem.errors import InputError, check_known, choices, show
from studies import Study
from studies.grammar.axes import DEFAULT_UNITS
from studies.language.case_input import check_units, field_values
from studies.language.loader import loads

from ..stored import provenance, quantity_variables
from ..stored.stored_cases import BACK
from ..words import caution_words
from ..words.free_rod_words import ELASTIC
from .ends_study import study_text

EQUILIBRIUM = ("equilibrium",)  # the dimension of a list
ALONG = ("beta", "alpha", "z", "contact")
DEAD_INDEX = {"long_name": "Morse index under dead loads, between its own end angles", "units": "1"}
COUNT = {"long_name": "number of equilibria", "units": "1"}
PUSH = ("push_min", "push_max")
EACH = ("dbeta0", "energy", "bends", "index", "attached")
DEAD_LOADS = "both end angles held, dead loads FZ, MZ and M3 at the far end, which is free to move"


def as_dataset(study: Study, case: Case, found: Sequence[Equilibrium]) -> xr.Dataset:
    """The equilibria of a case as a dataset over `equilibrium`, lowest energy first.

    Parameters
    ----------
    study
        The study of the case; the dataset takes its units and stores its text.
    case
        One ends problem; its numbers become scalars.
    found
        Its equilibria, all at the same stations.

    Returns
    -------
    The arrays of `ALONG` over (equilibrium, u), u = s/L, the numbers of `EACH`, `ELASTIC` and `PUSH` over
    (equilibrium), `count`; under held ends the reactions and the index under dead loads as well.
    """
    units, held = study.unit_system, fields_held(case)
    solutions = [equilibrium.solution for equilibrium in found]
    seen = [observe(sol, (*ELASTIC, *PUSH)) | sol.reactions for sol in solutions]
    names = (*ELASTIC, *PUSH, *(solutions[0].reactions if solutions else ()))
    numbers = {name: np.array([getattr(equilibrium, name) for equilibrium in found]) for name in EACH}
    numbers |= {name: np.array([float(row[name]) for row in seen]) for name in names}
    data: dict[str, Any] = quantity_variables.variables(numbers, EQUILIBRIUM, units)
    if held:
        data["energy"].attrs = quantity_variables.labels("held_energy", units)  # what the number is; the name stays
        dead = np.array([equilibrium.dead_index for equilibrium in found], dtype=np.int64)
        data["dead_index"] = xr.Variable(EQUILIBRIUM, dead, DEAD_INDEX)
        ways = np.array([equilibrium.found_by for equilibrium in found], dtype=str)
        data["found_by"] = xr.Variable(EQUILIBRIUM, ways)
    data["count"] = xr.Variable((), len(found), COUNT)
    texts = [str(caution_words.of_cases(sol, units=study.unit_system)) for sol in solutions]
    ds = of_solutions(solutions, data, texts, float(case.rod.L), units)
    ds["equilibrium"].attrs["long_name"] = "rank by energy"
    title = f"Equilibria with held ends: {choices(held)}" if held else "All equilibria with both end angles held"
    ds.attrs = attributes(study, case, title)
    if isinstance(found, HeldEquilibria):
        ranges = (
            f"{name} from {low:.4g} to {high:.4g} {quantity_variables.labels(name, units)['units']}"
            for name, (low, high) in found.search.within.items()
        )
        search = {"remark": found.remark, "searched": ", ".join(ranges)}
        ds.attrs |= {"stability": f"under held ends ({choices(held)})", **search}
    return with_case(ds, case, units)


def all_units(units: Mapping[str, str] | None) -> dict[str, str]:
    """The units of length and force; default: these words.

    Raises `InputError` for another name than these two, and for a unit that is not known.
    """
    words = {"length": "length", "force": "force"}
    for name, unit in (units or {}).items():
        check_known("unit", name, words)
        if not isinstance(unit, str):
            raise InputError(f"the unit of {name} must be text, got {show(unit)}")
    check_units({name: unit for name, unit in (units or {}).items() if unit != words[name]})
    return words | dict(units or {})


def of_solution(
    sol: Solution, dims: tuple[str, ...], u: Any, names: Sequence[str], units: Mapping[str, str]
) -> xr.Dataset:
    """A solution over a grid as a dataset: these arrays along the rods, whether each is solved, and its outcome.

    u: s/L at the stations.
    """
    along = quantity_variables.variables({name: getattr(sol, name) for name in names}, (*dims, "u"), units)
    data: dict[str, Any] = {quantity_variables.curve_name(name): array for name, array in along.items()}
    data["solved"] = xr.Variable(dims, np.asarray(sol.solved, dtype=bool))
    data["outcome"] = xr.Variable(dims, np.asarray(sol.outcome).astype(str))
    return xr.Dataset(
        data,
        quantity_variables.variables({"u": u}, ("u",), units)
        | quantity_variables.variables({"s": sol.s}, (*dims, "u"), units),
    )


def of_solutions(
    solutions: Sequence[Solution], numbers: Mapping[str, Any], texts: Sequence[str], L: float, units: Mapping[str, str]
) -> xr.Dataset:
    """Solutions of rods of one length as a dataset over `equilibrium`: `ALONG`, whether each is solved, and `numbers`.

    texts: the caution of each.
    """
    stations = solutions[0].s.size if solutions else 2
    each = {name: np.array([getattr(sol, name) for sol in solutions]).reshape(-1, stations) for name in ALONG}
    data: dict[str, Any] = {**quantity_variables.variables(each, (*EQUILIBRIUM, "u"), units), **numbers}
    data["solved"] = xr.Variable(EQUILIBRIUM, np.array([bool(sol.solved) for sol in solutions], dtype=bool))
    data["outcome"] = xr.Variable(EQUILIBRIUM, np.array([str(sol.outcome) for sol in solutions], dtype=str))
    data["caution"] = xr.Variable(EQUILIBRIUM, np.array(texts, dtype=str))
    u = np.linspace(0, 1, stations)
    coords = {
        "equilibrium": np.arange(1, len(solutions) + 1),
        **quantity_variables.variables({"u": u, "s": u * L}, ("u",), units),
    }
    return xr.Dataset(data, coords)


def attributes(study: Study, case: Case, title: str) -> dict[str, Any]:
    """The attributes that every dataset of equilibria has."""
    return {
        "title": title,
        "study_name": "equilibria",
        "study": study.text,
        "reading": study.reading or "",
        **quantity_variables.attributes_of_case(case, study.unit_system),
        "laws": json.dumps([]),
        "versions": json.dumps(provenance.versions()),
        "stability": DEAD_LOADS,
    }


def with_case(ds: xr.Dataset, case: Case, units: dict[str, str], skip: Collection[str] = ()) -> xr.Dataset:
    """The dataset with the numbers of the case as scalars; skip: the fields that vary."""
    every = {name: getattr(case.given, name) for pair in PAIRS for name in pair}
    ends = {name: value for name, value in every.items() if value is not None}
    varied = {*skip, *(("rho",) if {"R", "a"} & {*skip} else ())}
    numbers = {
        name: value for name, value in (quantity_variables.numbers_of_case(case) | ends).items() if name not in varied
    }
    return ds.assign(quantity_variables.variables({name: float(value) for name, value in numbers.items()}, (), units))


NUMBERS = {  # of each loop: units and long names of those that are no quantity of a case
    "turns_around": "turns_around",
    "folds": ("1", "folds", "periods of beta along the closed rod"),
    "about": ("rad", "about", "angle about which beta oscillates"),
    "lam": ("1", "λ", "axial moment, MZ rho/A"),
    "energy": "bending_energy",
    "index": "index",
    "push_min": "push_min",
    "push_max": "push_max",
    "attached": "attached",
}
LABELS = ("units", "symbol", "long_name")
STABILITY = "closed rods, the section free to turn, all on the surface"


def study_of_loop(one: Loop, units: Mapping[str, str] | None = None) -> Study:
    """A study whose one case is the start problem of a loop; units: default: cm and N."""
    times = [f"{count} {word}{'s' * (count > 1)}" for count, word in ((one.turns_around, "turn"), (one.folds, "fold"))]
    title = f"A closed rod of {' and '.join(times)}"
    text = study_text(title, {**DEFAULT_UNITS, **dict(units or {})}, field_values(one.solution.case))
    return loads(text, "loops")


def loops_as_dataset(found: Sequence[Loop], units: Mapping[str, str] | None = None) -> xr.Dataset:
    """Closed rods of one rod and cylinder as a dataset over `equilibrium`, in the order given.

    Returns
    -------
    The arrays of `ALONG` over (equilibrium, u), u = s/L, `NUMBERS`, MZ, outcome and caution over (equilibrium), and
    the numbers of the rod and the cylinder.

    Raises
    ------
    InputError
        For no loop, and for an unknown unit.
    """
    if not found:
        raise InputError("no loop was found: a dataset holds at least one")
    study, case = study_of_loop(found[0], units), found[0].solution.case
    words = study.unit_system
    solutions = [loop.solution for loop in found]
    data: dict[str, Any] = {}
    for name, row in NUMBERS.items():
        labels = quantity_variables.labels(row, words) if isinstance(row, str) else dict(zip(LABELS, row, strict=True))
        data[name] = xr.Variable(EQUILIBRIUM, np.array([getattr(loop, name) for loop in found]), labels)
    data |= quantity_variables.variables({"MZ": [float(sol.MZ) for sol in solutions]}, EQUILIBRIUM, words)
    data |= quantity_variables.variables({"FZ": 0.0, "M3": 0.0}, (), words)
    scalars = {**dict(case.rod.given()), "R": case.cylinder.R, "rho": case.rho}
    data |= quantity_variables.variables({name: float(value) for name, value in scalars.items()}, (), words)
    ds = of_solutions(solutions, data, [caution_of_loop(loop, words) for loop in found], float(case.rod.L), words)
    ds["equilibrium"].attrs["long_name"] = "number of the loop"
    where = "in" if case.cylinder.side == "inside" else "on"
    more = {"title": f"Closed rods {where} a cylinder", "stability": STABILITY}
    return ds.assign_attrs(attributes(study, case, "") | more | {"caution": caution_words.said(ds["caution"].values)})


def caution_of_loop(one: Loop, units: Mapping[str, str] | None = None) -> str:
    """The caution of a closed rod, whose ends are neighbours and not in self-contact."""
    met = np.nan if one.overlaps is None else float(one.overlaps)
    return str(caution_words.of_cases(one.solution, {"overlaps": np.array(met)}, units))


def numbers_of(sol: Solution, keys: Sequence[str]) -> dict[str, Any]:
    """Observables, loads and values at the ends, one for each case."""
    ends = {"dbeta0": lambda: sol.dbeta[..., 0], "beta0": lambda: sol.beta[..., 0], "betaL": lambda: sol.beta[..., -1]}
    ends |= {name: partial(getattr, sol, name) for name in quantity_variables.LOADS}
    ends |= {BACK: lambda: turns_back(sol, sol.z[..., -1] - sol.z[..., 0])}
    return observe(sol, [key for key in keys if key not in ends]) | {key: ends[key]() for key in keys if key in ends}


def stability(case: Case) -> str:
    """Under which ends the Morse index is meant."""
    held = fields_held(case)
    if not held:
        return DEAD_LOADS
    return f"{', '.join(held)} held; what is not held is given: the other end angles, and dead loads"
