"""Worker processes on this machine: how they start, receive calls, and how their end is noticed; a pool of them.

On Linux they are forked from one server process that has imported all code once, so that another starts in
milliseconds; a fork of this process itself would share its threads and locks. Each has a pipe of its own: where one is
killed, at whatever moment, the pipe ends and no other worker waits for it.
"""

import itertools
import multiprocessing
import os
import signal
import sys
import traceback
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from multiprocessing import forkserver, resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.context import ForkServerContext, SpawnContext
from multiprocessing.process import BaseProcess
from typing import Any

from solver.problem.errors import InputError

from .block import Chunk, keep_memory, solve_chunk
from .plan import Plan
from .recipe import check_worker, code_version

# One thread each, as there is one worker a core.
ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
FORKED = sys.platform == "linux"  # elsewhere a fork of a process that has loaded NumPy is unsafe or impossible
PRELOAD = f"{__package__}.preload"  # the module that the server process imports

Answer = tuple[int, bytes] | str  # how many cases of a chunk are solved and their results; or the outcome of all
Results = Iterator[tuple[Chunk, bytes | str]]  # cases with their packed results, or the outcome of them

DEATHS = 2  # of workers at one block, after which it is given up
KILLED = "failed: the process that solved it ended twice without an answer"


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


def hand_out(
    work: Plan,
    chunks: Iterable[Chunk],
    room: Callable[[], int],
    give: Callable[[Chunk], None],
    take: Callable[[], tuple[Chunk, Answer]],
) -> Results:
    """Give chunks to workers as far as there is room, and yield the results.

    What a worker leaves of a chunk (`solve_chunk`) is given to the next that has room. A chunk at which a worker died
    is solved again at the end, one block at a time; a block at which a second one dies is given up. take: waits for a
    chunk, and returns it with its answer.
    """
    waiting, rests, suspects, under_way = iter(chunks), deque[Chunk](), deque[Chunk](), 0
    done: tuple[Chunk, bytes | str] | None = None

    def next_chunk() -> Chunk | None:
        return rests.popleft() if rests else next(waiting, None)

    while True:
        for chunk in itertools.islice(iter(next_chunk, None), max(0, room())):
            give(chunk)
            under_way += 1
        if suspects and not under_way:
            give(suspects.popleft())
            under_way = 1
        if done is not None:
            yield done  # after others were given, as storing takes time
        if not under_way:
            return
        chunk, answer = take()
        under_way -= 1
        if not isinstance(answer, str):
            cases, content = answer
            solved, rest = chunk.cut(cases)
            done = solved, content
            if rest.cases:
                rests.append(rest)
        elif chunk.deaths + 1 < DEATHS:
            suspects.extend(chunk.blocks(work.block, chunk.deaths + 1))
            done = None
        else:
            done = chunk, answer


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

    def take() -> tuple[Chunk, Answer]:
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
        yield from hand_out(work, chunks, lambda: len(started) - len(busy), give, take)
    finally:
        for worker in started:
            worker.stop()


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
