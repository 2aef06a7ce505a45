"""The compiled core: where its shared library is, and how calls are shared out among threads."""

import ctypes
import os
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from .build import HERE, OTHER, digest, library_name

HOW = "install rod-workbench again, or in a checkout run python -m solver.core"
_SHARE = 256  # problems that a thread takes at a time


class MissingCore(ImportError):
    """The compiled core is not there, or is another one than these sources make."""


@cache
def library() -> Any:
    """The library. Raises `MissingCore` with what to do where it cannot be used."""
    path = Path(os.environ.get(OTHER) or HERE / library_name())
    try:
        core = ctypes.CDLL(str(path))
        core.rod_sources.restype = ctypes.c_char_p
    except (OSError, AttributeError) as error:  # not there, built for another system, or another library
        raise MissingCore(f"the compiled core cannot be loaded ({error}); {HOW}") from None
    if core.rod_sources().decode() != digest():
        raise MissingCore(f"{path} was compiled from other sources; {HOW}")
    return core


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


def share_out(part: Callable[[int, int], None], size: int) -> None:
    """Call part(a, b) for stretches that make up 0 .. size, in several threads where there are many problems."""
    if size < 2 * _SHARE or (count := min(threads(), size // _SHARE)) < 2:
        part(0, size)
        return
    from concurrent.futures import ThreadPoolExecutor  # one rod has no need of it

    with ThreadPoolExecutor(count) as pool:
        list(pool.map(lambda a: part(a, min(a + _SHARE, size)), range(0, size, _SHARE)))
