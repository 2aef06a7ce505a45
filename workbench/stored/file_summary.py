"""The summary of a stored dataset, read block by block, however many cases it has."""

import os
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver.observe.observables import OBSERVABLES
from solver.problem.declared_fields import PAIRS, VARY_LOADS
from solver.problem.errors import InputError
from studies.grammar.axes import SAMPLE
from studies.laws import law_words

from ..geometry.centreline import cut, spline
from ..words import caution_words, labels
from . import file_kinds, quantity_variables, reading, refined
from .derived_arrays import azimuths_of, states_of
from .solved_again import study_of
from .stored_cases import HELD_INDEX, StoredCases
from .stored_study import StoredStudy
from .stored_verdicts import statistics

if TYPE_CHECKING:
    from solver.nodes.pipe_states import StretchState

MOST_PLACES = 12  # of a boundary along one axis that are listed
MOST_STATES, MOST_COUNTED = 50, 2000  # rods whose states are listed; rods whose states are counted
DENSE = 3  # stations from one change of sign of beta to the next
# places between two stations at which the states are judged. x10: as good, and slower
PARTS = 16
AGAIN, FINE = 12, 1601  # rods of a file that are solved again at so many stations where the stored ones are too few
TOO_FEW = "too few stations along the rod are stored; a study with more, such as stations = 1601, says it"
NO_PUSH = "helical, or drawn by tension: the push along the rod is not stored"


def summary(path: Path) -> dict[str, Any]:
    """What the file holds, as plain data; "laws" are rows as of `stored_verdicts.verdicts`. Raises `InputError`.

    Memory: one number a case, for one observable at a time.
    """
    with reading.open_study(path, whole=True) as ds:
        data: dict[str, Any] = {"file": str(path), "bytes": os.stat(path).st_size}
        data |= {key: str(ds.attrs[key]) for key in ("title", "study_name", "reading", "method")}
        data |= {"tolerance": float(ds.attrs["tolerance"]), "format": int(ds.attrs["format"])}
        data |= {key: str(ds.attrs.get(key, "")) for key in ("created", "caution", *refined.SAMPLING)}
        stored = StoredStudy(ds)
        data["versions"] = stored.versions
        data["unit_system"] = stored.units
        data["axes"] = [_axis(ds[name]) for name in stored.axes]
        data["sampled"] = [_axis(ds[name]) for name in stored.sampled]
        data["stations"] = ds.sizes.get("u", 0)
        data["along"] = [name for name in quantity_variables.CURVES if name in ds.data_vars]
        data["boundaries"] = _boundaries(stored)
        data["cases"] = ds["outcome"].size
        counted = statistics(ds)
        data |= {key: counted[key] for key in ("unsolved", "equilibria", "branches", "laws")}
        data["outcomes"] = dict(Counter(counted["outcomes"]).most_common())
        data["observables"] = [_spread(ds[name]) for name in _observables(ds)]
        data["states"] = _states(stored)
        data["worst"] = [_worst(stored, name) for name in ("error", "condition")]
        data["verdicts"] = law_words.tally(data["laws"])
    return data


def _states(stored: StoredStudy) -> list[dict[str, Any]]:
    """The states along each rod with weight or friction, in words; of more than `MOST_STATES` rods, how many have which
    at their most buckled place; none of more than `MOST_COUNTED`.
    """
    from solver.nodes.pipe_states import in_words  # it loads the methods

    loaded = {*VARY_LOADS} & set(stored.ds.variables) and {"beta", "alpha"} <= set(stored.variables)
    if not loaded or stored.cases > MOST_COUNTED:
        return []
    rows, counts = list[dict[str, Any]](), Counter[str]()
    for place in np.ndindex(stored["outcome"].shape):
        case = stored.select(dict(zip(stored.axes, place, strict=True)))
        axes = {name: float(case[name]) for name in stored.axes}
        parts = _state(case, stored.cases <= AGAIN) if case["solved"] else "not solved"
        state = parts if isinstance(parts, str) else in_words(parts, case.units["length"])
        rows.append({**axes, "state": state})
        counts[parts if isinstance(parts, str) else _worst_state(parts)] += 1
    return rows if len(rows) <= MOST_STATES else [{"state": state, "cases": n} for state, n in counts.most_common()]


