"""The server of the live page: a few routes on one address.

It keeps no session and takes no file name from the browser: the files that it serves are listed here, a request is a
state (plain data), and a download is written in a temporary folder.

A search is NumPy code that cannot be interrupted from outside, and its memory grows with what it finds. So each runs in
a process of its own, which frees all of it at its end, and is killed once the client has left.
"""

import asyncio
import gc
import json
import logging
import re
from collections import Counter, OrderedDict
from collections.abc import Awaitable, Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from aiohttp import web

from solver.problem.errors import InputError

from ...run import worker_processes
from ...run.worker_processes import Worker
from ...words import escaping
from ...words.escaping import finite
from . import live_document, page_model
from .presets import PRESETS, Preset

HEADERS = {
    "Content-Security-Policy": "default-src 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Cache-Control": "no-store",
    "Referrer-Policy": "no-referrer",
    "X-Frame-Options": "DENY",
}
POLICY = re.compile(r'http-equiv="Content-Security-Policy" content="([^"]*)"')  # of the page, as a header too
LARGEST = 64 * 1024  # bytes of a request
DOWNLOADS = {"csv": "text/csv", "step": "model/step", "stl": "model/stl", "glb": "model/gltf-binary"}
REMEMBERED = 16  # solved rods
THREADS = 2  # that solve and mesh; each has memory of its own
FAULT = "internal error of the workbench; see the terminal of the server"
AT_ONCE = 2  # searches that run; one more is started of a client of whom none runs
SHARE, MOST = 8, 64  # searches that run or wait, of one client and of all
MEMORY = 3 * 2**30  # bytes of address space of a search, its libraries included

MANY = "too many searches are waiting; try again later"
NO_FLOAT = "these numbers are too large or too small to compute with"  # they are finite, but not their powers
TOO_LARGE = "this search needs more memory than the page allows; workbench equilibria has no such limit"

Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]


class Tasks:
    """Searches in processes, a share for each client: what one asks for never keeps another from its first search.

    A client is an address and the page that is open there. Of one client at most `SHARE` searches run or wait, of all
    `MOST`; further ones are refused. `AT_ONCE` run at a time, and one more of a client of whom none runs.
    """

    def __init__(self) -> None:
        self._running, self._waiting = Counter[str](), list[tuple[str, asyncio.Future[None]]]()

    async def run(self, client: str, function: Callable[..., Any], *args: Any) -> Any:
        """The result of a function (of a module, as it is sent by name) for these arguments.

        Raises `InputError` where the function does or the queue is full, `Failed` or `Died` for its other ends. Where
        the client leaves, aiohttp cancels the request, and the process is killed.
        """
        clients = [*self._running.elements(), *(each for each, _ in self._waiting)]
        if clients.count(client) >= SHARE or len(clients) >= MOST:
            raise InputError(MANY)
        await self._turn(client)
        try:
            worker = await asyncio.to_thread(Worker)
            try:
                worker.call(_search, function, args)
                return await asyncio.to_thread(worker.answer)
            finally:
                await asyncio.shield(asyncio.to_thread(worker.stop))
        finally:
            self._end(client)

    async def _turn(self, client: str) -> None:
        """Wait until a search of a client may run, which then counts as running."""
        turn = asyncio.get_running_loop().create_future()
        self._waiting.append((client, turn))
        self._start()
        try:
            await turn
        except asyncio.CancelledError:
            if (client, turn) in self._waiting:
                self._waiting.remove((client, turn))
            else:
                self._end(client)
            raise

    def _end(self, client: str) -> None:
        """Let those run that may, now that a search of a client has ended."""
        self._running[client] -= 1
        self._running += Counter()  # without those of whom none runs
        self._start()

    def _start(self) -> None:
        """Let the searches that wait run, the first of them first, as far as they may."""
        for client, turn in [*self._waiting]:
            if self._running.total() < AT_ONCE + (client not in self._running):
                self._waiting.remove((client, turn))
                self._running[client] += 1
                if not turn.done():
                    turn.set_result(None)


