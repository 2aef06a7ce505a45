"""The derivatives of start problems in one pass, and of shapes from the changes of their orbits, by the compiled core:
`sensitivities.c`."""

import ctypes
from collections.abc import Collection, Mapping
from typing import Any, NamedTuple

import numpy as np

from ..numerics.arrays import Array, Integers
from .library import Cutting, address, cut, fine, functions, numbers_of, on_grid, points, share_out
from .measures import GROUPS, NUMBERS, RATED

LOST, PARTLY = -1, ("push", "turned", "risen")  # measured over the middle third
SERIES_GOAL = 1e-14  # of the series of which the places of extremes are found, relative
_SHAPES = ("t", "beta", "rate", "z", "loads", "span", "by", "later", "ratio", "rho", "out")


class _Shapes(ctypes.Structure):
    """`shapes` in sensitivities.c."""

    _fields_ = [(name, ctypes.c_int64) for name in ("size", "stations", "F")] + [
        (name, ctypes.c_void_p) for name in _SHAPES
    ]


class _Grid(ctypes.Structure):
    """`grid` in orbit_parts.h."""

    _fields_ = [("m", ctypes.c_int64), ("angles", ctypes.c_void_p), ("table", ctypes.c_void_p)]


class _Sensitivities(ctypes.Structure):
    """`sensitivities` in sensitivities.c."""

    _fields_ = [
        ("along", _Shapes), ("marks", _Shapes),
        *((name, ctypes.c_void_p) for name in ("beta", "rate", "problems", "sign", "error", "lifts", "peak")),
        *((name, ctypes.c_int64) for name in ("wanted", "groups", "partly")),
        *((name, ctypes.c_double) for name in ("goal", "rates_goal")),
        *((name, ctypes.c_void_p) for name in ("kind", "half_period", "rates", "found")),
    ]  # fmt: skip


def shape_rates(out: Array, shape: Mapping[str, Array]) -> None:
    """Turn the changes of orbits into the derivatives of shapes, in place.

    Parameters
    ----------
    out : (5, B, F, n)
        The changes of beta, beta_t and the integrals of H_q d beta; filled with the derivatives of beta, dbeta, alpha,
        z and gamma at constant s/L.
    shape : mapping
        t, beta, rate (beta_t) and z/rho, (B, n) each; loads, (B, 3); span, ratio and rho, (B,); by, (11, B, F), rates
        of the numbers of the case; later, (B, F), those of the length in t. Without by, ratio and rho all is in units
        of rho.
    """
    given, kept = _shapes_of(out, shape)
    functions().rod_shape_rates(ctypes.byref(given))
    del kept


def _shapes_of(out: Array, shape: Mapping[str, Array]) -> tuple[_Shapes, Any]:
    kept = {name: np.ascontiguousarray(shape[name], dtype=float) for name in _SHAPES[:-1] if name in shape}
    _, B, F, n = out.shape
    return _Shapes(B, n, F, *(address(kept.get(name)) for name in _SHAPES[:-1]), address(out)), kept


class Measured(NamedTuple):
    """What is measured of B rods for their derivatives.

    sign, error : (B,), of the push, and of beta. names: of `RATED`. plain: of `NUMBERS`, whose values are wanted.
    middle: of `PARTLY`, over the middle third. goal: allowed error of the series, relative. seen: "lifts" and "peak",
    (B,) each, where what is observed is not what is measured here.
    """

    sign: Array
    error: Array
    names: Collection[str]
    plain: Collection[str]
    middle: Collection[str]
    goal: float
    seen: Mapping[str, Array]


class StartRates(NamedTuple):
    """The derivatives of B start problems by F fields.

    kind: (B,), of their orbits; of helices, and where it is `LOST`, nothing else is known. along: (5, B, F, n), of
    beta, dbeta, alpha, z and gamma. marks: (5, B, F, 4), of the same in units of rho at 0, 1/3, 2/3 and 1 of the
    length. half_period: (B, F). rates: (B, F) by name. values: numbers and their errors, (B,) each, by name; middle:
    the same over the middle third.
    """

    kind: Integers
    along: Array
    marks: Array
    half_period: Array
    rates: dict[str, Array]
    values: dict[str, tuple[Array, Array]]
    middle: dict[str, tuple[Array, Array]]


def start_sensitivities(
    problem: Any, shape: Mapping[str, Array], n: int, how: Cutting, measured: Measured | None = None
) -> StartRates:
    """The derivatives of B start problems. shape: as of `shape_rates`. n, how: as of `orbits.orbits`."""
    numbers, (B, stations), F = numbers_of(problem), shape["t"].shape, shape["by"].shape[2]
    out, ends, half = np.full((5, B, F, stations), np.nan), np.full((5, B, F, 4), np.nan), np.full((B, F), np.nan)
    kind, state = np.empty(B, dtype=np.int64), np.zeros((3, B, 4))
    known = {**shape, "loads": numbers[:, :3], "span": numbers[:, 3]}
    along, kept = _shapes_of(out, known)
    t = numbers[:, 3, None] * (np.arange(4) / 3)
    places = {"t": t, "beta": state[0], "rate": state[1], "z": state[2], "later": kept["later"]}
    marks, kept_marks = _shapes_of(ends, {**places, "loads": kept["loads"], "span": kept["span"]})
    seen, rates = np.zeros((3, B, 2, len(NUMBERS))), np.full((B, F, len(NUMBERS) + 1), np.nan)
    task = _Sensitivities(
        along, marks, address(state[0]), address(state[1]), address(numbers),
        kind=address(kind), half_period=address(half), rates=address(rates), found=address(seen),
    )  # fmt: skip
    if measured is not None:
        arrays = {"sign": measured.sign, "error": measured.error, **measured.seen}
        kept |= {name: np.ascontiguousarray(array, dtype=float) for name, array in arrays.items()}
        for name in arrays:
            setattr(task, name, address(kept[name]))
        task.wanted = sum(1 << RATED[name] for name in measured.names)
        task.groups, task.partly = _groups_of(measured.plain), _groups_of(measured.middle)
        task.goal, task.rates_goal = measured.goal, SERIES_GOAL
    searched = _Grid(*on_grid())

    def part(a: int, b: int) -> None:
        fine(functions().rod_sensitivities(
            ctypes.byref(task), ctypes.byref(searched), points(n), cut(how, False), ctypes.c_int64(a), ctypes.c_int64(b)
        ))  # fmt: skip

    share_out(part, B)
    del kept_marks
    if measured is None:
        return StartRates(kind, out, ends, half, {}, {}, {})
    places_of = {name: NUMBERS.index(name) for name in _members(measured.plain)}
    values = {name: (seen[0, :, 0, k], seen[0, :, 1, k]) for name, k in places_of.items()}
    thirds = {name: NUMBERS.index(name) for name in _members(measured.middle)}
    middle = {
        name: (seen[2, :, 0, k] - seen[1, :, 0, k], seen[2, :, 1, k] + seen[1, :, 1, k]) for name, k in thirds.items()
    }
    return StartRates(kind, out, ends, half, {name: rates[..., RATED[name]] for name in measured.names}, values, middle)


def _groups_of(names: Collection[str]) -> int:
    return sum(1 << k for k, group in enumerate(GROUPS) if not set(names).isdisjoint(group))


def _members(names: Collection[str]) -> list[str]:
    return [name for group in GROUPS if not set(names).isdisjoint(group) for name in group]
