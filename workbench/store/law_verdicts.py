"""The verdicts on the laws of a stored dataset; nothing is solved."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from studies.grammar.dimensions import SAMPLE
from studies.language.readings import DROPPED
from studies.laws import verdict_words
from studies.laws.law import Law
from studies.laws.verdicts import FAILS, HOLDS, QUALIFIED, TREND, UNDECIDED, VERDICTS, by_line, decide, refusal

from . import law_numbers, refined, schema

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray


def verdicts(ds: "xr.Dataset", crossing: "Mapping[str, NDArray[np.bool_]] | None" = None) -> list[dict[str, Any]]:
    """The verdicts on the laws of a dataset. A refined study is judged on its coarse grid.

    A law along an axis that the reading of Table 1 drops is not tested: it is not decided.

    Parameters
    ----------
    ds : xr.Dataset
    crossing : dict, optional
        Axis -> the steps along it, in its rising order, between equilibria of two branches; default: those between
        which the dataset's variable `branch` (a number a case, negative where it has none) changes.

    Returns
    -------
    list of dict
        One row a law, in the study's order; see `studies.laws.verdicts.decide`.

    Examples
    --------
    >>> from studies import load
    >>> from workbench.store.law_verdicts import verdicts
    >>> from workbench.store import in_memory
    >>> (law,) = verdicts(in_memory.run(load("fig7_1_modulus")))
    >>> law["observable"], law["verdict"]
    ('turns', 'holds')
    """
    if refined.is_refined(ds) and SAMPLE in ds["outcome"].dims and laws(ds):
        ds = refined.coarse(ds)
    rows = []
    for law in laws(ds):
        axes = {str(dim): ds[dim].values for dim in ds["outcome"].dims}
        observed = {name: ds[name].values for name in law.observables if name in ds}
        steps = crossings(ds, law.axis) if crossing is None else crossing.get(law.axis)
        counts = [name for name in observed if schema.is_count(ds[name])]
        row = decide(law, observed, axes, steps, counts, law_numbers.of_law(ds, law))
        rows.append(_row_of_untested(law, row) if _is_inert(ds, law) else row)
    return rows


def _is_inert(ds: "xr.Dataset", law: Law) -> bool:
    """Whether the reading of Table 1 drops the axis of a law, so that no case depends on it."""
    return DROPPED.get(str(ds.attrs.get("reading", "")).partition("/")[0]) == law.axis


def _row_of_untested(law: Law, row: Mapping[str, Any]) -> dict[str, Any]:
    """The row of a law that is not tested, with the values that were measured."""
    told = refusal(law, f"not tested along {law.axis}: {law.axis} has no effect under this reading")
    also = [
        {**new, "first": old["first"], "last": old["last"]} for new, old in zip(told["also"], row["also"], strict=True)
    ]
    return {**told, "first": row["first"], "last": row["last"], "also": also}


def verdicts_of_lines(ds: "xr.Dataset", law: Law) -> "xr.DataArray":
    """The verdict on a law on each line of the grid along its axis, over the other axes; see `verdicts.by_line`."""
    import xarray as xr

    axes = {str(dim): ds[dim].values for dim in ds["outcome"].dims}
    others = [dim for dim in axes if dim != law.axis]
    if _is_inert(ds, law):
        found = np.full([ds.sizes[dim] for dim in others], UNDECIDED)
        return xr.DataArray(found, {dim: ds[dim] for dim in others}, others)
    observed = ds[law.observable].transpose(*axes)
    counts = [law.observable] if schema.is_count(observed) else []
    known = law_numbers.of_law(ds, law)
    found = by_line(law, observed.values, axes, crossings(ds, law.axis), counts, known)
    return xr.DataArray(found, {dim: ds[dim] for dim in others}, others)


def crossings(ds: "xr.Dataset", axis: str) -> "NDArray[np.bool_] | None":
    """The steps along an axis, in its rising order, between which the number of the branch changes: bools over the
    grid, but one fewer along the axis. None where the dataset tells of no branches."""
    if "branch" not in ds or set(ds["branch"].dims) != set(ds["outcome"].dims):
        return None
    order = np.argsort(ds[axis].values, kind="stable")
    dims = [*(dim for dim in ds["outcome"].dims if dim != axis), axis]
    branch = ds["branch"].transpose(*dims).isel({axis: order}).values
    known = branch >= 0  # an unsolved case has none: the branch before it is held until the next
    last = np.maximum.accumulate(np.where(known, np.arange(order.size), 0), axis=-1)
    held = np.take_along_axis(branch, last, axis=-1)
    changes = (np.diff(held, axis=-1) != 0) & np.logical_or.accumulate(known, axis=-1)[..., :-1]
    return np.moveaxis(changes, -1, list(ds["outcome"].dims).index(axis))


def laws(ds: "xr.Dataset") -> list[Law]:
    """The laws that the dataset's study states. Raises `InputError` where they are none."""
    from . import reading

    return reading.laws(ds)


