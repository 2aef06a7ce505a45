"""Processes of this machine that solve chunks: how they start, what they are given, and how their death is noticed.

Where the system can, they are copies of one process that has read all code once: then starting another takes
milliseconds. A copy of this process itself would share its threads and locks.
"""

import multiprocessing
import os
import signal
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing import forkserver, resource_tracker
from multiprocessing.connection import Connection
from multiprocessing.context import ForkServerContext, SpawnContext
from multiprocessing.process import BaseProcess
from typing import Any

from solver.problem.errors import InputError
from studies import Study

from . import memory
from .block import Chunk, solved
from .recipe import check_worker, code_version

# One thread each: the workers are as many as there are cores to use.
ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
COPIED = sys.platform == "linux"  # elsewhere a copy of a process that has loaded NumPy is not safe, or not possible
_READ_FIRST = f"{__package__}.preload"


class Worker:
    """A process of its own, and the chunk that it has. One at a time, so that a death has one cause."""

    def __init__(self, study: Study) -> None:
        self.study = study
        self.chunk: Chunk | None = None
        self._start()

    def _start(self) -> None:
        """On its way; `check` waits for it. Raises `InputError` where the system has no process to give."""
        self.process, self.pipe = process(_work, self.study, code_version())

    def check(self) -> None:
        """Wait until it can begin. Raises `InputError` where it cannot."""
        if self._received() is None:
            self.process.join()
            raise InputError(f"a worker process cannot start: it ended with status {self.process.exitcode}")

    def give(self, chunk: Chunk, block: int) -> None:
        """Hand it a chunk; where it died idle, another takes its place."""
        try:
            self.pipe.send((chunk, block))
        except OSError:
            self.replace()
            self.pipe.send((chunk, block))
        self.chunk = chunk

    def take(self) -> tuple[Chunk, bytes | None]:
        """Its chunk and the results, None where it died. Raises what it raised."""
        chunk, self.chunk = self.chunk, None
        assert chunk is not None
        return chunk, self._received()

    def replace(self) -> None:
        """Another process in its place."""
        self.stop()
        self._start()
        self.check()

    def stop(self) -> None:
        """End it, whatever it does."""
        self.pipe.close()
        self.process.kill()
        self.process.join()

    def _received(self) -> bytes | None:
        try:
            results, refused, failed = self.pipe.recv()
        except (EOFError, OSError):
            return None
        if refused is not None:
            raise InputError(refused)
        if failed is not None:
            raise RuntimeError(f"in a worker process:\n{failed}")
        sent: bytes = results
        return sent


def process(target: Callable[..., None], *args: Any) -> tuple[BaseProcess, Connection]:
    """A process on its way, and our end of a pipe to it; target: called with the other end and the arguments.

    It ends with this one. Raises `InputError` where the system has none to give.
    """
    context = _context()
    ours, theirs = context.Pipe()
    made: BaseProcess = context.Process(target=target, args=(theirs, *args), daemon=True)
    try:
        with _one_thread(), _interrupts_held():
            made.start()
    except (EOFError, OSError) as error:  # an EOFError is that of the process to be copied, which is gone
        why = getattr(error, "strerror", None) or "the process that it would be a copy of ended"
        raise InputError(f"a worker process cannot start: {why}") from None
    theirs.close()
    return made, ours


def get_ready() -> None:
    """Let the process begin that workers are copies of; it reads the code while this one does something else."""
    if COPIED:
        _context()
        with _one_thread(), _interrupts_held():
            forkserver.ensure_running()


def _context() -> ForkServerContext | SpawnContext:
    if not COPIED:
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([_READ_FIRST, *_imported_by_main()])
    return context


def _imported_by_main() -> set[str]:
    """The modules of this package whose functions the main module uses: a worker imports the main module again."""
    package = __package__.partition(".")[0]
    owners = {
        str(getattr(value, "__module__", getattr(value, "__name__", "")))
        for value in vars(sys.modules["__main__"]).values()
    }
    return {name for name in owners if name.startswith(f"{package}.")}


def _work(pipe: Connection, study: Study, code: str) -> None:
    """The life of a worker: solve what comes until the pipe ends, as it does when the run is killed."""
    memory.keep()
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
