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
import warnings
from pathlib import Path
from typing import Any

SECONDS = 60  # of processor time; a file that takes them has hung the command
MEMORY = 8_000_000_000  # bytes of address space; a file of some kilobytes that asks for more is a bomb
COMMANDS = {
    "check": "check FILE",
    "summary": "summary FILE --json",
    "plot": "plot FILE --dpi 50 --out plot.png",
    "scene": "scene FILE --dpi 50 --out scene.png",
    "merge": "merge FILE GOOD --out merged.h5",
    "sensitivity": "sensitivity FILE",
    **{f"export {form}": f"export FILE --out rod.{form}" for form in ("csv", "vtp", "stl", "glb")},
}


def end_of(words: list[str]) -> tuple[Any, list[str]]:
    """The status of a command and what is wrong with how it ended; it writes into the folder of this process, empty.

    Right is: status 0 or 1 and no word of Python's on stderr; or 2, one sentence there and nothing written. Never a
    character that a terminal would obey.
    """
    from workbench import cli
    from workbench.commands import console

    consoles, streams, status = (console.out(), console.err()), (io.StringIO(), io.StringIO()), None
    before = [each.file for each in consoles]
    try:
        for each, stream in zip(consoles, streams, strict=True):
            each.file = stream
        with contextlib.redirect_stdout(streams[0]), contextlib.redirect_stderr(streams[1]), warnings.catch_warnings():
            warnings.simplefilter("always")
            cli.main(words)
    except SystemExit as end:
        status = end.code
    except BaseException as error:
        return None, [f"ended in {error!r:.300}"]
    finally:
        for each, file in zip(consoles, before, strict=True):
            each.file = file
    told, said = (stream.getvalue() for stream in streams)
    said = "".join(line for line in said.splitlines(keepends=True) if not line.startswith("workbench: notice: "))
    is_sentence = said.startswith("workbench: ") and said.count("\n") == 1 and len(said) < 1500
    wrong = {
        "printed a command": any(not letter.isprintable() and letter not in "\n\t" for letter in told + said),
        f"ended with status {status}": status not in (0, 1, 2),
        f"said {said[-300:]!r}": not is_sentence if status == 2 else "Warning" in said or "Traceback" in said,
        "left a file": status == 2 and any(Path().iterdir()),
    }
    for path in Path().iterdir():
        path.unlink()
    return status, [fault for fault, holds in wrong.items() if holds]


def main(folder: Path, good: Path, *names: str) -> None:
    """Give these commands each file of the folder; first the good file, which imports what they need."""
    from workbench.scene import opengl

    opengl.probe = lambda: (False, "not drawn")  # a file that is let in is read by scene, and not drawn
    for path in (good, *sorted(folder.iterdir())):
        asked = [
            [{"FILE": str(path), "GOOD": str(good)}.get(word, word) for word in COMMANDS[name].split()]
            for name in names
        ]
        for end, faults in map(end_of, asked) if path == good else ends_in_child(asked):
            print(json.dumps({"file": path.name, "status": end, "faults": faults}), flush=True)


def ends_in_child(asked: list[list[str]]) -> list[tuple[Any, list[str]]]:
    """What came of each command, all in one process; if that was killed, they all were."""
    read, write = os.pipe()
    child = os.fork()
    if not child:
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        with os.fdopen(write, "wb") as pipe:
            pipe.write(json.dumps([end_of(words) for words in asked]).encode())
        os._exit(0)
    os.close(write)
    with os.fdopen(read, "rb") as pipe:
        told = pipe.read()
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status):
        return [(None, [f"killed by {signal.Signals(os.WTERMSIG(status)).name}"])] * len(asked)
    return list(json.loads(told))


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:3]), *sys.argv[3:])
