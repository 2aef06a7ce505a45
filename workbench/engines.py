"""Who solves the chunks: this process, or several on this machine. The engine on a cluster is in `cluster`.

An engine yields each chunk with its packed results as they come, in any order; or with None, where it killed its worker
twice. A worker only solves: this process alone writes, so a worker that outlives a killed run can do no harm.
"""

import multiprocessing
import os
import signal
import traceback
from collections import deque
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess

from solver.errors import InputError
from studies import Study

from .chunks import Chunk, solved
from .plan import check_worker, code_version

Results = Iterator[tuple[Chunk, bytes | None]]

DEATHS = 2  # of workers at one chunk, after which it is given up
# One thread each: the workers are as many as there are cores to use.
ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


def serial(study: Study, chunks: Iterable[Chunk], block: int) -> Results:
    """In this process, one after the other."""
    for chunk in chunks:
        yield chunk, solved(study, chunk, block)


def cores() -> int:
    """How many this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@dataclass(eq=False)
class _Worker:
    """A process of its own, and the chunk that it has. One at a time, so that a death has one cause."""

    process: BaseProcess
    pipe: Connection
    chunk: Chunk | None = None

    def stop(self) -> None:
        self.pipe.close()
        self.process.kill()
        self.process.join()


def pool(study: Study, chunks: Iterable[Chunk], block: int, workers: int) -> Results:
    """In so many processes of this machine.

    A worker that dies is replaced, and its chunk solved again block by block; a block that kills another worker is
    given up. Raises `InputError` where workers cannot start.
    """
    waiting, again = iter(chunks), deque[Chunk]()
    crew: list[_Worker] = []
    try:
        crew += [_started(study) for _ in range(workers)]
        for worker in crew:
            _check_started(worker)
        while True:
            for i, worker in enumerate(crew):
                if worker.chunk is None and (chunk := again.popleft() if again else next(waiting, None)):
                    crew[i] = _given(worker, chunk, block, study)
            busy = {worker.pipe: i for i, worker in enumerate(crew) if worker.chunk}
            if not busy:
                return
            for pipe in wait(list(busy)):
                i = busy[pipe]  # type: ignore[index]
                chunk, results = crew[i].chunk, _received(crew[i])
                assert chunk is not None
                crew[i].chunk = None
                if results is None:
                    crew[i].stop()
                    crew[i] = _started(study)
                    _check_started(crew[i])
                    if chunk.deaths + 1 < DEATHS:
                        again.extend(chunk.blocks(block, chunk.deaths + 1))
                        continue
                elif following := again.popleft() if again else next(waiting, None):
                    crew[i] = _given(crew[i], following, block, study)  # before the results are stored
                yield chunk, results
    finally:
        for worker in crew:
            worker.stop()


def _started(study: Study) -> _Worker:
    """A new worker, on its way."""
    context = multiprocessing.get_context("spawn")  # a fork would share threads and locks
    ours, theirs = context.Pipe()
    process = context.Process(target=_work, args=(theirs, study, code_version()), daemon=True)
    with _one_thread(), _interrupts_held():
        process.start()
    theirs.close()
    return _Worker(process, ours)


def _check_started(worker: _Worker) -> None:
    if _received(worker) is None:
        worker.process.join()
        raise InputError(f"a worker process cannot start: it ended with status {worker.process.exitcode}")


def _given(worker: _Worker, chunk: Chunk, block: int, study: Study) -> _Worker:
    """A worker with the chunk to do: this one, or another where it died idle."""
    try:
        worker.pipe.send((chunk, block))
    except OSError:
        worker.stop()
        worker = _started(study)
        _check_started(worker)
        worker.pipe.send((chunk, block))
    worker.chunk = chunk
    return worker


def _received(worker: _Worker) -> bytes | None:
    """What the worker sent, or None where it died. Raises what it raised."""
    try:
        results, refused, failed = worker.pipe.recv()
    except (EOFError, OSError):
        return None
    if refused is not None:
        raise InputError(refused)
    if failed is not None:
        raise RuntimeError(f"in a worker process:\n{failed}")
    sent: bytes = results
    return sent


def _work(pipe: Connection, study: Study, code: str) -> None:
    """The life of a worker: solve what comes until the pipe ends, as it does when the run is killed."""
    try:
        check_worker(study, code)
        pipe.send((b"", None, None))
        while True:
            chunk, block = pipe.recv()
            pipe.send((solved(study, chunk, block), None, None))
    except (EOFError, OSError):
        return
    except InputError as error:
        pipe.send((None, str(error), None))
    except Exception:
        pipe.send((None, None, traceback.format_exc()))


@contextmanager
def _one_thread() -> Iterator[None]:
    """Processes started meanwhile use one thread each, unless the environment says otherwise."""
    ours = [name for name in ONE_THREAD if name not in os.environ]
    os.environ.update(dict.fromkeys(ours, "1"))
    try:
        yield
    finally:
        for name in ours:
            del os.environ[name]


@contextmanager
def _interrupts_held() -> Iterator[None]:
    """Processes started meanwhile never see Ctrl-C, which a terminal sends to all: their run ends them."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # its own start would let them through again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
