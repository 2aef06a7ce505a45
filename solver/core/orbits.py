"""Critical points of G and periodic orbits with their variations by the compiled core: `critical_points.c`, `orbits.c`,
`conditioning.c`, `variations.c`."""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..mechanics.potential import HasLoads
from ..numerics.arrays import Array, Booleans, Integers
from .library import AT, INT, Cutting, cut, fine, numbers_of, on_grid, points, run, structure, widest

_CRITICAL = 16  # most critical points of a problem
FUNCTIONS = 5  # series of a panel


_ReadOrbits = structure(  # orbit_parts.h
    "read_orbits", (INT, "coefficients panels"),
    (AT, "kind first count beta0 direction duration gain since width base origin series"),
)  # fmt: skip
_PanelArrays = structure("panel_arrays", (INT, "panels"), (AT, "arc columns series"))  # orbit_parts.h
_Covered = structure("covered", (AT, "of row low high time count begin"))  # orbit_parts.h
_PanelErrors = structure("panel_errors", (AT, "fastest error time_error time_rounding"))  # conditioning.c


class FoundOrbits(NamedTuple):
    """Orbits as `rod_orbits_fetch` fills them."""

    kind: Integers
    direction: Array
    arc: Integers
    columns: Array
    series: Array
    since: Array
    first: Integers
    counts: Integers
    duration: Array
    gain: Array


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
    if not fine(run("rod_critical_points", B, loads, on_grid(), beta, centre, count)):
        return None
    most = int(count.max(initial=0))
    return CriticalPoints(beta[:, :most], centre[:, :most], count)


def orbits(numbers: Array, pinned: Array | None, n: int, cutting: Cutting) -> FoundOrbits | None:
    """The orbits of B start problems.

    Parameters
    ----------
    numbers : (B, 6)
        lam, mu, phi, span, beta(0), beta_t(0).
    pinned : (B, 3), or None
        Angles, heights of the level above G there, and by how much the logs of the true heights are smaller.
    n : int
        Nodes of a panel.
    cutting : Cutting

    Returns
    -------
    FoundOrbits or None
        None where a number is not finite, or critical points could not be told apart.
    """
    B = numbers.shape[0]
    kind, direction, sizes = np.empty(B, np.int64), np.empty(B), np.empty(2, np.int64)
    task = B, numbers, pinned, on_grid(), points(n), cut(cutting, False)
    handle = run("rod_orbits", *task, kind, direction, sizes, result=AT)
    P, status = sizes.tolist()
    if handle is None:
        fine(status)
        return None
    arc, columns, series = np.empty(P, np.int64), np.empty((7, P)), np.empty((P, FUNCTIONS, n + 1))
    first, count = np.empty((2, 2 * B), np.int64)
    sums = np.empty(P), first, count, np.empty(2 * B), np.empty((2 * B, 3))
    run("rod_orbits_fetch", handle, _PanelArrays(P, arc, columns, series), *sums)
    return FoundOrbits(kind, direction, arc, columns, series, *sums)


def reading(orbit: Any) -> Any:
    """The orbits as the core reads them."""
    panels, arcs = orbit.panels, orbit.arcs
    arrays = (
        arcs.kind, orbit.first, orbit.count, orbit.problem.beta0, arcs.direction, orbit.duration, orbit.gain,
        orbit.since, panels.duration, panels.base, panels.origin, panels.series,
    )  # fmt: skip
    return _ReadOrbits(panels.series.shape[2], panels.arc.size, *map(np.ascontiguousarray, arrays))


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
    whole = (np.ascontiguousarray(a, dtype=np.int64) for a in (kind, first, count))
    times = (np.ascontiguousarray(a, dtype=float) for a in (duration, since, width))
    names = "kind", "first", "count", "duration", "since", "width"
    of, row = np.empty((2, 3 * since.size), dtype=np.int64)
    numbers, span = np.empty((5, 3 * since.size)), np.ascontiguousarray(span, dtype=float)
    orbit = _ReadOrbits(**dict(zip(names, (*whole, *times), strict=True)))
    size = run("rod_cover", orbit, span.size, span, _Covered(of, row, *numbers), result=INT)
    return of[:size], row[:size], *numbers[:, :size]


