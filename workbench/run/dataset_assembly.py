"""The labelled dataset of a study: one dimension for each axis, units and long names on every variable.

It is made of columns in memory; or of the cases of several sources, window by window, in a file, which is then judged.
"""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver import Case
from solver.problem.errors import InputError
from studies import Study
from studies.grammar.axes import Dimensions

from ..stored import file_checks, reading, schema
from ..stored.boxes import Columns, Where, blocks, extent, span
from ..stored.empty_dataset import frame_of
from ..stored.stored_verdicts import Tally, laws_of
from ..stored.stored_verdicts import statistics as statistics_of
from ..words import caution_words, outcome_counts
from . import atomic, writing
from .plan import TEXT_BYTES, Plan, bytes_of_file, remarks
from .recipe import Places
from .shards import Shards

WINDOW = 2**25  # bytes of results held while they are copied

Piece = tuple[Places, Columns]  # places of cases in a box, rising, and their variables


def make(
    study: Study, over: Dimensions, columns: Columns, remarks: Mapping[str, str] | None = None, case: Case | None = None
) -> xr.Dataset:
    """The dataset of a study as it was run, from its columns (`run.block.columns`) in the order of the grid.

    over: its samples and axes. remarks: attributes on how it was run (`plan.remarks`). case: the grid as one case,
    where the study does not know it.
    """
    data = {}
    for name, (dims, attrs) in schema.case_variables(study, over).items():
        values = columns[name]
        data[name] = xr.Variable(dims, values.reshape((*over.shape, *values.shape[1:])), attrs)
    ds = frame_of(study, over, remarks, case).assign(data)  # all at once: xarray aligns at each assignment
    return ds.assign_attrs(caution=caution_words.said(ds["caution"].values))


def make_as_planned(plan: Plan, columns: Columns) -> xr.Dataset:
    """The dataset of a study, from the columns of all its cases as they were solved."""
    if plan.study.sweeps:
        columns["branch"] = outcome_counts.number_branches(columns["branch"], columns["branch"])
    return make(plan.study, plan.dimensions, columns, remarks(plan))


@dataclass(frozen=True, eq=False)
class FileSource:
    """The cases of a stored dataset.

    name: of the file. ds: its dataset, opened lazily. variables: those over all axes. places: for each axis of the grid
    the index of each value in the file, or -1.
    """

    name: str
    ds: xr.Dataset
    variables: Sequence[str]
    places: Sequence[Places]

    @property
    def types(self) -> dict[str, np.dtype[Any]]:
        """The kinds of the numbers of each case."""
        return _number_types({name: self.ds[name] for name in self.variables})

    def read(self, where: Where) -> Piece | None:
        """The cases of a box that the file holds. Raises `InputError` where the file is damaged."""
        places = [place[part] for place, part in zip(self.places, where, strict=True)]
        held = [np.flatnonzero(place >= 0) for place in places]
        if not all(rows.size for rows in held):
            return None
        box = extent(where)
        cases = np.arange(prod(box)).reshape(box)[np.ix_(*held)].ravel()
        rows = [place[mine] for place, mine in zip(places, held, strict=True)]
        return cases, {name: _rows(self.ds[name].variable, rows) for name in self.variables}


def _rows(variable: xr.Variable, rows: Sequence[Places]) -> NDArray[Any]:
    """The cases of these rows of each axis, (cases, ...). Rows that lie close together are read with those between."""
    key: list[Any] = list(rows)
    within = [np.arange(mine.size) for mine in rows]
    for k, mine in enumerate(rows):
        low, high = int(mine.min()), int(mine.max()) + 1
        if high - low <= 4 * mine.size:
            key[k], within[k] = slice(low, high), mine - low
    values = np.asarray(variable[tuple(key)].values)[np.ix_(*within)]
    values = values.reshape(-1, *values.shape[len(rows) :])
    return values.astype(str) if values.dtype.kind == "O" else values


@dataclass(frozen=True, eq=False)
class ShardSource:
    """The cases in the shards of a run. tally: of all cases of the study, those of a file that it extends included."""

    parts: Shards
    plan: Plan
    tally: Tally
    name = "the shards of the run"

    @property
    def types(self) -> dict[str, np.dtype[Any]]:
        """The kinds of the numbers of each case. Raises `Damaged`."""
        return _number_types(self._read(0, 1))

    def read(self, where: Where) -> Piece | None:
        """The cases of a box that the run solves. Raises `Damaged`."""
        start, stop = span(where, self.plan.shape)
        new = self.plan.new
        if new is None:
            return np.arange(stop - start), self._read(start, stop)
        a, b = np.searchsorted(new, [start, stop])
        return (new[a:b] - start, self._read(a, b)) if a < b else None

    def _read(self, start: int, stop: int) -> Columns:
        """The columns of cases that were solved, with the branches of a sweep from 0.

        Whole numbers stay whole where all cases of the study are solved.
        """
        columns = self.parts.read_cases(start, stop)
        if self.plan.study.sweeps:
            columns["branch"] = outcome_counts.number_branches(columns["branch"], self.tally["branch"])
        if self.tally["solved"][False]:
            columns |= {k: v.astype(float) for k, v in columns.items() if v.dtype.kind == "i" and k != "branch"}
        return columns


Source = FileSource | ShardSource


def _number_types(columns: Mapping[str, Any]) -> dict[str, np.dtype[Any]]:
    return {name: values.dtype for name, values in columns.items() if values.dtype.kind in "biuf"}


