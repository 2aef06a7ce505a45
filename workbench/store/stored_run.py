"""The run that stored a file: whether it is a study complete, or a part to be extended. Read without xarray."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from solver.problem.errors import InputError
from studies.grammar.dimensions import SAMPLE, Dimension, Dimensions

from . import checksums, file_checks
from .plan import Plan
from .recipe import axis_line, differences
from .schema import FORMAT, dimension

MOST_TOLD = 5  # differences in one line
_ROUNDING = 8 * 2.0**-52  # relative; values of an axis that differ by less are the same


@dataclass(frozen=True, eq=False)
class StoredRun:
    """A complete file: its study's name, its recipe, its samples and axes, and its statistics."""

    name: str
    recipe: dict[str, Any]
    dimensions: Dimensions
    statistics: dict[str, Any]


def look(path: Path) -> StoredRun | None:
    """The run that stored the file; None where there is no file of this format that was stored by a run.

    Raises `InputError` for a file of a newer format.
    """
    try:
        with file_checks.open_valid(path) as file:
            found = np.asarray(file.attrs["format"]).item()
            there = _read(file) if found == FORMAT else None
            checksums.check(file, path, arrays=False)
    except InputError:
        return None
    if found > FORMAT:
        raise InputError(f"{path} is of format {found}, but this version reads format {FORMAT}")
    return there


def _read(file: h5py.File) -> StoredRun | None:
    made, told = (json.loads(file.attrs[name]) for name in ("recipe", "statistics"))
    fields = {name: np.asarray(file[dimension(name)][...], dtype=float) for name in made["axes"]}
    if any(made["axes"][name] != axis_line(values) for name, values in fields.items()):
        return None  # changed since by another program
    axes = {name: fields.pop(name) for name in made["order"] if name != SAMPLE}
    samples = Dimension(SAMPLE, fields) if SAMPLE in made["order"] else None
    return StoredRun(str(file.attrs["study_name"]), made, Dimensions.of(axes, samples), told)


def is_finished(there: StoredRun, plan: Plan) -> bool:
    """Whether the file is what the plan would make."""
    return not differences(there.recipe, plan.recipe)


def replace(there: StoredRun | None, plan: Plan, path: Path) -> str | None:
    """The line that a run replaces other results of the same study, with what has changed; None where it does not.

    ``replaces the results in rod.h5, which differ: base.E was 206000, now 210000``
    """
    if there is None or there.name != plan.study.name:
        return None
    told = differences(there.recipe, plan.recipe)
    more = f"; and {len(told) - MOST_TOLD} more" if len(told) > MOST_TOLD else ""
    return f"replaces the results in {path}, which differ: {'; '.join(told[:MOST_TOLD])}{more}" if told else None


def grow(there: StoredRun, plan: Plan) -> Plan | None:
    """The plan of the cases that the file does not hold yet; None where it is of another study.

    Raises `InputError` where only the code or a library has changed: old and new cases would not be consistent.
    """
    if plan.study.refine is not None:
        return _refine_further(there, plan)
    now = plan.recipe
    if there.recipe.get("order") != now["order"] or not plan.shape:
        return None
    matched = _match_dimensions(there.dimensions, plan.dimensions)
    if matched is None:
        return None
    dimensions, _ = matched
    plan = Plan(plan.study, dimensions)
    now = plan.recipe
    changed = [key for key in {**there.recipe, **now} if there.recipe.get(key) != now.get(key) and key != "axes"]
    if any(key not in _versions() for key in changed):
        return None
    if there.recipe["axes"] == now["axes"]:
        return plan
    if plan.study.sweeps:  # its branches would be numbered anew
        return None
    _check_versions(there.recipe, now, changed)
    return Plan(plan.study, dimensions, _new(there, plan))