def _search(function: Callable[..., Any], args: Any) -> Any:
    """The result of a call whose memory is limited. Raises `InputError` for numbers and memory beyond the limits."""
    _bound()
    try:
        return function(*args)
    except ArithmeticError:
        raise InputError(NO_FLOAT) from None
    except MemoryError:
        raise InputError(TOO_LARGE) from None


def _bound() -> None:
    """Limit the memory to `MEMORY`, where the system supports that."""
    try:
        import resource
    except ImportError:
        return
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))


class LiveRods:
    """The last solved rods; a rod that is not kept is solved again.

    Each is kept by what was asked; one that may leave the cylinder by its client, as it continues from that before.
    """

    def __init__(self) -> None:
        self._kept: OrderedDict[str, page_model.LiveRod] = OrderedDict()

    def keep(self, by: str, one: page_model.LiveRod) -> None:
        self._kept[by] = one
        while len(self._kept) > REMEMBERED:
            self._kept.popitem(last=False)

    def find(self, by: str) -> page_model.LiveRod | None:
        return self._kept.get(by)


Report = Callable[[str], None]
log = logging.getLogger(__name__)


def application(names: set[str], presets: Sequence[Preset] = PRESETS, report: Report = log.error) -> web.Application:
    """The application.

    names: the `host:port` that it accepts in Host and Origin. presets: the rods to begin with; the first is drawn when
    the page is opened. report: called with one sentence on each error of the server.
    """
    context = Context(LiveRods(), ThreadPoolExecutor(THREADS, "shapes"), Tasks())

    @web.middleware
    async def guard(request: web.Request, handler: Handler) -> web.StreamResponse:
        origin = request.headers.get("Origin")
        if request.host not in names:
            raise web.HTTPForbidden(text=f"this page is served at {', '.join(sorted(names))} only")
        if origin is not None and origin.partition("://")[2] not in names:
            raise web.HTTPForbidden(text="requests from pages of other sites are refused")
        if request.method == "POST" and request.content_type != "application/json":
            raise web.HTTPUnsupportedMediaType(text="a request must be JSON")
        response = await handler(request)
        for name, value in HEADERS.items():
            response.headers.setdefault(name, value)
        return response

    app = web.Application(middlewares=[guard], client_max_size=LARGEST)
    app.router.add_get("/", _page(live_document.text(presets, served=True)))
    for path, work in (
        ("/shape", _shape),
        ("/numbers", _numbers),
        ("/equilibria", _equilibria),
        ("/branches", _branches),
        ("/download", _download),
    ):
        app.router.add_post(path, _handler_of(work, context, report))
    return app


def warm() -> None:
    """Solve the first preset, so that everything is imported and compiled before the first request."""
    worker_processes.get_ready(page_model.__name__)
    page_model.shape(page_model.study_of(PRESETS[0].state))
    gc.freeze()  # what is loaded stays: the collector need not scan it while a slider moves


def _page(text: str) -> Handler:
    """Answers with the page."""
    policy = POLICY.search(text)
    assert policy is not None
    headers = {"Content-Security-Policy": f"{policy[1]}; frame-ancestors 'none'"}

    async def handler(request: web.Request) -> web.StreamResponse:
        return web.Response(text=text, content_type="text/html", headers=headers)

    return handler


