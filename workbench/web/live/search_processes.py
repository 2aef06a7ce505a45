"""Searches of the live page, each in a process of its own that is killed once the client has left.

A search is NumPy code that cannot be interrupted from outside, and its memory grows with what it finds; a process that
ends frees all of it. So no long search runs in the server itself.
"""

import asyncio
import contextlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection
from typing import Any

from solver.problem.errors import InputError

from ...store import worker_processes

AT_ONCE, WAITING = 2, 16  # searches that run, and that wait
MEMORY = 3 * 2**30  # bytes of address space of a search, its libraries included
INTERVAL = 0.1  # seconds between two checks whether the client is still connected

MANY = "too many searches are waiting; try again later"
NO_FLOAT = "these numbers are too large or too small to compute with"  # they are finite, but not their powers
TOO_LARGE = "this search needs more memory than the page allows; workbench equilibria has no such limit"


class Failed(Exception):
    """A search that ended without an answer; its message says how."""


class ClientLeft(Exception):
    """The client left before the answer was ready."""


class Tasks:
    """At most `AT_ONCE` processes at a time, and `WAITING` searches in a queue; further ones are refused."""

    def __init__(self) -> None:
        self._turn = asyncio.Semaphore(AT_ONCE)
        self._asked = 0
        self.running: set[Any] = set()

    async def run(self, wanted: Callable[[], bool], function: Callable[..., Any], *args: Any) -> Any:
        """The result of a function (of a module, as it is sent by name) for these arguments.

        wanted: whether the client is still connected. Raises `InputError` where the function does or the queue is full,
        `Failed` for its other errors, `ClientLeft` once the client has left.
        """
        if self._asked >= AT_ONCE + WAITING:
            raise InputError(MANY)
        with self._count():
            while self._turn.locked():
                await _pause(wanted)
            async with self._turn:
                return await self._process(wanted, function, args)

    @contextmanager
    def _count(self) -> Iterator[None]:
        self._asked += 1
        try:
            yield
        finally:
            self._asked -= 1

    async def _process(self, wanted: Callable[[], bool], function: Callable[..., Any], args: Any) -> Any:
        process, pipe = await asyncio.to_thread(worker_processes.process, _work, function, args)
        self.running.add(process)
        try:
            while not pipe.poll():
                await _pause(wanted, INTERVAL / 10)
            kind, answer = await asyncio.to_thread(_receive, pipe)
        finally:
            self.running.discard(process)
            process.kill()
            pipe.close()
            await asyncio.shield(asyncio.to_thread(process.join))
        if kind == "refused":
            raise InputError(answer)
        if kind == "failed":
            raise Failed(answer)
        return answer


async def _pause(wanted: Callable[[], bool], seconds: float = INTERVAL) -> None:
    if not wanted():
        raise ClientLeft
    await asyncio.sleep(seconds)


def _receive(pipe: Connection) -> tuple[str, Any]:
    try:
        kind, answer = pipe.recv()
    except (EOFError, OSError):
        return "failed", "its process ended"
    return kind, answer


def _work(pipe: Connection, function: Callable[..., Any], args: Any) -> None:
    """One call, and its result through the pipe."""
    _bound()
    try:
        answer = ("done", function(*args))
    except InputError as error:
        answer = ("refused", str(error))
    except ArithmeticError:
        answer = ("refused", NO_FLOAT)
    except MemoryError:
        answer = ("refused", TOO_LARGE)
    except Exception as error:
        answer = ("failed", f"{type(error).__name__}: {error}")
    with contextlib.suppress(OSError):
        pipe.send(answer)


def _bound() -> None:
    """Limit the memory to `MEMORY`, where the system supports that."""
    try:
        import resource
    except ImportError:
        return
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
