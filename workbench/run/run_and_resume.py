"""Run a study into a file: in chunks, by several workers, continuing where an earlier run stopped."""

import json
import os
import time
from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager, nullcontext, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from solver.problem.errors import InputError
from studies import Study
from studies.laws.law_words import count_of

from ..stored import bounds
from ..stored.stored_verdicts import Tally, count, statistics, tally_of
from . import atomic, cluster, shards, worker_processes
from .block import Chunk, blank_columns, solve_chunk
from .plan import Plan, compare, plan, room, rounds
from .shards import Damaged, Shards, decode, encode
from .worker_processes import Results


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
    def seconds_left(self) -> float | None:
        """Seconds left; None while nothing tells."""
        return (self.total - self.done) / self.rate if self.done > self._before else None

    @property
    def time_left(self) -> str:
        """``, 0:12:05 left``; empty while nothing tells."""
        return "" if self.seconds_left is None else f", {_clock(self.seconds_left)} left"

    def text(self) -> str:
        """``310 a second, 0:12:05 left, 2 unsolved``."""
        return f"{self.rate:.3g} a second{self.time_left}" + (f", {self.unsolved} unsolved" if self.unsolved else "")

    def data(self) -> dict[str, Any]:
        """What `text` says, as numbers for programs."""
        counts = {"done": self.done, "cases": self.total, "unsolved": self.unsolved}
        left = self.seconds_left
        return {**counts, "per_second": round(self.rate, 1), "seconds_left": left and round(left, 1)}


Progress = Callable[[int, int], AbstractContextManager[Meter]]  # takes total and done


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes // 60}:{minutes % 60:02d}:{rest:02d}"


@dataclass(frozen=True)
class RunOptions:
    """How a study is run; none of these changes a bit of what is stored.

    Parameters
    ----------
    workers : int, optional
        Processes on this machine; default: chosen automatically.
    scheduler : str, optional
        The address of a Dask cluster, instead.
    chunk : int, optional
        Cases in a chunk, at most; each is stored in parts of a few seconds' work.
    restart : bool
        Discard what an earlier run has kept, of all parts, and solve a complete study again.
    part : (int, int), optional
        (k, n): solve the k-th of n parts alone, for which each may have a machine of its own. No file is written; the
        finished cases of all parts, in one folder, are those of an interrupted run.
    """

    workers: int | None = None
    scheduler: str | None = None
    chunk: int | None = None
    restart: bool = False
    part: tuple[int, int] | None = None


DEFAULT = RunOptions()
KEPT = "finished cases are kept; run the same command again to continue"


@dataclass(frozen=True)
class Ran:
    """What a run did.

    statistics: of the file (`stored_verdicts.statistics`); of a part none. solved: cases that it solved itself. kept:
    of a part, which cases are kept, where, and how to go on.
    """

    statistics: dict[str, Any]
    solved: int
    seconds: float
    finished_before: bool = False
    kept: str = ""


