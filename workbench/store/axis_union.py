"""The values of an axis of several files together, and what is not stored of each case along them."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from studies.grammar.axes import SAMPLE

from .assembly import combine, same_bits


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
        elif any(union.axis in part.dims for part in parts) or not all(same_bits(parts[0], part) for part in parts):
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
    values = combine(pieces, union.values.size, union.axis, union.values)[name]
    united = xr.Variable((union.axis, *others), values, parts[0].attrs)
    return united.transpose(*(dim for dim in (*axes, *others) if dim in united.dims))
