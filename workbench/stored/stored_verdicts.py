"""The verdicts on the laws of a stored dataset, the numbers that their formulas use, and the tally of its cases."""

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from solver.problem.errors import InputError, choices
from studies.language.expressions import unit_names
from studies.language.printed import as_reading
from studies.laws import law_words
from studies.laws.case_rows import Grid
from studies.laws.judgement import Law, by_line, decide, refusal, targets
from studies.laws.law_verdict import LawVerdict, LawVerdicts
from studies.laws.line_verdicts import FAILS, HOLDS, TREND, UNDECIDED, branch_changes

from ..words import caution_words, escaping, outcome_counts
from . import quantity_variables, refined, schema
from .bounds import LINE
from .boxes import Columns, pieces
from .quantity_variables import dimension
from .schema import TEXTS

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from .stored_cases import StoredCases


Tally = dict[str, Counter[Any]]


def laws_of(ds: "xr.Dataset") -> list[Law]:
    """The laws that the dataset's study states; `InputError` where the attribute is not a list of laws."""
    try:
        laws = [Law.model_validate(row) for row in json.loads(ds.attrs["laws"])]
    except (KeyError, ValueError, TypeError, RecursionError):
        raise InputError("the dataset: the attribute laws is not a list of laws in JSON") from None
    for law in laws:
        for name, said in law.model_dump().items():
            if isinstance(said, str) and not escaping.is_line(said, LINE):
                raise InputError(f"the dataset: {name} of a law must be one line of text, got {escaping.show(said)}")
    return laws


def verdicts(ds: "xr.Dataset", crossing: "Mapping[str, NDArray[np.bool_]] | None" = None) -> LawVerdicts:
    """The verdicts on the laws of a dataset.

    A refined study is judged on all its cases: on the lines of its coarse grid, and in a plane also on those between
    them where a case goes against the law.

    A law along an axis that the reading of Table 1 drops is not tested: it is not decided. Values of rods that turn
    back against both their ends are left out, unless the law has `turned_back`.

    Parameters
    ----------
    ds : xr.Dataset
    crossing : dict, optional
        Axis -> the steps along it, in its rising order, between equilibria of two branches; default: those between
        which the dataset's variable `branch` (a number a case, negative where it has none) changes.

    Returns
    -------
    LawVerdicts
        One row a law, in the study's order; see `studies.laws.judgement.decide`.
    """
    rows, laws = [], laws_of(ds)
    study = refined.describe(ds) if laws and refined.has_all_cases(ds) else None
    for law in laws:
        left_out = _outside_the_law(ds, law)
        observed = {name: _without(ds[name].values, left_out) for name in law.observables if name in ds}
        if study is not None:
            values, branch = {name: ds[name].values for name in study.lattice.axes}, ds.get("branch")
            of_all = study.rows(law.axis, values, None if branch is None else branch.values)
            grid = replace(_grid(ds, law, None), axes=study.lattice.axes, rows=of_all)
        else:
            grid = _grid(ds, law, crossings(ds, law.axis) if crossing is None else crossing.get(law.axis))
        row = decide(law, observed, grid)
        if left_out.any():
            row["reason"] = law_words.join([row["reason"], _reason_left_out(left_out)])
        rows.append(_row_of_untested(law, row) if _is_inert(ds, law) else row)
    return LawVerdicts(rows)


def _outside_the_law(ds: "xr.Dataset", law: Law) -> "NDArray[np.bool_]":
    """The cases whose values do not enter a law, (*cases) of bool: rods that turn back against both their ends."""
    if law.turned_back or "caution" not in ds:
        return np.zeros(ds["outcome"].shape, dtype=bool)
    return caution_words.has_key(schema.over_cases(ds, ds["caution"]), caution_words.TURNED)


def _without(values: Any, left_out: "NDArray[np.bool_]") -> Any:
    """The values of all cases, NaN of those that are left out; the array itself where none is."""
    return np.where(left_out, np.nan, values) if left_out.any() else values


def _reason_left_out(left_out: "NDArray[np.bool_]") -> str:
    count = int(left_out.sum())
    words = ("turn back and are", "turns back and is")[count == 1]
    return f"{count} of {left_out.size} rods {words} left out"


