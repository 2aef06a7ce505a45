"""Run as a program: commands on every file of a folder, each file in a process of its own, told as JSON lines.

HDF5 may end the process on a damaged file, which only another process can tell.
"""

import contextlib
import io
import json
import os
import resource
import signal
import sys
from pathlib import Path
from typing import Any

SECONDS = 60  # of processor time; a file that takes them has hung the command
MEMORY = 8_000_000_000  # bytes of address space; a file of some kilobytes that asks for more is a bomb


def commands(path: Path, good: Path, out: Path) -> dict[str, list[str]]:
    return {
        "check": ["check", str(path)],
        "summary": ["summary", str(path)],
        "plot": ["plot", str(path), "--out", str(out / "plot.png")],
        "scene": ["scene", str(path), "--out", str(out / "scene.png")],
        "merge": ["merge", str(path), str(good), "--out", str(out / "merged.h5")],
    }


def run(args: list[str]) -> dict[str, Any]:
    """A command's status and what it wrote on stderr; a traceback is told as an exception."""
    from workbench import cli

    said = io.StringIO()
    with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
        try:
            cli.main(args)
        except SystemExit as end:
            return {"status": end.code, "said": said.getvalue()}
        except BaseException as error:
            return {"status": "exception", "said": repr(error)[:500]}
    return {"status": "no end", "said": said.getvalue()}


def main(folder: Path, good: Path, out: Path, *names: str) -> None:
    from workbench.commands import summary  # noqa: F401  (imported once, before the processes)
    from workbench.scene import opengl

    opengl.probe = lambda: (False, "not drawn")  # a file that is let in is read by scene, and not drawn
    for path in sorted(folder.iterdir()):
        asked = {name: args for name, args in commands(path, good, out).items() if name in names}
        for name, told in zip(asked, forked(list(asked.values())), strict=True):
            print(json.dumps({"file": path.name, "command": name, **told}), flush=True)


def forked(asked: list[list[str]]) -> list[dict[str, Any]]:
    """What came of each command, all in one process; if that was killed, they all were."""
    read, write = os.pipe()
    child = os.fork()
    if not child:
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        with os.fdopen(write, "wb") as pipe:
            pipe.write(json.dumps([run(args) for args in asked]).encode())
        os._exit(0)
    os.close(write)
    with os.fdopen(read, "rb") as pipe:
        told = pipe.read()
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status):
        return [{"status": f"killed by {signal.Signals(os.WTERMSIG(status)).name}", "said": ""}] * len(asked)
    return list(json.loads(told))


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:4]), *sys.argv[4:])
