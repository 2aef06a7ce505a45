"""A study stored as it is solved: in chunks, by as many workers as there are, going on where an earlier run stopped."""

import json
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from solver.problem.errors import InputError
from studies import Study

from ..data.schema import TEXTS
from . import local_pool, shards, worker_processes
from .block import kind_of, unsolved
from .plan import TOGETHER, Plan, bytes_a_case, bytes_of_file, plan
from .progress import Meter, Progress, unshown
from .recipe import recipe
from .resume import There, grown, is_finished, look, told_of
from .shards import Damaged, decode, encode

WORTH, WORTH_TOGETHER = 4, 10  # blocks for which a worker is worth its start

Tally = dict[str, Counter[Any]]


@dataclass(frozen=True)
class Options:
    """How a study is run; none of these changes a bit of what is stored.

    workers: processes on this machine, None for as many as are of use. scheduler: of a Dask cluster, instead.
    chunk: cases a chunk, None for a few seconds' work. restart: drop what an earlier run has kept, and solve a complete
    study again.
    """

    workers: int | None = None
    scheduler: str | None = None
    chunk: int | None = None
    restart: bool = False


DEFAULT = Options()


@dataclass(frozen=True)
class Ran:
    """What a run did. told: outcomes, cautions and verdicts of the file. solved: cases this run solved itself."""

    told: dict[str, Any]
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
    """Solve a study into a file; `study.tol` and `study.method` are those that it is run with.

    say: takes a line of text about the size, before the work begins. progress: makes the meter that counts the cases.
    Raises `InputError` where another run is at it, where the disk has no room, or where what is there is of another
    run; `KeyboardInterrupt` says how to go on.
    """
    if options.workers is not None and options.scheduler is not None:
        raise InputError("--workers is for this machine, --scheduler for a cluster: give one of them")
    work = plan(study)
    if (finished := _finished(work, output, options)) is not None:
        _tidy(work, output)
        return finished
    if study.follow is not None:
        return _follow(work, output)
    if options.scheduler is None and _workers(work, work.todo, options) > 1:
        worker_processes.get_ready()  # while this process reads xarray
    from ..data.writing import check_parent  # xarray is not needed before

    check_parent(output)
    folder = shards.folder_of(output)
    with _refusing_disk(output), shards.locked(folder):
        try:
            if (finished := _finished(work, output, options)) is not None:  # by the run that held it
                return finished
            there, work = _growing(work, output, options)
            if options.restart:
                shards.clear(folder, keep_lock=True)
            shards.clear_asides(folder)
            shards.check_recipe(folder, {**recipe(work), **_grows(there)})
            return _run(work, output, folder, there, options, say, progress)
        finally:
            if shards.is_empty(folder):
                shards.clear(folder)  # nothing was kept that a later run could use


def _follow(work: Plan, output: Path) -> Ran:
    """A study along one branch is one line: it cannot be cut, and is solved in memory."""
    from ..data import law_verdicts, writing
    from .following import run_followed

    writing.check_parent(output)
    began = time.monotonic()
    ds = run_followed(work.study, work.study.tol, work.study.method)
    tally = _of_file(None)
    _count({name: ds[name].values for name in ("solved", *TEXTS)}, tally)
    told = told_of(tally, law_verdicts.verdicts(ds))
    writing.write(ds.assign_attrs(recipe=json.dumps(recipe(work)), told=json.dumps(told)), output, force=True)
    return Ran(told, ds["outcome"].size, time.monotonic() - began)


def _finished(work: Plan, output: Path, options: Options) -> Ran | None:
    there = None if options.restart else look(output)
    if there is None:
        return None
    work = grown(there, work) or work
    return Ran(there.told, 0, 0.0, True) if is_finished(there, work) else None


def _tidy(work: Plan, output: Path) -> None:
    """Remove what a run left that was killed after its file was whole."""
    folder = shards.folder_of(output)
    if not folder.is_dir():
        return
    with suppress(InputError, OSError), shards.locked(folder):
        if shards.is_left_over(folder, recipe(work)):
            shards.clear(folder)


def _growing(work: Plan, output: Path, options: Options) -> tuple[There | None, Plan]:
    """The file there that the study extends, if any, and the plan of what is left."""
    there = None if options.restart else look(output)
    larger = grown(there, work) if there is not None else None
    return (there, larger) if larger is not None and larger.new is not None else (None, work)


def _grows(there: There | None) -> dict[str, Any]:
    return {} if there is None else {"grows": there.recipe["axes"]}


def _run(
    work: Plan,
    output: Path,
    folder: Path,
    there: There | None,
    options: Options,
    say: Callable[[str], None],
    progress: Progress,
) -> Ran:
    from .assembly import assemble

    tally = _of_file(there)
    kept = _verified(work, folder, tally)
    say(_room(work, folder, kept))
    with progress(work.size, work.size - work.todo + kept) as meter:
        told = None
        while told is None:
            _solve(work, folder, options, meter, tally)
            try:
                told = assemble(work, folder, output, there, tally)
            except Damaged:  # between the two, by another hand: what is left is solved again
                tally = _of_file(there)
                meter.done = work.size - work.todo + _verified(work, folder, tally)
    shards.clear(folder)
    return Ran(told, work.todo - kept, meter.seconds)


