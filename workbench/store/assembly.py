"""Cases of several sources assembled into one file, window by window, so that memory stays small, and judged."""

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver.problem.errors import InputError

from ..words import cautions, outcomes
from . import atomic, dataset, file_checks, schema, writing
from .grid_io import Where, blocks, extent, span
from .law_verdicts import Tally
from .law_verdicts import statistics as statistics_of
from .plan import Plan, bytes_a_case, bytes_of_file, remarks
from .schema import Columns
from .shards import Shards

WINDOW = 2**25  # bytes of results held while they are copied

Piece = tuple[NDArray[np.int64], Columns]  # places of cases in a box, rising, and their variables


@dataclass(frozen=True, eq=False)
class FileSource:
    """The cases of a stored dataset.

    name: of the file. ds: its dataset, opened lazily. variables: those over all axes. places: for each axis of the grid
    the index of each value in the file, or -1.
    """

    name: str
    ds: xr.Dataset
    variables: Sequence[str]
    places: Sequence[NDArray[np.int64]]

    def read(self, where: Where) -> Piece | None:
        """The cases of a box that the file holds. Raises `InputError` where the file is damaged."""
        places = [place[part] for place, part in zip(self.places, where, strict=True)]
        held = [np.flatnonzero(place >= 0) for place in places]
        if not all(rows.size for rows in held):
            return None
        box = extent(where)
        cases = np.arange(prod(box)).reshape(box)[np.ix_(*held)].ravel()
        rows = [place[mine] for place, mine in zip(places, held, strict=True)]
        with file_checks.reading(self.name):
            return cases, {name: _rows(self.ds[name].variable, rows) for name in self.variables}


def _rows(variable: xr.Variable, rows: Sequence[NDArray[np.int64]]) -> NDArray[Any]:
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
    """The cases in the shards of a run."""

    parts: Shards
    plan: Plan
    name = "the shards of the run"

    def read(self, where: Where) -> Piece | None:
        """The cases of a box that the run solves. Raises `Damaged`."""
        start, stop = span(where, self.plan.shape)
        new = self.plan.new
        if new is None:
            return np.arange(stop - start), self.parts.read_cases(start, stop)
        a, b = np.searchsorted(new, [start, stop])
        return (new[a:b] - start, self.parts.read_cases(a, b)) if a < b else None


def gather(
    sources: Sequence[FileSource | ShardSource], shape: tuple[int, ...], bytes_a_case: int,
    name_of: Callable[[int], str] = str,
) -> Iterator[tuple[Where, Columns]]:  # fmt: skip
    """The columns of each box of cases, in flat order, each case from the first source that holds it.

    name_of: what a message says of a case, by its flat index. Raises `InputError` where two sources differ in a case.
    """
    for where in blocks(shape, max(1, WINDOW // bytes_a_case)):
        parts = [(source.name, source.read(where)) for source in sources]
        held = [(name, *piece) for name, piece in parts if piece is not None]
        yield where, held[0][2] if len(held) == 1 else _combine(held, *span(where, shape), name_of)


def _combine(
    pieces: Sequence[tuple[str, NDArray[np.int64], Columns]], start: int, stop: int, name_of: Callable[[int], str]
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
    """Write the dataset of all shards, and of the cases of the existing file, in place of that file.

    tally: counts of solved, outcome, caution and branch over all cases. Returns the statistics of the file. Raises
    `shards.Damaged` for a damaged shard and `OSError` where the disk is full; the existing file then stays as it was.
    """
    aside = parts.folder / f".{output.name}"
    variables = schema.case_variables(plan.study, plan.dimensions)
    try:
        frame = dataset.frame(plan.study, plan.dimensions, remarks(plan))
        with ExitStack() as stack:
            sources: list[FileSource | ShardSource] = [ShardSource(parts, plan)]
            if plan.places is not None:
                held = stack.enter_context(writing.open_file(output))
                source = FileSource(str(output), held, list(variables), plan.places)
                sources = [source, *sources] if plan.todo else [source]
            gathered = gather(sources, plan.shape, bytes_a_case(plan.study))
            windows = ((where, _final(columns, tally, plan.study.sweeps)) for where, columns in gathered)
            statistics = store_cases(frame, aside, bytes_a_case(plan.study), variables, windows, plan.recipe, tally)
        atomic.move(aside, output)
        return statistics
    finally:
        aside.unlink(missing_ok=True)


def store_cases(
    frame: xr.Dataset, path: Path, bytes_a_case: int, variables: schema.CaseVariables,
    windows: Iterable[tuple[Where, Columns]], recipe: Mapping[str, Any] | None, tally: Tally | None = None,
) -> dict[str, Any]:  # fmt: skip
    """Write a study to a new file, and judge it; its statistics.

    frame, variables, windows: as of `writing.write_cases`. recipe: stored beside the statistics, from which a later run
    knows what the file holds; None: neither is stored. tally: of all cases, where it is known. Raises `OSError`.
    """
    cases = prod(frame.sizes[dim] for dim in variables["outcome"][0])
    writing.write_cases(frame, path, frame.nbytes + bytes_of_file(cases, bytes_a_case), variables, windows)
    with writing.open_file(path) as ds:
        statistics = statistics_of(ds, tally)
    with h5py.File(path, "a") as file:
        file.attrs["caution"] = cautions.tell(statistics["cautions"])
        if recipe is not None:
            file.attrs["recipe"], file.attrs["statistics"] = json.dumps(recipe), json.dumps(statistics)
        file_checks.store_sums(file)
    return statistics


def _final(columns: Columns, tally: Tally, sweeps: bool) -> Columns:
    """The columns as they are stored: branches of a sweep from 0, and numbers that some case has not as floats.

    Whole numbers stay whole where all cases are solved.
    """
    final = dict(columns)
    if sweeps:
        final["branch"] = outcomes.number_branches(final["branch"], tally["branch"])
    if tally["solved"][False]:
        final |= {k: v.astype(float) for k, v in final.items() if v.dtype.kind == "i" and k != "branch"}
    return final
