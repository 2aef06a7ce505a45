"""The server of the live page: a few routes on one address.

It keeps no session and takes no file name from the browser: the files that it serves are listed here, a request is a
state (plain data), and a download is written in a temporary folder.
"""

import asyncio
import gc
import json
import logging
import re
import secrets
import time
from collections import OrderedDict
from collections.abc import Awaitable, Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from struct import pack
from threading import Lock
from typing import Any

import numpy as np
from aiohttp import web

from solver.problem.errors import InputError

from ...store import worker_processes
from ...words import escaping
from ...words.escaping import finite
from . import live_document, page_model, page_shape, search_processes
from .presets import PRESETS, Preset

HEADERS = {"Content-Security-Policy": "default-src 'none'; frame-ancestors 'none'",
           "X-Content-Type-Options": "nosniff", "Cache-Control": "no-store", "Referrer-Policy": "no-referrer",
           "X-Frame-Options": "DENY"}  # fmt: skip
POLICY = re.compile(r'http-equiv="Content-Security-Policy" content="([^"]*)"')  # of the page, as a header too
LARGEST = 64 * 1024  # bytes of a request
DOWNLOADS = {"csv": "text/csv", "step": "model/step", "stl": "model/stl", "glb": "model/gltf-binary"}
REMEMBERED = 64  # solved rods that a slider may follow
THREADS = 2  # that solve and mesh; each has memory of its own
FAULT = "internal error of the workbench; see the terminal of the server"

Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]


class Shapes:
    """The last solved rods by ticket, as the page was given it with each; a rod that is not kept is solved again."""

    def __init__(self) -> None:
        self._kept: OrderedDict[str, page_shape.Shape] = OrderedDict()
        self._lock = Lock()

    def keep(self, one: page_shape.Shape) -> str:
        ticket = secrets.token_hex(8)
        with self._lock:
            self._kept[ticket] = one
            while len(self._kept) > REMEMBERED:
                self._kept.popitem(last=False)
        return ticket

    def find(self, ticket: Any) -> page_shape.Shape | None:
        with self._lock:
            return self._kept.get(ticket) if isinstance(ticket, str) else None


Report = Callable[[str], None]
log = logging.getLogger(__name__)


def application(names: set[str], presets: Sequence[Preset] = PRESETS, report: Report = log.error) -> web.Application:
    """The application.

    names: the `host:port` that it accepts in Host and Origin. presets: the rods to begin with; the first is drawn when
    the page is opened. report: called with one sentence on each error of the server.
    """
    shapes, few, tasks = Shapes(), ThreadPoolExecutor(THREADS, "shapes"), search_processes.Tasks()

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
    for path, work in (("/shape", _shape), ("/numbers", _numbers), ("/equilibria", _equilibria),
                       ("/branches", _branches), ("/download", _download)):  # fmt: skip
        app.router.add_post(path, _handler_of(work, shapes, few, tasks, report))
    return app


def warm() -> None:
    """Solve the first preset, so that everything is imported and compiled before the first request."""
    worker_processes.get_ready()
    page_shape.shape(page_model.study_of(PRESETS[0].state))
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
    """What a request needs.

    shapes: the rods that are kept. few: threads for work without a search. tasks: processes for searches. wanted:
    whether the client is still connected.
    """

    shapes: Shapes
    few: ThreadPoolExecutor
    tasks: search_processes.Tasks
    wanted: Callable[[], bool]

    async def in_thread(self, work: Callable[..., Any], *args: Any) -> Any:
        """The result of work of some milliseconds, in a thread."""
        return await asyncio.get_running_loop().run_in_executor(self.few, work, *args)

    async def search(self, work: Callable[..., Any], *args: Any) -> Any:
        """The result of work in a process, which is killed when the client leaves."""
        return await self.tasks.run(self.wanted, work, *args)

    async def shape(self, state: Any, near: page_shape.Shape | None = None) -> page_shape.Shape:
        """The rod of a state: followed from another or a start problem, else searched."""
        study = await self.in_thread(page_model.study_of, state)
        shape = await self.in_thread(page_shape.without_search, study, near.sol if near else None)
        if shape is None:
            lost = near is not None and near.sol.problem.kind == "ends"
            shape = await self.search(page_shape.search, study, lost)
        return shape

    async def again(self, asked: dict[str, Any]) -> page_shape.Shape:
        """The rod of a ticket; solved again where it is not kept."""
        return self.shapes.find(asked.get("ticket")) or await self.shape(asked.get("state"))