def _refine_further(there: StoredRun, plan: Plan) -> Plan | None:
    """The plan of a refined study that begins with the cases of the file; None where it is of another study.

    A file of fewer halvings, or of a smaller budget, holds the first cases of the refinement.
    """
    if there.recipe.get("order") != [SAMPLE] or "refine" not in there.recipe:
        return None
    same = Plan(plan.study, there.dimensions)
    was, now = there.recipe, same.recipe
    changed = [key for key in {**was, **now} if was.get(key) != now.get(key)]
    if not changed:
        return same
    before, after = was["refine"], now["refine"]
    larger = {"halvings", "budget"}
    other = [key for key in {**before, **after} if before.get(key) != after.get(key) and key not in larger]
    if other or any(key not in (*_versions(), "refine") for key in changed):
        return None
    if "refine" in changed and any(not before[key] <= after[key] for key in larger):
        return None
    _check_versions(was, now, [key for key in changed if key != "refine"])
    return Plan(plan.study, there.dimensions, np.arange(0))


def _check_versions(was: Mapping[str, Any], now: Mapping[str, Any], changed: list[str]) -> None:
    """Raise `InputError` where the code or a library has changed: old and new cases would not be consistent."""
    if changed:
        told = "; ".join(differences({key: was.get(key) for key in changed}, {key: now.get(key) for key in changed}))
        raise InputError(
            f"the existing file holds part of this study, but {told}; use --restart to solve all of it again"
        )


def places(there: StoredRun, plan: Plan) -> list[NDArray[np.int64]]:
    """For each dimension the index of each value in the file, -1 where the file has no such value."""
    matched = _match_dimensions(there.dimensions, plan.dimensions)
    assert matched is not None
    return matched[1]


def _new(there: StoredRun, plan: Plan) -> NDArray[np.int64]:
    """The flat indices of the cases that the file does not hold."""
    held = np.ones(plan.shape, dtype=bool)
    for i, place in enumerate(places(there, plan)):
        held &= (place >= 0).reshape([-1 if i == k else 1 for k in range(len(plan.shape))])
    return np.flatnonzero(~held)


def _match_dimensions(old: Dimensions, new: Dimensions) -> tuple[Dimensions, list[NDArray[np.int64]]] | None:
    """The new dimensions, with the old values to the last digit, and the index of each value among the old.

    None where an old value is not among the new.
    """
    each, found = [], []
    for before, now in zip(old.each, new.each, strict=True):
        matched = _match_samples(before, now) if now.name == SAMPLE else _match_axis(before, now)
        if matched is None:
            return None
        each.append(matched[0])
        found.append(matched[1])
    return Dimensions(tuple(each)), found


def _match_samples(old: Dimension, new: Dimension) -> tuple[Dimension, NDArray[np.int64]] | None:
    """Samples that begin with the old ones, and the index of each among the old, or -1; None where they do not."""
    if tuple(old.fields) != tuple(new.fields) or old.size > new.size:
        return None
    if not all(np.array_equal(values, new.fields[name][: old.size]) for name, values in old.fields.items()):
        return None
    index = np.arange(new.size)
    return new, np.where(index < old.size, index, -1)


def _match_axis(old: Dimension, new: Dimension) -> tuple[Dimension, NDArray[np.int64]] | None:
    """An axis that holds the old values in any order, and the index of each among the old, or -1."""
    before, values = old.fields[old.name], new.fields[new.name]
    order = np.argsort(before)
    right = np.searchsorted(before[order], values)
    pick = np.stack([order[np.clip(right + shift, 0, before.size - 1)] for shift in (-1, 0)])
    off = np.abs(before[pick] - values)
    nearest = np.take_along_axis(pick, off.argmin(axis=0)[None], axis=0)[0]
    same = off.min(axis=0) <= _ROUNDING * np.abs(values)
    if np.unique(nearest[same]).size < before.size:
        return None
    return Dimension(new.name, {new.name: np.where(same, before[nearest], values)}), np.where(same, nearest, -1)


def _versions() -> set[str]:
    """The keys of a recipe that are not the study: code, packages, block."""
    from solver.methods import METHODS

    return {"code", "numpy", "scipy", "block", *(method.requires for method in METHODS.values())}