def run_to_file(
    study: Study,
    output: Path,
    options: RunOptions = DEFAULT,
    say: Callable[[str], None] = lambda text: None,
    progress: Progress = lambda total, done: nullcontext(Meter(total, done)),
) -> Ran:
    """Solve a study into a file.

    Parameters
    ----------
    study : Study
        Its `tol` and `method` are those that it is run with.
    output : Path
        The file; a complete study of the same recipe in it is not solved again.
    options : Options
        How it is run.
    say : callable
        Takes a line of text about the size, before the work begins.
    progress : callable
        Makes the meter that counts the cases.

    Returns
    -------
    Ran
        Counts of outcomes and cautions, cases that this run solved, and seconds.

    Raises
    ------
    InputError
        Where another run is at it, where the disk has no room, or where what is there is of another run.
    KeyboardInterrupt
        It says how to go on.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from studies import load
    >>> from workbench.run.run_and_resume import run_to_file
    >>> with TemporaryDirectory() as folder:
    ...     ran = run_to_file(load("fig7_1_modulus"), Path(folder) / "modulus.h5")
    >>> ran.solved
    9
    """
    if options.workers is not None and options.scheduler is not None:
        raise InputError("--workers is for this machine, --scheduler for a cluster: give one of them")
    whole = plan(study)
    bounds.check_study(study, whole.dimensions)
    work = compare(output, whole, options.restart)
    if work.is_finished:
        _tidy(work, output)
        return _already(work)
    if options.part is not None:
        if study.variation.from_base or study.refine is not None:
            raise InputError("the cases of this study follow from one another, so it is solved whole: omit --part")
        work.part(*options.part)  # refused before anything is printed
    if study.variation.from_base:
        if work.replaced:
            say(work.replaced)
        return _follow(work, output)
    if options.scheduler is None and _count_workers(work, work.todo, options.workers) > 1:
        worker_processes.get_ready()  # while this process reads xarray
    from ..stored import reading
    from . import writing

    writing.check_parent(output)
    folder = shards.folder_of(output)
    with atomic.refusing(output, lambda: "" if shards.is_empty(folder) else KEPT), shards.lock(folder):
        work = compare(output, whole, options.restart)
        if work.is_finished:  # by the run that held the lock
            return _already(work)
        if work.replaced:
            say(work.replaced)
        recipe = work.recipe
        if work.stored is not None:
            reading.open_study(output, whole=True).close()  # a damaged file is refused before the others are solved
            recipe = {**recipe, "grows": work.stored.recipe["axes"]}
        parts = shards.begin(folder, recipe, options.restart)
        try:
            ran = _run(work, parts, output, options, say, progress)
        except KeyboardInterrupt:
            again = "run the same command again to"
            then = again if options.part is None else "run without --part to"
            raise KeyboardInterrupt(f"interrupted; {_way_on(work, folder, f'{again} continue', then)}") from None
        if options.part is not None:
            others = "copy the files of the folders of the other parts into it, then run without --part"
            return replace(ran, kept=_way_on(work, folder, others, "run without --part to"))
        shards.clear(folder)
        return ran


def _follow(work: Plan, output: Path) -> Ran:
    """A study that follows one equilibrium cannot be cut into chunks, and is solved in memory."""
    from . import writing
    from .in_memory import run_followed

    writing.check_parent(output)
    began = time.monotonic()
    ds = run_followed(work.study)
    numbers = statistics(ds)
    writing.write(ds.assign_attrs(recipe=json.dumps(work.recipe), statistics=json.dumps(numbers)), output, force=True)
    return Ran(numbers, ds["outcome"].size, time.monotonic() - began)


def _already(work: Plan) -> Ran:
    assert work.stored is not None
    return Ran(work.stored.statistics, 0, 0.0, True)


def _tidy(work: Plan, output: Path) -> None:
    """Remove what is left of a run that was killed after its file was complete."""
    folder = shards.folder_of(output)
    if not folder.is_dir():
        return
    with suppress(InputError, OSError), shards.lock(folder):
        if shards.is_left_over(folder, work.recipe):
            shards.clear(folder)


def _run(
    work: Plan, parts: Shards, output: Path, options: RunOptions, say: Callable[[str], None], progress: Progress
) -> Ran:
    from .dataset_assembly import assemble

    before = None if work.stored is None else work.stored.statistics
    tally = tally_of(before)
    stored = _count_stored(work, parts.folder)
    kept = _count_kept(work, parts, tally)
    if kept < stored:
        say(f"discarded: {count_of(stored - kept, 'case')} in {parts.folder}, damaged")
    say(room(work, parts.folder, kept, options.part))
    held, so_far, statistics = work.size - work.todo, work, None
    with progress(max(work.size, held + kept), held + kept) as meter:
        while statistics is None:
            try:
                for so_far, start, stop in rounds(work, parts.read_cases):
                    if options.part is not None:
                        start, stop = work.part(*options.part)
                    _solve(so_far, parts, options, meter, tally, start, stop)
                if options.part is not None:
                    return Ran({}, meter.done - held - kept, meter.seconds)
                statistics = assemble(so_far, parts, output, tally)
            except Damaged:  # by another program since it was read: its cases are solved again
                tally = tally_of(before)
                meter.done = held + _count_kept(work, parts, tally)
    return Ran(statistics, so_far.todo - kept, meter.seconds)


