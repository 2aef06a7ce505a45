"""Run as a program: commands on every file of a folder, each file in a process of its own, told as JSON lines.

HDF5 may end the process on a damaged file, which only another process can tell.
"""

import json
import os
import resource
import signal
import sys
from pathlib import Path
from typing import Any

from tests.workbench.altered import commands, ended

SECONDS = 60  # of processor time; a file that takes them has hung the command
MEMORY = 8_000_000_000  # bytes of address space; a file of some kilobytes that asks for more is a bomb


def main(folder: Path, good: Path, out: Path, *names: str) -> None:
    from workbench.commands import summary  # noqa: F401  (imported once, before the processes)
    from workbench.scene import opengl

    opengl.probe = lambda: (False, "not drawn")  # a file that is let in is read by scene, and not drawn
    for path in sorted(folder.iterdir()):
        asked = [words for name, words in commands(path, good, out).items() if name in names]
        for status, faults in forked(asked, out):
            print(json.dumps({"file": path.name, "status": status, "faults": faults}), flush=True)


def forked(asked: list[list[str]], out: Path) -> list[tuple[Any, list[str]]]:
    """What came of each command, all in one process; if that was killed, they all were."""
    read, write = os.pipe()
    child = os.fork()
    if not child:
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        with os.fdopen(write, "wb") as pipe:
            pipe.write(json.dumps([ended(words, out) for words in asked]).encode())
        os._exit(0)
    os.close(write)
    with os.fdopen(read, "rb") as pipe:
        told = pipe.read()
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status):
        return [(None, [f"killed by {signal.Signals(os.WTERMSIG(status)).name}"])] * len(asked)
    return list(json.loads(told))


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:4]), *sys.argv[4:])
