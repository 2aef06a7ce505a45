"""The server of the live page: a few routes on one address.

It keeps no session and takes no file name from the browser: the files that it serves are listed here, a request is a
state (plain data), and a download is written in a temporary folder.
"""

import asyncio
import gc
import json
import logging
import secrets
import time
from collections import OrderedDict
from collections.abc import Awaitable, Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path
from struct import pack
from threading import Lock
from typing import Any

import numpy as np
from aiohttp import web

from solver.problem.errors import InputError
from studies.readings import READINGS

from ...data import escaping
from ...data.escaping import finite
from ...run import worker_processes
from .. import browser_assets
from . import mesh, page_model, page_shape, search_processes
from .presets import PRESETS, Preset

PAGE = Path(__file__).parent / "page"
FILES = {
    "/": PAGE / "index.html",
    "/page.js": PAGE / "page.js",
    "/diagram.js": PAGE / "diagram.js",
    "/page.css": PAGE / "page.css",
    **{f"/{name}": path for name, path in browser_assets.scripts().items()},
}
# Vue compiles its templates in the page, hence unsafe-eval. No other address is contacted, and no other page may hold
# this one in a frame.
POLICY = (
    "default-src 'none'; script-src 'self' 'unsafe-eval'; style-src 'self'; img-src 'self' data: blob:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
HEADERS = {"Content-Security-Policy": POLICY, "X-Content-Type-Options": "nosniff", "Cache-Control": "no-store",
           "Referrer-Policy": "no-referrer", "X-Frame-Options": "DENY"}  # fmt: skip
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
    async def guarded(request: web.Request, handler: Handler) -> web.StreamResponse:
        origin = request.headers.get("Origin")
        if request.host not in names:
            raise web.HTTPForbidden(text=f"this page is served at {', '.join(sorted(names))} only")
        if origin is not None and origin.partition("://")[2] not in names:
            raise web.HTTPForbidden(text="requests from pages of other sites are refused")
        if request.method == "POST" and request.content_type != "application/json":
            raise web.HTTPUnsupportedMediaType(text="a request must be JSON")
        response = await handler(request)
        response.headers.update(HEADERS)
        return response

    app = web.Application(middlewares=[guarded], client_max_size=LARGEST)
    for path in FILES:
        app.router.add_get(path, _file)
    app.router.add_get("/presets", _offering(presets))
    for path, work in (("/shape", _shape), ("/numbers", _numbers), ("/equilibria", _equilibria), ("/ends", _ends),
                       ("/study", _study), ("/download", _download)):  # fmt: skip
        app.router.add_post(path, _answering(work, shapes, few, tasks, report))
    return app


def warm() -> None:
    """Solve the first preset, so that everything is imported and compiled before the first request."""
    worker_processes.get_ready()
    page_shape.shape(page_model.study_of(PRESETS[0].state))
    gc.freeze()  # what is loaded stays: the collector need not scan it while a slider moves


async def _file(request: web.Request) -> web.StreamResponse:
    return web.FileResponse(FILES[request.path])


def _offering(presets: Sequence[Preset]) -> Handler:
    """Answers with the rods to begin with and the readings of Table 1."""

    async def handler(request: web.Request) -> web.StreamResponse:
        return web.json_response({"presets": [asdict(preset) for preset in presets], "readings": list(READINGS)})

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
        found = await self.in_thread(page_shape.without_search, study, near.sol if near else None)
        if found is None:
            lost = near is not None and near.sol.problem.kind == "ends"
            found = await self.search(page_shape.searched, study, lost)
        return found

    async def again(self, asked: dict[str, Any]) -> page_shape.Shape:
        """The rod of a ticket; solved again where it is not kept."""
        return self.shapes.find(asked.get("ticket")) or await self.shape(asked.get("state"))


Work = Callable[[dict[str, Any], Context], Awaitable[web.Response]]


def _answering(
    work: Work, shapes: Shapes, few: ThreadPoolExecutor, tasks: search_processes.Tasks, report: Report
) -> Handler:
    """Answer a request's JSON; an `InputError` becomes status 422 with a sentence and the field."""

    async def handler(request: web.Request) -> web.StreamResponse:
        try:
            asked = await request.json()
        except (ValueError, RecursionError):  # a number of 5000 digits is a ValueError too
            return web.json_response({"sentence": "the request is not valid JSON", "field": ""}, status=400)

        def wanted() -> bool:
            return request.transport is not None and not request.transport.is_closing()

        try:
            if not isinstance(asked, dict):
                raise InputError("the request must be a table")
            return await work(asked, Context(shapes, few, tasks, wanted))
        except ArithmeticError:  # a radius of 5e-324, say
            return web.json_response({"sentence": search_processes.NO_FLOAT, "field": ""}, status=422)
        except InputError as error:
            refusal = {"sentence": str(error), "field": page_model.field_of(str(error))}
            return web.json_response(refusal, status=422)
        except search_processes.ClientLeft:
            return web.Response(status=499)  # nobody receives it
        except Exception as error:  # an error of ours: reported in the terminal, and as a sentence to the page
            report(escaping.line(f"{request.path} failed: {type(error).__name__}: {error}"))
            return web.json_response({"sentence": FAULT, "field": ""}, status=500)

    return handler


async def _shape(asked: dict[str, Any], at: Context) -> web.Response:
    """The rod's mesh and curves, with the seconds that solving and meshing took; polygons only where they are new."""
    start = time.perf_counter()
    one = await at.shape(asked.get("state"), at.shapes.find(asked.get("near")))
    body = await at.in_thread(_drawn, asked, one, at.shapes, time.perf_counter() - start)
    return web.Response(body=body, content_type="application/octet-stream")


def _drawn(asked: dict[str, Any], one: page_shape.Shape, shapes: Shapes, solving: float) -> bytes:
    begun = time.perf_counter()
    with np.errstate(over="raise"):  # numbers beyond single precision are an error, not drawn
        rod = mesh.rod(one.sol)
        wall = mesh.cylinder(one.sol, rod.squeeze)
        meshing = time.perf_counter() - begun
        lines = {name: np.asarray(values, dtype=np.float32) for name, values in page_model.curves(one).items()}
    arrays: dict[str, Any] = {}
    for name, drawn in (("rod", rod), ("wall", wall)):
        arrays |= {f"{name}.points": drawn.points, f"{name}.normals": drawn.normals, f"{name}.colours": drawn.colours}
        if asked.get(f"{name}_has") != drawn.key:
            arrays[f"{name}.polygons"] = drawn.polygons
            if drawn.coarse is not None:
                arrays[f"{name}.coarse"] = drawn.coarse
    head = {
        **page_model.facts(one), "squeeze": rod.squeeze, "rod_key": rod.key, "wall_key": wall.key,
        "ticket": shapes.keep(page_shape.bare(one)), "fields": page_model.fields(one.study),
        "side": one.sol.case.cylinder.side, "problem": one.sol.problem.kind,
        "seconds": {"solve": solving, "mesh": meshing},
    }  # fmt: skip
    return packed(head, arrays | lines)


def packed(head: dict[str, Any], arrays: dict[str, Any]) -> bytes:
    """The length of the JSON (4 bytes), the head as JSON, the arrays.

    Each begins at a multiple of 4 bytes; the head lists of each array its name, type, size and first byte after the
    JSON.
    """
    listed, parts, at = [], [], 0
    for name, array in arrays.items():
        data = np.ascontiguousarray(array).tobytes()
        listed.append([name, array.dtype.str[1:], array.size, at])
        parts.append(data + b"\0" * (-len(data) % 4))
        at += len(parts[-1])
    text = json.dumps({**finite(head), "arrays": listed}).encode()
    text += b" " * (-len(text) % 4)
    return b"".join([pack("<I", len(text)), text, *parts])


async def _numbers(asked: dict[str, Any], at: Context) -> web.Response:
    return web.json_response(finite(await at.in_thread(page_model.numbers, await at.again(asked))))


async def _equilibria(asked: dict[str, Any], at: Context) -> web.Response:
    study = await at.in_thread(page_model.study_of, asked.get("state"))
    return web.json_response(finite({"rows": await at.search(page_model.list_equilibria, study)}))


async def _ends(asked: dict[str, Any], at: Context) -> web.Response:
    study = await at.in_thread(page_model.study_of, asked.get("state"))
    return web.json_response(await at.search(page_model.ends_state, study))


async def _study(asked: dict[str, Any], at: Context) -> web.Response:
    study = await at.in_thread(page_model.study_of, asked.get("state"))
    return web.json_response({"text": await at.in_thread(page_model.text, study)})


async def _download(asked: dict[str, Any], at: Context) -> web.Response:
    kind = asked.get("kind")
    if not isinstance(kind, str) or kind not in DOWNLOADS:
        raise InputError(f"no download {str(kind)[:40]!r}; choose from {', '.join(DOWNLOADS)}")
    one = page_shape.portable(await at.again(asked))
    return web.Response(body=await at.search(page_model.file, one, kind), content_type=DOWNLOADS[kind])
