"""What a run has to do: its cases in order, blocks and chunks, the disk space that they need; and which of them a file
already holds. Needs no xarray."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.problem.errors import InputError, check_tolerance
from studies import Study
from studies.grammar.axes import SAMPLE, Axis, Dimension, Dimensions, Values, in_words
from studies.language import refine_table as tables
from studies.language.refinement import OUTCOME, Refinement
from studies.language.variation import SOURCES
from studies.laws.law_words import count_of

from ..stored import refined
from ..stored.boxes import Columns
from ..stored.case_solving import method_of
from ..stored.schema import TEXTS, shapes
from ..stored.sweep import Sweep, block_size
from ..words.escaping import bytes_in_words
from . import shards
from .block import Chunk
from .recipe import Places, StoredRun, differences, extend, look, recipe_of, versions_of_code

# Cases in a block: enough for NumPy, few enough for the cache; fewer where each case is solved by itself, as an
# interruption costs the block under way.
BLOCK, BLOCK_ALONE = 512, 8
BLOCK_VALUES = 2**18  # stations of all cases of a block, at most: some MB for each array
MOST_BLOCKS, MOST_BYTES = 16, 32 * 2**20  # of a chunk, at most: what a process holds
TEXT_BYTES = 200  # of outcome and caution in the file: references, and texts with a remark
SPARE = 4 * 2**20  # bytes for coordinates, attributes, half-filled packets and the lists of an HDF5 file

FOLLOWED, MIDDLE = "the case from which the others continue", "the case in the middle of the grid"


@dataclass(frozen=True, eq=False)
class Plan:
    """A study to be run, with its tolerance and method decided, its samples and axes, and the cases to be solved.

    refinement: of a refined study, whose samples are those of its rounds so far. stored: the run of a file that holds
    the study or a part of it. is_finished: whether it holds all of it. replaced: a line on the results of this study
    that the run replaces, with what has changed: ``replaces the results in rod.h5, which differ: tol was 1e-08, now
    1e-09``
    """

    study: Study
    dimensions: Dimensions
    refinement: Refinement | None = None
    stored: StoredRun | None = None
    is_finished: bool = False
    replaced: str = ""

    @property
    def shape(self) -> tuple[int, ...]:
        return self.dimensions.shape

    @property
    def size(self) -> int:
        """Cases of the grid."""
        return self.dimensions.size

    @cached_property
    def places(self) -> list[Places] | None:
        """For each dimension the index of each value in the file, -1 where it has none; without a file None.

        Raises `InputError` where a refined study has other cases than the file.
        """
        if self.stored is None:
            return None
        old = self.stored.dimensions
        if self.refinement is not None:  # the file may hold cases of later rounds
            old = Dimensions(tuple(each.only(np.arange(min(each.size, self.size))) for each in old.each))
        matched = extend(old, self.dimensions)
        if matched is None:
            raise InputError("the existing file was refined to other cases; use --restart to solve all of it again")
        return matched[1]

    @cached_property
    def new(self) -> NDArray[np.int64] | None:
        """Flat indices in the grid of the cases to be solved, rising; None for all."""
        if self.places is None:
            return None
        held = np.ones(self.shape, dtype=bool)
        for i, place in enumerate(self.places):
            held &= (place >= 0).reshape([-1 if i == k else 1 for k in range(held.ndim)])
        return np.flatnonzero(~held)

    @property
    def todo(self) -> int:
        """Cases to be solved."""
        return self.size if self.new is None else self.new.size

    @cached_property
    def block(self) -> int:
        """Cases in a block; depends on the study alone."""
        if self.study.sweeps:
            return block_size(self.shape, BLOCK_VALUES // self.study.stations)
        most = BLOCK if self.solves_blocks else BLOCK_ALONE
        return max(1, min(most, BLOCK_VALUES // self.study.stations))

    @cached_property
    def recipe(self) -> dict[str, Any]:
        """All that the numbers depend on (`recipe_of`)."""
        return recipe_of(self.study, self.dimensions, self.block)

    @property
    def solves_blocks(self) -> bool:
        """Whether the method solves a large block at once."""
        from solver.methods import METHODS

        method = METHODS.get(self.study.method)
        return method is None or method.batched  # a march of rods with weight is none of `METHODS`

    @cached_property
    def light(self) -> Study:
        """The study as workers need it: with the first of its samples and axes alone, as each chunk brings its own."""
        samples, axes = None, {}
        for each in self.dimensions.each:
            first = {name: values[:1] for name, values in each.fields.items()}
            if each.name == SAMPLE:
                samples = Dimension(SAMPLE, first)
            else:
                follow = each.name == self.study.variation.followed
                axes[each.name] = Axis.model_validate({"values": first[each.name].tolist(), "follow": follow})
        update = {"axes": axes, **dict.fromkeys(SOURCES), "refine": None, "laws": [], "observables": self.study.wanted}
        return self.study.with_values(**update).with_samples(samples)

    def chunk(self, start: int, stop: int) -> Chunk:
        """The chunk of the cases `start` to `stop` of those to be solved."""
        flat = np.arange(start, stop) if self.new is None else self.new[start:stop]
        in_order = self.sweep.hand_over(self.light, start, stop).solve if self.study.sweeps else None
        return Chunk(start, stop, self.dimensions.at(flat), 0, in_order)

    @cached_property
    def sweep(self) -> Sweep:
        """The states of the cases of a sweep."""
        return Sweep(self.study, self.dimensions.fields, self.block)

    def part(self, number: int, count: int) -> tuple[int, int]:
        """The first and the last + 1 of the cases to be solved of one of so many parts, from 1 on, of whole blocks; of
        single cases in a sweep of fewer blocks than parts, whose bits do not depend on blocks.

        Raises `InputError` where there are fewer of these than parts.
        """
        size = 1 if self.study.sweeps and count > -(-self.todo // self.block) else self.block
        if count > (most := -(-self.todo // size)):
            cases = f"{self.todo} cases{f' in blocks of {size}' * (size > 1)}"
            way_out = "choose a smaller N, or omit --part" if most > 1 else "omit --part"
            raise InputError(
                f"--part takes K/N with N at most {most}, as there are {cases}, got {number}/{count}: {way_out}"
            )
        start, stop = (min(size * (most * k // count), self.todo) for k in (number - 1, number))
        return start, stop

    def chunks(self, missing: Iterable[tuple[int, int]], most: int) -> Iterator[Chunk]:
        """The missing cases in chunks of at most so many cases, whole blocks each."""
        for start, stop in missing:
            for a in range(start, stop, most):
                yield self.chunk(a, min(a + most, stop))

    def chunk_size(self, workers: int = 1, given: int | None = None) -> int:
        """Cases in a chunk, whole blocks: as asked, else few enough that there are chunks for all workers."""
        if given is not None:
            return self.block * max(1, round(given / self.block))
        fair = -(-self.todo // self.block) // (4 * workers)
        held = MOST_BYTES // (self.block * bytes_a_case(self.study))
        return self.block * max(1, min(MOST_BLOCKS, fair, held))


def plan(study: Study) -> Plan:
    """The plan of a study; "auto" becomes the automatic method. Raises `InputError` as `solve` does."""
    dimensions = study.variation.dimensions
    method = method_of(study, dimensions)
    return Plan(study.model_copy(update={"tol": check_tolerance(study.tol), "method": method}), dimensions)


def remarks(plan: Plan) -> dict[str, str]:
    """Attributes on how a study was run: the first case of a sweep, what ended a refinement; none for other studies."""
    if plan.refinement is not None:
        return refined.attributes(plan.study, plan.refinement)
    return {"equilibria": _first_of(plan)} if plan.study.sweeps else {}


def _first_of(plan: Plan) -> str:
    """How the equilibrium of the first case of a sweep was selected, in one sentence."""
    sweep = plan.sweep
    first, cell = sweep.first().solution, sweep.grid.first
    row = zip(sweep.coordinates.items(), cell, strict=True)
    at = ", ".join(in_words(name, float(values[i])) for (name, values), i in row)
    which = plan.study.equilibrium
    name = MIDDLE if plan.study.variation.followed is None else FOLLOWED
    if first.begun:
        return f"{name}, {at}: its search began at {first.begun}"
    slope = None if which is None else which.dbeta0
    named = slope is not None and first.solved
    how = first.selection or (f"taken: the one next to beta'(0) = {slope:g}" if named else first.outcome)
    return f"{name}, {at}: {how}"


def bytes_a_case(study: Study) -> int:
    """Bytes of a case in memory and, at most, in the file."""
    numbers = (math.prod(shape) for name, shape in shapes(study).items() if name not in ("solved", *TEXTS))
    return 8 * sum(numbers) + TEXT_BYTES


def bytes_of_file(cases: int, bytes_a_case: int) -> int:
    """Bytes of a finished file of so many cases, at most."""
    return int(1.02 * cases * bytes_a_case) + SPARE


TOLD = 1e9  # bytes: what needs less is not told


def room(work: Plan, folder: Path, kept: int, part: tuple[int, int] | None = None) -> str:
    """The disk space that the run needs, in words; raises `InputError` where there is less.

    kept: cases of existing shards. part: which of how many parts is solved alone; it writes no file.
    """
    case, left = bytes_a_case(work.study), shards.free(folder)
    if part is None:
        final, parts = bytes_of_file(work.size, case), max(work.todo - kept, 0) * case
        whole, rest = map(bytes_in_words, (final, parts))
        needed = f"the study needs up to {whole} for the file and {rest} for its parts until it is whole"
        large = f"the file needs at most {whole}, and the run another {rest} until it ends"
    else:
        missing = shards.gaps_between(shards.shard_ranges(folder, work.todo), *work.part(*part))
        final, parts = 0, sum(stop - start for start, stop in missing) * case
        rest = bytes_in_words(parts)
        needed, large = f"the part needs up to {rest}", f"the part needs at most {rest}"
    if final + parts > left:
        raise InputError(f"{needed}, but {folder.parent} has {bytes_in_words(left)} left")
    new = f", {work.size - work.todo} of them already stored" if work.todo < work.size else ""
    going = f", {kept} kept from an earlier run" if kept else ""
    if work.study.refine is not None:
        stored = f"; {work.size} cases are stored already" if new else ""
        grid = f"{work.study.coarse().variation.size} cases of the coarse grid"
        return f"{grid}, at most {work.study.refine.budget} in all{stored}{going}"
    return f"{count_of(work.size, 'case')}{new}{going}{f'; {large}' * (final + parts > TOLD)}"


MOST_TOLD = 5  # differences in one line


def compare(path: Path, plan: Plan, restart: bool = False) -> Plan:
    """The plan beside what the file holds; restart: whatever it holds.

    Raises `InputError` where only the code or a library has changed: old and new cases would not be consistent.
    """
    stored = None if restart else look(path)
    if stored is None:
        return plan
    larger = _grow(stored, plan)
    changes = differences(stored.recipe, (larger or plan).recipe)
    if not changes:
        return replace(larger or plan, stored=stored, is_finished=True)
    if larger is not None and larger.stored is not None:
        return larger
    if stored.name != plan.study.name:
        return plan
    more = f"; and {len(changes) - MOST_TOLD} more" if len(changes) > MOST_TOLD else ""
    line = f"replaces the results in {path}, which differ: {'; '.join(changes[:MOST_TOLD])}{more}"
    return replace(plan, replaced=line)


def _grow(stored: StoredRun, plan: Plan) -> Plan | None:
    """The plan with the values of the file to the last digit; None where the file is of another study.

    The plan has the file as `stored` if it extends it, and not if it has the cases of the file alone.

    A file of a grid holds some values of its axes; one of a refined study the first cases of a refinement of more
    halvings or a larger budget. A sweep does not grow, as its branches would be numbered anew. Raises `InputError`.
    """
    was, refines = stored.recipe, plan.study.refine is not None
    if was.get("order") != plan.recipe["order"] or not plan.shape or ("refine" in was) != refines:
        return None
    matched = (stored.dimensions, []) if refines else extend(stored.dimensions, plan.dimensions)
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
    return replace(same, stored=stored)


def _is_larger(before: Mapping[str, Any], after: Mapping[str, Any]) -> bool:
    """Whether a refinement differs from an earlier one by more halvings or a larger budget alone."""
    may_grow = ("halvings", "budget")
    same = all(before.get(key) == after.get(key) for key in {**before, **after} if key not in may_grow)
    return same and all(before[key] <= after[key] for key in may_grow)


def rounds(work: Plan, read: Callable[[int, int], Columns]) -> Iterator[tuple[Plan, int, int]]:
    """The plan of all cases up to each round of a study, and the first and the last + 1 of the cases that it solves.

    A study that is not refined has one round. Those of a refined study follow from the numbers of the rounds before;
    its last one solves nothing. Cases are counted among those that the stored file does not hold. read: the columns of
    such cases, once they are solved. Raises `InputError` where the file was refined to other cases.
    """
    if work.study.refine is None:
        yield work, 0, work.todo
        return
    state = tables.refinement(work.study)
    held = np.empty((0, state.steps.size))
    if work.stored is not None:
        held = _numbers_to_watch(work.study, work.stored.read([*work.study.wanted, "solved"]))
    while state.next_count:
        first, last = len(state.numbers), len(state.places)
        start, stop = max(first - len(held), 0), max(last - len(held), 0)
        yield _plan_of_cases(work, state), start, stop
        new = [_numbers_to_watch(work.study, read(start, stop))] if start < stop else []
        state.take(np.concatenate([held[first:last], *new]))
    done = _plan_of_cases(work, state)
    yield done, done.todo, done.todo


def _plan_of_cases(work: Plan, state: Refinement) -> Plan:
    """The plan of the cases of a refinement so far."""
    samples = Dimension(SAMPLE, state.lattice.values(state.places))
    study = work.study.with_samples(samples)
    return replace(work, study=study, dimensions=Dimensions((samples,)), refinement=state)


def _numbers_to_watch(study: Study, columns: Columns) -> Values:
    """The watched numbers of each case, (cases, watched), those of laws last; whether it is solved as 0 or 1."""
    assert study.refine is not None
    watched = ["solved" if name == OUTCOME else name for name in study.refine.watch]
    rows = [columns[name] for name in (*watched, *(law.observable for law in tables.laws_to_watch(study)))]
    return np.stack([np.asarray(row, dtype=float) for row in rows], axis=1)
