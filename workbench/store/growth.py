"""What a run has to do beside what its file holds: nothing, new cases or all; in which rounds. Needs no xarray."""

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from solver.problem.errors import InputError
from studies import Study
from studies.grammar.axes import SAMPLE, Dimension, Dimensions, Values
from studies.language import refine as tables
from studies.language.refinement import OUTCOME, Refinement

from . import checksums, file_checks
from .plan import Plan
from .recipe import axis_line, differences, versions_of_code
from .schema import FORMAT, Columns, dimension

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
            version = np.asarray(file.attrs["format"]).item()
            stored = _read(file) if version == FORMAT else None
            checksums.check(file, path, arrays=False)
    except InputError:
        return None
    if version > FORMAT:
        raise InputError(f"{path} is of format {version}, but this version reads format {FORMAT}")
    return stored


def _read(file: h5py.File) -> StoredRun | None:
    recipe, statistics = (json.loads(file.attrs[name]) for name in ("recipe", "statistics"))
    fields = {name: np.asarray(file[dimension(name)][...], dtype=float) for name in recipe["axes"]}
    if any(recipe["axes"][name] != axis_line(values) for name, values in fields.items()):
        return None  # changed since by another program
    axes = {name: fields.pop(name) for name in recipe["order"] if name != SAMPLE}
    samples = Dimension(SAMPLE, fields) if SAMPLE in recipe["order"] else None
    return StoredRun(str(file.attrs["study_name"]), recipe, Dimensions.of(axes, samples), statistics)


@dataclass(frozen=True, eq=False)
class Growth:
    """What a run has to do beside what its file holds.

    work: the plan of the cases to be solved. stored: the run of a file that holds the study or a part of it; None where
    the run begins anew. is_finished: whether the file holds all of it. replaced: a line on the results of this study
    that the run replaces, with what has changed: ``replaces the results in rod.h5, which differ: tol was 1e-08, ...``
    """

    work: Plan
    stored: StoredRun | None = None
    is_finished: bool = False
    replaced: str = ""

    @property
    def recipe(self) -> dict[str, Any]:
        """The recipe of the run: that of its plan, and the values of the axes that the file holds."""
        return self.work.recipe if self.stored is None else {**self.work.recipe, "grows": self.stored.recipe["axes"]}


def compare(path: Path, plan: Plan, restart: bool = False) -> Growth:
    """What the plan needs beside the file; restart: whatever it holds.

    Raises `InputError` where only the code or a library has changed: old and new cases would not be consistent.
    """
    stored = None if restart else look(path)
    if stored is None:
        return Growth(plan)
    larger = _grow(stored, plan)
    changes = differences(stored.recipe, (larger or plan).recipe)
    if not changes:
        return Growth(larger or plan, stored, True)
    if larger is not None and larger.new is not None:
        return Growth(larger, stored)
    if stored.name != plan.study.name:
        return Growth(plan)
    more = f"; and {len(changes) - MOST_TOLD} more" if len(changes) > MOST_TOLD else ""
    line = f"replaces the results in {path}, which differ: {'; '.join(changes[:MOST_TOLD])}{more}"
    return Growth(plan, replaced=line)


def _grow(stored: StoredRun, plan: Plan) -> Plan | None:
    """The plan with the cases of the file, those that it does not hold as `new`; None where it is of another study.

    A file of a grid holds some values of its axes; one of a refined study the first cases of a refinement of more
    halvings or a larger budget. A sweep does not grow, as its branches would be numbered anew. Raises `InputError`.
    """
    was, refines = stored.recipe, plan.study.refine is not None
    if was.get("order") != plan.recipe["order"] or not plan.shape or ("refine" in was) != refines:
        return None
    matched = (stored.dimensions, []) if refines else _match_dimensions(stored.dimensions, plan.dimensions)
    if matched is None:
        return None
    same = Plan(plan.study, matched[0])
    changed = [key for key in {**was, **same.recipe} if was.get(key) != same.recipe.get(key)]
    versions = [key for key in changed if key in versions_of_code()]
    larger = [key for key in changed if key not in versions]
    if not larger:
        return same
    grows = larger == ["refine"] and _is_larger(was["refine"], same.recipe["refine"]) if refines else larger == ["axes"]
    if not grows or plan.study.sweeps:
        return None
    if versions:
        changes = "; ".join(differences(*({key: row.get(key) for key in versions} for row in (was, same.recipe))))
        raise InputError(
            f"the existing file holds part of this study, but {changes}; use --restart to solve all of it again"
        )
    return Plan(plan.study, same.dimensions, np.arange(0) if refines else _new(stored, same))