def _of_file(there: There | None) -> Tally:
    if there is None:
        return {"solved": Counter(), "outcome": Counter(), "caution": Counter(), "branch": Counter()}
    texts = {"outcome": Counter(there.told["outcomes"]), "caution": Counter(there.told["cautions"])}
    return {"solved": Counter({False: there.told["unsolved"]}), **texts, "branch": Counter()}  # a sweep does not grow


def _verified(work: Plan, folder: Path, tally: Tally) -> int:
    """Count the cases of the shards that are there, each looked at; damaged ones are removed."""
    kept = 0
    for start, stop in shards.stretches(folder, work.todo):
        try:
            _count(shards.read_shard(folder, start, stop), tally)
        except Damaged:
            continue
        kept += stop - start
    return kept


def _count(columns: dict[str, Any], tally: Tally) -> int:
    """Add the columns to the tally; how many of their cases are not solved."""
    for branch in columns.get("branch", ()):
        tally["branch"][int(branch)] += 1
    for name in TEXTS:
        counts = tally[name]
        texts, times = np.unique(columns[name].astype(str), return_counts=True)
        for text, count in zip(texts.tolist(), times.tolist(), strict=True):
            counts[kind_of(text)] += count
    unsolved = int(np.count_nonzero(~columns["solved"]))
    tally["solved"][False] += unsolved
    return unsolved


def _solve(work: Plan, folder: Path, options: Options, meter: Meter, tally: Tally) -> None:
    """Solve what is missing, and keep it."""
    missing = shards.missing(shards.stretches(folder, work.todo), work.todo)
    if not missing:
        return
    try:
        for chunk, results in _engine(work, missing, options):
            if isinstance(results, str):
                results = encode(unsolved(work.study, chunk.cases, results))
            shards.store_shard(folder, chunk.start, chunk.stop, results)
            meter.add(chunk.cases, _count(decode(results), tally))
    except KeyboardInterrupt:
        raise KeyboardInterrupt(_kept(work, folder)) from None


def _kept(work: Plan, folder: Path) -> str:
    """How to go on; counted from the shards, as the interruption may come between a shard and the meter."""
    missing = shards.missing(shards.stretches(folder, work.todo), work.todo)
    done = work.size - sum(stop - start for start, stop in missing)
    kept = f"{done} of {work.size} cases are kept in {folder}; the same command goes on from there"
    return f"interrupted; {kept if done else 'nothing was finished yet'}"


def _engine(work: Plan, missing: list[tuple[int, int]], options: Options) -> local_pool.Results:
    left = sum(stop - start for start, stop in missing)
    if options.scheduler is not None:
        from .dask_engine import cluster

        return cluster(work, missing, options.scheduler, options.chunk)
    workers = _workers(work, left, options)
    chunks = work.chunks(missing, _chunk_size(work, workers, options.chunk))
    if workers == 1:
        return local_pool.serial(work.light, chunks, work.block)
    return local_pool.pool(work.light, chunks, work.block, workers)


def _workers(work: Plan, left: int, options: Options) -> int:
    """Processes for so many cases; the first worker takes a second to start, or some blocks' time."""
    if options.workers is not None:
        return options.workers
    blocks = WORTH_TOGETHER if work.study.method in TOGETHER else WORTH
    return max(1, min(local_pool.cores(), left // (blocks * work.block)))


def _chunk_size(work: Plan, workers: int, asked: int | None) -> int:
    """In whole blocks."""
    return work.chunk_size(workers) if asked is None else work.block * max(1, round(asked / work.block))


def _room(work: Plan, folder: Path, kept: int) -> str:
    """What the run takes, in words; raises `InputError` where the disk has less."""
    case = bytes_a_case(work.study)
    final, parts = bytes_of_file(work), (work.todo - kept) * case
    there = shards.free(folder)
    if final + parts > there:
        needed = f"{_bytes(final)} for the file and {_bytes(parts)} for its parts until it is whole"
        raise InputError(f"the study needs up to {needed}, but {folder.parent} has {_bytes(there)} left")
    new = f", {work.size - work.todo} of them there already" if work.todo < work.size else ""
    going = f", {kept} kept from an earlier run" if kept else ""
    room = f"a file of at most {_bytes(final)}, and {_bytes(parts)} more while it runs"
    return f"{work.size} case{'s' * (work.size != 1)}{new}{going}: {room}"


def _bytes(count: int) -> str:
    for unit, size in (("GB", 1e9), ("MB", 1e6)):
        if count >= size:
            return f"{count / size:.3g} {unit}"
    return f"{count / 1e3:.3g} kB"


@contextmanager
def _refusing_disk(output: Path) -> Iterator[None]:
    """What the disk refuses is told in one sentence; what is kept stays."""
    try:
        yield
    except OSError as error:
        why = error.strerror or str(error).partition(",")[0]
        kept = "what is finished is kept, and the same command goes on from there"
        raise InputError(f"cannot write {output}: {why}; {kept}") from None
