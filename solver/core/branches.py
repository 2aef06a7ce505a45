"""Steps along a branch of equilibria by the compiled core: `branch_steps.c`."""

import ctypes
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ..numerics.arrays import Array
from .library import Cutting, address, cut, fine, functions, on_grid, points

LEFT_TO_CALLER, AT_END, IS_CLOSED, ENOUGH = range(4)  # why the steps end
KINDS = ("saddle", "start", "end")
RECORD = np.dtype(
    [(name, "f8") for name in ("p", "pin", "sign", "y")]
    + [(name, "i8") for name in ("leaving", "turns", "index")]
    + [("numbers", "f8", 6)]
)
NO_ORBIT = 100
NUMBERS, PARTS = 11, 5  # of an equilibrium; of a change
RATES = NUMBERS * (PARTS + 2) + 1  # doubles of `orbit_numbers`
_MOST = 256  # records of a call
_PROBLEM = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_double, ctypes.POINTER(ctypes.c_double))
_UNKNOWNS, _EQUATIONS = PARTS + 2, PARTS + 1
Numbers = Callable[[float], Sequence[float] | None]


class Level(ctypes.Structure):
    """`path` in branches.h."""

    _fields_ = [(name, ctypes.c_double) for name in ("pin", "sign", "y")]
    _fields_ += [(name, ctypes.c_int64) for name in ("leaving", "turns")]


class Chart(ctypes.Structure):
    """`chart` in branches.h."""

    _fields_ = [(name, ctypes.c_int) for name in ("kind", "logarithmic")]
    _fields_ += [(name, ctypes.c_double) for name in ("own", "scale")]
    _fields_ += [("at", Level)]


class Grid(ctypes.Structure):
    """`grid` in branches.h."""

    _fields_ = [("m", ctypes.c_int64), ("angles", ctypes.c_void_p), ("table", ctypes.c_void_p)]


class Point(ctypes.Structure):
    """`point` in branch_points.h."""

    _fields_ = [
        ("w", ctypes.c_double * _UNKNOWNS),
        ("jacobian", ctypes.c_double * (_EQUATIONS * _UNKNOWNS)),
        ("tangent", ctypes.c_double * _UNKNOWNS),
    ]
    _fields_ += [(name, ctypes.c_double) for name in ("sign", "bend", "ahead")]
    _fields_ += [("chart", Chart)]


def chart_of(chart: Any) -> Chart:
    """A `charts.Chart` as the core reads it."""
    at = Level(chart.at.pin, chart.at.sign, chart.at.y, chart.at.leaving, chart.at.turns)
    return Chart(KINDS.index(chart.kind), chart.logarithmic, 0.0, chart.scale, at)


class _Range(ctypes.Structure):
    """`range` in branch_points.h."""

    _fields_ = [(name, ctypes.c_double) for name in ("scale", "low", "high", "rounding")]
    _fields_ += [("count", ctypes.c_int64), ("halts", ctypes.c_void_p)]


class _Held(ctypes.Structure):
    """`held_ends` in branch_points.h."""

    _fields_ = [("given", ctypes.c_int64 * PARTS), ("loads", ctypes.c_double)]


class _Curve(ctypes.Structure):
    """`curve` in branch_steps.c."""

    _fields_ = [
        ("problem", _PROBLEM),
        ("over", ctypes.POINTER(_Range)),
        ("held", ctypes.POINTER(_Held)),
        ("by", Grid),
        *((name, ctypes.c_void_p) for name in ("nodes", "times", "orbits")),
    ]


def _call(numbers: Numbers, count: int, raised: list[BaseException]) -> Any:
    """The problem at a value of the parameter as the core calls it, so many numbers; what it raises is kept."""

    def at(p: float, out: Any) -> int:
        try:
            values = numbers(p)
            if values is None:
                return 1
            for k, number in zip(range(count), values, strict=True):
                out[k] = number
        except BaseException as error:  # it cannot pass through the core
            raised.append(error)
            return 1
        return 0

    return _PROBLEM(at)


class Steps:
    """Steps along branches over one parameter.

    Parameters
    ----------
    numbers : callable
        Of p, None where there is no problem. Under dead loads lam, mu, phi, span, beta(0) and beta(L); with held ends
        the five given numbers, span and A/C.
    scale : float
        Of p.
    n, how
        As of `orbits.orbits`; how panels are cut for the transit times, and for the orbits.
    held : tuple of int, optional
        The places of the given numbers among those of `orbit_rates`, with held ends.
    """

    def __init__(self, numbers: Numbers, scale: float, n: int, how: tuple[Cutting, Cutting], held: Any = None) -> None:
        self._raised: list[BaseException] = []
        self._scale, self._held = scale, held
        self._pointed = points(n), cut(how[0], True), cut(how[1], False)
        pointers = (ctypes.cast(pointer, ctypes.c_void_p) for pointer in self._pointed)
        self._curve = _Curve(
            _call(numbers, 7 if held else 6, self._raised),
            None,
            None,
            Grid(*on_grid()),
            *pointers,
        )

    def excess(self, chart: Chart, p: float, x: Array) -> Array | None:
        """The length at each x, at most three, less that of the rod at p; None where there is no such orbit."""
        x, off = np.ascontiguousarray(x), np.empty(x.size)
        failed = functions().rod_branch_excess(
            ctypes.byref(self._curve), ctypes.byref(chart), ctypes.c_double(p), ctypes.c_int64(x.size), address(x),
            address(off),
        )  # fmt: skip
        self._raise()
        return off if failed != NO_ORBIT and fine(failed) else None

    def run(
        self, at: Point, step: float, kept: int, first: Any, most: int, halts: Array, rounding: float, loads: float
    ) -> tuple[Any, Array, float, int, int]:
        """At most so many records from a point, which is replaced by the last one.

        Parameters
        ----------
        at, step, kept
            The point, the length of the next step, and for how many steps its coordinate is kept.
        first : array of RECORD
            The begin of the branch.
        halts : array
            Where to halt, rising, from the lower to the upper end of the range.
        rounding : float
            Below which two values of p are one.
        loads : float
            The scale of the loads, with held ends.

        Returns
        -------
        tuple
            The records; with held ends their numbers and rates, (N, `orbit_rates.RECORD`); step and kept as they are
            then; and why there are no more.
        """
        over = _Range(self._scale, halts[0], halts[-1], rounding, halts.size, address(halts))
        out = np.empty(min(most, _MOST), RECORD)
        rates = np.empty((out.size if self._held else 0, RATES))
        length, keep = ctypes.c_double(step), ctypes.c_int64(kept)
        count, why = ctypes.c_int64(), ctypes.c_int64()
        self._curve.over = ctypes.pointer(over)
        if self._held:
            self._curve.held = ctypes.pointer(_Held((ctypes.c_int64 * PARTS)(*self._held), loads))
        status = functions().rod_branch_steps(
            ctypes.byref(self._curve), ctypes.byref(at), ctypes.byref(length), ctypes.byref(keep), address(first),
            ctypes.c_int64(out.size), address(out), address(rates), ctypes.byref(count), ctypes.byref(why),
        )  # fmt: skip
        self._raise()
        fine(status)
        return out[: count.value], rates[: count.value], length.value, keep.value, why.value

    def _raise(self) -> None:
        if self._raised:
            raise self._raised.pop()