def _grid(ds: "xr.Dataset", law: Law, steps: "NDArray[np.bool_] | None") -> Grid:
    """What a law is judged on besides its observables."""
    axes = {str(dim): ds[dim].values for dim in ds["outcome"].dims}
    counts = [name for name in law.observables if name in ds and quantity_variables.is_count(ds[name])]
    solved = {"solved": ds["solved"].values & ~_outside_the_law(ds, law)} if "solved" in ds else {}
    return Grid(axes, steps, counts, {**_numbers_of_law(ds, law), **solved})


def _is_inert(ds: "xr.Dataset", law: Law) -> bool:
    """Whether the reading of Table 1 drops the axis of a law, so that no case depends on it."""
    reading = str(ds.attrs.get("reading", ""))
    return bool(reading) and as_reading(reading).inert_field == law.axis


def _row_of_untested(law: Law, row: Mapping[str, Any]) -> LawVerdict:
    """The row of a law that is not tested, with the values that were measured."""
    untested = refusal(law, f"not tested along {law.axis}: {law.axis} has no effect under this reading")
    also = [
        {**new, "first": old["first"], "last": old["last"]}
        for new, old in zip(untested["also"], row["also"], strict=True)
    ]
    return LawVerdict({**untested, "first": row["first"], "last": row["last"], "also": also})


def verdicts_of_lines(stored: "StoredCases", law: Law) -> "xr.DataArray":
    """The verdict on a law on each line of the grid along its axis, over the other axes; see `judgement.by_line`."""
    import xarray as xr

    ds, axes = stored.ds, stored.axes
    others = [dim for dim in axes if dim != law.axis]
    if _is_inert(ds, law):
        values = np.full([ds.sizes[dim] for dim in others], UNDECIDED)
    else:
        observed = _without(ds[law.observable].transpose(*axes).values, _outside_the_law(ds, law))
        values = by_line(law, observed, _grid(ds, law, crossings(ds, law.axis)))
    return xr.DataArray(values, {dim: ds[dim] for dim in others}, others)


def crossings(ds: "xr.Dataset", axis: str) -> "NDArray[np.bool_] | None":
    """The steps along an axis, in its rising order, between which the number of the branch changes: bools over the
    grid, but one fewer along the axis. None where the dataset tells of no branches."""
    if "branch" not in ds or set(ds["branch"].dims) != set(ds["outcome"].dims):
        return None
    order = np.argsort(ds[axis].values, kind="stable")
    dims = [*(dim for dim in ds["outcome"].dims if dim != axis), axis]
    branch = ds["branch"].transpose(*dims).isel({axis: order}).values
    return np.moveaxis(branch_changes(branch), -1, list(ds["outcome"].dims).index(axis))


def status(unsolved: int, rows: Sequence[Mapping[str, Any]]) -> int:
    """The exit status: 0 where every case was solved and every law is true, at least as a trend; else 1."""
    return int(unsolved > 0 or any(row["verdict"] not in (HOLDS, TREND) for row in rows))


def is_refuted(unsolved: int, rows: Sequence[Mapping[str, Any]]) -> bool:
    """Whether a case is unsolved, or a law is false or not decided; one that is true in part is not refuted."""
    return unsolved > 0 or any(row["verdict"] in (UNDECIDED, FAILS) for row in rows)


def _numbers_of_law(ds: "xr.Dataset", law: Law) -> "dict[str, NDArray[np.float64]]":
    """The numbers that the formulas of a law use. Raises `InputError` for a name that is missing."""
    names = dict.fromkeys(name for formula in law.formulas.values() for name in formula.names)
    return {name: np.asarray(schema.over_cases(ds, _number_of(ds, name)), dtype=float) for name in names}


def numbers_compared(ds: "xr.Dataset", law: Law) -> "dict[str, NDArray[np.float64]]":
    """The numbers with which a law compares its observable, by key, of each case. Raises `InputError`."""
    numbers = targets(law, ds["outcome"].shape, _numbers_of_law(ds, law))
    return {key: values for key, (values, _) in numbers.items()}


