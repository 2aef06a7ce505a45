"""The dataset of all equilibria of one case, and what it shares with the dataset of branches."""

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from solver import Case, Solution
from solver.equilibria import Equilibrium
from solver.equilibrium_list import HeldEquilibria
from solver.observe.observables import observe
from solver.problem.case import PAIRS
from solver.problem.errors import choices
from solver.problem.reduced import held_of
from studies import Study

from ..store import dataset, schema
from ..words import cautions
from .ends_study import ELASTIC, elastic

EQUILIBRIUM = ("equilibrium",)  # the dimension of a list
ALONG = ("beta", "alpha", "z", "contact")
DEAD_INDEX = {"long_name": "Morse index under dead loads, between its own end angles", "units": "1"}
COUNT = {"long_name": "number of equilibria", "units": "1"}
PUSH = ("push_min", "push_max")
EACH = ("dbeta0", "energy", "turns", "index", "attached")
DEAD_LOADS = "both end angles held, dead loads FZ, MZ and M3 at the far end, which is free to move"


def dataset_of(study: Study, case: Case, found: Sequence[Equilibrium]) -> xr.Dataset:
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
    units, held = study.unit_system, held_of(case)
    solutions = [equilibrium.solution for equilibrium in found]
    reactions = list(solutions[0].reactions) if solutions else []
    rows = [
        {**{name: getattr(equilibrium, name) for name in EACH}, **_numbers_of(equilibrium.solution)}
        for equilibrium in found
    ]
    numbers = {name: np.array([row[name] for row in rows]) for name in (*EACH, *ELASTIC, *PUSH, *reactions)}
    data: dict[str, Any] = dataset.variables(numbers, EQUILIBRIUM, units)
    if held:
        data["energy"].attrs = schema.labels("held_energy", units)  # what the number is; the name stays
        dead = np.array([equilibrium.dead_index for equilibrium in found], dtype=np.int64)
        data["dead_index"] = xr.Variable(EQUILIBRIUM, dead, DEAD_INDEX)
        data["found_by"] = xr.Variable(
            EQUILIBRIUM, np.array([equilibrium.found_by for equilibrium in found], dtype=str)
        )
    data["count"] = xr.Variable((), len(found), COUNT)
    cautions_of = [str(cautions.of_cases(sol, unit=study.units.length)) for sol in solutions]
    ds = of_solutions(solutions, data, cautions_of, float(case.rod.L), units)
    ds["equilibrium"].attrs["long_name"] = "rank by energy"
    title = f"Equilibria with held ends: {choices(held)}" if held else "All equilibria with both end angles held"
    ds.attrs = attributes(study, case, title)
    if isinstance(found, HeldEquilibria):
        ranges = (
            f"{name} from {low:.4g} to {high:.4g} {schema.labels(name, units)['units']}"
            for name, (low, high) in found.search.within.items()
        )
        search = {"remark": found.remark, "searched": ", ".join(ranges)}
        ds.attrs |= {"stability": f"under held ends ({choices(held)})", **search}
    return with_case(ds, case, units)


def _numbers_of(sol: Solution) -> dict[str, Any]:
    return {**elastic(sol), **{name: float(value) for name, value in (observe(sol, PUSH) | sol.reactions).items()}}


def of_solutions(
    solutions: Sequence[Solution], numbers: Mapping[str, Any], texts: Sequence[str], L: float, units: Mapping[str, str]
) -> xr.Dataset:
    """Solutions of rods of one length as a dataset over `equilibrium`: `ALONG`, whether each is solved, and `numbers`.

    texts: the caution of each.
    """
    stations = solutions[0].s.size if solutions else 2
    each = {name: np.array([getattr(sol, name) for sol in solutions]).reshape(-1, stations) for name in ALONG}
    data: dict[str, Any] = {**dataset.variables(each, (*EQUILIBRIUM, "u"), units), **numbers}
    data["solved"] = xr.Variable(EQUILIBRIUM, np.array([bool(sol.solved) for sol in solutions], dtype=bool))
    data["outcome"] = xr.Variable(EQUILIBRIUM, np.array([str(sol.outcome) for sol in solutions], dtype=str))
    data["caution"] = xr.Variable(EQUILIBRIUM, np.array(texts, dtype=str))
    u = np.linspace(0, 1, stations)
    coords = {"equilibrium": np.arange(1, len(solutions) + 1), **dataset.variables({"u": u, "s": u * L}, ("u",), units)}
    return xr.Dataset(data, coords)


def attributes(study: Study, case: Case, title: str) -> dict[str, Any]:
    """The attributes that every dataset of equilibria has."""
    return {
        "title": title, "study_name": "equilibria", "study": study.text, "reading": study.reading or "",
        **schema.attributes_of_case(case, study.unit_system), "laws": json.dumps([]),
        "versions": json.dumps(dataset.versions()),
        "stability": DEAD_LOADS,
    }  # fmt: skip


def with_case(ds: xr.Dataset, case: Case, units: dict[str, str], skip: str = "") -> xr.Dataset:
    """The dataset with the numbers of the case as scalars; skip: the field that is an axis."""
    every = {name: getattr(case.given, name) for pair in PAIRS for name in pair}
    ends = {name: value for name, value in every.items() if value is not None}
    numbers = {**schema.numbers_of_case(case), **ends}
    return ds.assign({
        name: xr.Variable((), float(value), schema.labels(name, units))
        for name, value in numbers.items()
        if name != skip and not (name == "rho" and skip in ("R", "a"))
    })  # fmt: skip
