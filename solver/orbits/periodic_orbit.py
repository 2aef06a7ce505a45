"""Periodic orbits: the paper's quadrature (36) made exact, over half a period; the rest follows by symmetry.

The arcs of the orbit, from its start to the turning points (or once round), are cut into pieces on which time is a
smooth function of one variable u, however near a saddle the orbit passes: x = a sinh(u) over a saddle that the orbit
passes, x = x1 cosh(u) where it turns before the saddle, x = x1 sin(u) where it turns nearer the centre; x is the
distance from that saddle or centre. On panels of these, short enough for a Chebyshev series to reach rounding or the
tolerance, t(u) is integrated and inverted, and beta, beta_t, alpha, z become series in t (`arcs.c`, `panels.c`,
`orbits.c`). Reflection at the turning points and repetition give the rest, so a rod of a million bends costs as much as
one of three. The series converge geometrically; all problems are solved together.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..core.library import AT, CURVES, INT, Cutting, cut, fine, numbers_of, on_grid, points, run, structure, widest
from ..numerics.arrays import Array, Columns, Integers
from ..problem.dimensionless import StartProblem
from ..problem.trajectory import PLAIN, stood_in
from .potential import slope_rate

HELIX, LIBRATION, ROTATION = 0, 1, 2
# tolerance of orbits that are as exact as floats allow. x10: a digit less where derivatives are taken of them
TIGHT = 1e-13
# The levels of B orbits: the angles above whose heights of G they lie, the gaps, and by how much the logs of the true
# gaps are smaller, (B,) each
Pin = tuple[Array, Array, Array]

_ReadOrbits = structure("read_orbits", "orbit_parts.h")
_PanelArrays = structure("panel_arrays", "orbit_parts.h")
_Covered = structure("covered", "orbit_parts.h")
_PanelErrors = structure("panel_errors", "orbit_errors.c")


@dataclass(frozen=True, eq=False)
class _Panels(Columns):
    """P panels, in order of arc and of time away from the start.

    arc: (P,), 2 b for the forward arc of problem b, 2 b + 1 for the backward one. duration: (P,). base: (P,), the angle
    of a critical point, with whole turns, from which beta counts on the panel: next to it beta has relative accuracy.
    origin: (P,), the same in [-pi, pi). series: (P, 5, n + 1), of beta - base, |beta_t|, alpha, z and the swirl (the
    integral of sin cos), the last three from the start of the arc. fastest: (P,), largest |beta_t|, 0 on panels at
    rest. error: (P,), what the truncated series leave out of beta. time_error: (P,), what they leave out of the
    duration, as a share of it. time_rounding: (P,), what the rounding of G changes of the duration, as a share. calls:
    (P,), evaluations of G.
    """

    arc: Integers
    duration: Array
    base: Array
    origin: Array
    series: Array
    fastest: Array
    error: Array
    time_error: Array
    time_rounding: Array
    calls: Integers


class Periodic(ABC):
    """The orbits of B problems, however they are computed: what they repeat, and where the far ends of the rods lie."""

    problem: StartProblem
    kind: Any  # HELIX, LIBRATION or ROTATION, (B,)

    @property
    @abstractmethod
    def ahead(self) -> Array:
        """Time from the start to the turning point ahead, or of a whole turn of a rotation, (B,)."""

    @property
    @abstractmethod
    def back(self) -> Array:
        """Time from the turning point behind to the start; 0 in a rotation, (B,)."""

    @abstractmethod
    def at(self, t: Array) -> tuple[Array, Array, Array, Array]:
        """beta, beta_t, alpha, z at t (B, n), each (B, n)."""

    @cached_property
    def far_angle(self) -> Array:
        """beta at the far ends of the rods, (B,)."""
        return self.at(self.problem.span[:, None])[0][:, 0]

    @cached_property
    def period(self) -> Array:
        """Period of beta_t, (B,); inf on a helix."""
        arcs = np.where(self.kind == LIBRATION, 2.0, 1.0)
        return np.where(self.kind == HELIX, np.inf, arcs * (self.ahead + self.back))

    @cached_property
    def turns(self) -> Array:
        """Turning points passed by the far end, (B,); 0 where beta does not librate."""
        return self.far_end[0]

    @cached_property
    def far_end(self) -> tuple[Array, Array]:
        """Turning points passed by the far end, and the time since the last, (B,) each; 0 and inf without any.

        The time is inf too where the far end lies beyond the start again, on the way to the next turning point.
        """
        span, period, librates = self.problem.span, self.period, self.kind == LIBRATION
        with np.errstate(invalid="ignore"):
            rest = np.where(np.isfinite(period), np.fmod(span, period), span)
            periods = np.where(np.isfinite(period), np.round((span - rest) / period), 0.0)
        second = librates & (rest > 2 * self.ahead)  # beyond the start again, on the way to the turning point behind it
        time, limit = np.where(second, rest - 2 * self.ahead, rest), np.where(second, self.back, self.ahead)
        returns = librates & (time > limit)
        turns = np.where(librates, 2 * periods + second + returns, 0.0)
        return turns, np.where(returns, limit - np.maximum(2 * limit - time, 0), np.inf)


@dataclass(frozen=True, eq=False)
class Orbit(Periodic):
    """The orbits of B problems, ready to be read anywhere along the rod.

    kind: (B,), HELIX, LIBRATION or ROTATION. direction: (B,), sign of beta_t after the start. panels: see there. since:
    (P,), time from the start to each panel. first, count: (2 B,), the panels of each arc. duration: (2 B,), of each
    arc. gain: (2 B, 3), what alpha, z and the swirl gain over it. A libration has a forward and a backward arc, from
    its start to the turning points; together they are half a period. A rotation has a forward arc only, one whole turn.
    A helix has none.

    The rest is known of equilibria, and None for other orbits. lengthens: (B,), 1 where the length of the orbit between
    the two end angles grows with its level, 0 where it shrinks, NaN where that is unknown; the Morse index needs it.
    response: (B,), largest |d beta(t)/d beta(L)| along the rod. paths: `boundary.Paths`.
    """

    problem: StartProblem
    kind: Integers
    direction: Array
    panels: _Panels
    since: Array
    first: Integers
    count: Integers
    duration: Array
    gain: Array
    lengthens: Array | None = None
    response: Array | None = None
    paths: Any = None

    @property
    def ahead(self) -> Array:
        return self.duration[0::2]

    @property
    def back(self) -> Array:
        return self.duration[1::2]

    @cached_property
    def turns(self) -> Array:
        return self.far_end[0] if self.paths is None else np.asarray(self.paths.turns, float)

    @property
    def evaluations(self) -> Integers:
        """Evaluations of G for each orbit, (B,)."""
        calls = np.bincount(self.panels.arc // 2, weights=self.panels.calls, minlength=self.problem.size)
        return calls.astype(np.int64)

    @property
    def fastest(self) -> Array:
        """The largest |beta_t| along each orbit, (B,)."""
        fastest = np.zeros(self.problem.size)
        np.maximum.at(fastest, self.panels.arc // 2, self.panels.fastest)
        return fastest

    def at(self, t: Array) -> tuple[Array, Array, Array, Array]:
        """beta, beta_t, alpha, z at t (B, n), each (B, n)."""
        beta, dbeta, alpha, z, _ = self._read(t)
        return beta, dbeta, alpha, z

    def _read(self, t: Array) -> Array:
        """beta, beta_t, alpha, z and the swirl at t (B, n), (5, B, n)."""
        out = np.empty((CURVES, *t.shape))
        run("rod_orbits_read", as_core_orbits(self), *t.shape, np.ascontiguousarray(t), out)
        return out

    def take(self, rows: Integers | slice) -> "Orbit":
        """The orbits of some problems: of a slice as views, or of numbers (b,) that rise."""
        arc_rows: Any
        panel_rows: Any
        if isinstance(rows, slice):
            arc_rows = slice(2 * rows.start, 2 * rows.stop)
            begin, count = self.first[arc_rows], self.count[arc_rows]
            panel_rows = slice(begin[0], begin[0] + count.sum())
        else:
            arc_rows = (2 * rows[:, None] + [0, 1]).reshape(-1)
            begin, count = self.first[arc_rows], self.count[arc_rows]
            panel_rows = np.repeat(begin - np.cumsum(count) + count, count) + np.arange(count.sum())
        panels = replace(self.panels.take(panel_rows), arc=np.repeat(np.arange(count.size), count))
        known = [None if v is None else v[rows] for v in (self.lengthens, self.response)]
        known.append(None if self.paths is None else self.paths.take(rows))
        arcs = self.kind[rows], self.direction[rows]
        parts = self.problem.take(rows), *arcs, panels, self.since[panel_rows], np.cumsum(count) - count, count
        return Orbit(*parts, self.duration[arc_rows], self.gain[arc_rows], *known)

    def swirl(self, t: Array) -> Array:
        """The integral of sin(beta) cos(beta) from the start, (B, n)."""
        swirl: Array = self._read(t)[4]
        return swirl

    @property
    def exact(self) -> "Orbit":
        """The orbits by quadrature, which the Morse index needs: these themselves."""
        return self


def solve_orbit(problem: StartProblem, tol: float, pin: Pin | None = None, stretch: float = 1.0) -> Orbit:
    """The orbits of B start problems; those of a problem that is not finite, which the core refuses, are NaN.

    Parameters
    ----------
    problem : StartProblem
        B start problems.
    tol : float
        Allowed error of beta [rad].
    pin : tuple of arrays (B,), optional
        Angles from which the levels are measured, the heights of the levels above G there, and by how much the logs of
        the true heights are smaller: the orbits stay longer at these saddles. Default: those of the start.
    stretch : float
        A factor of the panels along saddles.
    """
    n, length = (16, 0.6) if tol >= 1e-6 else (24, 0.45)
    cutting = Cutting(length, 0.05 * tol, stretch)
    pinned = None if pin is None else np.stack(pin, axis=1)
    orbit = orbits_of(problem, pinned, n, cutting)
    if orbit is not None:
        return orbit
    rows = [slice(b, b + 1) for b in range(problem.size)]
    singles = [orbits_of(problem.take(row), None if pinned is None else pinned[row], n, cutting) for row in rows]
    fit = np.array([single is not None for single in singles])
    if pinned is not None:
        pinned = np.where(fit[:, None], pinned, [PLAIN["beta0"], 0.0, 0.0])
    orbit = orbits_of(stood_in(problem, fit), pinned, n, cutting)
    assert orbit is not None
    orbit.panels.series[~fit[orbit.panels.arc // 2]] = np.nan
    return replace(orbit, problem=problem)


def orbits_of(problem: StartProblem, pinned: Array | None, n: int, cutting: Cutting) -> Orbit | None:
    """The orbits of B start problems by the core.

    Parameters
    ----------
    problem : StartProblem
    pinned : (B, 3), or None
        `pin` of `solve_orbit` as columns.
    n : int
        Nodes of a panel.
    cutting : Cutting

    Returns
    -------
    Orbit or None
        None where a number is not finite, or critical points could not be told apart.
    """
    B = problem.size
    kind, direction, sizes = np.empty(B, np.int64), np.empty(B), np.empty(2, np.int64)
    task = B, numbers_of(problem), pinned, on_grid(), points(n), cut(cutting, CURVES)
    handle = run("rod_orbits", *task, kind, direction, sizes, result=AT)
    P, status = sizes.tolist()
    if handle is None:
        fine(status)
        return None
    arc, columns, series = np.empty(P, np.int64), np.empty((7, P)), np.empty((P, CURVES, n + 1))
    first, count = np.empty((2, 2 * B), np.int64)
    sums = np.empty(P), first, count, np.empty(2 * B), np.empty((2 * B, 3))
    run("rod_orbits_fetch", handle, _PanelArrays(P, arc, columns, series), *sums)
    duration, base, origin, fastest, error, time_error, time_rounding = columns
    calls = np.where(fastest == 0, 0, 2 * n)  # a panel at rest costs nothing
    panels = _Panels(arc, duration, base, origin, series, fastest, error, time_error, time_rounding, calls)
    return Orbit(problem, kind, direction, panels, *sums)


def as_core_orbits(orbit: Orbit) -> Any:
    """The orbits as the core reads them."""
    panels = orbit.panels
    arrays = (
        orbit.kind, orbit.first, orbit.count, orbit.problem.beta0, orbit.direction, orbit.duration, orbit.gain,
        orbit.since, panels.duration, panels.base, panels.origin, panels.series,
    )  # fmt: skip
    return _ReadOrbits(panels.series.shape[2], panels.arc.size, *arrays)


def cover(
    span: Array, kind: Integers, first: Integers, count: Integers, duration: Array, since: Array, width: Array
) -> tuple[Integers, Integers, Array, Array, Array, Array, Array]:
    """The pieces that B rods cover of their orbits: the columns of `observe.solution_pieces.Pieces`, (Q,) each.

    Parameters
    ----------
    span, kind : (B,)
        The lengths in t, and the kinds of the orbits.
    first, count, duration : (2 B,)
        Of the arcs: their first panels, the numbers of these, and how long they last.
    since, width : (P,)
        Of the panels: the time from the start, and how long they last.
    """
    of, row = np.empty((2, 3 * since.size), dtype=np.int64)
    numbers, span = np.empty((5, 3 * since.size)), np.ascontiguousarray(span, dtype=float)
    orbit = _ReadOrbits(kind=kind, first=first, count=count, duration=duration, since=since, width=width)
    size = run("rod_cover", orbit, span.size, span, _Covered(of, row, *numbers), result=INT)
    return of[:size], row[:size], *numbers[:, :size]


def judge(orbit: Orbit) -> tuple[Array, Array]:
    """Condition number and estimated error of B start problems from their orbits, (B,) each."""
    return _judge(orbit, held=False)


def response(orbit: Orbit) -> tuple[Array, Array]:
    """How B orbits whose beta(0) is held answer a change of beta(L), (B,) each.

    The largest |d beta(t)/d beta(L)| = |eta(t)/eta(L)|, the condition numbers of equilibria between given ends, and
    eta(L) = d beta(L)/d beta_t(0), NaN for a helix. eta is the Jacobi field, at the nodes of all panels that the rod
    passes, in its first period and in its last: between them eta grows evenly. At least 1; unbounded at a fold.
    """
    return _judge(orbit, held=True)


def _judge(orbit: Orbit, held: bool) -> tuple[Array, Array]:
    panels = orbit.panels
    errors = _PanelErrors(panels.fastest, panels.error, panels.time_error, panels.time_rounding)
    first, second = np.empty((2, orbit.problem.size))
    fine(run("rod_orbits_judge", *_problems(orbit), errors, held, widest(), first, second))
    return first, second


def _problems(orbit: Orbit) -> tuple[Any, ...]:
    """The problems and their orbits as the first arguments of functions of orbit_errors.c."""
    numbers = numbers_of(orbit.problem)
    return len(numbers), numbers, as_core_orbits(orbit), points(orbit.panels.series.shape[2] - 1)


def action(orbit: Orbit) -> Array:
    """The integral of beta_t^2 over B rods, (B,)."""
    out = np.empty(orbit.problem.size)
    run("rod_orbits_action", *_problems(orbit), out)
    return out


def helix_half_waves(problem: Any) -> Array:
    """r L/pi of helices of the angle beta(0), (B,), with r^2 = H'; 0 about a saddle."""
    return np.asarray(np.sqrt(np.maximum(slope_rate(problem, problem.beta0), 0)) * problem.span / np.pi)


