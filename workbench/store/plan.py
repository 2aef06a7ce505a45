"""The plan of a run: its cases in order, their blocks and chunks, and the disk space that they need."""

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver import Case, Ends, InputError
from solver.problem.errors import check_tolerance, choices
from studies import Study
from studies.grammar.axes import SAMPLE, Axis, Dimension, Dimensions, in_words
from studies.language.refinement import Refinement
from studies.language.study_data import SOURCES

from . import refined, shards, sweep
from .block import Chunk
from .case_solutions import State
from .recipe import recipe_of
from .schema import TEXTS, shapes

Coordinates = Mapping[str, NDArray[np.float64]]

# Cases in a block: enough for NumPy, few enough for the cache; fewer where each case is solved by itself.
BLOCK, BLOCK_ALONE = 512, 32
BLOCK_VALUES = 2**18  # stations of all cases of a block, at most: some MB for each array
MOST_BLOCKS, MOST_BYTES = 8, 32 * 2**20  # of a chunk: what the death of a worker costs, and what a process holds
TEXT_BYTES = 200  # of outcome and caution in the file: references, and texts with a remark
SPARE = 4 * 2**20  # bytes for coordinates, attributes, half-filled packets and the lists of an HDF5 file

FOLLOWED, MIDDLE = "the case from which the others continue", "the case in the middle of the grid"


