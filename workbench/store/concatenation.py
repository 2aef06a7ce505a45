"""Cases of several sources in one grid: files along the union of their values, and new cases beside those of a file."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import prod
from typing import Any, Protocol

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver.problem.errors import InputError
from studies.grammar.dimensions import SAMPLE

from . import file_checks, grid_io
from .schema import Columns

WINDOW = 2**25  # bytes of results held while they are copied


@dataclass(frozen=True, eq=False)
class Union:
    """The values of an axis of several files together.

    values: rising, or the numbers of the samples. places: where each file holds each of them, or -1. fields: of the
    samples, field -> values.
    """

    axis: str
    values: NDArray[Any]
    places: list[NDArray[np.int64]]
    fields: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)


class Source(Protocol):
    """Where cases of a grid come from; `find` and `read` take flat indices in the grid."""

    @property
    def name(self) -> str:
        """Its name in messages."""

    def find(self, start: int, stop: int) -> NDArray[np.int64]:
        """Those of the cases `start` to `stop` that it holds, rising."""

    def read(self, flat: NDArray[np.int64]) -> Columns:
        """The variables of these cases, which it holds."""


@dataclass(frozen=True, eq=False)
class FileSource:
    """The cases of a stored dataset.

    name: of the file. ds: its dataset, opened lazily. variables: those over all axes. shape: of the grid. places: for
    each axis of the grid the index of each value in the file, or -1.
    """

    name: str
    ds: xr.Dataset
    variables: Sequence[str]
    shape: tuple[int, ...]
    places: Sequence[NDArray[np.int64]]

    def find(self, start: int, stop: int) -> NDArray[np.int64]:
        """Those of the cases `start` to `stop` that the file holds."""
        flat = np.arange(start, stop)
        at = np.unravel_index(flat, self.shape)
        return flat[np.all([place[i] >= 0 for place, i in zip(self.places, at, strict=True)], axis=0)]

    def read(self, flat: NDArray[np.int64]) -> Columns:
        """The variables of these cases. Raises `InputError` where the file is damaged."""
        own = self.ds["outcome"].shape
        at = np.unravel_index(flat, self.shape)
        rows = np.ravel_multi_index([place[i] for place, i in zip(self.places, at, strict=True)], own)
        with file_checks.reading(self.name):
            return {name: _rows(self.ds[name].variable, own, rows) for name in self.variables}


def _rows(variable: xr.Variable, shape: tuple[int, ...], rows: NDArray[np.int64]) -> NDArray[Any]:
    """Rows at flat indices of a file: in one read where they lie close together, else a read for each run."""
    low, high = int(rows.min()), int(rows.max()) + 1
    if high - low <= 4 * rows.size:
        values = grid_io.read(variable, shape, low, high)[rows - low]
    else:
        order = np.argsort(rows, kind="stable")
        runs = np.split(rows[order], np.flatnonzero(np.diff(rows[order]) != 1) + 1)
        values = np.concatenate([grid_io.read(variable, shape, int(run[0]), int(run[-1]) + 1) for run in runs])
        values = values[np.argsort(order, kind="stable")]
    return values.astype(str) if values.dtype.kind == "O" else values


def gather(
    sources: Sequence[Source], shape: tuple[int, ...], bytes_a_case: int, union: Union | None = None, axis: int = 0
) -> Iterator[tuple[int, Columns]]:
    """The first case and the columns of each window of cases, in flat order, each case from the first that holds it.

    union: of the axis of that number, along which sources overlap. Raises `InputError` where they then differ.
    """
    size, window = prod(shape), max(1, WINDOW // bytes_a_case)
    for start in range(0, size, window):
        stop = min(start + window, size)
        found = [(source, source.find(start, stop)) for source in sources]
        pieces = [(source.name, flat - start, source.read(flat)) for source, flat in found if flat.size]
        if len(pieces) == 1:
            yield start, pieces[0][2]
            continue
        numbers = np.arange(start, stop)
        values = numbers if union is None else union.values[np.unravel_index(numbers, shape)[axis]]
        yield start, _combine(pieces, stop - start, "case" if union is None else union.axis, values)


def unite(axis: str, rows: Sequence[NDArray[np.float64]]) -> Union:
    """The union of the values of an axis; the same value, to the bit, may stand in several files."""
    values = np.unique(np.concatenate(rows))
    places = []
    for row in rows:
        place = np.full(values.size, -1)
        place[np.searchsorted(values, row)] = np.arange(row.size)
        places.append(place)
    return Union(axis, values, places)


def unite_samples(files: Sequence[Mapping[str, NDArray[np.float64]]]) -> Union:
    """The union of the samples of several files, field -> values: each sample once, those of the first file first.

    A sample is known by its values, to the bit; one that a file holds several times stays so.
    """
    index: dict[tuple[float | int, ...], int] = {}
    held = []
    for fields in files:
        seen: Counter[tuple[float, ...]] = Counter()
        place: dict[int, int] = {}
        for i, row in enumerate(zip(*(values.tolist() for values in fields.values()), strict=True)):
            place[index.setdefault((*row, seen[row]), len(index))] = i
            seen[row] += 1
        held.append(place)
    rows = np.array([key[:-1] for key in index])
    places = [np.array([place.get(number, -1) for number in range(len(index))]) for place in held]
    together = {name: rows[:, k].copy() for k, name in enumerate(files[0])}
    return Union(SAMPLE, np.arange(len(index)), places, together)


def layout(
    files: Sequence[xr.Dataset], names: Sequence[str], union: Union, axes: Sequence[str]
) -> tuple[xr.Dataset, list[str]]:
    """The dataset of all that is not stored of each case, and the names of the variables over all axes.

    names: of the files. A field of the case is stored without an axis of one value; it gets that axis if the files
    differ in it. Raises `InputError` where two files differ at the same values.
    """
    first = files[0]
    held: dict[str, Any] = {union.axis: xr.Variable((union.axis,), union.values, first[union.axis].attrs)}
    cases: list[str] = []
    for name in (str(name) for name in first.variables if name != union.axis):
        parts = [ds[name].variable for ds in files]
        if name not in first.coords and all(part.dims[: len(axes)] == tuple(axes) for part in parts):
            cases.append(name)
        elif any(union.axis in part.dims for part in parts) or not all(_same_bits(parts[0], part) for part in parts):
            held[name] = _unite_field(name, parts, names, union, axes)
        else:
            held[name] = parts[0]
    coords = {name: held.pop(name) for name in [*held] if name in first.coords}
    return xr.Dataset(held, coords), cases


def _unite_field(
    name: str, parts: Sequence[xr.Variable], names: Sequence[str], union: Union, axes: Sequence[str]
) -> xr.Variable:
    """A variable over the union of the axis, and over the other dimensions that it has in any file."""
    sizes = {dim: size for part in parts for dim, size in zip(part.dims, part.shape, strict=True)}
    others = {dim: sizes[dim] for dim in (*axes, "u", *sizes) if dim in sizes and dim != union.axis}
    rows = []
    for part, place in zip(parts, union.places, strict=True):
        whole = part.set_dims({union.axis: int(place.max()) + 1, **others}).transpose(union.axis, *others)
        mine = np.flatnonzero(place >= 0)
        rows.append((mine, {name: whole.values[place[mine]]}))
    pieces = [(source, mine, columns) for source, (mine, columns) in zip(names, rows, strict=True)]
    values = _combine(pieces, union.values.size, union.axis, union.values)[name]
    united = xr.Variable((union.axis, *others), values, parts[0].attrs)
    return united.transpose(*(dim for dim in (*axes, *others) if dim in united.dims))


def _combine(
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
        both = np.concatenate([columns[name] for _, _, columns in pieces])
        combined[name] = np.empty((size, *both.shape[1:]), dtype=both.dtype)
        for _, mine, columns in reversed(pieces):
            combined[name][mine] = columns[name]
        for i, (source, mine, columns) in enumerate(pieces):
            again = np.flatnonzero(owner[mine] != i)
            if _same_bits(combined[name][mine[again]], columns[name][again].astype(both.dtype)):
                continue
            k = next(k for k in again if not _same_bits(combined[name][mine[[k]]], columns[name][[k]]))
            sources = f"{pieces[owner[mine[k]]][0]} and {source}"
            raise InputError(f"{sources} both hold {axis} = {values[mine[k]]:.10g}, but with other values of {name}")
    return combined


def _same_bits(a: Any, b: Any) -> bool:
    """Equal, NaN being equal to NaN."""
    a, b = np.asarray(a), np.asarray(b)
    if a.dtype.kind in "iuf" and b.dtype.kind in "iuf":
        return np.array_equal(a, b, equal_nan=True)
    return np.array_equal(a.astype(str), b.astype(str))
