"""The dataset of all equilibria of one case, and what it shares with the dataset of branches."""

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from solver import Case
from solver.equilibria import Equilibrium
from solver.equilibrium_list import HeldEquilibria
from solver.observe.observables import observe
from solver.problem.case import PAIRS
from solver.problem.errors import choices
from solver.problem.held_ends import held_of
from studies import Study

from ..store import dataset, schema
from ..words import cautions
from .ends_study import ELASTIC, elastic

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
    units = study.unit_system
    data: dict[str, Any] = {}
    stations = found[0].solution.s.size if found else 2
    for name in ALONG:
        values = np.array([getattr(one.solution, name) for one in found]).reshape(len(found), stations)
        data[name] = xr.Variable(("equilibrium", "u"), values, schema.labels(name, units))
    for name in EACH:
        values = np.array([getattr(one, name) for one in found])
        of = "held_energy" if name == "energy" and held_of(case) else name  # what the number is; the name stays
        data[name] = xr.Variable(("equilibrium",), values, schema.labels(of, units))
    parts = [elastic(one.solution) for one in found]
    for name in ELASTIC:
        data[name] = xr.Variable(("equilibrium",), np.array([part[name] for part in parts]), schema.labels(name, units))
    pushes = [observe(one.solution, PUSH) for one in found]
    for name in PUSH:
        values = np.array([float(push[name]) for push in pushes])
        data[name] = xr.Variable(("equilibrium",), values, schema.labels(name, units))
    data["count"] = xr.Variable((), len(found), COUNT)
    reactions = [one.solution.reactions for one in found]
    for name in reactions[0] if reactions else ():
        values = np.array([float(each[name]) for each in reactions])
        data[name] = xr.Variable(("equilibrium",), values, schema.labels(name, units))
    held = held_of(case)
    if held:
        dead = np.array([one.dead_index for one in found], dtype=np.int64)
        data["dead_index"] = xr.Variable(("equilibrium",), dead, DEAD_INDEX)
        data["found_by"] = xr.Variable(("equilibrium",), np.array([one.found_by for one in found], dtype=str))
    solved = np.array([bool(one.solution.solved) for one in found], dtype=bool)
    data["solved"] = xr.Variable(("equilibrium",), solved)
    data["outcome"] = xr.Variable(("equilibrium",), np.array([str(one.solution.outcome) for one in found], dtype=str))
    cautions_of = [str(cautions.of_cases(one.solution, unit=study.units.length)) for one in found]
    data["caution"] = xr.Variable(("equilibrium",), np.array(cautions_of, dtype=str))
    u = np.linspace(0, 1, stations)
    coords = {
        "equilibrium": xr.Variable(("equilibrium",), np.arange(1, len(found) + 1), {"long_name": "rank by energy"}),
        "u": xr.Variable(("u",), u, schema.labels("u", units)),
        "s": xr.Variable(("u",), u * float(case.rod.L), schema.labels("s", units)),
    }
    title = f"Equilibria with held ends: {choices(held)}" if held else "All equilibria with both end angles held"
    ds = xr.Dataset(data, coords, attributes(study, case, title))
    if isinstance(found, HeldEquilibria):
        ranges = (
            f"{name} from {low:.4g} to {high:.4g} {schema.labels(name, units)['units']}"
            for name, (low, high) in found.search.within.items()
        )
        told = {"remark": found.remark, "searched": ", ".join(ranges)}
        ds.attrs |= {"stability": f"under held ends ({choices(held)})", **told}
    return with_case(ds, case, units)


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
