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


def commands(path: Path, good: Path, out: Path) -> dict[str, list[str]]:
    """What is asked of every altered file; good: another dataset of the same study, to be merged with it."""
    coarse = ["--dpi", "50"]
    asked = {
        "check": ["check", "FILE"],
        "check --json": ["check", "FILE", "--json"],
        "summary": ["summary", "FILE"],
        "summary --json": ["summary", "FILE", "--json"],
        "plot": ["plot", "FILE", "--out", str(out / "plot.png"), *coarse],
        "scene": ["scene", "FILE", "--out", str(out / "scene.png"), *coarse],
        "merge": ["merge", "FILE", str(good), "--out", str(out / "merged.h5")],
    }
    for kind in ("csv", "vtp", "stl", "glb"):
        asked[f"export {kind}"] = ["export", "FILE", "--out", str(out / f"rod.{kind}")]
    asked["export step"] = ["export", "FILE", "--out", str(out / "rod.step"), "--tolerance", "0.01", "--centreline"]
    return {name: [str(path) if word == "FILE" else word for word in words] for name, words in asked.items()}


def end_of(words: list[str], out: Path) -> tuple[Any, list[str]]:
    """The status of a command and what is wrong with how it ended; `out` is where it may write, empty before.

    Right is: status 0 or 1 and no word of Python's on stderr; or 2, one sentence there and nothing written. Never a
    character that a terminal would obey.
    """
    from workbench import cli
    from workbench.commands import console

    told, said = io.StringIO(), io.StringIO()
    before = console.out().file, console.err().file
    console.out().file, console.err().file = told, said
    status: Any = "no end"
    try:
        with contextlib.redirect_stdout(told), contextlib.redirect_stderr(said), warnings.catch_warnings():
            warnings.simplefilter("always")
            cli.main(words)
    except SystemExit as end:
        status = end.code
    except BaseException as error:
        return None, [f"ended in {error!r:.300}"]
    finally:
        console.out().file, console.err().file = before
    lines = said.getvalue().splitlines(keepends=True)
    found, sentence = [], "".join(line for line in lines if not line.startswith("workbench: notice: "))
    obeyed = {one for one in told.getvalue() + sentence if not one.isprintable() and one not in "\n\t"}
    if obeyed:
        found.append(f"printed {obeyed}")
    if status not in (0, 1, 2):
        found.append(f"status {status}")
    if status == 2 and not (sentence.startswith("workbench: ") and sentence.count("\n") == 1 and len(sentence) < 1500):
        found.append(f"said {sentence[-300:]!r}")
    if status != 2 and ("Warning" in sentence or "Traceback" in sentence):
        found.append(f"warned {sentence[-300:]!r}")
    left = [path.name for path in out.iterdir()]
    if status == 2 and left:
        found.append(f"left {left}")
    for path in out.iterdir():
        path.unlink()
    return status, found


def main(folder: Path, good: Path, out: Path, *names: str) -> None:
    """Give these commands, or with "all" every one, each file of the folder."""
    from workbench.commands import summary  # noqa: F401  (imported once, before the processes)
    from workbench.scene import opengl

    if names != ("all",):
        opengl.probe = lambda: (False, "not drawn")  # a file that is let in is read by scene, and not drawn
    for path in sorted(folder.iterdir()):
        asked = [words for name, words in commands(path, good, out).items() if names == ("all",) or name in names]
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
            pipe.write(json.dumps([end_of(words, out) for words in asked]).encode())
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
