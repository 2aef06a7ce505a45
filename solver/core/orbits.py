"""Critical points of G and periodic orbits by the compiled core: `critical_points.c`, `orbits.c`, `conditioning.c`."""

import ctypes
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..mechanics.potential import HasLoads
from ..numerics.arrays import Array, Booleans, Integers
from .library import Cutting, address, cut, fine, functions, numbers_of, on_grid, points

_CRITICAL = 16  # most critical points of a problem
FUNCTIONS, PIECE_COLUMNS = 5, 17  # series of a panel; numbers of a piece


class _ReadOrbits(ctypes.Structure):
    """`read_orbits` in orbits.c."""

    _fields_ = [(name, ctypes.c_int64) for name in ("coefficients", "panels")] + [
        (name, ctypes.c_void_p)
        for name in ("kind", "first", "count", "beta0", "direction", "duration", "gain", "since", "width", "series")
    ]


class FoundOrbits(NamedTuple):
    """Orbits as `rod_orbits_fetch` fills them."""

    kind: Integers
    direction: Array
    counts: Integers
    columns: Array
    arc: Integers
    rank: Integers
    series: Array
    duration: Array
    gain: Array
    pieces: Array


@dataclass(frozen=True, eq=False)
class CriticalPoints:
    """The critical points of G in [-pi, pi) of B problems, rising; padded to (B, K) with NaN.

    beta: (B, K). centre: (B, K), whether each is a minimum of G; they alternate. count: (B,), even, at least 2.
    A saddle and a centre may share an angle, where H only touches zero: under twist alone, at beta = 0 or pi.
    """

    beta: Array
    centre: Booleans
    count: Integers


def critical_points(problem: HasLoads) -> CriticalPoints:
    """All critical points of G, which are the helices of the loads: the roots of H, found as sign changes on a grid and
    refined inside their brackets. None, a count of 0, where a load is not finite."""
    loads = np.stack([problem.lam, problem.mu, problem.phi], axis=1)
    every = _critical_points(loads)
    if every is None:  # all are refused for the sake of those that are not finite
        fit = np.array([_critical_points(load[None]) is not None for load in loads])
        every = _critical_points(np.where(fit[:, None], loads, 0.0))
        assert every is not None
        every.beta[~fit], every.centre[~fit], every.count[~fit] = np.nan, False, 0
    return every


def _critical_points(loads: Array) -> CriticalPoints | None:
    """Those of loads (B, 3); None where one is not finite, or critical points could not be told apart."""
    B = loads.shape[0]
    beta, centre = np.full((B, _CRITICAL), np.nan), np.zeros((B, _CRITICAL), np.bool_)
    count = np.empty(B, np.int64)
    status = functions().rod_critical_points(
        ctypes.c_int64(B), address(loads), *on_grid(),
        address(beta), address(centre), address(count),
    )  # fmt: skip
    most = int(count.max(initial=0)) if fine(status) else 0
    return CriticalPoints(beta[:, :most], centre[:, :most], count) if fine(status) else None


def orbits(numbers: Array, pin: Any, n: int, cutting: Cutting) -> FoundOrbits | None:
    """The orbits of B start problems.

    Parameters
    ----------
    numbers : (B, 6)
        lam, mu, phi, span, beta(0), beta_t(0).
    pin : tuple of (B,), (B,), or None
        Angles, and heights of the level above G there.
    n : int
        Nodes of a panel.
    cutting : Cutting

    Returns
    -------
    FoundOrbits or None
        None where a number is not finite, or critical points could not be told apart.
    """
    core, B = functions(), numbers.shape[0]
    kind, direction, count = np.empty(B, np.int64), np.empty(B), np.empty(2 * B, np.int64)
    pieces, status = ctypes.c_int64(), ctypes.c_int64()
    pinned = (None, None) if pin is None else tuple(np.ascontiguousarray(v, dtype=float) for v in pin)
    handle = core.rod_orbits(
        ctypes.c_int64(B), address(numbers), address(pinned[0]), address(pinned[1]), *on_grid(), points(n),
        cut(cutting, False),
        address(kind), address(direction), address(count), ctypes.byref(pieces), ctypes.byref(status),
    )  # fmt: skip
    if handle is None:
        fine(status.value)
        return None
    P = int(count.sum())
    columns, arc, rank = np.empty((6, P)), np.empty(P, np.int64), np.empty(P, np.int64)
    series, duration, gain = np.empty((P, FUNCTIONS, n + 1)), np.empty(2 * B), np.empty((2 * B, 3))
    kept = np.empty((pieces.value, PIECE_COLUMNS))
    rest = (columns, arc, rank, series, duration, gain, kept)
    core.rod_orbits_fetch(ctypes.c_void_p(handle), ctypes.c_int64(P), *(address(a) for a in rest))
    return FoundOrbits(kind, direction, count, *rest)