def _worst_state(parts: "tuple[StretchState, ...]") -> str:
    """The state of a rod at its most buckled place."""
    from solver.nodes.pipe_states import HELICAL, SINUSOIDAL, STRAIGHT

    words = {part.word for part in parts}
    return next(
        (f"{word} in a part or all along" for word in (HELICAL, SINUSOIDAL) if word in words), f"{STRAIGHT} all along"
    )


def _is_dense(case: StoredStudy) -> bool:
    """Whether each wave of one rod has at least `DENSE` stations between its ends."""
    from solver.nodes.pipe_states import BENT

    sign = np.sign(case["beta"].values)
    ends = np.flatnonzero(sign[1:] * sign[:-1] < 0)
    waves = np.abs(np.diff(case["alpha"].values[ends])) >= BENT
    return bool((np.diff(ends)[waves] >= DENSE).all())


def _state(case: StoredStudy, again: bool) -> "tuple[StretchState, ...] | str":
    """The states along one rod; `TOO_FEW` where the stations are too few, also after it is solved again if `again`."""
    from solver.nodes.pipe_states import HELICAL

    if not _is_dense(case):
        try:
            case = case.solve(max(FINE, case["s"].size), ["beta", "alpha", "contact"]) if again else case
        except InputError:
            return TOO_FEW
        if not _is_dense(case):
            return TOO_FEW
    parts = states_of(case, *_between_stations(case, "beta", "alpha"))
    if all(part.word != HELICAL for part in parts):
        return parts
    if "contact" not in case:  # whether the wall pushes decides
        try:
            case = case.solve(case["s"].size, ["beta", "alpha", "contact"])
        except InputError:
            return NO_PUSH
    return states_of(case, *_between_stations(case, "beta", "alpha", "push"))


def _between_stations(case: StoredStudy, *names: str) -> list[Any]:
    """s, and arrays along one rod from splines through the stations, at `PARTS` times as many places."""
    known = {name: case.arrays.derive(name).values for name in (*names, *["radius"] * case.leaves)}
    known["s"] = s = case["s"].values
    known["alpha"], places = azimuths_of(case, known), cut(s, PARTS)
    return [places, *(spline(s, known[name])(places) for name in names)]


def _observables(ds: xr.Dataset) -> list[str]:
    """The observables, the reactions of held ends, other loads and end moments that the study names, and the index."""
    try:
        study = study_of(ds)
        names, reactions = study.wanted, [load for load, partner in PAIRS if partner in study.held]
    except InputError:  # a file without the text of its study
        names, reactions = [], []
    holding = [name for name in OBSERVABLES if name in names and OBSERVABLES[name].holds and name not in reactions]
    known = [name for name in (*reactions, *holding, HELD_INDEX) if name in ds.data_vars]
    return [*quantity_variables.observables_of(ds), *known]


def _boundaries(stored: StoredStudy) -> list[dict[str, Any]]:
    """The located boundary of each watched observable of a refined study, along each axis that crosses it."""
    rows: list[dict[str, Any]] = []
    if not stored.is_refined:
        return rows
    study = stored.refinement
    each = [(name, stored.boundary(name)) for name in study.watch]
    each += [(f"law {claim}", stored.boundary(claim)) for claim in study.laws]
    for name, pairs in each:
        for axis in map(str, pairs.coords):
            half = pairs[f"{axis}_half_width"].values
            middle = pairs[axis].values[half > 0]
            row: dict[str, Any] = {"name": name, "axis": axis, "pairs": int(middle.size)}
            row |= dict.fromkeys(("from", "to", "half_width"))
            if middle.size:
                row |= {"from": float(middle.min()), "to": float(middle.max()), "half_width": float(half.max())}
            row["places"] = _places(pairs, axis) if len(pairs.coords) == 1 and middle.size <= MOST_PLACES else []
            row |= {"units": str(stored[axis].attrs.get("units", "")), "unknown": pairs.attrs.get("unknown", 0)}
            rows.append(row)
    return rows


def _places(pairs: xr.Dataset, axis: str) -> list[dict[str, Any]]:
    """Each place of a boundary along a single axis, in rising order."""
    order = np.argsort(pairs[axis].values)
    keys = {"at": axis, "half_width": f"{axis}_half_width", "before": "before", "after": "after"}
    return [{key: pairs[name].values[i].item() for key, name in keys.items()} for i in order]


def _axis(axis: xr.DataArray) -> dict[str, Any]:
    values = axis.values
    ends = {"count": int(values.size), "from": float(values.min()), "to": float(values.max())}
    return {"name": str(axis.name), **ends, "units": str(axis.attrs.get("units", ""))}


