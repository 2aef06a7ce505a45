"""All equilibria over an axis: joined into branches, folds marked, the study's laws judged on each branch."""

import json
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import xarray as xr

from solver import Case, equilibria
from solver.equilibria import Equilibrium
from solver.observe.observables import observe
from studies import Study
from studies.axes import quantity_of
from studies.laws import QUALIFIED, Law, decide

from ..commands.own_case import with_fields
from ..data import labels, schema
from ..figures.equilibria import attributes, with_case
from .folds import place
from .tracking import joined

EACH = ("dbeta0", "energy", "turns", "index", "attached")
STATIONS = 101


def sweep(study: Study, case: Case, name: str, values: Any, step: Callable[[str], None]) -> xr.Dataset:
    """Over (axis, member), members of each value by energy, NaN beyond their number: what is listed of each, the
    observables that the study's laws on this axis judge, and `branch`, its number. Over `fold`: where two branches
    meet. Attribute `branches`: a row each, with its laws' verdicts (`studies.laws.decide`), as JSON."""

    @cache
    def at(value: float) -> list[Equilibrium]:
        return equilibria(with_fields(case, {name: value}), stations=STATIONS)

    laws = [law for law in study.laws if law.axis == name]
    said = lambda value: step(f"{name} = {value:.4g}")  # noqa: E731
    found, branch, meets = joined(at, [float(value) for value in values], said)
    units = study.unit_system
    most = max((len(f) for f in found), default=0)
    wanted = list(dict.fromkeys(one for law in laws for one in law.observables if one not in EACH))
    table = {key: np.full((len(found), most), np.nan) for key in (*EACH, *wanted)}
    for k, members in enumerate(found):
        for i, one in enumerate(members):
            for key in EACH:
                table[key][k, i] = getattr(one, key)
            for key, value in observe(one.solution, wanted).items():
                table[key][k, i] = value
    dims = (name, "member")
    data: dict[str, Any] = {key: xr.Variable(dims, v, schema.labels(key, units)) for key, v in table.items()}
    data["branch"] = xr.Variable(dims, _padded(branch, most), {"long_name": "number of the branch, -1 for none"})
    outcome = [[str(f[i].solution.outcome) if i < len(f) else "" for i in range(most)] for f in found]
    solved = [[i < len(f) and bool(f[i].solution.solved) for i in range(most)] for f in found]
    data["solved"] = xr.Variable(dims, np.array(solved, dtype=bool).reshape(len(found), most))
    data["outcome"] = xr.Variable(dims, np.array(outcome, dtype=str).reshape(len(found), most))
    folded = [place(at, meet) for meet in meets]
    for i, (key, row) in enumerate((("fold", name), ("fold_dbeta0", "dbeta0"), ("fold_energy", "energy"))):
        labels = schema.labels(quantity_of(row).name, units)
        labels["long_name"] += " where two equilibria meet and cease to exist"
        data[key] = xr.Variable(("fold",), np.array([f[i] for f in folded], dtype=float), labels)
    numbers = np.array([[branch[m.k][m.i], branch[m.k][m.j]] for m in meets], dtype=np.int64).reshape(-1, 2)
    data["fold_branches"] = xr.Variable(("fold", "two"), numbers, {"long_name": "the two branches that meet"})
    ds = xr.Dataset(data, {name: xr.Variable((name,), values, schema.labels(quantity_of(name).name, units))})
    ds.attrs = attributes(study, case, f"All equilibria over {quantity_of(name).symbol}")
    ds.attrs["branches"] = json.dumps(_rows(ds, name, laws))
    return with_case(ds, case, units, skip=name)


def branches(ds: xr.Dataset) -> list[dict[str, Any]]:
    """A row a branch: where it begins and ends on the axis, index, turns at both ends, and each law's verdict."""
    return list(json.loads(ds.attrs["branches"]))


def folds(ds: xr.Dataset) -> list[dict[str, float]]:
    """Where two branches meet."""
    names = ("fold", "fold_dbeta0", "fold_energy")
    return [{name: float(ds[name][i]) for name in names} for i in range(ds.sizes["fold"])]


def _padded(rows: list[list[int]], most: int) -> Any:
    out = np.full((len(rows), most), -1, dtype=np.int64)
    for k, numbers in enumerate(rows):
        out[k, : len(numbers)] = numbers
    return out


def _rows(ds: xr.Dataset, name: str, laws: list[Law]) -> list[dict[str, Any]]:
    rows = []
    scale = 180 / np.pi if labels.is_angle(ds[name]) else 1.0
    for number in range(int(ds["branch"].max()) + 1 if ds["branch"].size else 0):
        k, i = np.nonzero(ds["branch"].values == number)
        turns = ds["turns"].values[k, i].astype(int)
        row: dict[str, Any] = {
            "branch": number, "from": float(ds[name].values[k[0]] * scale), "to": float(ds[name].values[k[-1]] * scale),
            "values": int(k.size), "index": int(ds["index"].values[k[0], i[0]]),
            "turns": f"{turns[0]} to {turns[-1]}" if turns[0] != turns[-1] else str(turns[0]),
        }  # fmt: skip
        for law in laws:
            said = decide(law, {one: ds[one].values[k, i] for one in law.observables}, {name: ds[name].values[k]})
            kinds = f": {', '.join(said['qualifications'])}" if said["verdict"] == QUALIFIED else ""
            row[f"{law.observable} {law.direction}"] = said["verdict"] + kinds if k.size > 2 else "too short"
        rows.append(row)
    return rows
