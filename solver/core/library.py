"""The compiled core: where its shared library is, how calls are shared out among threads, and how panels are cut."""

import ctypes
import os
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import numpy as np

from ..numerics.arrays import Array
from ..numerics.chebyshev import Basis, basis
from . import tuning
from .build import HERE, OTHER, digest, library_name

HOW = "install rod-workbench again, or in a checkout run python -m solver.core"
INT, FLOAT, AT = ctypes.c_int64, ctypes.c_double, ctypes.c_void_p
_KINDS = {"double": FLOAT, "int64_t": INT, "int": ctypes.c_int}
_SHARE = 256  # problems that a thread takes at a time. x10: batches of fewer than 5,120 use one thread


class MissingCore(ImportError):
    """The compiled core is not there, or is another one than these sources make."""


def library_path() -> Path:
    """Where the library is."""
    return Path(os.environ.get(OTHER) or HERE / library_name())


@cache
def library() -> Any:
    """The library. Raises `MissingCore` with what to do where it cannot be used."""
    path = library_path()
    try:
        core = ctypes.CDLL(str(path))
        core.rod_sources.restype = ctypes.c_char_p
    except (OSError, AttributeError) as error:  # not there, built for another system, or another library
        raise MissingCore(f"the compiled core cannot be loaded ({error}); {HOW}") from None
    if core.rod_sources().decode() != digest():
        raise MissingCore(f"{path} was compiled from other sources; {HOW}")
    core.rod_tune(ctypes.byref(Tuning(**tuning.values())))
    return core


@cache
def widest() -> int:
    """How many problems the core marches together on this processor."""
    return int(library().rod_lanes())


def begin_of(array: Any) -> int:
    """Where the numbers of a contiguous array begin."""
    try:
        return ctypes.addressof(ctypes.c_char.from_buffer(array))  # three times as fast as what NumPy offers
    except (TypeError, ValueError):  # an array that is empty or cannot be written
        begin: int = array.__array_interface__["data"][0]
        return begin


class Structure(ctypes.Structure):
    """A struct of the core, from numbers, arrays and other structs, which it keeps alive; a field without one is 0.

    An array that the core only reads becomes one of the numbers that the C file declares, contiguous; one that it
    writes is so already. Raises `MissingCore` for a field that the struct does not have.
    """

    _file: ClassVar[str]
    _names: ClassVar[list[str]]
    _pointers: ClassVar[dict[str, Any]]  # the numbers of the arrays that are only read; of other pointers None

    def __init__(self, *values: Any, **named: Any) -> None:
        self.kept = []
        for name, value in (*zip(self._names, values, strict=False), *named.items()):
            if name not in self._names:
                raise MissingCore(f"the struct {type(self).__name__} in {self._file} has no field {name}; {HOW}")
            if (kind := self._pointers.get(name)) is not None and value is not None:
                value = np.ascontiguousarray(value, dtype=kind)
            self.kept.append(value)
            setattr(self, name, _place_of(value) if name in self._pointers else value)


def _place_of(value: Any) -> Any:
    """Where an array or a struct begins; another value as it is."""
    if isinstance(value, np.ndarray):
        return begin_of(value)
    return ctypes.addressof(value) if isinstance(value, Structure) else value


def structure(name: str, file: str, **kinds: Any) -> Any:
    """The class of a struct of the core, as a C file declares it.

    kinds: those of fields that are structs, arrays or functions; numbers and pointers are read. Raises `MissingCore`
    where the file has no such struct, or declares a field of another kind.
    """
    declared = re.search(rf"typedef struct \{{([^{{}}]*)\}} {name};", _text_of(file))
    if declared is None:
        raise MissingCore(f"{file} has no struct {name}; {HOW}")
    fields: list[tuple[str, Any]] = []
    pointers: dict[str, Any] = {}
    text_of_fields = re.sub(r"/\*.*?\*/", "", declared[1], flags=re.DOTALL)
    for is_read, kind, names in re.findall(r"(const )?(\w+) ([^;]+);", text_of_fields):
        for text in names.split(","):
            star, field, array = re.fullmatch(r"(\*?)(\w+)(\[.*\])?", text.strip()).groups()  # type: ignore[union-attr]
            known = kinds.get(field, AT if star else None if array else _KINDS.get(kind))
            if known is None:
                raise MissingCore(f"the field {field} of struct {name} in {file} is not what Python knows; {HOW}")
            fields.append((field, known))
            if known is AT:
                pointers[field] = np.dtype(_KINDS[kind]) if is_read and kind in _KINDS else None
    names_of = {"_names": [field for field, _ in fields], "_pointers": pointers}
    return type(name, (Structure,), {"_fields_": fields, "_file": file, **names_of})