def read(orbit: Any, t: Array) -> Array:
    """beta, beta_t, alpha, z and the swirl of the orbits at t (B, n): (5, B, n)."""
    out = np.empty((FUNCTIONS, *t.shape))
    run("rod_orbits_read", reading(orbit), *t.shape, np.ascontiguousarray(t), out)
    return out


def judge(orbit: Any) -> tuple[Array, Array]:
    """Condition number and estimated error of B start problems from their orbits, (B,) each."""
    return _judge(orbit, held=False)


def response(orbit: Any) -> tuple[Array, Array]:
    """How B orbits whose beta(0) is held answer a change of beta(L), (B,) each.

    The largest |d beta(t)/d beta(L)| = |eta(t)/eta(L)|, the condition numbers of equilibria between given ends, and
    eta(L) = d beta(L)/d beta_t(0), NaN for a helix. eta is the Jacobi field, at the nodes of all panels that the rod
    passes, in its first period and in its last: between them eta grows evenly. At least 1; unbounded at a fold.
    """
    return _judge(orbit, held=True)


def _judge(orbit: Any, held: bool) -> tuple[Array, Array]:
    panels = orbit.panels
    errors = map(np.ascontiguousarray, (panels.fastest, panels.error, panels.time_error, panels.time_rounding))
    first, second = np.empty((2, orbit.problem.size))
    fine(run("rod_orbits_judge", *_problems(orbit), _PanelErrors(*errors), held, first, second))
    return first, second


def _problems(orbit: Any) -> tuple[Any, ...]:
    """The problems and their orbits as the first arguments of functions of conditioning.c."""
    numbers = numbers_of(orbit.problem)
    return len(numbers), numbers, reading(orbit), points(orbit.panels.series.shape[2] - 1)


def action(orbit: Any) -> Array:
    """The integral of beta_t^2 over B rods, (B,)."""
    out = np.empty(orbit.problem.size)
    run("rod_orbits_action", *_problems(orbit), out)
    return out


PAIRS = 10  # elements of M that are kept
_SUMS = PAIRS + 3  # with the integrals of sin, cos and sin cos of beta
_SERIES = 9 + _SUMS  # of a panel, one coefficient of all after the other
KEPT = ("least", "M", "jump", "closing", "series", "gain")


_VariedOrbits = structure("varied_orbits", (AT, " ".join(KEPT)), (INT, "lanes"))  # variations.h


def variations(orbit: Any) -> dict[str, Array]:
    """The arrays of `orbit.variations.Variations` by their names. orbit: B orbits, none of them a helix."""
    problem, n = orbit.problem, orbit.panels.series.shape[2] - 1
    P, B = orbit.panels.arc.size, problem.size
    loads = np.stack([problem.lam, problem.mu, problem.phi], axis=1)
    shapes = (P,), (P, PAIRS, n), (P, PAIRS), (2 * B, PAIRS)
    out = dict(zip(KEPT, map(np.empty, (*shapes, (P, n + 1, _SERIES), (B, 2, _SUMS))), strict=True))
    varied = _VariedOrbits(**out, lanes=widest())
    fine(run("rod_variations", B, loads, reading(orbit), points(n), varied))
    return out


def arguments_of(varied: Any) -> tuple[Any, Any]:
    """Orbits and their variations as arguments of the core. varied: `orbit.variations.Variations`."""
    return varied.reading, _VariedOrbits(**varied.kept, lanes=widest())


def changes(varied: Any, t: Array, parts: Array) -> Array:
    """The changes of varied orbits at t (B, n) by F directions with the parts (B, 5, F): (5, B, F, n), of beta, of
    beta_t and of the integrals of H_q d beta up to t."""
    (B, n), F = t.shape, parts.shape[2]
    out = np.empty((5, B, F, n))
    given = np.ascontiguousarray(t), np.ascontiguousarray(parts.swapaxes(1, 2))
    run("rod_variations_changes", *arguments_of(varied), B, n, F, *given, out)
    return out
