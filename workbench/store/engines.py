"""Chunks solved in this process, by several workers on this machine, or by those of a Dask cluster (extra `cluster`).

An engine yields each chunk with its packed results, in any order; or with the outcome of its cases, where two workers
died at it. Workers only solve, and this process alone writes: a cluster needs the packages, but no shared folder.
"""

import itertools
import os
import traceback
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from multiprocessing.connection import wait
from typing import Any
from urllib.parse import urlsplit

from solver.problem.errors import InputError
from studies import Study

from . import worker_processes
from .block import Chunk, solve_chunk
from .plan import Plan
from .recipe import check_worker, code_version
from .worker_processes import Died, Failed, Worker

Results = Iterator[tuple[Chunk, bytes | str]]

WORTH, WORTH_TOGETHER = 4, 10  # blocks that justify starting a worker
DEATHS = 2  # of workers at one block, after which it is given up
KILLED = "failed: the process that solved it ended twice without an answer"


def solve(
    work: Plan, missing: list[tuple[int, int]], workers: int | None, scheduler: str | None, chunk: int | None
) -> Results:
    """Solve the missing cases of a plan; workers, scheduler, chunk: as of `study_store.Options`."""
    if not missing:
        return iter(())
    if scheduler is not None:
        return cluster(work, missing, scheduler, chunk)
    count = count_workers(work, sum(stop - start for start, stop in missing), workers)
    chunks = work.chunks(missing, work.chunk_size(count, chunk))
    if count == 1:
        return ((chunk, solve_chunk(work.light, chunk, work.block)) for chunk in chunks)
    return pool(work, chunks, count)


