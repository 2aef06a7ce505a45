"""Cases of several sources assembled into one file, window by window, so that memory stays small, and judged."""

import json
from collections.abc import Iterable, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..words import cautions, outcomes
from . import atomic, checksums, concatenation, dataset, netcdf, refined, schema, shards, writing
from .plan import Plan, bytes_a_case, bytes_of_file, first_of
from .schema import Columns
from .shards import Shards
from .stored_run import StoredRun, places
from .tally import Tally
from .tally import statistics as statistics_of


def assemble(plan: Plan, parts: Shards, output: Path, there: StoredRun | None, tally: Tally) -> dict[str, Any]:
    """Write the dataset of all shards, and of the cases of the existing file, in place of that file.

    tally: counts of solved, outcome, caution and branch over all cases. Returns the statistics of the file. Raises
    `shards.Damaged` for a damaged shard and `OSError` where the disk is full; the existing file then stays as it was.
    """
    aside = parts.folder / f".{output.name}"
    rows = dataset.store(plan.study, plan.dimensions)
    variables = [writing.CaseVariable(row.name, row.dims, schema.labels_in(plan.study, row.row)) for row in rows]
    try:
        frame = dataset.frame(plan.study, plan.dimensions, first_of(plan))
        if plan.refinement is not None:
            frame = frame.assign_attrs(refined.attributes(plan.study, plan.refinement))
        with ExitStack() as stack:
            sources: list[concatenation.Source] = [ShardSource(parts, plan)]
            if there is not None:
                held = stack.enter_context(netcdf.open_file(output))
                names = [row.name for row in rows]
                source = concatenation.FileSource(str(output), held, names, plan.shape, places(there, plan))
                sources = [source, *sources] if plan.todo else [source]
            gathered = concatenation.gather(sources, plan.shape, bytes_a_case(plan.study))
            windows = ((start, _final(columns, tally)) for start, columns in gathered)
            statistics = store_cases(
                frame, aside, bytes_of_file(plan), variables, plan.shape, windows, plan.recipe, tally
            )
        atomic.move(aside, output)
        return statistics
    finally:
        aside.unlink(missing_ok=True)


def store_cases(
    frame: xr.Dataset, path: Path, size: int, variables: Sequence[writing.CaseVariable], shape: tuple[int, ...],
    windows: Iterable[tuple[int, Columns]], recipe: Mapping[str, Any] | None, tally: Tally | None = None,
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


def _final(columns: Columns, tally: Tally) -> Columns:
    """The columns as they are stored: branches numbered from 0, and numbers that some case has not as floats.

    Whole numbers stay whole where all cases are solved.
    """
    final = dict(columns)
    if "branch" in final:
        final["branch"] = outcomes.number_branches(final["branch"], tally["branch"])
    if tally["solved"][False]:
        final |= {k: v.astype(float) for k, v in final.items() if v.dtype.kind == "i" and k != "branch"}
    return final


class ShardSource:
    """The cases in the shards of a run; one shard is held at a time."""

    name = "the shards of the run"

    def __init__(self, parts: Shards, plan: Plan) -> None:
        self._parts, self._new = parts, plan.new
        self._stored = shards.shard_ranges(parts.folder, plan.todo)
        self._names = {row.column: row.name for row in dataset.store(plan.study, plan.dimensions)}
        self._held: tuple[int, int] = (0, 0)
        self._columns: Columns = {}

    def find(self, start: int, stop: int) -> NDArray[np.int64]:
        """Those of the cases `start` to `stop` of the grid that the run solves."""
        if self._new is None:
            return np.arange(start, stop)
        a, b = np.searchsorted(self._new, [start, stop])
        return self._new[a:b]

    def read(self, flat: NDArray[np.int64]) -> Columns:
        """The variables of these cases, which follow one another in the run. Raises `Damaged`."""
        ends = flat[[0, -1]] if self._new is None else np.searchsorted(self._new, flat[[0, -1]])
        start, stop = int(ends[0]), int(ends[1]) + 1
        pieces: list[Columns] = []
        for a, b in self._stored:
            if a < stop and b > start:
                if (a, b) != self._held:
                    self._columns, self._held = self._parts.read(a, b), (a, b)
                mine = slice(max(start - a, 0), stop - a)
                pieces.append({name: self._columns[column][mine] for column, name in self._names.items()})
        return {name: np.concatenate([piece[name] for piece in pieces]) for name in pieces[0]}
