"""The tally of a study: how many cases are unsolved, and how often each outcome, caution and branch occurs."""

from collections import Counter
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ..words import outcomes
from . import law_verdicts
from .grid_io import blocks
from .schema import SAMPLING, TEXTS, Columns
from .stored_run import StoredRun

if TYPE_CHECKING:
    import xarray as xr

Tally = Mapping[str, Counter[Any]]

BLOCK = 100_000  # cases that are read at a time


def tally_of(there: StoredRun | None) -> Tally:
    """The tally of an existing file, or an empty one. A sweep is never extended, so it has no branches."""
    if there is None:
        return {name: Counter() for name in ("solved", *TEXTS, "branch")}
    found = there.statistics
    texts = {"outcome": Counter(found["outcomes"]), "caution": Counter(found["cautions"])}
    return {"solved": Counter({False: found["unsolved"]}), **texts, "branch": Counter()}


def count(columns: Columns, tally: Tally) -> int:
    """Add the columns to the tally, and return how many of their cases are not solved."""
    if "branch" in columns:
        tally["branch"].update(outcomes.count_branches(columns["branch"]))
    for name in TEXTS:
        texts, counts = np.unique(columns[name].astype(str), return_counts=True)
        for text, cases in zip(texts.tolist(), counts.tolist(), strict=True):
            tally[name][text] += cases
        together = outcomes.group(tally[name])
        tally[name].clear()
        tally[name].update(together)
    unsolved = int(np.count_nonzero(~columns["solved"]))
    tally["solved"][False] += unsolved
    return unsolved


def statistics(ds: "xr.Dataset", tally: Tally | None = None) -> dict[str, Any]:
    """What is said of a stored study without reading its cases again: the tally, the verdicts, sentences.

    tally: of all cases of the dataset; default: counted here, block by block.
    """
    if tally is None:
        tally = tally_of(None)
        names = [name for name in ("solved", *TEXTS, "branch") if name in ds]
        for where in blocks(ds["solved"].shape, BLOCK):
            count({name: ds[name][where].values for name in names}, tally)
    return {
        "unsolved": tally["solved"][False],
        **{f"{name}s": dict(sorted(tally[name].items())) for name in TEXTS},
        "laws": law_verdicts.verdicts(ds),
        "equilibria": str(ds.attrs.get("equilibria", "")),
        "branches": outcomes.branch_sentence(tally["branch"]) if tally["branch"] else "",
        **{name: str(ds.attrs[name]) for name in SAMPLING if name in ds.attrs},
    }
