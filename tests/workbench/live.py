"""The live page's server in a thread of the test's own, and states of the page."""

import asyncio
import copy
import json
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from http.client import HTTPConnection, HTTPResponse
from typing import Any

import numpy as np

from workbench.web.live.presets import PRESETS

STATES: dict[str, dict[str, Any]] = {preset.name: preset.state for preset in PRESETS}


def state(name: str = "table1", reading: str | None = None, **changes: object) -> dict[str, Any]:
    """A preset with another reading, and with other values of its rod."""
    changed = copy.deepcopy(STATES[name])
    changed["base"] |= changes
    return changed | ({"reading": reading} if reading else {})


@contextmanager
def served(presets: Sequence[Any] | None = None) -> Iterator[int]:
    """The port at which the page is served on 127.0.0.1, until the end of the block; presets: default the shipped."""
    from aiohttp import web

    from workbench.commands import explore
    from workbench.web.live import server

    listener = explore.open_socket("127.0.0.1", 0)
    port = listener.getsockname()[1]
    loop = asyncio.new_event_loop()
    app = server.application(explore.host_names("127.0.0.1", port, []), presets or PRESETS)
    runner = web.AppRunner(app, access_log=None, shutdown_timeout=2, handler_cancellation=True)  # as the command
    loop.run_until_complete(runner.setup())
    loop.run_until_complete(web.SockSite(runner, listener).start())
    thread = threading.Thread(target=loop.run_forever, daemon=True)
    thread.start()
    try:
        yield port
    finally:
        asyncio.run_coroutine_threadsafe(runner.cleanup(), loop).result(10)
        loop.call_soon_threadsafe(loop.stop)
        thread.join(10)
        loop.close()


def asked(
    port: int, method: str, path: str, body: Any = None, headers: dict[str, str] | None = None, source: str = ""
) -> HTTPResponse:
    """The answer to one request, read whole (`.data`); source: the address that asks."""
    connection = HTTPConnection("127.0.0.1", port, timeout=600, source_address=(source, 0) if source else None)
    data = body if isinstance(body, (bytes, type(None))) else json.dumps(body).encode()
    given = {"Content-Type": "application/json"} if data is not None else {}
    connection.request(method, path, data, {**given, **(headers or {})})
    answer = connection.getresponse()
    answer.data = answer.read()  # type: ignore[attr-defined]
    connection.close()
    return answer


def unpacked(data: bytes) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Head and arrays of an answer of /shape."""
    head = json.loads(data)
    return head, {name: np.array(row) for name, row in head["arrays"].items()}
