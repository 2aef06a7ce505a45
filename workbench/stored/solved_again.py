"""The study and the cases of a stored dataset, solved again or at other values."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver import Case, Ends, Solution, solve
from solver.free.free_rods import trajectory_of
from solver.orbits.forces import push_from
from solver.orbits.joined_orbits import Rows
from solver.problem.case_fields import values_of, with_field
from solver.problem.declared_fields import FIELDS
from solver.problem.errors import InputError, check_known
from solver.solution import FreeSolution
from solver.solve import own_ends
from studies import Study
from studies.grammar.axes import SAMPLE, WORDS, Dimension, quantity_of
from studies.language.case_input import case_to_solve
from studies.language.loader import loads
from studies.language.study import MAX_STATIONS

from ..words.free_rod_words import error_beside
from . import quantity_variables, schema
from .case_solving import method_of, solve_one
from .chosen_cases import SAME, real
from .sweep import Sweep, between

POINT = "point"  # a dimension and its variables
POINT_FORCES = ("point_force_at", "point_force", "point_force_error")
AGREES = 1e-4  # rad, or a share of the length or of the largest value: by which a rod may differ that is solved again
MOST_SOLVED = 10_000  # cases that are solved again: seconds


def study_of(ds: xr.Dataset) -> Study:
    """The study of a dataset, under its reading and with the samples of the dataset; `InputError` where it has none."""
    if not ds.attrs.get("study"):
        raise InputError("the dataset holds no study that solves its cases again")
    values = samples_of(ds)  # also where there are none: no table that the text names is read
    context = {"samples": Dimension(SAMPLE, values) if values else None}
    study = loads(schema.text_of(ds, "study"), "the dataset's study", schema.text_of(ds, "study_name"), context)
    return study.under(schema.text_of(ds, "reading") or None)


def case_of(ds: xr.Dataset, study: Study, values: Mapping[str, float] | None = None) -> Case:
    """The case of a dataset, of the shape of its remaining axes, at other values of some fields.

    An axis whose value is given has no dimension. Raises `InputError`.
    """
    values = dict(values or {})
    for name in study.variation.fields:
        if name not in values and quantity_variables.dimension(name) not in ds.coords:
            raise InputError(f"the dataset has lost its axis {quantity_variables.dimension(name)!r}")
    placed: dict[str, Any] = {**_places(ds, study, values), **values}
    if not study.variation.from_base:
        if values or "FZ" not in ds.data_vars:
            return case_to_solve(study, placed)
        case = study.case_of(placed)
        return _with_stored_force(ds, study, case) if study.varies and isinstance(case.given, Ends) else case
    (field,) = study.variation.fields
    return with_field(own_ends(study.case()), quantity_of(field).name, placed[field])


def _with_stored_force(ds: xr.Dataset, study: Study, case: Case) -> Case:
    """The case with the FZ that was found for it, where the study gives its force at s = 0."""
    stored = ds["FZ"].transpose(*schema.axes_left(ds, study)).values
    return with_field(case, "FZ", np.where(np.isfinite(stored), stored, values_of(case, "FZ"))[()])


def solve_at(ds: xr.Dataset, study: Study, values: Mapping[str, Any]) -> Solution:
    """Solve the dataset's cases, at other values of some fields, with its tolerance, method and stations.

    Raises `InputError` for a field that the study has not, or for more than `MOST_SOLVED` cases.
    """
    varies = study.variation
    fields = [*varies.fields] if varies.from_base else [name for name in study.fields if name not in WORDS]
    values = {quantity_variables.field_of(study, name): value for name, value in values.items()}
    for name in values:
        check_known("field", name, fields)
    values = {name: real(name, value) for name, value in values.items()}
    return _solve(ds, study, case_of(ds, study, values), values)


def _solve(ds: xr.Dataset, study: Study, case: Case, values: Mapping[str, Any] = {}) -> Solution:
    """Solve the case of the dataset at other values of some fields, none by default, as `solve_at`."""
    if case.size > MOST_SOLVED:
        many = f"{case.size} cases would have to be solved again, more than {MOST_SOLVED}"
        raise InputError(f"{many}; select some first, as ds.rod.sel({schema.axes_left(ds, study)[0]}=...).rod")
    tol, method = schema.number_of(ds, "tolerance"), schema.text_of(ds, "method")
    stations = _stations(ds, study, case)
    if study.sweeps:
        as_run = study.model_copy(update={"tol": tol, "method": method})
        return _swept(as_run, case, stations, {**_places(ds, study, values), **values})
    if not study.variation.from_base:
        return solve_one(case, study.equilibrium, tol, method, stations, study.let_go)
    return solve(case, tol=tol, method=method, stations=stations, seed=_slope(ds, study, case))


def solve_once(ds: xr.Dataset, study: Study, case: Case, kept: dict[Any, Solution]) -> Solution:
    """Solve the dataset's own case, rods off the wall only once: at other stations their shape is read anew.

    kept: these rods, by the values of their axes.
    """
    if not study.leaves or study.sweeps or study.variation.from_base:
        return _solve(ds, study, case)
    names = [quantity_variables.dimension(name) for name in study.variation.fields]
    key = tuple((name, np.asarray(ds[name].values).tobytes()) for name in names)
    known = kept.get(key)
    if known is None:
        known = kept[key] = _solve(ds, study, case)
    n = _stations(ds, study, known.case)
    t = known.t[:, -1:] * (np.linspace(0, 1, n) if isinstance(n, int) else np.atleast_1d(ds["u"].values))
    if np.array_equal(t, known.t):
        return known
    answers = trajectory_of(known.case, known.trajectory.free.answers, t, known.tol)
    return type(known)(known.case, *answers, t, known.method, known.tol)


def point_forces_of(sol: Solution, dims: Sequence[str]) -> dict[str, xr.Variable]:
    """The point forces of the wall on each case, over its dimensions and `POINT`: `POINT_FORCES`, where each acts
    [length], its size and the error of that [force]; NaN beyond their number."""
    assert isinstance(sol, FreeSolution)
    each = np.empty(sol.case.size, dtype=object)
    each[:] = [*sol.point_forces.ravel()] if sol.case.shape else [sol.point_forces]
    units = np.broadcast_to(sol.case.rod.bending_stiffness / sol.case.rho**2, sol.case.shape).ravel()
    rows = [
        [(s, force, error_beside(sol, s, 1, k) * unit) for s, force in pairs or ()]
        for k, (pairs, unit) in enumerate(zip(each, units, strict=True))
    ]
    most = max(map(len, rows), default=0)
    padded = np.array([row + [(np.nan, np.nan, np.nan)] * (most - len(row)) for row in rows], dtype=float)
    padded = padded.reshape(*sol.case.shape, most, 3)
    return {name: xr.Variable((*dims, POINT), padded[..., k]) for k, name in enumerate(POINT_FORCES)}


def at_stations(ds: xr.Dataset, stations: int) -> xr.Dataset:
    """A dataset without its arrays along the rod and with so many stations or a little more, the stored ones among
    them. Raises `InputError` for too many."""
    n = max(ds.sizes.get("u", 2) - 1, 1)
    more = -(-(stations - 1) // n)
    if more * n >= MAX_STATIONS:
        raise InputError(f"about {stations} stations are needed, and at most {MAX_STATIONS} are solved")
    u = xr.Variable(("u",), np.linspace(0, 1, more * n + 1), ds["u"].attrs if "u" in ds.coords else None)
    return (ds.drop_dims("u") if "u" in ds.dims else ds.drop_vars(["u", "s"], errors="ignore")).assign_coords(u=u)


def with_arrays(bare: xr.Dataset, study: Study, sol: Solution, names: Iterable[str]) -> xr.Dataset:
    """A dataset of `at_stations` with arrays along the rod of the solution of its cases."""
    axes = schema.axes_left(bare, study)
    dims = (*axes, "u")
    shape = [bare.sizes[dim] for dim in dims]

    def array(values: Any) -> xr.Variable:
        return xr.Variable(dims, np.broadcast_to(np.asarray(values), shape))

    def along(name: str) -> Any:
        return push_from(sol.contact, schema.text_of(bare, "side")) if name == "push" else getattr(sol, name)

    arrays = {quantity_variables.curve_name(name): array(along(name)) for name in names}
    denser = bare.assign_coords(s=array(sol.s)).assign(arrays)
    return denser.assign(point_forces_of(sol, axes)) if isinstance(sol, FreeSolution) else denser


def check_shapes(ds: xr.Dataset, denser: xr.Dataset) -> None:
    """Raise `InputError` where the cases of a dataset, solved again at more stations, have other shapes than stored."""
    for name in (str(name) for name in denser.data_vars if "u" in denser[name].dims and name in ds):
        dims = denser[name].dims
        solved = ds["solved"].transpose(*dims[:-1]).values
        stored = ds[name].transpose(*dims).values[solved]
        size = {"beta": 1.0, "alpha": 1.0, "z": float(np.max(denser["s"].values))}.get(name)
        size = np.abs(stored).max(initial=0.0) if size is None else size
        again = denser[name].values[..., :: (denser.sizes["u"] - 1) // max(ds.sizes["u"] - 1, 1)][solved]
        if not np.abs(again - stored).max(initial=0.0) <= AGREES * size:
            raise InputError(f"solved again, the cases have other shapes than the file: {name} differs")


def _places(ds: xr.Dataset, study: Study, values: Mapping[str, Any]) -> dict[str, Any]:
    """The values of the study's varied fields that are not given: one where selected, else along their dimension."""
    left = [name for name in study.variation.fields if name not in values]
    dims = {name: quantity_variables.own_dimension(study, name) for name in left}
    open_axes = [dim for dim in schema.axes_left(ds, study) if dim in dims.values()]
    placed: dict[str, Any] = {}
    for name in left:
        shape = [-1 if dims[name] == other else 1 for other in open_axes if dims[name] in open_axes]
        placed[name] = ds[quantity_variables.dimension(name)].values.reshape(shape)
    return placed


