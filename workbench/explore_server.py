"""The live page's server: a few routes on one address.

It keeps no session, and takes no path or name of a file from the browser: what is served is listed here, what is asked
is a state (plain data), what is downloaded is made in a folder of its own.
"""

import asyncio
import gc
import json
import secrets
import tempfile
import time
from collections import OrderedDict
from collections.abc import Awaitable, Callable
from dataclasses import asdict
from pathlib import Path
from struct import pack
from threading import Lock
from typing import Any

import numpy as np
from aiohttp import web

from solver.errors import InputError
from studies.readings import READINGS

from . import browser, explore_mesh, explore_model, explore_shape, exporting
from .console import finite
from .explore_presets import PRESETS

PAGE = Path(__file__).parent / "page"
FILES = {
    "/": PAGE / "index.html",
    "/page.js": PAGE / "page.js",
    "/diagram.js": PAGE / "diagram.js",
    "/page.css": PAGE / "page.css",
    **{f"/{name}": path for name, path in browser.scripts().items()},
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

Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]


class Shapes:
    """The last shapes, by the ticket that the page was given with each; a lost one costs only time."""

    def __init__(self) -> None:
        self._kept: OrderedDict[str, explore_shape.Shape] = OrderedDict()
        self._lock = Lock()

    def keep(self, one: explore_shape.Shape) -> str:
        ticket = secrets.token_hex(8)
        with self._lock:
            self._kept[ticket] = one
            while len(self._kept) > REMEMBERED:
                self._kept.popitem(last=False)
        return ticket

    def find(self, ticket: Any) -> explore_shape.Shape | None:
        with self._lock:
            return self._kept.get(ticket) if isinstance(ticket, str) else None


def application(names: set[str]) -> web.Application:
    """The application; names: the `host:port` by which it may be asked, in Host and Origin."""
    shapes = Shapes()

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
    app.router.add_get("/presets", _presets)
    for path, work in (("/shape", _shape), ("/numbers", _numbers), ("/equilibria", _equilibria), ("/ends", _ends),
                       ("/study", _study), ("/download", _download)):  # fmt: skip
        app.router.add_post(path, _answering(work, shapes))
    return app


def warm() -> None:
    """Solve the first preset, so that what is compiled at the first solve is there when the page asks."""
    explore_shape.shape(explore_model.study_of(PRESETS[0].state))
    gc.freeze()  # what is loaded stays: the collector need not walk over it while a slider moves


async def _file(request: web.Request) -> web.StreamResponse:
    return web.FileResponse(FILES[request.path])


async def _presets(request: web.Request) -> web.StreamResponse:
    return web.json_response({"presets": [asdict(preset) for preset in PRESETS], "readings": list(READINGS)})


def _answering(work: Callable[[dict[str, Any], Shapes], web.Response], shapes: Shapes) -> Handler:
    """Work on a request's JSON aside; what is refused is answered with status 422, a sentence and the field."""

    async def handler(request: web.Request) -> web.StreamResponse:
        try:
            asked = await request.json()
        except (ValueError, RecursionError):  # a number of 5000 digits is a ValueError too
            return web.json_response({"sentence": "this is no JSON", "field": ""}, status=400)
        try:
            if not isinstance(asked, dict):
                raise InputError("ask with a table")
            return await asyncio.to_thread(work, asked, shapes)
        except ArithmeticError:  # a radius of 5e-324, say: what is finite at the door need not stay so
            told = {"sentence": "numbers as large or as small as these cannot be computed with", "field": ""}
            return web.json_response(told, status=422)
        except InputError as error:
            told = {"sentence": str(error), "field": explore_model.blamed(str(error))}
            return web.json_response(told, status=422)

    return handler


def _again(asked: dict[str, Any], shapes: Shapes) -> explore_shape.Shape:
    """The shape of a ticket; solved anew where it is forgotten."""
    return shapes.find(asked.get("ticket")) or explore_shape.shape(explore_model.study_of(asked.get("state")))


def _shape(asked: dict[str, Any], shapes: Shapes) -> web.Response:
    """The rod's mesh and curves, with the seconds that solving and meshing took; polygons only where they are new."""
    start = time.perf_counter()
    near = shapes.find(asked.get("near"))
    one = explore_shape.shape(explore_model.study_of(asked.get("state")), near.sol if near else None)
    solved = time.perf_counter()
    with np.errstate(over="raise"):  # what single precision cannot hold is told, not drawn
        rod = explore_mesh.rod(one.sol)
        wall = explore_mesh.cylinder(one.sol, rod.squeeze)
        meshed = time.perf_counter()
        lines = {name: np.asarray(values, dtype=np.float32) for name, values in explore_model.curves(one).items()}
    arrays: dict[str, Any] = {}
    for name, drawn in (("rod", rod), ("wall", wall)):
        arrays |= {f"{name}.points": drawn.points, f"{name}.normals": drawn.normals, f"{name}.colours": drawn.colours}
        if asked.get(f"{name}_has") != drawn.key:
            arrays[f"{name}.polygons"] = drawn.polygons
            if drawn.light is not None:
                arrays[f"{name}.light"] = drawn.light
    head = {
        **explore_model.told(one), "squeeze": rod.squeeze, "rod_key": rod.key, "wall_key": wall.key,
        "ticket": shapes.keep(one), "fields": explore_model.fields(one.study), "side": one.sol.case.cylinder.side,
        "problem": one.sol.problem.kind, "seconds": {"solve": solved - start, "mesh": meshed - solved},
    }  # fmt: skip
    return web.Response(body=packed(head, arrays | lines), content_type="application/octet-stream")


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


def _numbers(asked: dict[str, Any], shapes: Shapes) -> web.Response:
    return web.json_response(finite(explore_model.numbers(_again(asked, shapes))))


def _equilibria(asked: dict[str, Any], shapes: Shapes) -> web.Response:
    found = explore_model.every(explore_model.study_of(asked.get("state")))
    return web.json_response(finite({"rows": found}))


def _ends(asked: dict[str, Any], shapes: Shapes) -> web.Response:
    return web.json_response(explore_model.by_ends(explore_model.study_of(asked.get("state"))))


def _study(asked: dict[str, Any], shapes: Shapes) -> web.Response:
    return web.json_response({"text": explore_model.text(explore_model.study_of(asked.get("state")))})


def _download(asked: dict[str, Any], shapes: Shapes) -> web.Response:
    kind = asked.get("kind")
    if not isinstance(kind, str) or kind not in DOWNLOADS:
        raise InputError(f"no download {str(kind)[:40]!r}; choose from {', '.join(DOWNLOADS)}")
    ds = explore_model.stored(_again(asked, shapes))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"rod.{kind}"
        try:
            exporting.export(ds, exporting.Wish(path, {}))
        except InputError as error:
            raise InputError(str(error).partition("; --")[0]) from None  # the page has no such options
        data = path.read_bytes()
    return web.Response(body=data, content_type=DOWNLOADS[kind])
