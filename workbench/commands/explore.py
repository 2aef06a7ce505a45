"""The command explore: serve the live page on this machine."""

import contextlib
import socket
import sys
import threading
from pathlib import Path
from typing import Annotated, Any

from . import console, option_checks
from .case_options import Given, takes_case
from .options import ForceOutput, argument, option
from .present import Result, presents, result_of_files

MISSING = "the server of the live page needs aiohttp ({why}): pip install 'rod-workbench[explore]'"
THIS_MACHINE = ("127.0.0.1", "localhost", "::1")
EVERYWHERE = ("0.0.0.0", "::", "")


@presents()
@takes_case()
def explore(
    file: Annotated[
        Path | None, argument("FILE|STUDY", "Study, by name or TOML file, or stored file; options replace its fields.")
    ] = None,
    host: Annotated[str, option("ADDRESS", "Address to listen on.")] = "127.0.0.1",
    port: Annotated[int, option("PORT", "Port to listen on; 0 takes a free one.", min=0, max=65535)] = 8765,
    name: Annotated[
        list[str] | None, option("NAME", "Another host name under which browsers reach this machine; repeatable.")
    ] = None,
    save: Annotated[
        Path | None, option("FILE", "Write the page as one HTML file that works offline, and serve nothing.")
    ] = None,
    force: ForceOutput = False,
    *,
    given: Given,
) -> Result:
    """Serve the live page: sliders for a rod, in the browser.

    The page shows the shape, forces and equilibria of a rod while its sliders move. It begins with Table 1, with the
    rod of options, as for the command solve, or with any study or stored file: of several cases it shows one, and says
    which. Only this machine can open the page unless --host says
    otherwise. Ctrl-C ends the command.
    """
    from solver.problem.errors import InputError

    from ..web.live.presets import PRESETS, own_preset

    if save is not None:
        option_checks.check(save, (".html",), force)
        own = own_preset(file, given.values, given.units)
        size = _save(save, PRESETS if own is None else (own, *PRESETS))
        said = [f"wrote {save}: {size / 1e3:.0f} kB, opens in a browser without a server"]
        return result_of_files([save], said + ([] if own is None else [own.source]))

    try:
        from ..web.live import server
    except ImportError as error:
        raise InputError(MISSING.format(why=error)) from None

    names = name or []
    if host in EVERYWHERE and not names:
        raise InputError(f"--host {host!r} listens on every address: give the name of this machine with --name")
    own = own_preset(file, given.values, given.units)
    listener = open_socket(host, port)
    port = listener.getsockname()[1]
    presets = PRESETS if own is None else (own, *PRESETS)
    app = server.application(host_names(host, port, names), presets, console.warn)
    address = f"http://{_bracket(host)}:{port}/"
    said = [f"the live page is at {address} (Ctrl-C ends it)", *([] if own is None else [own.source])]
    open_to_all = f"everyone who can reach {host} can use the page; it has no password"

    def serve() -> None:
        sys.stdout.flush()
        threading.Thread(target=server.warm, daemon=True).start()
        _serve(app, listener)

    return Result(
        lambda: {"address": address, "shown": None if own is None else own.source},
        lambda: console.say("\n".join(said)),
        warnings=[] if host in THIS_MACHINE else [open_to_all],
        afterwards=serve,
    )


def _save(path: Path, presets: Any) -> int:
    """Write the page as a file; its size in bytes."""
    from ..store import atomic
    from ..web.live import live_document

    text = live_document.text(presets, served=False)
    atomic.write(path, lambda aside: aside.write_text(text, encoding="utf-8"))
    return len(text.encode())


def _serve(app: Any, listener: socket.socket) -> None:
    """Serve until Ctrl-C."""
    import asyncio

    from aiohttp import web

    async def serve() -> None:
        runner = web.AppRunner(app, access_log=None, handler_cancellation=True)
        await runner.setup()
        try:
            await web.SockSite(runner, listener).start()
            await asyncio.Event().wait()
        finally:
            await runner.cleanup()

    with contextlib.suppress(KeyboardInterrupt):  # Ctrl-C is the normal end
        asyncio.run(serve())


def open_socket(host: str, port: int) -> socket.socket:
    """A socket that listens on an address. Raises `InputError` if it cannot."""
    from solver.problem.errors import InputError

    listener = None
    try:
        family, kind, proto, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        listener = socket.socket(family, kind, proto)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(address)
        listener.listen(64)
    except (OSError, OverflowError) as error:
        if listener is not None:
            listener.close()
        why = getattr(error, "strerror", None) or error
        raise InputError(f"cannot listen on {host}:{port}: {why}; choose another --port (0 takes a free one)") from None
    return listener


def host_names(host: str, port: int, names: list[str]) -> set[str]:
    """The Host headers that a browser may send.

    The address, the further names (such as `lab.example` or `lab.example:8080`), and the names of this machine if it
    listens on its own address.
    """
    own = ["127.0.0.1", "localhost", "[::1]"] if host in (*THIS_MACHINE, *EVERYWHERE) else []
    found = {f"{name}:{port}" for name in [_bracket(host), *own] if name}
    for name in names:
        found |= {name} if name.rpartition(":")[2].isdigit() else {f"{name}:{port}"}
    return found | {name.removesuffix(":80") for name in found if name.endswith(":80")}


def _bracket(host: str) -> str:
    return f"[{host}]" if ":" in host else host
