"""The live page's server: a few routes on one address.

It keeps no session, and takes no path or name of a file from the browser: what is served is listed here, what is asked
is a state (plain data), what is downloaded is made in a folder of its own.
"""

import asyncio
import gc
import json
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

from ...commands import console
from ...commands.console import finite
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
# Vue compiles its templates in the page, hence unsafe-eval. Nothing comes from, or goes to, another address, and no
# other page frames this one.
POLICY = (
    "default-src 'none'; script-src 'self' 'unsafe-eval'; style-src 'self'; img-src 'self' data: blob:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
HEADERS = {"Content-Security-Policy": POLICY, "X-Content-Type-Options": "nosniff", "Cache-Control": "no-store",
           "Referrer-Policy": "no-referrer", "X-Frame-Options": "DENY"}  # fmt: skip
LARGEST = 64 * 1024  # bytes of a request
DOWNLOADS = {"csv": "text/csv", "step": "model/step", "stl": "model/stl", "glb": "model/gltf-binary"}
REMEMBERED = 64  # shapes that a slider may follow
THREADS = 2  # that solve and mesh; each keeps memory of its own
FAULT = "the server failed at this, which is a fault of the workbench; its terminal says more"

Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]


class Shapes:
    """The last shapes, by the ticket that the page was given with each; a lost one costs only time."""

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


def application(names: set[str], presets: Sequence[Preset] = PRESETS) -> web.Application:
    """The application.

    names: the `host:port` by which it may be asked, in Host and Origin. presets: the rods to begin with, first the one
    that is drawn when the page is opened.
    """
    shapes, few, tasks = Shapes(), ThreadPoolExecutor(THREADS, "shapes"), search_processes.Tasks()

    @web.middleware
    async def guarded(request: web.Request, handler: Handler) -> web.StreamResponse:
        origin = request.headers.get("Origin")
        if request.host not in names:
            raise web.HTTPForbidden(text=f"this page is at {', '.join(sorted(names))} only")
        if origin is not None and origin.partition("://")[2] not in names:
            raise web.HTTPForbidden(text="asked by a page of another site")
        if request.method == "POST" and request.content_type != "application/json":
            raise web.HTTPUnsupportedMediaType(text="ask with JSON")
        response = await handler(request)
        response.headers.update(HEADERS)
        return response

    app = web.Application(middlewares=[guarded], client_max_size=LARGEST)
    for path in FILES:
        app.router.add_get(path, _file)
    app.router.add_get("/presets", _offering(presets))
    for path, work in (("/shape", _shape), ("/numbers", _numbers), ("/equilibria", _equilibria), ("/ends", _ends),
                       ("/study", _study), ("/download", _download)):  # fmt: skip
        app.router.add_post(path, _answering(work, shapes, few, tasks))
    return app


def warm() -> None:
    """Solve the first preset, so that what is compiled at the first solve is there when the page asks."""
    worker_processes.get_ready()
    page_shape.shape(page_model.study_of(PRESETS[0].state))
    gc.freeze()  # what is loaded stays: the collector need not walk over it while a slider moves


async def _file(request: web.Request) -> web.StreamResponse:
    return web.FileResponse(FILES[request.path])


def _offering(presets: Sequence[Preset]) -> Handler:
    """Answers with the rods to begin with and the readings of Table 1."""

    async def handler(request: web.Request) -> web.StreamResponse:
        return web.json_response({"presets": [asdict(preset) for preset in presets], "readings": list(READINGS)})

    return handler


@dataclass(frozen=True)
class Desk:
    """What a request is answered with. shapes: kept. few: threads for what takes no search. tasks: processes for what
    does. wanted: whether the client is still there."""

    shapes: Shapes
    few: ThreadPoolExecutor
    tasks: search_processes.Tasks
    wanted: Callable[[], bool]

    async def soon(self, work: Callable[..., Any], *args: Any) -> Any:
        """The work done in a thread: some milliseconds."""
        return await asyncio.get_running_loop().run_in_executor(self.few, work, *args)

    async def search(self, work: Callable[..., Any], *args: Any) -> Any:
        """The work done in a process, and stopped when the client leaves."""
        return await self.tasks.run(self.wanted, work, *args)

    async def shape(self, state: Any, near: page_shape.Shape | None = None) -> page_shape.Shape:
        """The shape of a state: followed from another or solved from its start, else searched."""
        study = await self.soon(page_model.study_of, state)
        found = await self.soon(page_shape.soon, study, near.sol if near else None)
        if found is None:
            lost = near is not None and near.sol.problem.kind == "ends"
            found = await self.search(page_shape.searched, study, lost)
        return found

    async def again(self, asked: dict[str, Any]) -> page_shape.Shape:
        """The shape of a ticket; solved anew where it is forgotten."""
        return self.shapes.find(asked.get("ticket")) or await self.shape(asked.get("state"))