def _gather(
    sources: Sequence[Source],
    shape: tuple[int, ...],
    most: int,
    types: Mapping[str, np.dtype[Any]],
    name_of: Callable[[int], str],
) -> Iterator[tuple[Where, Columns]]:
    """The columns of each box of at most so many cases, in flat order, each case from the first source that holds it.

    Raises `InputError` where two sources differ in a case.
    """
    for where in blocks(shape, most):
        parts = [(source.name, source.read(where)) for source in sources]
        held = [(name, *piece) for name, piece in parts if piece is not None]
        columns = held[0][2] if len(held) == 1 else _combine(held, *span(where, shape), name_of)
        typed = {name: values.astype(types.get(name, values.dtype), copy=False) for name, values in columns.items()}
        yield where, typed


def _combine(
    pieces: Sequence[tuple[str, Places, Columns]], start: int, stop: int, name_of: Callable[[int], str]
) -> Columns:
    """The columns of the cases `start` to `stop`; pieces: the name of a source, its cases among them, their columns."""
    owner = np.full(stop - start, -1)
    for i, (_, mine, _) in reversed([*enumerate(pieces)]):
        owner[mine] = i
    combined: Columns = {}
    for name in pieces[0][2]:
        every = np.concatenate([columns[name] for _, _, columns in pieces])
        combined[name] = np.empty((stop - start, *every.shape[1:]), dtype=every.dtype)
        for _, mine, columns in reversed(pieces):
            combined[name][mine] = columns[name]
        for i, (source, mine, columns) in enumerate(pieces):
            again = np.flatnonzero(owner[mine] != i)
            if _same_bits(combined[name][mine[again]], columns[name][again].astype(every.dtype)):
                continue
            k = next(k for k in again if not _same_bits(combined[name][mine[[k]]], columns[name][[k]]))
            sources = f"{pieces[owner[mine[k]]][0]} and {source}"
            raise InputError(f"{sources} both hold {name_of(start + int(mine[k]))}, but with other values of {name}")
    return combined


def _same_bits(a: NDArray[Any], b: NDArray[Any]) -> bool:
    """Equal, NaN being equal to NaN."""
    if a.dtype.kind in "iuf" and b.dtype.kind in "iuf":
        return np.array_equal(a, b, equal_nan=True)
    return np.array_equal(a.astype(str), b.astype(str))


def assemble(plan: Plan, parts: Shards, output: Path, tally: Tally) -> dict[str, Any]:
    """Merge the cases of the existing file with those of all shards, in place of that file; the statistics of the new.

    tally: counts of solved, outcome, caution and branch over all cases. Raises `shards.Damaged` for a damaged shard,
    `InputError` for a damaged file and `OSError` where the disk is full; the existing file then stays as it was.
    """
    aside = parts.folder / f".{output.name}"
    variables = schema.case_variables(plan.study, plan.dimensions)
    try:
        frame = frame_of(plan.study, plan.dimensions, remarks(plan))
        with ExitStack() as stack:
            sources: list[Source] = [ShardSource(parts, plan, tally)] if plan.todo else []
            if plan.places is not None:
                held = stack.enter_context(reading.open_study(output))
                sources = [FileSource(str(output), held, list(variables), plan.places), *sources]
            statistics = combine(sources, frame, variables, aside, plan.recipe, tally)
        atomic.move(aside, output)
        return statistics
    finally:
        aside.unlink(missing_ok=True)


def combine(
    sources: Sequence[Source],
    frame: xr.Dataset,
    variables: schema.CaseVariables,
    path: Path,
    recipe: Mapping[str, Any] | None,
    tally: Tally | None = None,
    name_of: Callable[[int], str] = str,
) -> dict[str, Any]:
    """Write a study whose cases are those of several sources to a new file, and judge it; its statistics.

    Parameters
    ----------
    sources
        Each case is taken from the first that holds it, and is equal in all.
    frame, variables
        The dataset of all that is not stored of each case; what is, with its dimensions and attributes.
    recipe
        Stored beside the statistics, from which a later run knows what the file holds; None: neither is stored.
    tally
        Of all cases, where it is known.
    name_of
        What a message says of a case, by its flat index.

    Raises
    ------
    InputError
        Where two sources differ in a case, or a file is damaged.
    OSError
        Where the disk is full.
    """
    axes = variables["outcome"][0]
    shape = tuple(frame.sizes[dim] for dim in axes)
    each = [source.types for source in sources]
    types = {name: np.result_type(*(types[name] for types in each)) for name in each[0]}
    numbers = {name: prod(frame.sizes[dim] for dim in dims[len(axes) :]) for name, (dims, _) in variables.items()}
    size = sum(8 * count if name in types else TEXT_BYTES for name, count in numbers.items())  # of a case
    windows = _gather(sources, shape, max(1, WINDOW // size), types, name_of)
    writing.write_cases(frame, path, frame.nbytes + bytes_of_file(prod(shape), size), variables, windows)
    unread = schema.TEXTS if tally is not None and not laws_of(frame) else ()
    with reading.raw(path, unread) as ds:
        statistics = statistics_of(ds, tally)
    with h5py.File(path, "a") as file:
        file.attrs["caution"] = caution_words.tell(statistics["cautions"])
        if recipe is not None:
            file.attrs["recipe"], file.attrs["statistics"] = json.dumps(recipe), json.dumps(statistics)
        file_checks.store_sums(file)
    return statistics