@cache
def _text_of(file: str) -> str:
    return (HERE / file).read_text(encoding="utf-8")


def run(name: str, *arguments: Any, result: Any = ctypes.c_int) -> Any:
    """Call a function of the core.

    Whole numbers, also flags, are given as int64, others as double, arrays and structs by where they begin, None as
    NULL. The function has a ctype as its result.
    """
    call = getattr(library(), name)
    call.restype = result
    return call(*map(_argument, arguments))


def _argument(value: Any) -> Any:
    if isinstance(value, float):
        return FLOAT(value)
    return INT(int(value)) if isinstance(value, (int, np.integer, np.bool_)) else AT(_place_of(value))


def threads() -> int:
    """The number of threads that a call may use: that of the processors, or OMP_NUM_THREADS."""
    limit = os.environ.get("OMP_NUM_THREADS", "")
    if limit.isdigit():
        return max(1, int(limit))
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def share_out(part: Callable[[int, int], object], size: int) -> None:
    """Call part(a, b) for stretches that make up 0 .. size, in several threads where there are many problems."""
    if size < 2 * _SHARE or (count := min(threads(), size // _SHARE)) < 2:
        part(0, size)
        return
    from concurrent.futures import ThreadPoolExecutor  # one rod has no need of it

    with ThreadPoolExecutor(count) as pool:
        list(pool.map(lambda a: part(a, min(a + _SHARE, size)), range(0, size, _SHARE)))


Tuning = structure("tuning", "tuning.h")
_Points, _Cutting, _Grid = (structure(name, "orbit_parts.h") for name in ("points", "cutting", "grid"))


class Cutting(NamedTuple):
    """How panels are cut: `cutting` in orbit_parts.h. lanes: numbers computed at once, 0 for as many as there can be;
    their number changes no bit."""

    length: float
    goal: float
    stretch: float
    lanes: int = 0


@cache
def points(n: int) -> Any:
    """The nodes of panels and the maps on them, for the core."""
    panel: Basis = basis(n)
    return _Points(n, panel.nodes, panel.analyse, panel.values, panel.differentiate)


TIMES, ANGLE, CURVES = 0, 2, 5  # how many series of a panel are wanted: of none, of beta and |beta_t|, of all


@cache
def cut(cutting: Cutting, series: int) -> Any:
    """How panels are cut, for the core. series: how many are wanted of each, `TIMES`, `ANGLE` or `CURVES`."""
    length, goal, stretch, lanes = cutting
    return _Cutting(length, goal, stretch, series, lanes or widest())


@cache
def grid() -> tuple[Array, Array]:
    """The grid of the search for critical points of G: angles, and H, H' there as linear functions of
    (lam - mu, lam + mu, mu, phi, 1): (M,), (5, 2 M).

    Even spacing leaves at most one pair of roots of H in a cell; small loads gather three roots about beta = 0 and
    beta = pi, which points in geometric progression separate.
    """
    near = 2.0 ** -np.arange(6, 42)
    even = np.linspace(-np.pi, np.pi, 193)[:-1] + 1e-3
    angles = np.sort(np.concatenate([even, near, -near, [0.0], near - np.pi, np.pi - near]))
    s, c = np.sin(angles), np.cos(angles)
    up, size = c > 0, np.abs(c)
    bent = s * s * (1 + 2 * size) / (1 + size)
    value = [c * up, c * ~up, bent, -s, -2 * c * s**3]
    rate = [-s * up, -s * ~up, np.where(up, -s, s) + 2 * np.sin(2 * angles), -c, -2 * s * s * (3 * c * c - s * s)]
    return angles, np.hstack([value, rate])


@cache
def on_grid() -> Any:
    """The grid for the core."""
    angles, table = grid()
    return _Grid(angles.size, angles, table)


def fine(status: int) -> bool:
    """Whether a function of the core could do its work."""
    if status == 1:  # NO_MEMORY of orbit_parts.h
        raise MemoryError
    return status == 0


def numbers_of(problem: Any) -> Array:
    """lam, mu, phi, span, beta(0) and beta_t(0) of B start problems, (B, 6); of ends problems beta(L) in its place."""
    numbers = np.empty((problem.size, 6))
    for k, number in enumerate(vars(problem).values()):
        numbers[:, k] = number
    return numbers
