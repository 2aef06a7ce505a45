"""Run a study into a file: in chunks, by several workers, continuing where an earlier run stopped."""

import json
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from solver.problem.errors import InputError
from studies import Study

from . import engines, shards, worker_processes
from .block import unsolved
from .plan import Plan, plan, room
from .rounds import Rounds
from .shards import Damaged, Shards, decode, encode
from .stored_run import StoredRun, grow, is_finished, look, replace
from .tally import Meter, Progress, Tally, count, statistics, tally_of, unshown

WORTH, WORTH_TOGETHER = 4, 10  # blocks that justify starting a worker


@dataclass(frozen=True)
class Options:
    """How a study is run; none of these changes a bit of what is stored.

    Parameters
    ----------
    workers : int, optional
        Processes on this machine; default: chosen automatically.
    scheduler : str, optional
        The address of a Dask cluster, instead.
    chunk : int, optional
        Cases in a chunk; default: a few seconds' work.
    restart : bool
        Discard what an earlier run has kept, and solve a complete study again.
    """

    workers: int | None = None
    scheduler: str | None = None
    chunk: int | None = None
    restart: bool = False


DEFAULT = Options()


@dataclass(frozen=True)
class Ran:
    """What a run did. statistics: of the file (`tally.statistics`). solved: cases that this run solved itself."""

    statistics: dict[str, Any]
    solved: int
    seconds: float
    finished_before: bool = False