Work = Callable[[dict[str, Any], Context], Awaitable[web.Response]]


def _handler_of(
    work: Work, shapes: Shapes, few: ThreadPoolExecutor, tasks: search_processes.Tasks, report: Report
) -> Handler:
    """Answer a request's JSON; an `InputError` becomes an answer with its sentence and the field.

    Such a refusal has status 200: a browser writes every other status in its console as an error of the page.
    """

    async def handler(request: web.Request) -> web.StreamResponse:
        try:
            data = await request.json()
        except (ValueError, RecursionError):  # a number of 5000 digits is a ValueError too
            return _refusal("the request is not valid JSON", status=400)

        def is_wanted() -> bool:
            return request.transport is not None and not request.transport.is_closing()

        try:
            if not isinstance(data, dict):
                raise InputError("the request must be a table")
            return await work(data, Context(shapes, few, tasks, is_wanted))
        except ArithmeticError:  # a radius of 5e-324, say
            return _refusal(search_processes.NO_FLOAT)
        except InputError as error:
            return _refusal(str(error), page_model.field_of(str(error)))
        except search_processes.ClientLeft:
            return web.Response(status=499)  # nobody receives it
        except Exception as error:  # an error of ours: reported in the terminal, and as a sentence to the page
            report(escaping.line(f"{request.path} failed: {type(error).__name__}: {error}"))
            return _refusal(FAULT, status=500)

    return handler


def _refusal(sentence: str, field: str = "", status: int = 200) -> web.Response:
    return web.json_response({"refused": sentence, "field": field}, status=status)


async def _shape(asked: dict[str, Any], at: Context) -> web.Response:
    """The rod at its stations, and what is known of it."""
    start = time.perf_counter()
    rod = await at.shape(asked.get("state"), at.shapes.find(asked.get("near")))
    body = await at.in_thread(_tell, rod, at.shapes, time.perf_counter() - start)
    return web.Response(body=body, content_type="application/octet-stream")


def _tell(rod: page_shape.Shape, shapes: Shapes, solving: float) -> bytes:
    head = {
        **page_model.facts(rod), "ticket": shapes.keep(page_shape.bare(rod)), "problem": rod.sol.problem.kind,
        "seconds": {"solve": solving},
    }  # fmt: skip
    return pack_arrays(head, page_model.stations(rod))


def pack_arrays(head: dict[str, Any], arrays: dict[str, Any]) -> bytes:
    """The length of the JSON (4 bytes), the head as JSON, the arrays.

    Each begins at a multiple of 8 bytes; the head lists of each array its name, type, size and first byte after the
    JSON.
    """
    listed, parts, at = [], [], 0
    for name, array in arrays.items():
        data = np.ascontiguousarray(array).tobytes()
        listed.append([name, array.dtype.str[1:], array.size, at])
        parts.append(data + b"\0" * (-len(data) % 8))
        at += len(parts[-1])
    text = json.dumps({**finite(head), "arrays": listed}).encode()
    text += b" " * (-(4 + len(text)) % 8)
    return b"".join([pack("<I", len(text)), text, *parts])


async def _numbers(asked: dict[str, Any], at: Context) -> web.Response:
    return web.json_response(finite(await at.in_thread(page_model.numbers, await at.again(asked))))


async def _equilibria(asked: dict[str, Any], at: Context) -> web.Response:
    study = await at.in_thread(page_model.study_of, asked.get("state"))
    return web.json_response(finite({"rows": await at.search(page_model.list_equilibria, study)}))


async def _branches(asked: dict[str, Any], at: Context) -> web.Response:
    study = await at.in_thread(page_model.study_of, asked.get("state"))
    field, ends = asked.get("field"), (asked.get("low"), asked.get("high"))
    if not all(isinstance(end, (int, float)) and np.isfinite(end) for end in ends):
        raise InputError("the range of a branch diagram must be two numbers")
    return web.json_response(finite(await at.search(page_model.follow_branches, study, str(field), *ends)))


async def _download(asked: dict[str, Any], at: Context) -> web.Response:
    kind = asked.get("kind")
    if not isinstance(kind, str) or kind not in DOWNLOADS:
        raise InputError(f"no download {str(kind)[:40]!r}; choose from {', '.join(DOWNLOADS)}")
    rod = page_shape.portable(await at.again(asked))
    return web.Response(body=await at.search(page_model.file, rod, kind), content_type=DOWNLOADS[kind])
