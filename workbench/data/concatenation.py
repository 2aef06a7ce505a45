"""Datasets concatenated along one axis, block by block, so that memory stays small."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import h5py
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver.problem.errors import InputError
from studies.dimensions import SAMPLE

from . import file_checks, schema
from .grid_io import Where, blocks

BLOCK = 2**21  # numbers that are held of each file: 16 MB


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


@dataclass(frozen=True, eq=False)
class Joined:
    """A variable of the union: its name, dimensions and shape there, and its parts in the files."""

    name: str
    dims: tuple[str, ...]
    shape: tuple[int, ...]
    parts: list[xr.DataArray]

    @property
    def is_text(self) -> bool:
        """Whether it holds text and no numbers."""
        return any(part.dtype.kind not in "biuf" for part in self.parts)

    @property
    def dtype(self) -> Any:
        """That of all parts together: whole numbers stay whole where all are; netCDF has no booleans."""
        if self.is_text:
            return h5py.string_dtype()
        dtype = np.result_type(*(part.dtype for part in self.parts))
        return np.dtype(np.int8) if dtype.kind == "b" else dtype


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


def layout(files: Sequence[xr.Dataset], union: Union, axes: Sequence[str]) -> tuple[xr.Dataset, list[Joined]]:
    """A dataset of all coordinates and of what does not vary along the axis, and a list of the variables that do.

    A field of the case is stored without an axis of one value; it gets that axis if the files differ in the field.
    """
    first = files[0]
    fixed: dict[str, Any] = {}
    varying: list[Joined] = []
    sizes = {**first.sizes, union.axis: union.values.size}
    for name in map(str, first.variables):
        if name == union.axis:
            continue
        parts = [ds[name] for ds in files]
        dims = {str(dim) for part in parts for dim in part.dims}
        if union.axis not in dims and all(_same_bits(parts[0].values, part.values) for part in parts):
            fixed[name] = first[name].variable
            continue
        dims.add(union.axis)
        ordered = tuple(dim for dim in (*axes, *map(str, first.dims)) if dim in dims)
        ordered = tuple(dict.fromkeys(ordered))
        varying.append(Joined(name, ordered, tuple(sizes[dim] for dim in ordered), parts))
    coords = {name: variable for name, variable in fixed.items() if name in first.coords}
    coords[union.axis] = xr.Variable((union.axis,), union.values, first[union.axis].attrs)
    data = {name: variable for name, variable in fixed.items() if name not in first.coords}
    return xr.Dataset(data, coords), varying


def stream(file: Any, varying: Sequence[Joined], union: Union, names: Sequence[str]) -> None:
    """Write the variables that vary along the axis into an open h5netcdf file.

    names: of the files, as a refusal tells them. Raises `InputError` where two files hold the same case with other
    numbers.
    """
    if labels := [joined.name for joined in varying if joined.name in joined.parts[0].coords]:
        file.attrs["coordinates"] = " ".join(labels)  # that s is one, which no dimension is named after
    for joined in varying:
        variable = _created(file, joined)
        for where in blocks(joined.shape, BLOCK):
            variable[where] = _gathered(joined, union, where, names)


def _created(file: Any, joined: Joined) -> Any:
    """The variable in the file, labelled and packed as in the first of the files."""
    kind: dict[str, Any] = {"dtype": joined.dtype}
    stored: list[Any] = [part.encoding.get("chunksizes") for part in joined.parts if part.dims == joined.dims]
    if not joined.is_text:
        kind |= schema.packing(len(joined.shape), joined.dtype)
    if stored and all(stored):
        kind["chunks"] = tuple(min(max(sizes), n) for *sizes, n in zip(*stored, joined.shape, strict=True))
    if not joined.is_text and np.dtype(joined.dtype).kind == "f":
        kind["fillvalue"] = np.nan
    variable = file.create_variable(joined.name, joined.dims, **kind)
    for key, value in joined.parts[0].attrs.items():
        variable.attrs[key] = value
    if joined.parts[0].dtype.kind == "b":
        variable.attrs["dtype"] = "bool"
    return variable


def _gathered(joined: Joined, union: Union, where: Where, names: Sequence[str]) -> NDArray[Any]:
    """One block of the union: each value of the axis from the first file that has it, the others compared with it."""
    wanted = where[joined.dims.index(union.axis)]
    block = np.empty([part.stop - part.start for part in where], dtype=object if joined.is_text else joined.dtype)
    along = np.moveaxis(block, joined.dims.index(union.axis), 0)
    owner = np.full(wanted.stop - wanted.start, -1)
    for i, (part, places) in enumerate(zip(joined.parts, union.places, strict=True)):
        mine = np.flatnonzero(places[wanted] >= 0)
        if not mine.size:
            continue
        with file_checks.reading(names[i]):
            rows = _rows(joined, part, union.axis, where, places[wanted][mine])
        held = owner[mine] >= 0
        if not _same_bits(along[mine[held]], rows[held].astype(along.dtype)):
            k = next(k for k in np.flatnonzero(held) if not _same_bits(along[[mine[k]]], rows[[k]].astype(along.dtype)))
            value = union.values[wanted][mine[k]]
            both = f"{names[owner[mine[k]]]} and {names[i]}"
            raise InputError(f"{both} both hold {union.axis} = {value:.10g}, but with other values of {joined.name}")
        along[mine[~held]] = rows[~held]
        owner[mine] = i
    return block


def _rows(joined: Joined, part: xr.DataArray, axis: str, where: Where, at: NDArray[np.int64]) -> NDArray[Any]:
    """A file's part of a block, the axis first: its values at these places, the other dimensions as the block's."""
    others = tuple(dim for dim in joined.dims if dim != axis)
    low, high = int(at.min()), int(at.max()) + 1
    chosen = {dim: piece for dim, piece in zip(joined.dims, where, strict=True) if dim != axis and dim in part.dims}
    if axis in part.dims:
        chosen[axis] = slice(low, high)
    variable = part.variable.isel(chosen)
    missing = {dim: piece.stop - piece.start for dim, piece in zip(joined.dims, where, strict=True)}
    missing[axis] = high - low
    whole = variable.set_dims({dim: missing[dim] for dim in (axis, *others)}).values
    return whole[at - low]


def _same_bits(a: NDArray[Any], b: NDArray[Any]) -> bool:
    """Equal, NaN being equal to NaN."""
    if a.dtype.kind in "iuf" and b.dtype.kind in "iuf":
        return np.array_equal(a, b, equal_nan=True)
    return np.array_equal(a.astype(str), b.astype(str))
