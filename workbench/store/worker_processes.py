"""Worker processes on this machine: how they start, receive chunks, and how their end is noticed.

On Linux they are forked from one server process that has imported all code once, so that another starts in
milliseconds; a fork of this process itself would share its threads and locks. Each has a pipe of its own: where one is
killed, at whatever moment, the pipe ends and no other worker waits for it.
"""

import ctypes
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

from .block import Chunk, solve_chunk
from .recipe import check_worker, code_version

# One thread each, as there is one worker a core.
ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
FORKED = sys.platform == "linux"  # elsewhere a fork of a process that has loaded NumPy is unsafe or impossible
PRELOAD = f"{__package__}.preload"  # the module that the server process imports


class Worker:
    """A worker process and the chunk that it solves; one at a time, so that it is known at which chunk it died."""

    def __init__(self, study: Study) -> None:
        self.study = study
        self.chunk: Chunk | None = None
        self._start()

    def _start(self) -> None:
        """Start the process; `check` waits for it. Raises `InputError` where the system refuses."""
        self.process, self.pipe = process(_work, self.study, code_version())

    def check(self) -> None:
        """Wait until it is ready. Raises `InputError` where it ends before."""
        if self._receive() is None:
            raise InputError(f"a worker process cannot start: {self.end_reason()}")

    def give(self, chunk: Chunk, block: int) -> None:
        """Send it a chunk; where it died while idle, it is replaced first."""
        try:
            self.pipe.send((chunk, block))
        except OSError:
            self.replace()
            self.pipe.send((chunk, block))
        self.chunk = chunk

    def take(self) -> tuple[Chunk, bytes | None]:
        """Its chunk and the packed results, None where it died. Raises what it raised."""
        chunk, self.chunk = self.chunk, None
        assert chunk is not None
        return chunk, self._receive()

    def end_reason(self) -> str:
        """How a process that died ended, in words."""
        self.process.join()
        code = self.process.exitcode
        if code is not None and code < 0:
            return f"it was killed by {signal.Signals(-code).name}"
        return f"it ended with status {code}"

    def replace(self) -> None:
        """Start another process in its place."""
        self.stop()
        self._start()
        self.check()

    def stop(self) -> None:
        """Kill the process, whatever it is doing."""
        self.pipe.close()
        self.process.kill()
        self.process.join()

    def _receive(self) -> bytes | None:
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
    """Start a process that calls `target` with one end of a pipe and the arguments; return it and our end.

    The process ends with this one at the latest. Raises `InputError` where the system refuses to start it.
    """
    context = _context()
    ours, theirs = context.Pipe()
    child: BaseProcess = context.Process(target=target, args=(theirs, *args), daemon=True)
    try:
        with _as_workers():
            child.start()
    except (EOFError, ConnectionError):  # which of them depends on when it ended
        raise InputError("a worker process cannot start: the process from which it is forked has ended") from None
    except OSError as error:
        raise InputError(f"a worker process cannot start: {error.strerror or error}") from None
    theirs.close()
    return child, ours


def get_ready(*modules: str) -> None:
    """Start the server process from which workers are forked; it imports the code while this process goes on.

    modules: that it imports too, by their names.
    """
    if FORKED:
        _context(*modules)
        with _as_workers():
            forkserver.ensure_running()


def _context(*modules: str) -> ForkServerContext | SpawnContext:
    if not FORKED:
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([PRELOAD, *modules, *_modules_of_main()])
    return context


def _modules_of_main() -> set[str]:
    """The modules of this package that the main module uses: each worker imports the main module again."""
    package = __package__.partition(".")[0]
    owners = {
        str(getattr(value, "__module__", getattr(value, "__name__", "")))
        for value in vars(sys.modules["__main__"]).values()
    }
    return {name for name in owners if name.startswith(f"{package}.")}


def _work(pipe: Connection, study: Study, code: str) -> None:
    """Solve what the pipe brings until it ends, as it does when the run is killed."""
    keep_memory()
    try:
        check_worker(study, code)
        pipe.send((b"", None, None))
        while True:
            chunk, block = pipe.recv()
            pipe.send((solve_chunk(study, chunk, block), None, None))
    except (EOFError, OSError):
        return
    except InputError as error:
        pipe.send((None, str(error), None))
    except Exception:
        pipe.send((None, None, traceback.format_exc()))


@contextmanager
def _as_workers() -> Iterator[None]:
    """Processes started in the body use one thread each, unless the environment says otherwise, and ignore Ctrl-C.

    A terminal sends that to all: their run ends them.
    """
    ours = [name for name in ONE_THREAD if name not in os.environ]
    os.environ.update(dict.fromkeys(ours, "1"))
    before = None
    if hasattr(signal, "pthread_sigmask"):
        resource_tracker.ensure_running()  # its own start would unblock the signal
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        if before is not None:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
        for name in ours:
            del os.environ[name]


# Of malloc.h. The sizes are the largest that glibc itself would choose after such arrays were freed.
_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3
_KEPT, _LARGEST = 64 * 2**20, 32 * 2**20


def keep_memory() -> None:
    """Keep up to 64 MB of freed memory in this process, where the C library (glibc) has that setting.

    Otherwise the system provides each temporary array of a block page by page, which costs a sixth of the time; Dask
    starts its workers with that setting off. The setting holds for the whole process, so it is for our own only.
    """
    if sys.platform != "linux":
        return
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(_MMAP_THRESHOLD, _LARGEST)
        mallopt(_TRIM_THRESHOLD, _KEPT)