def _count_kept(work: Plan, parts: Shards, tally: Tally) -> int:
    """Count the cases of the existing shards, each verified; damaged ones are removed."""
    kept = 0
    for start, stop in shards.shard_ranges(parts.folder, _most(work)):
        try:
            count(parts.read(start, stop), tally)
        except Damaged:
            continue
        kept += stop - start
    return kept


def _most(work: Plan) -> int:
    """The most cases that shards may hold; a refinement has more than its plan at the beginning."""
    return work.todo if work.study.refine is None else shards.MOST


def _count_stored(work: Plan, folder: Path) -> int:
    """Count the cases of the existing shards, whatever these hold."""
    return sum(stop - start for start, stop in shards.shard_ranges(folder, _most(work)))


def _solve(work: Plan, parts: Shards, options: RunOptions, meter: Meter, tally: Tally, start: int, stop: int) -> None:
    """Solve those of the cases `start` to `stop` that have no shard, and store theirs."""
    missing = shards.gaps_between(shards.shard_ranges(parts.folder, work.todo), start, stop)
    meter.total = meter.done + sum(last - first for first, last in missing)
    for chunk, results in _results(work, missing, options):
        if isinstance(results, str):
            results = encode(blank_columns(work.study, chunk.cases, results))
        parts.store(chunk.start, chunk.stop, results)
        meter.add(chunk.cases, count(decode(results), tally))


def _way_on(work: Plan, folder: Path, others: str, then: str) -> str:
    """Which cases are kept, and how to go on: to the others, or, as then says, to write the file.

    They are counted from the shards, as an interruption may come between a shard and the meter.
    """
    done = _count_stored(work, folder)
    if not done:
        return "no case was finished yet"
    cases = "new cases" if work.todo < work.size else "cases"
    which = cases if work.study.refine else f"of {work.todo} {cases}"  # a refinement chooses more as it goes
    more = f"{then} write the file" if done == work.todo and not work.study.refine else others
    return f"{done} {which} are kept in {folder}; {more}"


# Cases solved by themselves, and blocks of others, that justify starting a worker.
WORTH, WORTH_TOGETHER = 128, 10


def _results(work: Plan, missing: list[tuple[int, int]], options: RunOptions) -> Results:
    """The missing cases in chunks or parts of them with their packed results, in any order; or with the outcome of
    their cases, where two workers died at them."""
    if not missing:
        return iter(())
    if options.scheduler is not None:
        return cluster.solve(work, missing, options.scheduler, options.chunk)
    count = _count_workers(work, sum(stop - start for start, stop in missing), options.workers)
    chunks = work.chunks(missing, work.chunk_size(count, options.chunk))
    if count == 1:
        return _alone(work, chunks)
    return worker_processes.pool(work, chunks, count)


def _alone(work: Plan, chunks: Iterable[Chunk]) -> Results:
    """The results of the chunks, solved in this process."""
    for rest in chunks:
        while rest.cases:
            cases, content = solve_chunk(work.light, rest, work.block)
            solved, rest = rest.cut(cases)
            yield solved, content


def _count_workers(work: Plan, cases: int, given: int | None) -> int:
    """How many workers of this machine are worth starting for so many cases, unless as many are asked for."""
    if given is not None:
        return given
    worth = WORTH_TOGETHER * work.block if work.solves_blocks else max(WORTH, work.block)
    return max(1, min(cores(), cases // worth))


def cores() -> int:
    """How many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
