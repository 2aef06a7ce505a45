"""The tally of a study: cases unsolved, outcomes, cautions, branches; and how far its run is."""

import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

from ..words import outcomes
from . import law_verdicts
from .grid_io import pieces
from .growth import StoredRun
from .schema import SAMPLING, TEXTS, Columns

if TYPE_CHECKING:
    import xarray as xr


Tally = Mapping[str, Counter[Any]]

BLOCK = 100_000  # cases that are read at a time


def tally_of(stored: StoredRun | None) -> Tally:
    """The tally of an existing file, or an empty one."""
    if stored is None:
        return {name: Counter() for name in ("solved", *TEXTS, "branch")}
    statistics = stored.statistics
    texts = {"outcome": Counter(statistics["outcomes"]), "caution": Counter(statistics["cautions"])}
    branch = Counter({int(number): cases for number, cases in statistics["branch_counts"].items()})
    return {"solved": Counter({False: statistics["unsolved"]}), **texts, "branch": branch}


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
        for piece in pieces(ds, names, BLOCK):
            count({name: piece[name].values for name in names}, tally)
    return {
        "unsolved": tally["solved"][False],
        **{f"{name}s": dict(sorted(tally[name].items())) for name in TEXTS},
        "laws": law_verdicts.verdicts(ds),
        "equilibria": str(ds.attrs.get("equilibria", "")),
        "branches": outcomes.branches_of(ds, tally["branch"]),
        "branch_counts": dict(sorted(tally["branch"].items())),
        **{name: str(ds.attrs[name]) for name in SAMPLING if name in ds.attrs},
    }


class Meter:
    """Counts cases: `done` of `total` are finished. show: called with the meter whenever the count has changed."""

    def __init__(self, total: int, done: int, show: "Callable[[Meter], None]" = lambda meter: None) -> None:
        self.total, self.done, self.unsolved = total, done, 0
        self._before, self._began, self._show = done, time.monotonic(), show

    def add(self, cases: int, unsolved: int) -> None:
        """So many more cases are done, of which so many were not solved."""
        self.done += cases
        self.unsolved += unsolved
        self._show(self)

    @property
    def seconds(self) -> float:
        """Since the run began."""
        return time.monotonic() - self._began

    @property
    def rate(self) -> float:
        """Cases a second."""
        return (self.done - self._before) / max(self.seconds, 1e-9)

    @property
    def left(self) -> float | None:
        """Seconds left; None while nothing tells."""
        return (self.total - self.done) / self.rate if self.done > self._before else None

    def text(self) -> str:
        """``310 a second, 0:12:05 left, 2 unsolved``."""
        left = "" if self.left is None else f", {_clock(self.left)} left"
        return f"{self.rate:.3g} a second{left}" + (f", {self.unsolved} unsolved" if self.unsolved else "")

    def data(self) -> dict[str, Any]:
        """The same for programs."""
        counts = {"done": self.done, "cases": self.total, "unsolved": self.unsolved}
        return {**counts, "per_second": round(self.rate, 1), "seconds_left": self.left and round(self.left, 1)}


Progress = Callable[[int, int], AbstractContextManager[Meter]]  # takes total and done


@contextmanager
def unshown(total: int, done: int) -> Iterator[Meter]:
    """A meter that nobody sees."""
    yield Meter(total, done)


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes // 60}:{minutes % 60:02d}:{rest:02d}"