Work = Callable[[dict[str, Any], Desk], Awaitable[web.Response]]


def _answering(work: Work, shapes: Shapes, few: ThreadPoolExecutor, tasks: search_processes.Tasks) -> Handler:
    """Work on a request's JSON aside; what is refused is answered with status 422, a sentence and the field."""

    async def handler(request: web.Request) -> web.StreamResponse:
        try:
            asked = await request.json()
        except (ValueError, RecursionError):  # a number of 5000 digits is a ValueError too
            return web.json_response({"sentence": "this is no JSON", "field": ""}, status=400)

        def wanted() -> bool:
            return request.transport is not None and not request.transport.is_closing()

        try:
            if not isinstance(asked, dict):
                raise InputError("ask with a table")
            return await work(asked, Desk(shapes, few, tasks, wanted))
        except ArithmeticError:  # a radius of 5e-324, say
            return web.json_response({"sentence": search_processes.NO_FLOAT, "field": ""}, status=422)
        except InputError as error:
            told = {"sentence": str(error), "field": page_model.blamed(str(error))}
            return web.json_response(told, status=422)
        except search_processes.Gone:
            return web.Response(status=499)  # to nobody
        except Exception as error:  # a fault of ours, told on the server and as a sentence to the page
            console.warn(f"{request.path} failed: {type(error).__name__}: {error}")
            return web.json_response({"sentence": FAULT, "field": ""}, status=500)

    return handler


async def _shape(asked: dict[str, Any], at: Desk) -> web.Response:
    """The rod's mesh and curves, with the seconds that solving and meshing took; polygons only where they are new."""
    start = time.perf_counter()
    one = await at.shape(asked.get("state"), at.shapes.find(asked.get("near")))
    body = await at.soon(_drawn, asked, one, at.shapes, time.perf_counter() - start)
    return web.Response(body=body, content_type="application/octet-stream")


def _drawn(asked: dict[str, Any], one: page_shape.Shape, shapes: Shapes, solving: float) -> bytes:
    begun = time.perf_counter()
    with np.errstate(over="raise"):  # what single precision cannot hold is told, not drawn
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
        **page_model.told(one), "squeeze": rod.squeeze, "rod_key": rod.key, "wall_key": wall.key,
        "ticket": shapes.keep(page_shape.bare(one)), "fields": page_model.fields(one.study),
        "side": one.sol.case.cylinder.side, "problem": one.sol.problem.kind,
        "seconds": {"solve": solving, "mesh": meshing},
    }  # fmt: skip
    return packed(head, arrays | lines)


def packed(head: dict[str, Any], arrays: dict[str, Any]) -> bytes:
    """A head as JSON and arrays after it: the length of the JSON (4 bytes), the JSON, the arrays.

    Each begins at a multiple of 4 bytes; the head lists each array: name, type, values, first byte after the JSON.
    """
    listed, parts, at = [], [], 0
    for name, array in arrays.items():
        data = np.ascontiguousarray(array).tobytes()
        listed.append([name, array.dtype.str[1:], array.size, at])
        parts.append(data + b"\0" * (-len(data) % 4))
        at += len(parts[-1])
    said = json.dumps({**finite(head), "arrays": listed}).encode()
    said += b" " * (-len(said) % 4)
    return b"".join([pack("<I", len(said)), said, *parts])


async def _numbers(asked: dict[str, Any], at: Desk) -> web.Response:
    return web.json_response(finite(await at.soon(page_model.numbers, await at.again(asked))))


async def _equilibria(asked: dict[str, Any], at: Desk) -> web.Response:
    study = await at.soon(page_model.study_of, asked.get("state"))
    return web.json_response(finite({"rows": await at.search(page_model.every, study)}))


async def _ends(asked: dict[str, Any], at: Desk) -> web.Response:
    study = await at.soon(page_model.study_of, asked.get("state"))
    return web.json_response(await at.search(page_model.by_ends, study))


async def _study(asked: dict[str, Any], at: Desk) -> web.Response:
    study = await at.soon(page_model.study_of, asked.get("state"))
    return web.json_response({"text": await at.soon(page_model.text, study)})


async def _download(asked: dict[str, Any], at: Desk) -> web.Response:
    kind = asked.get("kind")
    if not isinstance(kind, str) or kind not in DOWNLOADS:
        raise InputError(f"no download {str(kind)[:40]!r}; choose from {', '.join(DOWNLOADS)}")
    one = page_shape.portable(await at.again(asked))
    return web.Response(body=await at.search(page_model.file, one, kind), content_type=DOWNLOADS[kind])
