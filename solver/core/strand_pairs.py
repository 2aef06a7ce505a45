"""The search for self-contact by the compiled core: `strand_pairs.c`."""

import ctypes
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from ..numerics.arrays import Array, Integers
from .library import begin_of, function, share_out, widest
from .panels import fine

_STEPS, _NUMBERS = ("first", "since", "width", "series"), ("period", "length", "a", "apart")


class Limits(NamedTuple):
    """The largest numbers of periods and of pairs compared for a rod, and of periods compared together."""

    rounds: int
    most_pairs: int
    together: int


class _Rods(ctypes.Structure):
    """`rods` in strand_pairs.c."""

    _fields_ = [
        *((name, ctypes.c_void_p) for name in ("orbits", *_STEPS, *_NUMBERS, "periods")),
        *((name, ctypes.c_int64) for name in (*Limits._fields, "lanes")),
    ]


def meets(orbit: Any, numbers: Mapping[str, Array], periods: Integers, limits: Limits) -> Array:
    """Whether B marched rods meet themselves, (B,): 1, 0, or NaN where `limits` leaves that open.

    Parameters
    ----------
    orbit : MarchedOrbit
        B orbits, none of them lost.
    numbers : mapping
        period, length, a, apart as of `observe.strand_pairs.Strands`, (B,) each.
    periods : array, (B,)
        Periods that are compared with the first.
    limits : Limits
    """
    steps = orbit.steps
    kept = {name: getattr(steps, name) for name in _STEPS} | {"orbits": orbit.found, "periods": periods}
    kept |= {name: np.asarray(numbers[name], dtype=float) for name in _NUMBERS}
    kept = {name: np.ascontiguousarray(array) for name, array in kept.items()}
    places = {name: begin_of(array) for name, array in kept.items()}
    rods, found = _Rods(**places, **limits._asdict(), lanes=widest()), np.empty(periods.size)
    call = function("rod_meets", ctypes.c_int, *2 * [ctypes.c_void_p], *2 * [ctypes.c_int64])

    def part(a: int, b: int) -> None:
        fine(call(ctypes.addressof(rods), begin_of(found), a, b))

    share_out(part, periods.size)
    return found
