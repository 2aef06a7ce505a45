"""The tally of a run: how many cases are unsolved, and how often each outcome, caution and branch occurs."""

from collections import Counter
from collections.abc import Mapping
from typing import Any

import numpy as np

from ..words import outcomes
from .schema import TEXTS, Columns
from .stored_run import StoredRun

Tally = Mapping[str, Counter[Any]]


def tally_of(there: StoredRun | None) -> Tally:
    """The tally of an existing file, or an empty one. A sweep is never extended, so it has no branches."""
    if there is None:
        return {name: Counter() for name in ("solved", *TEXTS, "branch")}
    found = there.statistics
    texts = {"outcome": Counter(found["outcomes"]), "caution": Counter(found["cautions"])}
    return {"solved": Counter({False: found["unsolved"]}), **texts, "branch": Counter()}


def count(columns: Columns, tally: Tally) -> int:
    """Add the columns to the tally, and return how many of their cases are not solved."""
    for branch in columns.get("branch", ()):
        tally["branch"][int(branch)] += 1
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


def statistics_of(tally: Mapping[str, Mapping[Any, int]], laws: list[dict[str, Any]]) -> dict[str, Any]:
    """The statistics of a file: how many cases are unsolved, have each outcome, each caution, and the verdicts."""
    texts = {f"{name}s": dict(sorted(tally[name].items())) for name in ("outcome", "caution")}
    return {"unsolved": tally["solved"][False], **texts, "laws": laws}
