"""All equilibria over an axis as a dataset: branches, folds, and the study's laws judged on each branch."""

import json
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver import Case, equilibria
from solver.equilibria import Equilibrium
from solver.observe.observables import OBSERVABLES, observe
from studies import Study
from studies.axes import quantity_of
from studies.law import Law
from studies.laws import QUALIFIED, decide

from ..data import schema
from ..run.case_input import with_fields
from .equilibria_dataset import EACH, attributes, with_case
from .folds import fold_at
from .tracking import Meeting, track

STATIONS = 101


def sweep(study: Study, case: Case, name: str, values: Any, step: Callable[[str], None]) -> xr.Dataset:
    """All equilibria of an ends problem at each value of one field, joined into branches.

    Parameters
    ----------
    study
        The study of the case: its units, and the laws to judge on each branch.
    case
        The ends problem.
    name, values
        The field that varies and its values, (n,), rising; angles in rad.
    step
        Called with a text before each value is solved.

    Returns
    -------
    Over (axis, member), members by rising energy and NaN beyond their number: the numbers of `EACH`, the observables
    of the study's laws on this axis, the outcome, and `branch`, the number of the branch (-1: no member). Over
    `fold`: where two branches meet. The attribute `branches` holds a row for each branch, with the verdict of each
    law, as JSON.
    """

    @cache
    def at(value: float) -> list[Equilibrium]:
        return equilibria(with_fields(case, {name: value}), stations=STATIONS)

    laws = [law for law in study.laws if law.axis == name and _is_of_observables(law)]
    units = study.unit_system
    found, branch, meetings = track(at, [float(x) for x in values], lambda value: step(f"{name} = {value:.4g}"))
    most = max((len(members) for members in found), default=0)
    dims = (name, "member")
    data: dict[str, Any] = {
        key: xr.Variable(dims, numbers, schema.labels(key, units))
        for key, numbers in _numbers(found, most, laws).items()
    }
    data["branch"] = xr.Variable(dims, _padded(branch, most), {"long_name": "number of the branch, -1 for none"})
    outcome = [[str(f[i].solution.outcome) if i < len(f) else "" for i in range(most)] for f in found]
    solved = [[i < len(f) and bool(f[i].solution.solved) for i in range(most)] for f in found]
    data["solved"] = xr.Variable(dims, np.array(solved, dtype=bool).reshape(len(found), most))
    data["outcome"] = xr.Variable(dims, np.array(outcome, dtype=str).reshape(len(found), most))
    folded = [fold_at(at, meeting) for meeting in meetings]
    for i, (key, row) in enumerate((("fold", name), ("fold_dbeta0", "dbeta0"), ("fold_energy", "energy"))):
        labels = schema.labels(quantity_of(row).name, units)
        labels["long_name"] += " where two equilibria meet and cease to exist"
        data[key] = xr.Variable(("fold",), np.array([f[i] for f in folded], dtype=float), labels)
    pairs = _branch_pairs(branch, meetings)
    data["fold_branches"] = xr.Variable(("fold", "two"), pairs, {"long_name": "the two branches that meet"})
    ds = xr.Dataset(data, {name: xr.Variable((name,), values, schema.labels(quantity_of(name).name, units))})
    ds.attrs = attributes(study, case, f"All equilibria over {quantity_of(name).symbol}")
    ds.attrs["branches"] = json.dumps(_rows(ds, name, laws))
    return with_case(ds, case, units, skip=name)


def branches(ds: xr.Dataset) -> list[dict[str, Any]]:
    """A row for each branch: its first and last value of the axis, index, number of bends, and each law's verdict."""
    return list(json.loads(ds.attrs["branches"]))


def folds(ds: xr.Dataset) -> list[dict[str, float]]:
    """Axis value, beta'(0) and energy of each fold."""
    names = ("fold", "fold_dbeta0", "fold_energy")
    return [{name: float(ds[name][i]) for name in names} for i in range(ds.sizes["fold"])]


def _numbers(found: Sequence[Sequence[Equilibrium]], most: int, laws: Sequence[Law]) -> dict[str, NDArray[np.float64]]:
    """The numbers of `EACH` and the observables of the laws, (values, most) each."""
    judged = list(dict.fromkeys(one for law in laws for one in law.observables if one not in EACH))
    table = {key: np.full((len(found), most), np.nan) for key in (*EACH, *judged)}
    for k, members in enumerate(found):
        for i, one in enumerate(members):
            numbers = {key: getattr(one, key) for key in EACH} | observe(one.solution, judged)
            for key, value in numbers.items():
                table[key][k, i] = value
    return table


def _is_of_observables(law: Law) -> bool:
    """Whether a law is about the direction of observables; expressions and formulas are those of a stored study."""
    return law.direction is not None and set(law.observables) <= set(OBSERVABLES)


def _branch_pairs(branch: Sequence[Sequence[int]], meetings: Sequence[Meeting]) -> NDArray[np.int64]:
    pairs = [[branch[m.k][m.i], branch[m.k][m.j]] for m in meetings]
    return np.array(pairs, dtype=np.int64).reshape(-1, 2)


def _padded(rows: list[list[int]], most: int) -> Any:
    out = np.full((len(rows), most), -1, dtype=np.int64)
    for k, numbers in enumerate(rows):
        out[k, : len(numbers)] = numbers
    return out


def _rows(ds: xr.Dataset, name: str, laws: list[Law]) -> list[dict[str, Any]]:
    rows = []
    scale = 180 / np.pi if ds[name].attrs["units"] == "rad" else 1.0
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
