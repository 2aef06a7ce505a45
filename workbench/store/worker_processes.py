"""Worker processes on this machine: how they start, receive calls, and how their end is noticed.

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
from contextlib import contextmanager, suppress
from multiprocessing import forkserver, resource_tracker
from multiprocessing.connection import Connection
from multiprocessing.context import ForkServerContext, SpawnContext
from multiprocessing.process import BaseProcess
from typing import Any

from solver.problem.errors import InputError

# One thread each, as there is one worker a core.
ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
FORKED = sys.platform == "linux"  # elsewhere a fork of a process that has loaded NumPy is unsafe or impossible
PRELOAD = f"{__package__}.preload"  # the module that the server process imports


class Died(Exception):
    """A worker ended without an answer; its message says how."""


class Failed(Exception):
    """A call in a worker raised something else than an `InputError`. trace: where."""

    def __init__(self, message: str, trace: str) -> None:
        super().__init__(message)
        self.trace = trace


class Worker:
    """A process that makes one call at a time, so that it is known at which call it died.

    It ends with this process at the latest. Raises `InputError` where the system refuses to start it.
    """

    def __init__(self) -> None:
        context = _context()
        self.pipe, theirs = context.Pipe()
        self.process: BaseProcess = context.Process(target=_serve, args=(theirs,), daemon=True)
        try:
            with _as_workers():
                self.process.start()
        except (EOFError, ConnectionError):  # which of them depends on when it ended
            raise InputError("a worker process cannot start: the process from which it is forked has ended") from None
        except OSError as error:
            raise InputError(f"a worker process cannot start: {error.strerror or error}") from None
        theirs.close()

    def call(self, function: Callable[..., Any], *args: Any) -> None:
        """Send it a call, of a function of a module. Raises `OSError` where it died while idle."""
        self.pipe.send((function, args))

    def answer(self) -> Any:
        """Wait for the result of the call. Raises the `InputError` of the call, `Failed` or `Died`."""
        try:
            kind, *answer = self.pipe.recv()
        except (EOFError, OSError):
            raise Died(self._end_reason()) from None
        if kind == "refused":
            raise InputError(*answer)
        if kind == "failed":
            raise Failed(*answer)
        return answer[0]

    def stop(self) -> None:
        """Kill the process, whatever it is doing."""
        self.process.kill()
        self.process.join()
        self.pipe.close()

    def _end_reason(self) -> str:
        self.process.join()
        code = self.process.exitcode
        if code is not None and code < 0:
            return f"it was killed by {signal.Signals(-code).name}"
        return f"it ended with status {code}"


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


def _serve(pipe: Connection) -> None:
    """Make the calls that the pipe brings until it ends, as it does when the process that calls is killed."""
    keep_memory()
    with suppress(EOFError, OSError):
        while True:
            pipe.send(_answer_to(*pipe.recv()))


def _answer_to(function: Callable[..., Any], args: tuple[Any, ...]) -> tuple[Any, ...]:
    """The answer of a call and its kind, as `Worker.answer` reads it."""
    try:
        return "done", function(*args)
    except InputError as error:
        return "refused", str(error)
    except Exception as error:
        return "failed", f"{type(error).__name__}: {error}", traceback.format_exc()


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