def helix_index(half_waves: Array) -> Array:
    """The Morse index of helices between their end angles: how many whole numbers are below r L/pi, (B,)."""
    return np.maximum(np.ceil(half_waves * (1 - 1e-12)) - 1, 0)


def jacobi_zeros(orbit: Orbit) -> Array:
    """The Morse index of B orbits as the number of zeros of the Jacobi field inside (0, L).

    The Jacobi field solves eta'' + H'(beta) eta = 0, eta(0) = 0, eta'(0) = 1. beta_t solves the same equation, so by
    Sturm eta has one zero between each two zeros of beta_t, the turning points. Whether another follows the last of
    them is given by the sign of eta(L) = d beta(L)/d beta_t(0), which is that of -2 beta_t(0) beta_t(L) dT/d(level), T
    being the length of the orbit between the two angles. So the index is exact however long the rod and however
    closely it passes a saddle. The search for equilibria knows the sign of dT/d(level) (`Orbit.lengthens`); for other
    orbits the core gives that of eta(L).

    Returns
    -------
    array (B,)
        The Morse index as floats; NaN where a float cannot hold what decides it.
    """
    problem, turns = orbit.problem, orbit.turns
    librates = orbit.kind == LIBRATION
    shorter = np.full(problem.size, np.nan) if orbit.lengthens is None else 1 - orbit.lengthens
    if np.isnan(shorter[librates]).any():
        end = np.where(turns % 2 == 0, 1, -1) * response(orbit)[1]
        shorter = np.where(np.isnan(shorter), np.where(np.isnan(end), np.nan, end > 0), shorter)
    with np.errstate(invalid="ignore"):
        of_helix = helix_index(helix_half_waves(problem))
    at_rest = orbit.back == 0  # eta is beta_t itself
    index = np.maximum(turns - 1 + np.where(at_rest, 1, shorter), 0)
    return np.where(orbit.kind == HELIX, of_helix, np.where(librates, index, 0))