def _numbers(variable: xr.DataArray) -> NDArray[np.float64]:
    """All the values of one number a case, (cases,)."""
    return variable.values.ravel().astype(float)


def _spread(variable: xr.DataArray) -> dict[str, Any]:
    """Smallest, median and largest value, None where there is none; the dimensions, and how many values are missing."""
    values = _numbers(variable)
    finite = values[np.isfinite(values)]
    three = (float(f(finite)) if finite.size else None for f in (np.min, np.median, np.max))
    return {
        "name": str(variable.name),
        "over": " x ".join(map(str, variable.dims)),
        "units": str(variable.attrs.get("units", "")),
        **dict(zip(("min", "median", "max"), three, strict=True)),
        "missing": int(values.size - finite.size),
    }


def _worst(stored: StoredStudy, name: str) -> dict[str, Any]:
    """The largest value of one number of the solved cases, and the place of its case on the axes and among samples."""
    variable = stored[name]
    values = np.where(_numbers(stored["solved"]) > 0, _numbers(variable), np.nan)
    if not np.isfinite(values).any():
        return {"name": name, "value": None, "at": {}}
    i = int(np.nanargmax(np.where(np.isfinite(values), values, np.nan)))
    where = np.unravel_index(i, variable.shape)
    at = {str(dim): variable[dim][k].item() for dim, k in zip(variable.dims, where, strict=True)}
    at |= {field: stored[field].sel({SAMPLE: at[SAMPLE]}).item() for field in stored.sampled}
    return {"name": name, "value": float(values[i]), "at": at}


def least_accurate(path: Path) -> dict[str, Any]:
    """The solved case of the largest error: `error`, `outcome`, and `at`, its place on the axes in words.

    Raises `InputError`.
    """
    with reading.open_study(path) as ds:
        worst = _worst(StoredStudy(ds), "error")
        at = [f"{name} = {labels.value(value, ds[name], 6)}" for name, value in worst["at"].items()]
        outcome = ds["outcome"].sel({str(dim): worst["at"][dim] for dim in ds["outcome"].dims})
        return {"error": worst["value"], "outcome": str(outcome.values), "at": ", ".join(at)}


def brief_law(row: dict[str, Any]) -> dict[str, Any]:
    """A law's row with the number of its exceptions, of which there may be as many as cases, in place of their list."""
    short = {key: value for key, value in row.items() if key not in ("exceptions", "also")}
    said = {"stated": law_words.law_in_words(row), "said": law_words.sentence(row)}
    return {**short, **said, "exceptions": len(row["exceptions"])}


SENTENCES = ("stability", "begin", "end", "remark", "searched")  # attributes that are printed as they are


def contents(path: Path) -> dict[str, Any]:
    """What the file holds, as plain data. Raises `InputError`."""
    ds = reading.read(path, study=False)
    each = {str(name): variable for name, variable in ds.variables.items() if "u" not in variable.dims}
    numbers = [name for name, variable in each.items() if variable.dtype.kind in "iuf"]
    solved = ds["solved"].values.astype(bool) if "solved" in ds else np.ones(0, dtype=bool)
    named = ds["outcome"].values.astype(str) if "outcome" in ds else np.zeros(0, dtype=str)
    texts = Counter(map(str, np.ravel(ds["caution"].values))) if "caution" in ds else Counter()
    return {
        "file": str(path),
        "bytes": os.stat(path).st_size,
        "kind": file_kinds.kind_of(ds).what,
        "title": str(ds.attrs.get("title", "")),
        "sizes": {str(dim): int(size) for dim, size in ds.sizes.items()},
        "along": [str(name) for name, variable in ds.data_vars.items() if "u" in variable.dims],
        "numbers": [_spread(ds[name]) for name in numbers if ds[name].ndim],
        "fields": [_spread(ds[name]) for name in numbers if not ds[name].ndim],
        "outcomes": dict(Counter(named[named != ""].tolist())),
        "unsolved": int((~solved & (named != "")).sum()) if solved.shape == named.shape else 0,
        "caution": caution_words.tell(texts),
        "said": {key: str(ds.attrs[key]) for key in SENTENCES if ds.attrs.get(key)},
        "versions": StoredCases(ds).versions if "versions" in ds.attrs else {},
    }