def unsolved(ds: "xr.Dataset") -> int:
    """How many cases are not solved."""
    return int((~ds["solved"].values).sum())


def count_of(count: int, word: str) -> str:
    """``1 case``, ``9 cases``."""
    return f"{count} {word}{'s' * (count != 1)}"


def status(unsolved: int, rows: Sequence[Mapping[str, Any]]) -> int:
    """The exit status: 0 where every case was solved and every law holds, at least as a trend; else 1."""
    return int(unsolved > 0 or any(row["verdict"] not in (HOLDS, TREND) for row in rows))


def is_refuted(unsolved: int, rows: Sequence[Mapping[str, Any]]) -> bool:
    """Whether a case is unsolved, or a law fails or is not decided; a qualified one is not refuted."""
    return unsolved > 0 or any(row["verdict"] in (UNDECIDED, FAILS) for row in rows)


def all_well(ds: "xr.Dataset") -> bool:
    """Whether every case was solved and every law holds, at least as a trend."""
    return status(unsolved(ds), verdicts(ds)) == 0


def tally(rows: Sequence[Mapping[str, Any]]) -> dict[str, int]:
    """How many laws have each verdict, those of no law included."""
    found = [row["verdict"] for row in rows]
    return {verdict: found.count(verdict) for verdict in VERDICTS}


def tally_of(rows: Sequence[Mapping[str, Any]], noun: str = "law") -> str:
    """The tally in words: ``7 laws: 3 true, 4 true in part``."""
    return f"{count_of(len(rows), noun)}: {verdict_words.count(tally(rows))}"


def law_in_words(row: Mapping[str, Any]) -> str:
    """The law in words: ``turns falls along E``."""
    return f"{row['observable']} {row['does']} along {row['axis']}"


def measure(row: Mapping[str, Any]) -> str:
    """What was measured: ``exponent 2 ± 0.001``; of a direction the values at the two ends of the axis, ``8 → 5``, or
    their ranges over the lines of a grid."""
    if row["found"]:
        return str(row["found"])
    return f"{_span(row['first'])} → {_span(row['last'])}"


def said(row: Mapping[str, Any]) -> str:
    """The verdict and why: ``true in part: 6 of 9 rows agree (judged at R = 0.75)``."""
    notes = detail(row)
    return f"{plain(row)}: {notes}" if notes else plain(row)


def plain(row: Mapping[str, Any]) -> str:
    """The verdict in words that a reader understands at once: ``true in part``."""
    return verdict_words.PLAIN[row["verdict"]]


def detail(row: Mapping[str, Any]) -> str:
    """What qualifies a verdict: the reason, the line that decides, lines of a grid, exceptions; or nothing."""
    notes = [row["reason"]] if row["reason"] else []
    if verdict_words.ON_PART not in row["qualifications"]:  # whose reason says the next two
        if row["at"]:
            notes.append(f"at {', '.join(f'{name} = {value:.4g}' for name, value in row['at'].items())}")
        if row["lines"] > 1:
            notes.append(f"of {row['lines']} rows {verdict_words.count(row['line_verdicts'])}")
    if row["verdict"] == QUALIFIED:
        return "; ".join(notes)
    if row["exceptions"]:
        notes.append(f"{len(row['exceptions'])} of {row['steps']} {row['counted']}")
    if row["tau"] is not None and row["verdict"] != HOLDS:
        notes.append(f"tau {row['tau']:.2f}")
    return "; ".join(notes)


def _span(ends: list[float] | None) -> str:
    if ends is None:
        return "?"
    low, high = ends
    return f"{low:.4g}" if low == high else f"{low:.4g}..{high:.4g}"