def _number_of(ds: "xr.Dataset", name: str) -> Any:
    """A number by its name in a formula: of a field, a stored variable, a stiffness or a unit."""
    import xarray as xr

    if name in unit_names({key: str(ds.attrs[f"{key}_unit"]) for key in ("length", "force")}):
        return xr.DataArray(1.0)
    if name == "torsional_stiffness":
        return quantity_variables.torsional_stiffness(str(ds.attrs["stiffness"]), ds)
    if name == "bending_stiffness":
        return quantity_variables.bending_stiffness(str(ds.attrs["stiffness"]), ds)
    try:
        key = dimension(name)
    except InputError:
        key = name  # an expression
    if key not in ds.variables or not set(ds[key].dims) <= set(ds["outcome"].dims) or ds[key].dtype.kind not in "iufb":
        stored = [str(variable) for variable in ds.variables if set(ds[variable].dims) <= set(ds["outcome"].dims)]
        raise InputError(f"the dataset stores no number {name!r} of each case; available: {choices(stored)}")
    return ds[key]


def boundary_of_law(stored: "StoredCases", refinement: "refined.Refined", law: Law) -> "xr.Dataset":
    """The boundary of a law, as `StoredStudy.boundary` gives it: pairs of neighbouring lines with other verdicts.

    Raises `InputError` for a dataset that is not refined in the plane.
    """
    if len(refined.axes_of(stored.ds)) < 2:
        raise InputError("the boundary of a law needs a study that is refined in the plane of two axes")
    index, values = refinement.lines(law.axis)
    (across,) = (name for name in values if name != law.axis)
    each = verdicts_of_lines(type(stored)(refined.grid_of(stored.ds, index, values)), law).values
    change = np.flatnonzero(each[1:] != each[:-1])
    sides = [("pair", each[change + side].astype(str)) for side in (0, 1)]
    places = {across: (values[across][change], values[across][change + 1])}
    return refined.pairs(stored.ds, places, sides, "lines").assign_attrs(law=law.claim)


def tally_of(statistics: Mapping[str, Any] | None = None) -> Tally:
    """The tally of an existing file by its statistics, or an empty one."""
    if statistics is None:
        return {name: Counter() for name in ("solved", *TEXTS, "branch")}
    texts = {"outcome": Counter(statistics["outcomes"]), "caution": Counter(statistics["cautions"])}
    branch = Counter({int(number): cases for number, cases in statistics["branch_counts"].items()})
    return {"solved": Counter({False: statistics["unsolved"]}), **texts, "branch": branch}


def count(columns: Columns, tally: Tally) -> int:
    """Add the columns to the tally, and return how many of their cases are not solved."""
    if "branch" in columns:
        tally["branch"].update(outcome_counts.count_branches(columns["branch"]))
    for name in TEXTS:
        tally[name].update(columns[name].astype(str).ravel().tolist())
        tally[name] = outcome_counts.group(tally[name])
    unsolved = int(np.count_nonzero(~columns["solved"]))
    tally["solved"][False] += unsolved
    return unsolved


def statistics(ds: "xr.Dataset", tally: Tally | None = None) -> dict[str, Any]:
    """What is said of a stored study without reading its cases again: the tally, the verdicts, sentences.

    tally: of all cases of the dataset; default: counted here, block by block.
    """
    if tally is None:
        tally = tally_of()
        names = [name for name in ("solved", *TEXTS, "branch") if name in ds]
        for piece in pieces(ds.variables, names):
            count({name: piece[name].values for name in names}, tally)
    return {
        "unsolved": tally["solved"][False],
        **{f"{name}s": dict(sorted(tally[name].items())) for name in TEXTS},
        "laws": verdicts(ds),
        "equilibria": str(ds.attrs.get("equilibria", "")),
        "branches": _branches(ds, tally["branch"]),
        "branch_counts": dict(sorted(tally["branch"].items())),
        **{name: str(ds.attrs[name]) for name in refined.SAMPLING if name in ds.attrs},
    }


def _branches(ds: "xr.Dataset", counts: Mapping[int, int]) -> str:
    """One sentence about the branches of a study; counts: branch -> how many cases; none for a study without."""
    if not counts:
        return ""
    several = sum(size > 1 for size in ds["branch"].shape) > 1
    return outcome_counts.branch_sentence(counts, ds["branch"].attrs.get("long_name") == outcome_counts.LEFT, several)
