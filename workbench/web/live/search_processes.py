"""Searches of the live page, each in a process of its own that is killed when nobody waits for its answer any more.

A search is NumPy code that nothing can interrupt from outside, and takes memory in proportion to what it finds; a
process gives all of it back. What may take long therefore never runs in the server itself.
"""

import asyncio
import contextlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection
from typing import Any

from solver.problem.errors import InputError

from ...run import worker_processes

AT_ONCE, WAITING = 2, 16  # searches that run, and that wait for their turn
MEMORY = 3 * 2**30  # bytes of addresses that a search may take, those of its libraries among them
LOOK = 0.1  # seconds between two looks at whether the client is still there

MANY = "too many searches wait already; ask again in a while"
NO_FLOAT = "numbers as large or as small as these cannot be computed with"  # finite when asked, but not their powers
TOO_LARGE = "this search takes more memory than the page gives it: workbench equilibria has no such bound"


class Failed(Exception):
    """A search that ended otherwise than with an answer or a refusal; says how."""


class Gone(Exception):
    """The client left before the answer was there."""


class Tasks:
    """At most `AT_ONCE` processes at a time; who comes beyond `WAITING` more is refused."""

    def __init__(self) -> None:
        self._turn = asyncio.Semaphore(AT_ONCE)
        self._asked = 0
        self.running: set[Any] = set()

    async def run(self, wanted: Callable[[], bool], function: Callable[..., Any], *args: Any) -> Any:
        """What the function (of a module, as it is sent by name) returns for these arguments.

        wanted: whether somebody still waits for it. Raises `InputError` for what the function refuses and where there
        are too many, `Failed` for what else it raises, `Gone` once nobody waits.
        """
        if self._asked >= AT_ONCE + WAITING:
            raise InputError(MANY)
        with self._counted():
            while self._turn.locked():
                await _pause(wanted)
            async with self._turn:
                return await self._process(wanted, function, args)

    @contextmanager
    def _counted(self) -> Iterator[None]:
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
                await _pause(wanted, LOOK / 10)
            kind, answer = await asyncio.to_thread(_received, pipe)
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


async def _pause(wanted: Callable[[], bool], seconds: float = LOOK) -> None:
    if not wanted():
        raise Gone
    await asyncio.sleep(seconds)


def _received(pipe: Connection) -> tuple[str, Any]:
    try:
        kind, answer = pipe.recv()
    except (EOFError, OSError):
        return "failed", "its process ended"
    return kind, answer


def _work(pipe: Connection, function: Callable[..., Any], args: Any) -> None:
    """The life of a process: one call."""
    _bound()
    try:
        told = ("done", function(*args))
    except InputError as error:
        told = ("refused", str(error))
    except ArithmeticError:
        told = ("refused", NO_FLOAT)
    except MemoryError:
        told = ("refused", TOO_LARGE)
    except Exception as error:
        told = ("failed", f"{type(error).__name__}: {error}")
    with contextlib.suppress(OSError):
        pipe.send(told)


def _bound() -> None:
    """Take no more memory than `MEMORY`, where the system can be told so."""
    try:
        import resource
    except ImportError:
        return
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
