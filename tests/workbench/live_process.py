"""The command explore as a process of its own, the memory that it holds, and stand-ins for searches."""

import os
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from studies import Study

ROOT = Path(__file__).parents[2]


@contextmanager
def explored() -> Iterator[tuple[int, subprocess.Popen]]:
    """The port of a server and its process, until the end of the block."""
    words = [sys.executable, "-m", "workbench", "explore", "--port", "0"]
    with subprocess.Popen(words, cwd=ROOT, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            found = re.search(r":(\d+)/", process.stdout.readline())
            assert found
            yield int(found[1]), process
        finally:
            process.kill()


def megabytes(pid: int) -> float:
    """What a process holds in memory [MB], all pages that it shares with others among them."""
    told = Path(f"/proc/{pid}/status").read_text()
    return int(re.search(r"^VmRSS:\s+(\d+)", told, re.M)[1]) / 1e3  # type: ignore[index]


def endless(study: Study) -> Any:
    """A search that does not end; tells its process in the file that is the study's title."""
    with open(study.title, "a") as file:
        file.write(f"{os.getpid()}\n")
    while True:
        time.sleep(0.05)


def endless_or_listed(study: Study) -> Any:
    """An endless search of a study whose title is a file; else an empty list."""
    return endless(study) if os.sep in study.title else []


def broken(asked: Any) -> Any:
    """A search that fails as no search should."""
    raise IndexError("at \x1b[2J a line of the solver")


def greedy(study: Study) -> Any:
    """A search that takes more memory than there is."""
    return bytearray(10**15)