def count_workers(work: Plan, cases: int, given: int | None) -> int:
    """How many workers of this machine are worth starting for so many cases, unless as many are asked for."""
    if given is not None:
        return given
    blocks = WORTH_TOGETHER if work.batched else WORTH
    return max(1, min(cores(), cases // (blocks * work.block)))


def cores() -> int:
    """How many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _hand_out(
    work: Plan, chunks: Iterable[Chunk], room: Callable[[], int], give: Callable[[Chunk], None],
    take: Callable[[], tuple[Chunk, bytes | str]],
) -> Results:  # fmt: skip
    """Give chunks to workers as far as there is room, and yield the results.

    A chunk at which a worker died is solved again at the end, one block at a time; a block at which a second one dies
    is given up. take: waits for a chunk, and returns it with its results, or says why it has none.
    """
    waiting, suspects, under_way = iter(chunks), deque[Chunk](), 0
    done: tuple[Chunk, bytes | str] | None = None
    while True:
        for chunk in itertools.islice(waiting, max(0, room())):
            give(chunk)
            under_way += 1
        if suspects and not under_way:
            give(suspects.popleft())
            under_way = 1
        if done is not None:
            yield done  # after others were given, as storing takes time
        if not under_way:
            return
        chunk, results = done = take()
        under_way -= 1
        if isinstance(results, str) and chunk.deaths + 1 < DEATHS:
            suspects.extend(chunk.blocks(work.block, chunk.deaths + 1))
            done = None


def pool(work: Plan, chunks: Iterable[Chunk], workers: int) -> Results:
    """Solve the chunks in so many processes of this machine. Raises `InputError` where workers cannot start."""
    started: list[Worker] = []
    busy: dict[Any, tuple[Worker, Chunk]] = {}  # by the pipe of the worker

    def begin(count: int) -> None:
        for _ in range(count):  # each is listed at once, so that it is stopped where the next cannot start
            started.append(Worker())
            with suppress(OSError):  # its answer then says how it died
                started[-1].call(check_worker, work.light, code_version())
        for worker in started[-count:]:
            try:
                worker.answer()
            except Died as how:
                raise InputError(f"a worker process cannot start: {how}") from None

    def replace(worker: Worker) -> None:
        worker.stop()
        started.remove(worker)
        begin(1)

    def give(chunk: Chunk) -> None:
        worker = next(worker for worker in started if worker.pipe not in busy)
        try:
            worker.call(solve_chunk, work.light, chunk, work.block)
        except OSError:  # it died while idle
            replace(worker)
            return give(chunk)
        busy[worker.pipe] = worker, chunk

    def take() -> tuple[Chunk, bytes | str]:
        worker, chunk = busy.pop(wait(list(busy))[0])
        try:
            return chunk, worker.answer()
        except Died as how:
            replace(worker)
            return chunk, f"{KILLED} ({how})"
        except Failed as error:
            raise RuntimeError(f"in a worker process:\n{error.trace}") from None

    try:
        begin(workers)
        yield from _hand_out(work, chunks, lambda: len(started) - len(busy), give, take)
    finally:
        for worker in started:
            worker.stop()


MISSING = "--scheduler needs the packages dask and distributed: pip install 'rod-workbench[cluster]'"
PATIENCE = 20.0  # seconds to wait for a scheduler, and for its first worker
AHEAD = 2  # chunks submitted for each thread of a worker: one to solve, one to wait


def cluster(work: Plan, missing: Iterable[tuple[int, int]], address: str, chunk_size: int | None) -> Results:
    """Solve the missing cases on the cluster at that address (tcp://host:port).

    A few chunks are submitted for each thread, so that neither side holds many. Where a worker dies, Dask solves its
    chunks again, as often as its scheduler allows, and then gives up all of them. Raises `InputError` where there is no
    such cluster, no worker, or a worker with other code.
    """
    try:
        from distributed import CancelledError, Client, KilledWorker, as_completed
        from distributed.comm.core import CommClosedError
    except ImportError:
        raise InputError(MISSING) from None
    _check_address(address)
    try:
        client = Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        why = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise InputError(f"no Dask scheduler answers at {address}: {why}") from None
    done, code = as_completed(loop=client.loop), code_version()
    under_way: dict[Any, Chunk] = {}

    def threads() -> int:
        return sum(client.nthreads().values())

    def give(chunk: Chunk) -> None:
        future = client.submit(_solve, work.light, chunk, work.block, code, pure=False)
        under_way[future.key] = chunk
        done.add(future)

    def take() -> tuple[Chunk, bytes | str]:
        future = next(done)
        chunk = under_way.pop(future.key)
        try:
            results = future.result()  # Dask solves it again where the worker died before the results were fetched
        except KilledWorker:
            return chunk, KILLED
        except (CancelledError, CommClosedError):
            raise InputError(
                "the Dask scheduler no longer answers; finished cases are kept; run the same command again to continue"
            ) from None
        future.release()
        return chunk, results

    try:
        _check_workers(client, work.light)
        chunks = work.chunks(missing, work.chunk_size(threads(), chunk_size))
        yield from _hand_out(work, chunks, lambda: AHEAD * max(1, threads()) - len(under_way), give, take)
    finally:
        client.close(timeout=2)


def _check_address(address: str) -> None:
    try:
        parts = urlsplit(address)
        if parts.scheme in ("tcp", "tls") and parts.hostname and parts.port:
            return
    except ValueError:  # a port that is no number
        pass
    raise InputError(f"--scheduler must be tcp://host:port or tls://host:port, got {address!r}")


def _check_workers(client: Any, study: Study) -> None:
    try:
        client.wait_for_workers(1, timeout=PATIENCE)
    except TimeoutError:
        raise InputError(f"the cluster has no worker after {PATIENCE:g} s; start one with dask worker") from None
    try:
        client.run(check_worker, study, code_version())
    except ImportError as error:
        raise InputError(f"a worker lacks what this run needs: {error}") from None


def _solve(study: Study, chunk: Chunk, block: int, code: str) -> bytes:
    """Solve a chunk in a worker, which may have joined later than the others."""
    check_worker(study, code)
    worker_processes.keep_memory()
    try:
        return solve_chunk(study, chunk, block)
    except InputError:
        raise
    except Exception:
        wrong = traceback.format_exc()
    # Outside the handler: Dask also sends the exception's context, and waits for ever where it cannot be sent.
    raise RuntimeError(f"in a worker of the cluster:\n{wrong}")