def _is_larger(before: Mapping[str, Any], after: Mapping[str, Any]) -> bool:
    """Whether a refinement differs from an earlier one by more halvings or a larger budget alone."""
    may_grow = ("halvings", "budget")
    same = all(before.get(key) == after.get(key) for key in {**before, **after} if key not in may_grow)
    return same and all(before[key] <= after[key] for key in may_grow)


def places(stored: StoredRun, plan: Plan) -> list[NDArray[np.int64]]:
    """For each dimension the index of each value in the file, -1 where the file has no such value."""
    matched = _match_dimensions(stored.dimensions, plan.dimensions)
    assert matched is not None
    return matched[1]


def _new(stored: StoredRun, plan: Plan) -> NDArray[np.int64]:
    """The flat indices of the cases that the file does not hold."""
    held = np.ones(plan.shape, dtype=bool)
    for i, place in enumerate(places(stored, plan)):
        held &= (place >= 0).reshape([-1 if i == k else 1 for k in range(len(plan.shape))])
    return np.flatnonzero(~held)


def _match_dimensions(old: Dimensions, new: Dimensions) -> tuple[Dimensions, list[NDArray[np.int64]]] | None:
    """The new dimensions, with the old values to the last digit, and the index of each value among the old.

    None where an old value is not among the new.
    """
    each, indices = [], []
    for before, now in zip(old.each, new.each, strict=True):
        matched = _match_samples(before, now) if now.name == SAMPLE else _match_axis(before, now)
        if matched is None:
            return None
        each.append(matched[0])
        indices.append(matched[1])
    return Dimensions(tuple(each)), indices


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


def rounds(growth: Growth, output: Path | None, read: Callable[[int, int], Columns]) -> Iterator[tuple[Plan, int, int]]:
    """The plan of all cases up to each round of a study, and the first and the last + 1 of the cases that it solves.

    A study that is not refined has one round. Those of a refined study follow from the numbers of the rounds before;
    its last one solves nothing. Cases are counted among those that the file `output` does not hold. read: the columns
    of such cases, once they are solved. Raises `InputError` where the file was refined to other cases.
    """
    work = growth.work
    if work.study.refine is None:
        yield work, 0, work.todo
        return
    state = tables.refinement(work.study)
    held = np.empty((0, state.steps.size))
    if growth.stored is not None and output is not None:
        with h5py.File(output, "r") as file:
            held = _numbers_to_watch(work.study, {name: file[name][...] for name in (*work.study.wanted, "solved")})
    while state.wanted:
        first, last = len(state.numbers), len(state.places)
        start, stop = max(first - len(held), 0), max(last - len(held), 0)
        yield _plan_of_cases(growth, state), start, stop
        new = [_numbers_to_watch(work.study, read(start, stop))] if start < stop else []
        state.take(np.concatenate([held[first:last], *new]))
    done = _plan_of_cases(growth, state)
    yield done, done.todo, done.todo


def _plan_of_cases(growth: Growth, state: Refinement) -> Plan:
    """The plan of the cases of a refinement so far. Raises `InputError` where the existing file holds other cases."""
    samples = Dimension(SAMPLE, state.lattice.values(state.places))
    new = None
    if growth.stored is not None:
        (before,) = growth.stored.dimensions.each
        size = min(before.size, samples.size)
        if any(not np.array_equal(row[:size], before.fields[name][:size]) for name, row in samples.fields.items()):
            raise InputError("the existing file was refined to other cases; use --restart to solve all of it again")
        new = np.arange(before.size, samples.size)
    return Plan(growth.work.study.with_samples(samples), Dimensions((samples,)), new, state)


def _numbers_to_watch(study: Study, columns: Columns) -> Values:
    """The watched numbers of each case, (cases, watched), those of laws last; whether it is solved as 0 or 1."""
    assert study.refine is not None
    watched = ["solved" if name == OUTCOME else name for name in study.refine.watch]
    rows = [columns[name] for name in (*watched, *(law.observable for law in tables.laws_to_watch(study)))]
    return np.stack([np.asarray(row, dtype=float) for row in rows], axis=1)