def samples_of(ds: xr.Dataset) -> dict[str, NDArray[np.float64]]:
    """The samples of a dataset, or the one that is selected: field -> values. Raises `InputError`."""
    fields = schema.fields_of_samples(ds)
    for name in fields:
        if name not in FIELDS or quantity_variables.dimension(name) not in ds.coords:
            raise InputError(f"the dataset has lost its sampled field {name!r}")
    return {name: np.atleast_1d(ds[quantity_variables.dimension(name)].values).astype(float) for name in fields}


def _swept(study: Study, case: Case, stations: Any, places: Mapping[str, Any]) -> Solution:
    """Cases at or between those of a sweep. places: field -> its values, of all that the cases do not share."""
    over = study.variation.dimensions
    study = study.model_copy(update={"method": method_of(study, over)})
    sweep = Sweep(study, over.fields, 1, keeps_all=True)
    rows = {name: np.broadcast_to(value, case.shape).ravel() for name, value in places.items()}
    solutions = []
    for i in range(case.size):
        place = {name: float(row[i]) for name, row in rows.items()}
        at = stations if isinstance(stations, int) else np.broadcast_to(stations, (*case.shape, np.shape(stations)[-1]))
        mine = at if isinstance(at, int) else at.reshape(case.size, -1)[i]
        solutions.append(between(study, study.case_of(place), partial(sweep.nearest, place), mine))
    return solutions[0] if not case.shape else _together(case, solutions)


