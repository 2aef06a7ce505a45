"""The compiled core: where its shared library is, and how calls are shared out among threads."""

import ctypes
import os
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from .build import HERE, OFF, OTHER, digest, library_name

_SHARE = 256  # problems that a thread takes at a time


@cache
def library() -> Any:
    """The library; None where it was not built, or where `OFF` is set."""
    return None if os.environ.get(OFF) else _loaded()[0]


def why_missing() -> str:
    """Why the library is not used; empty where it is."""
    return f"switched off by {OFF}" if os.environ.get(OFF) else _loaded()[1]


@cache
def _loaded() -> tuple[Any, str]:
    """The library and an empty text; or None and why there is none."""
    path = Path(os.environ.get(OTHER) or HERE / library_name())
    if os.environ.get(OTHER) and not path.exists():
        return None, f"{OTHER} names {path}, which does not exist"
    if not path.exists():
        return None, "the installation could not compile it; install a C compiler, then rod-workbench again"
    try:
        core = ctypes.CDLL(str(path))
    except OSError as error:  # built for another system
        return None, str(error)
    if not hasattr(core, "rod_sources"):
        return None, f"{path} is another library"
    core.rod_sources.restype = ctypes.c_char_p
    if core.rod_sources().decode() != digest():
        return (
            None,
            f"{path} was compiled from other sources; install rod-workbench again, or run python -m solver.core",
        )
    return core, ""


@cache
def widest() -> int:
    """How many problems the core marches together on this processor."""
    return int(library().rod_lanes())


@cache
def function(name: str, result: Any, *arguments: Any) -> Any:
    """A function of the library, with the ctypes of its result and arguments."""
    found = getattr(library(), name)
    found.restype, found.argtypes = result, arguments
    return found


def begin_of(array: NDArray[Any]) -> int:
    """Where the numbers of a contiguous array begin."""
    begin: int = array.__array_interface__["data"][0]
    return begin


def address(array: NDArray[Any] | None) -> ctypes.c_void_p:
    """The same as an argument of a function whose ctypes are not given; NULL for None."""
    return ctypes.c_void_p(None if array is None else begin_of(array))


def threads() -> int:
    """The number of threads that a call may use: that of the processors, or OMP_NUM_THREADS."""
    told = os.environ.get("OMP_NUM_THREADS", "")
    if told.isdigit():
        return max(1, int(told))
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def shared_out(part: Callable[[int, int], None], size: int) -> None:
    """Call part(a, b) for stretches that make up 0 .. size, in several threads where there are many problems."""
    if size < 2 * _SHARE or (count := min(threads(), size // _SHARE)) < 2:
        part(0, size)
        return
    from concurrent.futures import ThreadPoolExecutor  # one rod has no need of it

    with ThreadPoolExecutor(count) as pool:
        list(pool.map(lambda a: part(a, min(a + _SHARE, size)), range(0, size, _SHARE)))