@dataclass(frozen=True)
class Context:
    """What requests need.

    shapes: the rods that are kept. few: threads for work without a search. tasks: processes for searches. client: who
    asks.
    """

    shapes: LiveRods
    few: ThreadPoolExecutor
    tasks: Tasks
    client: str = ""

    async def in_thread(self, work: Callable[..., Any], *args: Any) -> Any:
        """The result of work of some milliseconds, in a thread."""
        return await asyncio.get_running_loop().run_in_executor(self.few, work, *args)

    async def search(self, work: Callable[..., Any], *args: Any) -> Any:
        """The result of work in a process, which is killed when the client leaves."""
        return await self.tasks.run(self.client, work, *args)

    async def shape(self, asked: dict[str, Any]) -> page_model.LiveRod:
        """The rod of the state that a request has.

        Only `/shape` sends `lost`, as of `page_model.shape`, and asks for a new rod; other requests mean the one that
        the client sees, which is kept by its client if it may leave the cylinder.
        """
        state, lost = asked.get("state"), bool(asked.get("lost"))
        key = json.dumps([state, lost], sort_keys=True)
        shape = self.shapes.find(key)
        if shape is None:
            study = await self.in_thread(page_model.study_of, state)
            before = self.shapes.find(self.client)
            if before is not None and "lost" not in asked and before.study == study:
                return before
            solve = self.search if await self.in_thread(page_model.is_searched, study) else self.in_thread
            shape = await solve(page_model.shape, study, lost, before if lost and study.leaves else None)
            self.shapes.keep(self.client if study.leaves else key, shape)
        return shape


Work = Callable[[dict[str, Any], Context], Awaitable[Any]]  # to plain data, or to a response


def _handler_of(work: Work, context: Context, report: Report) -> Handler:
    """Answer a request's JSON; an `InputError` becomes an answer with its sentence and the field.

    Such a refusal has status 200: a browser writes every other status in its console as an error of the page.
    """

    async def handler(request: web.Request) -> web.StreamResponse:
        try:
            data = json.loads(await request.read())  # in UTF-8, whatever charset the request claims
        except (ValueError, RecursionError):  # a number of 5000 digits is a ValueError too
            return _refusal("the request is not valid JSON", status=400)
        try:
            if not isinstance(data, dict):
                raise InputError("the request must be a table")
            client = f"{request.remote} {request.headers.get('X-Page', '')[:40]}"  # the page: the number that it took
            answer = await work(data, replace(context, client=client))
            return answer if isinstance(answer, web.StreamResponse) else web.json_response(finite(answer))
        except ArithmeticError:  # a radius of 5e-324, say
            return _refusal(NO_FLOAT)
        except InputError as error:
            return _refusal(str(error), page_model.field_of(str(error)))
        except Exception as error:  # an error of ours: reported in the terminal, and as a sentence to the page
            report(escaping.line(f"{request.path} failed: {type(error).__name__}: {error}"))
            return _refusal(FAULT, status=500)

    return handler


def _refusal(sentence: str, field: str = "", status: int = 200) -> web.Response:
    return web.json_response({"refused": sentence, "field": field}, status=status)


async def _shape(asked: dict[str, Any], at: Context) -> Any:
    """The rod at its stations, and what is known of it."""
    return await at.in_thread(page_model.answer, await at.shape(asked))


async def _numbers(asked: dict[str, Any], at: Context) -> Any:
    return await at.in_thread(page_model.numbers, await at.shape(asked))


async def _equilibria(asked: dict[str, Any], at: Context) -> Any:
    study = await at.in_thread(page_model.study_of, asked.get("state"))
    return {"rows": await at.search(page_model.list_equilibria, study)}


async def _branches(asked: dict[str, Any], at: Context) -> Any:
    study = await at.in_thread(page_model.study_of, asked.get("state"))
    field, ends = asked.get("field"), (asked.get("low"), asked.get("high"))
    if not all(isinstance(end, (int, float)) and np.isfinite(end) for end in ends):
        raise InputError("the range of a branch diagram must be two numbers")
    return await at.search(page_model.follow_branches, study, str(field), *ends)


async def _download(asked: dict[str, Any], at: Context) -> Any:
    kind = asked.get("kind")
    if not isinstance(kind, str) or kind not in DOWNLOADS:
        raise InputError(f"no download {str(kind)[:40]!r}; choose from {', '.join(DOWNLOADS)}")
    rod = await at.shape(asked)
    return web.Response(body=await at.search(page_model.file, rod, kind), content_type=DOWNLOADS[kind])
