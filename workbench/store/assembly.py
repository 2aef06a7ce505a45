"""Cases of several sources assembled into one file, window by window, so that memory stays small, and judged."""

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import Any, Protocol

import h5py
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver.problem.errors import InputError

from ..words import cautions, outcomes
from . import atomic, checksums, dataset, file_checks, netcdf, schema, writing
from .grid_io import Where, blocks, extent, span
from .growth import StoredRun, places
from .plan import Plan, bytes_a_case, bytes_of_file, remarks
from .schema import Columns
from .shards import Shards
from .tally import Tally
from .tally import statistics as statistics_of

WINDOW = 2**25  # bytes of results held while they are copied

Piece = tuple[NDArray[np.int64], Columns]  # places of cases in a box, rising, and their variables


class Source(Protocol):
    """Where cases of a grid come from."""

    @property
    def name(self) -> str:
        """Its name in messages."""

    def read(self, where: Where) -> Piece | None:
        """Those cases of a box of the grid that it holds; None where there are none."""


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


def gather(
    sources: Sequence[Source],
    shape: tuple[int, ...],
    bytes_a_case: int,
    along: tuple[int, str, NDArray[Any]] | None = None,
) -> Iterator[tuple[Where, Columns]]:
    """The columns of each box of cases, in flat order, each case from the first source that holds it.

    along: the axis along which sources overlap: its number, its name and its values. Raises `InputError` where they
    then differ.
    """
    for where in blocks(shape, max(1, WINDOW // bytes_a_case)):
        parts = [(source.name, source.read(where)) for source in sources]
        held = [(name, *piece) for name, piece in parts if piece is not None]
        if len(held) == 1:
            yield where, held[0][2]
            continue
        numbers = np.arange(*span(where, shape))
        axis, name, values = along or (0, "case", numbers)
        at = np.unravel_index(numbers, shape)[axis] if along else numbers - numbers[0]
        yield where, combine(held, numbers.size, name, values[at])


class ShardSource:
    """The cases in the shards of a run."""

    name = "the shards of the run"

    def __init__(self, parts: Shards, plan: Plan) -> None:
        self._parts, self._new, self._shape = parts, plan.new, plan.shape

    def read(self, where: Where) -> Piece | None:
        """The cases of a box that the run solves. Raises `Damaged`."""
        start, stop = span(where, self._shape)
        if self._new is None:
            return np.arange(stop - start), self._parts.read_cases(start, stop)
        a, b = np.searchsorted(self._new, [start, stop])
        return (self._new[a:b] - start, self._parts.read_cases(a, b)) if a < b else None


def assemble(plan: Plan, parts: Shards, output: Path, stored: StoredRun | None, tally: Tally) -> dict[str, Any]:
    """Write the dataset of all shards, and of the cases of the existing file, in place of that file.

    tally: counts of solved, outcome, caution and branch over all cases. Returns the statistics of the file. Raises
    `shards.Damaged` for a damaged shard and `OSError` where the disk is full; the existing file then stays as it was.
    """
    aside = parts.folder / f".{output.name}"
    variables = schema.case_variables(plan.study, plan.dimensions)
    try:
        frame = dataset.frame(plan.study, plan.dimensions, remarks(plan))
        with ExitStack() as stack:
            sources: list[Source] = [ShardSource(parts, plan)]
            if stored is not None:
                held = stack.enter_context(netcdf.open_file(output))
                names = [variable.name for variable in variables]
                source = FileSource(str(output), held, names, places(stored, plan))
                sources = [source, *sources] if plan.todo else [source]
            gathered = gather(sources, plan.shape, bytes_a_case(plan.study))
            windows = ((where, _final(columns, tally, plan.study.sweeps)) for where, columns in gathered)
            statistics = store_cases(
                frame, aside, bytes_of_file(plan), variables, plan.shape, windows, plan.recipe, tally
            )
        atomic.move(aside, output)
        return statistics
    finally:
        aside.unlink(missing_ok=True)


def store_cases(
    frame: xr.Dataset, path: Path, size: int, variables: Sequence[schema.CaseVariable], shape: tuple[int, ...],
    windows: Iterable[tuple[Where, Columns]], recipe: Mapping[str, Any] | None, tally: Tally | None = None,
) -> dict[str, Any]:  # fmt: skip
    """Write a study to a new file, and judge it; its statistics.

    frame, size: as of `writing.append_to`. variables, shape, windows: as of `writing.write_cases`. recipe: stored
    beside the statistics, from which a later run knows what the file holds; None: neither is stored. tally: of all
    cases, where it is known. Raises `OSError`.
    """
    with writing.append_to(frame, path, size) as file:
        writing.write_cases(file, variables, shape, windows)
    with netcdf.open_file(path) as ds:
        statistics = statistics_of(ds, tally)
    with h5py.File(path, "a") as file:
        file.attrs["caution"] = cautions.tell(statistics["cautions"])
        if recipe is not None:
            file.attrs["recipe"], file.attrs["statistics"] = json.dumps(recipe), json.dumps(statistics)
        checksums.store(file)
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


def combine(
    pieces: Sequence[tuple[str, NDArray[np.int64], Columns]], size: int, axis: str, values: NDArray[Any]
) -> Columns:
    """The columns of `size` cases from several sources, each case from the first that has it.

    pieces: the name of a source, the cases that it holds, and their columns. axis, values: what a message says of a
    case. Raises `InputError` where two sources differ in a case.
    """
    owner = np.full(size, -1)
    for i, (_, mine, _) in reversed([*enumerate(pieces)]):
        owner[mine] = i
    combined: Columns = {}
    for name in pieces[0][2]:
        every = np.concatenate([columns[name] for _, _, columns in pieces])
        combined[name] = np.empty((size, *every.shape[1:]), dtype=every.dtype)
        for _, mine, columns in reversed(pieces):
            combined[name][mine] = columns[name]
        for i, (source, mine, columns) in enumerate(pieces):
            again = np.flatnonzero(owner[mine] != i)
            if same_bits(combined[name][mine[again]], columns[name][again].astype(every.dtype)):
                continue
            k = next(k for k in again if not same_bits(combined[name][mine[[k]]], columns[name][[k]]))
            sources = f"{pieces[owner[mine[k]]][0]} and {source}"
            raise InputError(f"{sources} both hold {axis} = {values[mine[k]]:.10g}, but with other values of {name}")
    return combined


def same_bits(a: Any, b: Any) -> bool:
    """Equal, NaN being equal to NaN."""
    a, b = np.asarray(a), np.asarray(b)
    if a.dtype.kind in "iuf" and b.dtype.kind in "iuf":
        return np.array_equal(a, b, equal_nan=True)
    return np.array_equal(a.astype(str), b.astype(str))