class _PanelErrors(ctypes.Structure):
    """`panel_errors` in conditioning.c."""

    _fields_ = [(name, ctypes.c_void_p) for name in ("fastest", "error", "time_error", "time_rounding")]


def reading(orbit: Any) -> tuple[_ReadOrbits, Any]:
    """The orbits as the core reads them, and the arrays behind it."""
    panels, arcs = orbit.panels, orbit.arcs
    kept = [np.ascontiguousarray(a) for a in (
        arcs.kind, orbit.first, orbit.count, orbit.problem.beta0, arcs.direction, orbit.duration, orbit.gain,
        orbit.since, panels.duration, panels.series,
    )]  # fmt: skip
    return _ReadOrbits(panels.series.shape[2], panels.arc.size, *(address(a) for a in kept)), kept


class _Covered(ctypes.Structure):
    """`covered` in orbit_parts.h."""

    _fields_ = [(name, ctypes.c_void_p) for name in ("of", "row", "low", "high", "time", "count", "begin")]


def cover(
    span: Array, kind: Integers, first: Integers, count: Integers, duration: Array, since: Array, width: Array
) -> tuple[Integers, Integers, Array, Array, Array, Array, Array]:
    """The pieces that B rods cover of their orbits: the columns of `observe.rod_pieces.Pieces`, (Q,) each.

    Parameters
    ----------
    span, kind : (B,)
        The lengths in t, and the kinds of the orbits.
    first, count, duration : (2 B,)
        Of the arcs: their first panels, the numbers of these, and how long they last.
    since, width : (P,)
        Of the panels: the time from the start, and how long they last.
    """
    given = [np.ascontiguousarray(a, dtype=np.int64) for a in (kind, first, count)]
    times = [np.ascontiguousarray(a, dtype=float) for a in (duration, since, width)]
    places = dict(
        zip(("kind", "first", "count", "duration", "since", "width"), map(address, given + times), strict=True)
    )
    of, row = np.empty((2, 3 * since.size), dtype=np.int64)
    numbers, span = np.empty((5, 3 * since.size)), np.ascontiguousarray(span, dtype=float)
    size = functions().rod_cover(
        ctypes.byref(_ReadOrbits(**places)), ctypes.c_int64(span.size), address(span),
        ctypes.byref(_Covered(*map(address, (of, row, *numbers)))),
    )  # fmt: skip
    return of[:size], row[:size], *numbers[:, :size]


def read(orbit: Any, t: Array) -> Array:
    """beta, beta_t, alpha, z and the swirl of the orbits at t (B, n): (5, B, n)."""
    t, (of, kept) = np.ascontiguousarray(t), reading(orbit)
    out = np.empty((FUNCTIONS, *t.shape))
    functions().rod_orbits_read(
        ctypes.byref(of), ctypes.c_int64(t.shape[0]), ctypes.c_int64(t.shape[1]), address(t), address(out)
    )
    del kept
    return out


def judge(orbit: Any) -> tuple[Array, Array]:
    """Condition number and estimated error of B start problems from their orbits, (B,) each."""
    return _variation("rod_orbits_judge", orbit)


def response(orbit: Any) -> tuple[Array, Array]:
    """How B orbits whose beta(0) is held answer a change of beta(L), (B,) each.

    The largest |d beta(t)/d beta(L)| = |eta(t)/eta(L)|, the condition numbers of equilibria between given ends, and
    eta(L) = d beta(L)/d beta_t(0), NaN for a helix. eta is the Jacobi field, at the nodes of all panels that the rod
    passes, in its first period and in its last: between them eta grows evenly. At least 1; unbounded at a fold.
    """
    return _variation("rod_orbits_response", orbit)


def _variation(name: str, orbit: Any) -> tuple[Array, Array]:
    """Two numbers of each orbit by a function of conditioning.c."""
    numbers, (of, kept), panels = numbers_of(orbit.problem), reading(orbit), orbit.panels
    errors = [np.ascontiguousarray(a) for a in (panels.fastest, panels.error, panels.time_error, panels.time_rounding)]
    first, second = np.empty((2, numbers.shape[0]))
    fine(getattr(functions(), name)(
        ctypes.c_int64(numbers.shape[0]), address(numbers), ctypes.byref(of), _points_of(orbit),
        ctypes.byref(_PanelErrors(*(address(a) for a in errors))), address(first), address(second),
    ))  # fmt: skip
    del kept
    return first, second


def action(orbit: Any) -> Array:
    """The integral of beta_t^2 over B rods, (B,)."""
    numbers, (of, kept) = numbers_of(orbit.problem), reading(orbit)
    out = np.empty(numbers.shape[0])
    size = ctypes.c_int64(out.size)
    functions().rod_orbits_action(size, address(numbers), ctypes.byref(of), _points_of(orbit), address(out))
    del kept
    return out


def _points_of(orbit: Any) -> Any:
    return points(orbit.panels.series.shape[2] - 1)