@dataclass(frozen=True, eq=False)
class Plan:
    """A study to be run, with its tolerance and method decided, its samples and axes, and the cases to be solved.

    new: flat indices in the grid of the cases to be solved, rising; None for all. refinement: of a refined study, whose
    samples are those of its rounds so far.
    """

    study: Study
    dimensions: Dimensions
    new: NDArray[np.int64] | None = None
    refinement: Refinement | None = None

    @property
    def shape(self) -> tuple[int, ...]:
        return self.dimensions.shape

    @property
    def size(self) -> int:
        """Cases of the grid."""
        return self.dimensions.size

    @property
    def todo(self) -> int:
        """Cases to be solved."""
        return self.size if self.new is None else self.new.size

    @cached_property
    def block(self) -> int:
        """Cases in a block; depends on the study alone."""
        if self.study.sweeps:
            return sweep.block_size(self.shape, BLOCK_VALUES // self.study.stations)
        most = BLOCK if self.batched else BLOCK_ALONE
        return max(1, min(most, BLOCK_VALUES // self.study.stations))

    @cached_property
    def recipe(self) -> dict[str, Any]:
        """All that the numbers depend on (`recipe_of`)."""
        return recipe_of(self.study, self.dimensions, self.block)

    @property
    def batched(self) -> bool:
        """Whether the method solves a large block at once."""
        from solver.methods import METHODS

        method = METHODS.get(self.study.method)
        return method is None or method.batched  # a march of rods with weight is none of `METHODS`

    @cached_property
    def light(self) -> Study:
        """The study as workers need it: with the first of its samples and axes alone, as each chunk brings its own."""
        samples, axes = None, {}
        for dimension in self.dimensions.each:
            first = {name: values[:1] for name, values in dimension.fields.items()}
            if dimension.name == SAMPLE:
                samples = Dimension(SAMPLE, first)
            else:
                follow = dimension.name == self.study.followed
                axes[dimension.name] = Axis.model_validate({"values": first[dimension.name].tolist(), "follow": follow})
        update = {"axes": axes, **dict.fromkeys(SOURCES), "refine": None, "laws": [], "observables": self.study.wanted}
        light = self.study.model_copy(update=update).with_samples(samples)
        light._text, light._part_of = "", None
        return light

    def chunk(self, start: int, stop: int) -> Chunk:
        """The chunk of the cases `start` to `stop` of those to be solved."""
        flat = np.arange(start, stop) if self.new is None else self.new[start:stop]
        values = self.dimensions.at(flat)
        states = self._states(start, stop, values) if self.study.sweeps else {}
        return Chunk(start, stop, values, 0, self.shape, states)

    def _states(self, start: int, stop: int, values: Coordinates) -> dict[int, State]:
        whole: sweep.Spine | None = self.study.whole
        if whole is None:
            return self.spine.hand_over(start, stop)
        rows = (dict(zip(values, row, strict=True)) for row in zip(*values.values(), strict=True))
        return {start + i: whole.nearest(row) for i, row in enumerate(rows)}

    @cached_property
    def spine(self) -> sweep.Spine:
        """The cases from which the blocks of a sweep begin."""
        return sweep.Spine(self.study, self.dimensions.fields, self.block)

    def chunks(self, missing: Iterable[tuple[int, int]], most: int) -> Iterator[Chunk]:
        """The missing cases in chunks of at most so many cases, whole blocks each."""
        for start, stop in missing:
            for a in range(start, stop, most):
                yield self.chunk(a, min(a + most, stop))

    def chunk_size(self, workers: int = 1, given: int | None = None) -> int:
        """Cases in a chunk, whole blocks: as asked, else a few seconds' work and enough chunks for all workers."""
        if given is not None:
            return self.block * max(1, round(given / self.block))
        fair = -(-self.todo // self.block) // (4 * workers)
        held = MOST_BYTES // (self.block * bytes_a_case(self.study))
        return self.block * max(1, min(MOST_BLOCKS, fair, held))


def plan(study: Study, tol: float | None = None, method: str | None = None) -> Plan:
    """The plan of a study, with another tolerance or method if given; "auto" becomes the automatic method.

    Raises `InputError` for a tolerance or method that `solve` refuses.
    """
    from solver.methods import choose_method, varying_method

    dimensions = study.dimensions()
    first = study.case_of({name: values[0] for name, values in dimensions.fields.items()})
    if study.follow is not None:  # the equilibrium is followed by its ends, also where the study gives its start
        first = Case(first.rod, first.cylinder, Ends(0.0, 0.0))
    tol = check_tolerance(study.tol if tol is None else tol)
    method_name = study.method if method is None else method
    name = varying_method(first.kind, method_name) if study.varies else choose_method(first.kind, method_name).name
    if study.held and name != "shooting":
        raise InputError(f"method {name!r} needs dead loads and end angles, got {choices(study.held)}; choose shooting")
    return Plan(study.model_copy(update={"tol": tol, "method": name}), dimensions)


def remarks(plan: Plan) -> dict[str, str]:
    """Attributes on how a study was run: the first case of a sweep, what ended a refinement; none for other studies."""
    if plan.refinement is not None:
        return refined.attributes(plan.study, plan.refinement)
    return {"equilibria": _first_of(plan)} if plan.study.sweeps else {}


def _first_of(plan: Plan) -> str:
    """How the equilibrium of the first case of a sweep was selected, in one sentence."""
    spine = plan.study.whole or plan.spine
    first, cell = spine.first().solution, spine.grid.first
    row = zip(spine.coordinates.items(), cell, strict=True)
    at = ", ".join(in_words(name, float(values[i])) for (name, values), i in row)
    which = plan.study.equilibrium
    name = MIDDLE if plan.study.followed is None else FOLLOWED
    if first.begun:
        return f"{name}, {at}: its search began at {first.begun}"
    slope = None if which is None else which.dbeta0
    named = slope is not None and first.solved
    how = first.selection or (f"taken: the one next to beta'(0) = {slope:g}" if named else first.outcome)
    return f"{name}, {at}: {how}"


def bytes_a_case(study: Study) -> int:
    """Bytes of a case in memory and, at most, in the file."""
    return (
        8 * sum(math.prod(shape) for name, shape in shapes(study).items() if name not in ("solved", *TEXTS))
        + TEXT_BYTES
    )


def bytes_of_file(plan: Plan) -> int:
    """Bytes of the finished file, at most."""
    return int(1.02 * plan.size * bytes_a_case(plan.study)) + SPARE


TOLD = 1e9  # bytes: what needs less is not told


def room(work: Plan, folder: Path, kept: int) -> str:
    """The disk space that the run needs, in words; raises `InputError` where there is less."""
    case = bytes_a_case(work.study)
    final, parts = bytes_of_file(work), max(work.todo - kept, 0) * case
    left = shards.free(folder)
    if final + parts > left:
        needed = f"{_bytes(final)} for the file and {_bytes(parts)} for its parts until it is whole"
        raise InputError(f"the study needs up to {needed}, but {folder.parent} has {_bytes(left)} left")
    new = f", {work.size - work.todo} of them already stored" if work.todo < work.size else ""
    going = f", {kept} kept from an earlier run" if kept else ""
    if work.study.refine is not None:
        grid = f"{work.study.coarse().size} cases of the coarse grid"
        return (
            f"{grid}, at most {work.study.refine.budget} in all{new and f', {work.size} of them already stored'}{going}"
        )
    large = f"; the file needs at most {_bytes(final)}, and the run another {_bytes(parts)} until it ends"
    return f"{work.size} case{'s' * (work.size != 1)}{new}{going}{large if final + parts > TOLD else ''}"


def _bytes(count: int) -> str:
    for unit, size in (("GB", 1e9), ("MB", 1e6)):
        if count >= size:
            return f"{count / size:.3g} {unit}"
    return f"{count / 1e3:.3g} kB"
