"""Steps along a branch of equilibria by the compiled core: `branch_steps.c`."""

import ctypes
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from .library import address
from .panels import Cutting, cut, fine, functions, points

LEFT_TO_CALLER, AT_END, IS_CLOSED, ENOUGH = range(4)  # why the steps end
KINDS = ("saddle", "start", "end")
RECORD = np.dtype(
    [(name, "f8") for name in ("p", "pin", "sign", "y")]
    + [(name, "i8") for name in ("leaving", "turns", "index")]
    + [("numbers", "f8", 6)]
)
_MOST = 256  # records of a call
_PROBLEM = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_double, ctypes.POINTER(ctypes.c_double))
Pair = ctypes.c_double * 2
Numbers = Callable[[float], Sequence[float] | None]


class Path(ctypes.Structure):
    """`path` in branches.h."""

    _fields_ = [(name, ctypes.c_double) for name in ("pin", "sign", "y")]
    _fields_ += [(name, ctypes.c_int64) for name in ("leaving", "turns")]


class Chart(ctypes.Structure):
    """`chart` in branches.h."""

    _fields_ = [(name, ctypes.c_int) for name in ("kind", "logarithmic")]
    _fields_ += [(name, ctypes.c_double) for name in ("own", "scale")]
    _fields_ += [("at", Path)]


class Point(ctypes.Structure):
    """`point` in branch_steps.c."""

    _fields_ = [(name, Pair) for name in ("w", "jacobian", "tangent")]
    _fields_ += [(name, ctypes.c_double) for name in ("sign", "bend", "ahead")]
    _fields_ += [("chart", Chart)]


class _Range(ctypes.Structure):
    """`range` in branch_steps.c."""

    _fields_ = [(name, ctypes.c_double) for name in ("scale", "low", "high", "rounding")]
    _fields_ += [("count", ctypes.c_int64), ("halts", ctypes.c_void_p)]


def _called(numbers: Numbers, raised: list[BaseException]) -> Any:
    """The problem at a value of the parameter as the core calls it; what it raises is kept."""

    def at(p: float, out: Any) -> int:
        try:
            found = numbers(p)
            if found is None:
                return 1
            for k, number in enumerate(found):
                out[k] = number
        except BaseException as error:  # it cannot pass through the core
            raised.append(error)
            return 1
        return 0

    return _PROBLEM(at)


class Steps:
    """Steps along branches over one parameter.

    numbers: lam, mu, phi, span, beta(0) and beta(L) of the problem at p, None where there is none. scale: of p. halts:
    the values at which to halt, rising, from the lower to the upper end of the range. rounding: below which two values
    are one. grid, n, how: as of `orbits.orbits`, for the transit times.
    """

    def __init__(
        self, numbers: Numbers, scale: float, halts: Sequence[float], rounding: float, grid: Any, n: int, how: Cutting
    ) -> None:
        self._raised: list[BaseException] = []
        self._kept = np.array(halts, dtype=float)
        self._problem = _called(numbers, self._raised)
        self._over = _Range(scale, halts[0], halts[-1], rounding, self._kept.size, address(self._kept))
        angles, table = self._grid = grid
        self._told = (
            self._problem, ctypes.byref(self._over), ctypes.c_int64(angles.size), address(angles), address(table),
            points(n), cut(how, True),
        )  # fmt: skip

    def run(self, at: Point, step: float, kept: int, first: Any, most: int) -> tuple[Any, float, int, int]:
        """At most so many records from a point, which is replaced by the last one; the length of the next step; for
        how many steps the coordinate is kept; and why there are no more records. first: record of the branch's begin.
        """
        most = min(most, _MOST)
        out = np.empty(most, RECORD)
        length, keep = ctypes.c_double(step), ctypes.c_int64(kept)
        count, why = ctypes.c_int64(), ctypes.c_int64()
        status = functions().rod_branch_steps(
            *self._told, ctypes.byref(at), ctypes.byref(length), ctypes.byref(keep), address(first),
            ctypes.c_int64(most), address(out), ctypes.byref(count), ctypes.byref(why),
        )  # fmt: skip
        if self._raised:
            raise self._raised.pop()
        fine(status)
        return out[: count.value], length.value, keep.value, why.value