def _together(case: Case, solutions: list[Solution]) -> Solution:
    """Solutions of single cases as the one solution of their grid."""
    rows = Rows(len(solutions))
    for sol in solutions:
        answer = replace(sol.trajectory, swirl=None, orbit=None, shapes=None)  # type: ignore[arg-type]
        rows.add((answer, sol.problem, sol.t, sol.trajectory.swirl()))
    answer, problem, t, swirl = rows.join()
    answer = replace(answer, swirl=partial(np.asarray, swirl))
    return Solution(case, problem, answer, t, solutions[0].method, solutions[0].tol)


def _stations(ds: xr.Dataset, study: Study, case: Case) -> Any:
    """The number of stations; or their arc lengths, where they are not evenly spaced from end to end."""
    if "u" not in ds.coords:
        return study.stations
    u = np.atleast_1d(ds["u"].values)
    if np.array_equal(u, np.linspace(0.0, 1.0, u.size)):
        return u.size
    return np.broadcast_to(np.asarray(case.rod.L), case.shape)[..., None] * u


def _slope(ds: xr.Dataset, study: Study, case: Case) -> Any:
    """beta'(0) near that of the followed equilibrium, of the shape of the case. Raises `InputError` past the fold."""
    (name,) = map(quantity_variables.dimension, study.variation.fields)
    targets, fold = np.broadcast_to(values_of(case, name), case.shape), float(ds["fold"])
    values, slopes = np.atleast_1d(*np.broadcast_arrays(ds[name].values, ds["dbeta0"].values))
    rises = 1 if fold >= values.max() else -1  # the fold is the last value
    beyond = rises * (targets - fold) > SAME * abs(fold)  # never where there is no fold, as that is stored as NaN
    if beyond.any():
        far = targets[beyond][np.abs(targets[beyond] - fold).argmax()]
        raise InputError(f"{name} = {far:.10g} lies beyond the fold at {fold:.10g}, where the equilibrium ends")
    order = np.argsort(values)
    return np.interp(targets, values[order], slopes[order])
