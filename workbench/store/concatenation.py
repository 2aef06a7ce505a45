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

from . import file_checks
from .grid_io import Where, blocks, extent, span
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
    sources: Sequence[Source], shape: tuple[int, ...], bytes_a_case: int, union: Union | None = None, axis: int = 0
) -> Iterator[tuple[Where, Columns]]:
    """The columns of each box of cases, in flat order, each case from the first source that holds it.

    union: of the axis of that number, along which sources overlap. Raises `InputError` where they then differ.
    """
    for where in blocks(shape, max(1, WINDOW // bytes_a_case)):
        parts = [(source.name, source.read(where)) for source in sources]
        held = [(name, *piece) for name, piece in parts if piece is not None]
        if len(held) == 1:
            yield where, held[0][2]
            continue
        numbers = np.arange(*span(where, shape))
        values = numbers if union is None else union.values[np.unravel_index(numbers, shape)[axis]]
        yield where, _combine(held, numbers.size, "case" if union is None else union.axis, values)


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