def run_to_file(
    study: Study,
    output: Path,
    options: Options = DEFAULT,
    say: Callable[[str], None] = lambda text: None,
    progress: Progress = unshown,
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
    >>> from workbench.store.study_store import run_to_file
    >>> with TemporaryDirectory() as folder:
    ...     ran = run_to_file(load("fig7_1_modulus"), Path(folder) / "modulus.h5")
    >>> ran.solved
    9
    """
    if options.workers is not None and options.scheduler is not None:
        raise InputError("--workers is for this machine, --scheduler for a cluster: give one of them")
    work = plan(study)
    if (finished := _finish(work, output, options)) is not None:
        _tidy(work, output)
        return finished
    if study.follow is not None:
        if told := replace(_store(output, options), work, output):
            say(told)
        return _follow(work, output)
    if options.scheduler is None and _workers(work, work.todo, options) > 1:
        worker_processes.get_ready()  # while this process reads xarray
    from .writing import check_parent

    check_parent(output)
    folder = shards.folder_of(output)
    with _refusing_disk(output), shards.lock(folder):
        try:
            if (finished := _finish(work, output, options)) is not None:  # by the run that held the lock
                return finished
            there, work = _growth(work, output, options)
            if there is None and (told := replace(_store(output, options), work, output)):
                say(told)
            if options.restart:
                shards.clear(folder, keep_lock=True)
            shards.clear_asides(folder)
            digest = shards.check_recipe(folder, {**work.recipe, **_grows(there)})
            return _run(work, output, Shards(folder, digest), there, options, say, progress)
        finally:
            if shards.is_empty(folder):
                shards.clear(folder)  # there is nothing that a later run could use


def _follow(work: Plan, output: Path) -> Ran:
    """A study that follows one equilibrium cannot be cut into chunks, and is solved in memory."""
    from . import writing
    from .in_memory import run_followed

    writing.check_parent(output)
    began = time.monotonic()
    ds = run_followed(work.study, work.study.tol, work.study.method)
    found = statistics(ds)
    writing.write(ds.assign_attrs(recipe=json.dumps(work.recipe), statistics=json.dumps(found)), output, force=True)
    return Ran(found, ds["outcome"].size, time.monotonic() - began)


def _store(output: Path, options: Options) -> StoredRun | None:
    """The run that stored the existing file, unless its results are to be discarded."""
    return None if options.restart else look(output)


def _finish(work: Plan, output: Path, options: Options) -> Ran | None:
    there = _store(output, options)
    if there is None:
        return None
    work = grow(there, work) or work
    return Ran(there.statistics, 0, 0.0, True) if is_finished(there, work) else None


def _tidy(work: Plan, output: Path) -> None:
    """Remove what is left of a run that was killed after its file was complete."""
    folder = shards.folder_of(output)
    if not folder.is_dir():
        return
    with suppress(InputError, OSError), shards.lock(folder):
        if shards.is_left_over(folder, work.recipe):
            shards.clear(folder)


def _growth(work: Plan, output: Path, options: Options) -> tuple[StoredRun | None, Plan]:
    """The existing file that the study extends, if any, and the plan of the remaining cases."""
    there = _store(output, options)
    larger = grow(there, work) if there is not None else None
    return (there, larger) if larger is not None and larger.new is not None else (None, work)


def _grows(there: StoredRun | None) -> dict[str, Any]:
    return {} if there is None else {"grows": there.recipe["axes"]}


def _run(
    work: Plan,
    output: Path,
    parts: Shards,
    there: StoredRun | None,
    options: Options,
    say: Callable[[str], None],
    progress: Progress,
) -> Ran:
    from .assembly import assemble

    tally = tally_of(there)
    kept = _count_kept(work, parts, tally)
    say(room(work, parts.folder, kept))
    held = work.size - work.todo
    with progress(max(work.size, held + kept), held + kept) as meter:
        told = None
        while told is None:
            try:
                work = _solve_missing(work, parts, output, there, options, meter, tally)
                told = assemble(work, parts, output, there, tally)
            except Damaged:  # by another program since it was read: its cases are solved again
                tally = tally_of(there)
                meter.done = held + _count_kept(work, parts, tally)
    shards.clear(parts.folder)
    return Ran(told, work.todo - kept, meter.seconds)


def _count_kept(work: Plan, parts: Shards, tally: Tally) -> int:
    """Count the cases of the existing shards, each verified; damaged ones are removed."""
    kept = 0
    most = work.todo if work.study.refine is None else shards.MOST
    for start, stop in shards.shard_ranges(parts.folder, most):
        try:
            count(parts.read(start, stop), tally)
        except Damaged:
            continue
        kept += stop - start
    return kept


def _solve_missing(
    work: Plan, parts: Shards, output: Path, there: StoredRun | None, options: Options, meter: Meter, tally: Tally
) -> Plan:
    """Solve the missing cases, of a refined study round by round; the plan of all cases. Raises `Damaged`."""
    if work.study.refine is None:
        _solve(work, parts, options, meter, tally)
        return work
    rounds = Rounds(work.study, there, output)
    for part, start, stop in rounds:
        meter.total = max(meter.total, part.size)
        _solve(part, parts, options, meter, tally, start)
        rounds.take(parts.read_cases(start, stop) if start < stop else None)
    return rounds.plan()


def _solve(work: Plan, parts: Shards, options: Options, meter: Meter, tally: Tally, first: int = 0) -> None:
    """Solve the missing cases from `first` on and store their shards."""
    missing = shards.missing_ranges(shards.shard_ranges(parts.folder, work.todo), work.todo)
    missing = [(max(start, first), stop) for start, stop in missing if stop > first]
    if not missing:
        return
    try:
        for chunk, results in _engine(work, missing, options):
            if isinstance(results, str):
                results = encode(unsolved(work.study, chunk.cases, results))
            parts.store(chunk.start, chunk.stop, results)
            meter.add(chunk.cases, count(decode(results), tally))
    except KeyboardInterrupt:
        raise KeyboardInterrupt(_keep(work, parts.folder)) from None


def _keep(work: Plan, folder: Path) -> str:
    """How to continue; counted from the shards, as the interruption may come between a shard and the meter."""
    missing = shards.missing_ranges(shards.shard_ranges(folder, work.todo), work.todo)
    done = work.size - sum(stop - start for start, stop in missing)
    kept = f"{done} of {work.size} cases are kept in {folder}; run the same command again to continue"
    return f"interrupted; {kept if done else 'no case was finished yet'}"


def _engine(work: Plan, missing: list[tuple[int, int]], options: Options) -> engines.Results:
    left = sum(stop - start for start, stop in missing)
    if options.scheduler is not None:
        return engines.cluster(work, missing, options.scheduler, options.chunk)
    workers = _workers(work, left, options)
    chunks = work.chunks(missing, work.chunk_size(workers, options.chunk))
    if workers == 1:
        return engines.serial(work.light, chunks, work.block)
    return engines.pool(work.light, chunks, work.block, workers)


def _workers(work: Plan, left: int, options: Options) -> int:
    """How many workers are worth starting for so many cases."""
    if options.workers is not None:
        return options.workers
    blocks = WORTH_TOGETHER if work.batched else WORTH
    return max(1, min(engines.cores(), left // (blocks * work.block)))


@contextmanager
def _refusing_disk(output: Path) -> Iterator[None]:
    """An `OSError` of the body becomes an `InputError` of one sentence; finished shards stay."""
    try:
        yield
    except OSError as error:
        why = error.strerror or str(error).partition(",")[0]
        kept = "finished cases are kept; run the same command again to continue"
        raise InputError(f"cannot write {output}: {why}; {kept}") from None
