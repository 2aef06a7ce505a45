"""The command explore: the live page, served on this machine."""

import asyncio
import contextlib
import socket
import sys
import threading
from pathlib import Path
from typing import Any

from solver.problem.errors import InputError

from ..web.live.presets import PRESETS
from . import console

MISSING = "the live page needs aiohttp, trame-client and trame-vtk ({why}): pip install 'rod-workbench[explore]'"
EVERYWHERE = ("0.0.0.0", "::", "")


def explore(
    host: str,
    port: int,
    names: list[str],
    file: Path | None = None,
    options: dict[str, Any] | None = None,
    units: dict[str, str] | None = None,
) -> int:
    """Serve the page until interrupted; always 0.

    names: further names by which the browser may call this machine, as `lab.example` or `lab.example:8080`. file,
    options, units: the rod that the page begins with, as `explore_own.preset` takes them; default: Table 1. Raises
    `InputError` where that is no rod, a part is missing, or the port is taken.
    """
    try:
        from ..web.live import own_case, server
    except ImportError as error:
        raise InputError(MISSING.format(why=error)) from None
    if host in EVERYWHERE and not names:
        raise InputError(f"--host {host!r} listens on every address: say with --name by which name it is to be called")
    own = own_case.preset(file, options or {}, units or {})
    listener = bound(host, port)
    port = listener.getsockname()[1]
    presets = PRESETS if own is None else (own, *PRESETS)
    app = server.application(called(host, port, names), presets)
    console.say(f"the live page is at http://{_bracketed(host)}:{port}/ (Ctrl-C ends it)")
    sys.stdout.flush()
    if host not in ("127.0.0.1", "::1", "localhost"):
        console.warn(f"everyone who reaches {host} can use it; there is no password")

    threading.Thread(target=server.warm, daemon=True).start()

    async def serve() -> None:
        from aiohttp import web

        runner = web.AppRunner(app, access_log=None, handler_cancellation=True)
        await runner.setup()
        try:
            await web.SockSite(runner, listener).start()
            await asyncio.Event().wait()
        finally:
            await runner.cleanup()

    with contextlib.suppress(KeyboardInterrupt):  # how it is ended
        asyncio.run(serve())
    return 0


def bound(host: str, port: int) -> socket.socket:
    """A socket that listens there; `InputError` where it cannot."""
    try:
        family, kind, proto, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        listener = socket.socket(family, kind, proto)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(address)
        listener.listen(64)
    except (OSError, OverflowError) as error:
        why = getattr(error, "strerror", None) or error
        raise InputError(f"cannot listen at {host}:{port}: {why}; choose another --port, 0 takes a free one") from None
    return listener


def called(host: str, port: int, names: list[str]) -> set[str]:
    """What a browser may send as Host: the address, `names`, and this machine's own where it listens there."""
    own = ["127.0.0.1", "localhost", "[::1]"] if host in ("127.0.0.1", "localhost", "::1", *EVERYWHERE) else []
    found = {f"{name}:{port}" for name in [_bracketed(host), *own] if name}
    for name in names:
        found |= {name} if name.rpartition(":")[2].isdigit() else {f"{name}:{port}"}
    return found | {name.removesuffix(":80") for name in found if name.endswith(":80")}


def _bracketed(host: str) -> str:
    return f"[{host}]" if ":" in host else host
