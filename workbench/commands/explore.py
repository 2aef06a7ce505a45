"""The command explore: serve the live page on this machine."""

import socket
import sys
import threading
from pathlib import Path
from typing import Annotated

from solver.problem.declared_fields import ALL_FIELDS
from solver.problem.errors import InputError

from ..run import atomic
from . import console
from .case_options import GivenOptions
from .options import ForceOutput, argument, check_file, option
from .present import Result, presents, result_of_files

MISSING = "the server of the live page needs aiohttp ({why}): pip install 'rod-workbench[explore]'"
THIS_MACHINE = ("127.0.0.1", "localhost", "::1")
EVERYWHERE = ("0.0.0.0", "::", "")


@presents(case=tuple(ALL_FIELDS))
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
    given: GivenOptions,
) -> Result:
    """Serve the live page: sliders for a rod, in the browser.

    The page shows the shape, forces and equilibria of a rod while its sliders move. It begins with a drill pipe in a
    borehole, with the rod of options, as for the command solve, or with any study or stored file: of several cases it
    shows one, and says which. Only this machine can open the page unless --host says otherwise. Ctrl-C ends the
    command.
    """
    from ..web.live import live_document
    from ..web.live.presets import PRESETS, own_preset

    if save is not None:
        check_file(save, (".html",), force)
    names = name or []
    if save is None and host in EVERYWHERE and not names:
        raise InputError(f"--host {host!r} listens on every address: give the name of this machine with --name")
    preset = own_preset(file, given.values, given.units)
    presets, source = (PRESETS, None) if preset is None else ((preset, *PRESETS), preset.source)
    if save is not None:
        text = live_document.text(presets, served=False)
        atomic.write_text(save, text)
        said = f"wrote {save}: {len(text.encode()) / 1e3:.0f} kB, opens in a browser without a server"
        return result_of_files([save], [said, *([source] if source else [])])
    try:
        from aiohttp import web

        from ..web.live import server
    except ImportError as error:
        raise InputError(MISSING.format(why=error)) from None

    listener = open_socket(host, port)
    port = listener.getsockname()[1]
    app = server.application(host_names(host, port, names), presets, console.warn)
    address = f"http://{_bracket(host)}:{port}/"
    said = "\n".join([f"the live page is at {address} (Ctrl-C ends it)", *([source] if source else [])])
    open_to_all = f"everyone who can reach {host} can use the page; it has no password"

    def serve() -> None:
        sys.stdout.flush()
        threading.Thread(target=server.warm, daemon=True).start()
        web.run_app(app, sock=listener, print=None, access_log=None, handler_cancellation=True, handle_signals=False)

    return Result(
        lambda: {"address": address, "shown": source},
        lambda: console.say(said),
        warnings=[] if host in THIS_MACHINE else [open_to_all],
        afterwards=serve,
    )


def open_socket(host: str, port: int) -> socket.socket:
    """A socket that listens on an address. Raises `InputError` if it cannot."""
    try:
        family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        return socket.create_server(address[:2], family=family, backlog=64)
    except (OSError, OverflowError) as error:
        why = str(getattr(error, "strerror", None) or error).partition(" (while")[0]
        raise InputError(f"cannot listen on {host}:{port}: {why}; choose another --port (0 takes a free one)") from None


def host_names(host: str, port: int, names: list[str]) -> set[str]:
    """The Host headers that a browser may send.

    The address, the further names (such as `lab.example` or `lab.example:8080`), and the names of this machine if it
    listens on its own address.
    """
    local = ["127.0.0.1", "localhost", "[::1]"] if host in (*THIS_MACHINE, *EVERYWHERE) else []
    hosts = {f"{name}:{port}" for name in [_bracket(host), *local] if name}
    for name in names:
        hosts |= {name} if name.rpartition(":")[2].isdigit() else {f"{name}:{port}"}
    return hosts | {name.removesuffix(":80") for name in hosts if name.endswith(":80")}


def _bracket(host: str) -> str:
    return f"[{host}]" if ":" in host else host
