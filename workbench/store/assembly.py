"""Cases of several sources assembled into one file, window by window, so that memory stays small, and judged."""

import json
from collections.abc import Iterable, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr

from ..words import cautions, outcomes
from . import atomic, checksums, concatenation, dataset, netcdf, schema, writing
from .grid_io import Where, span
from .growth import StoredRun, places
from .plan import Plan, bytes_a_case, bytes_of_file, remarks
from .schema import Columns
from .shards import Shards
from .tally import Tally
from .tally import statistics as statistics_of


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
            sources: list[concatenation.Source] = [ShardSource(parts, plan)]
            if stored is not None:
                held = stack.enter_context(netcdf.open_file(output))
                names = [variable.name for variable in variables]
                source = concatenation.FileSource(str(output), held, names, places(stored, plan))
                sources = [source, *sources] if plan.todo else [source]
            gathered = concatenation.gather(sources, plan.shape, bytes_a_case(plan.study))
            windows = ((where, _final(columns, tally)) for where, columns in gathered)
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
    """The cases in the shards of a run."""

    name = "the shards of the run"

    def __init__(self, parts: Shards, plan: Plan) -> None:
        self._parts, self._new, self._shape = parts, plan.new, plan.shape

    def read(self, where: Where) -> concatenation.Piece | None:
        """The cases of a box that the run solves. Raises `Damaged`."""
        start, stop = span(where, self._shape)
        if self._new is None:
            return np.arange(stop - start), self._parts.read_cases(start, stop)
        a, b = np.searchsorted(self._new, [start, stop])
        return (self._new[a:b] - start, self._parts.read_cases(a, b)) if a < b else None
