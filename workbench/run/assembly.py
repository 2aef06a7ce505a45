"""Assemble the shards into the output file, window by window, so that memory stays small."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from ..data import (
    atomic,
    branch_numbers,
    cautions,
    checksums,
    dataset,
    grid_io,
    law_verdicts,
    netcdf,
    refined,
    schema,
    writing,
)
from ..data.schema import Columns
from . import shards
from .plan import Plan, bytes_a_case, bytes_of_file, first_of
from .resume import StoredRun, places
from .shards import Shards
from .tally import Tally, statistics_of

WINDOW = 2**25  # bytes of results held while they are copied


def assemble(plan: Plan, parts: Shards, output: Path, there: StoredRun | None, tally: Tally) -> dict[str, Any]:
    """Write the dataset of all shards, and of the cases of the existing file, in place of that file.

    tally: counts of solved, outcome, caution and branch over all cases. Returns the statistics of the file. Raises
    `shards.Damaged` for a damaged shard and `OSError` where the disk is full; the existing file then stays as it was.
    """
    aside = parts.folder / f".{output.name}"
    try:
        frame = dataset.frame(plan.study, plan.dimensions, first_of(plan))
        frame = frame.assign_attrs(caution=cautions.told(tally["caution"]))
        if plan.refinement is not None:
            frame = frame.assign_attrs(refined.attributes(plan.study, plan.refinement))
        with writing.appending(frame, aside, bytes_of_file(plan)) as file:
            _write_cases(file, plan, _rows(plan, parts, output, there), tally)
        statistics = _statistics(aside, tally)
        with h5py.File(aside, "a") as file:
            file.attrs["recipe"] = json.dumps(plan.recipe)
            file.attrs["statistics"] = json.dumps(statistics)
            checksums.store(file)
        atomic.move(aside, output)
        return statistics
    finally:
        aside.unlink(missing_ok=True)


def _statistics(path: Path, tally: Tally) -> dict[str, Any]:
    """The statistics of the file, from which `run` reports without reading its cases again."""
    with netcdf.opened(path) as ds:
        verdicts, first = law_verdicts.verdicts(ds), str(ds.attrs.get("equilibria", ""))
        sampling = {name: str(ds.attrs[name]) for name in schema.SAMPLING if name in ds.attrs}
    branches = branch_numbers.sentence(tally["branch"]) if tally["branch"] else ""
    return {**statistics_of(tally, verdicts), "equilibria": first, "branches": branches, **sampling}


def _write_cases(file: Any, plan: Plan, rows: Iterator[tuple[int, Columns]], tally: Tally) -> None:
    """Every variable over the axes, window by window. Whole numbers stay whole where all cases are solved."""
    all_solved = not tally["solved"][False]
    variables: dict[str, Any] = {}
    for start, columns in rows:
        for row in dataset.stored(plan.study, plan.dimensions):
            values = columns[row.column]
            if row.name == "branch":
                values = branch_numbers.numbered(values, tally["branch"])
            elif values.dtype.kind == "i" and not all_solved:
                values = values.astype(float)
            if row.name not in variables:
                variables[row.name] = _created(file, plan, row, values)
            values = values.astype({"U": object, "b": np.int8}.get(values.dtype.kind, values.dtype), copy=False)
            grid_io.write(variables[row.name], plan.shape, start, values)


def _created(file: Any, plan: Plan, row: dataset.Stored, values: NDArray[Any]) -> Any:
    shape = plan.shape + values.shape[1:]
    kind: dict[str, Any] = {"dtype": h5py.string_dtype()} if values.dtype.kind == "U" else {"dtype": values.dtype}
    if values.dtype.kind == "f":
        kind["fillvalue"] = np.nan
    if values.dtype.kind == "b":  # which netCDF has not: as xarray stores it
        kind["dtype"] = np.int8
    if shape:
        kind |= {"chunks": grid_io.packing(shape), **schema.packing(len(shape), values.dtype)}
    variable = file.create_variable(row.name, row.dims, **kind)
    for key, text in schema.labels_in(plan.study, row.row).items():
        variable.attrs[key] = text
    if values.dtype.kind == "b":
        variable.attrs["dtype"] = "bool"
    return variable


def _rows(plan: Plan, parts: Shards, output: Path, there: StoredRun | None) -> Iterator[tuple[int, Columns]]:
    """The first case and the columns of each window of cases, in flat order."""
    window = max(1, WINDOW // bytes_a_case(plan.study))
    new = _Window(parts, plan.todo)
    if plan.new is None:
        for start in range(0, plan.size, window):
            yield start, new.rows(start, min(start + window, plan.size))
        return
    assert there is not None
    with h5py.File(output, "r") as file:
        held = _Held(file, plan, there)
        for start in range(0, plan.size, window):
            stop = min(start + window, plan.size)
            a, b = np.searchsorted(plan.new, [start, stop])
            yield start, _merged(new.rows(int(a), int(b)) if a < b else {}, plan.new[a:b] - start, held, start, stop)


def _merged(new: Columns, at: NDArray[np.int64], held: "_Held", start: int, stop: int) -> Columns:
    """The columns of a window: new rows at their places, rows of the existing file at the others."""
    other = np.setdiff1d(np.arange(stop - start), at, assume_unique=True)
    if not other.size:
        return new
    old = held.rows(start + other)
    if not at.size:
        return old
    merged: Columns = {}
    for name, rows in old.items():
        both = np.concatenate([rows, new[name]])
        merged[name] = np.empty_like(both)
        merged[name][np.concatenate([other, at])] = both
    return merged


class _Window:
    """The results in the shards, in order; one shard is held at a time."""

    def __init__(self, parts: Shards, cases: int) -> None:
        self._parts = parts
        self._there = shards.stored_ranges(parts.folder, cases)
        self._held: tuple[int, int] = (0, 0)
        self._columns: Columns = {}

    def rows(self, start: int, stop: int) -> Columns:
        """The columns of the cases `start` to `stop`. Raises `Damaged`."""
        pieces: list[Columns] = []
        for a, b in self._there:
            if a < stop and b > start:
                if (a, b) != self._held:
                    self._columns, self._held = self._parts.read(a, b), (a, b)
                mine = slice(max(start - a, 0), stop - a)
                pieces.append({name: values[mine] for name, values in self._columns.items()})
        return {name: np.concatenate([piece[name] for piece in pieces]) for name in pieces[0]}


class _Held:
    """The cases of the existing file that is extended."""

    def __init__(self, file: h5py.File, plan: Plan, there: StoredRun) -> None:
        self._file, self._plan = file, plan
        self._places = places(there, plan)
        self._shape = there.dimensions.shape
        self._stored = dataset.stored(plan.study, plan.dimensions)

    def rows(self, flat: NDArray[np.int64]) -> Columns:
        """The columns of cases of the new grid that the file holds."""
        at = np.unravel_index(flat, self._plan.shape)
        old = np.ravel_multi_index([place[i] for place, i in zip(self._places, at, strict=True)], self._shape)
        found = {row.column: self._read(self._file[row.name], old) for row in self._stored}
        return {**found, "solved": found["solved"].astype(bool)}

    def _read(self, variable: h5py.Dataset, old: NDArray[np.int64]) -> NDArray[Any]:
        """Rows at flat indices of the file: in one read where they lie close together, else a read for each run."""
        if h5py.check_string_dtype(variable.dtype):
            variable = variable.asstr()
        low, high = int(old.min()), int(old.max()) + 1
        if high - low <= 4 * old.size:
            return self._text(grid_io.read(variable, self._shape, low, high))[old - low]
        runs = np.split(old, np.flatnonzero(np.diff(old) != 1) + 1)
        return self._text(
            np.concatenate([grid_io.read(variable, self._shape, int(run[0]), int(run[-1]) + 1) for run in runs])
        )

    @staticmethod
    def _text(values: NDArray[Any]) -> NDArray[Any]:
        return values.astype(str) if values.dtype.kind == "O" else values
