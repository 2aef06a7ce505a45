"""Waiting for what another process does."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

PATIENCE = 600  # s that anything is waited for, on a machine with much else to do


def until(condition: Callable[[], Any], told: Callable[[], Any] = lambda: "it never came") -> Any:
    """What the condition gives, once that is true; where it never is, the test fails with what is told."""
    end = time.monotonic() + PATIENCE
    while not (found := condition()):
        if time.monotonic() > end:
            pytest.fail(str(told()))
        time.sleep(0.02)
    return found


def alive(pid: int) -> bool:
    """Whether there is such a process, one that only waits to be buried aside."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False
