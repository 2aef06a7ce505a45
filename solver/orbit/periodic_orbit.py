"""Periodic orbits: the paper's quadrature (36) made exact, over half a period; the rest follows by symmetry.

The arcs of the orbit, from its start to the turning points (or once round), are cut into pieces on which time is a
smooth function of one variable u (`pieces`). On panels of these, short enough for a Chebyshev series to reach rounding
or the tolerance, t(u) is integrated and inverted, and beta, beta_t, alpha, z become series in t. Reflection at the
turning points and repetition give the rest, so a rod of a million bends costs as much as one of three. The series
converge geometrically; all problems are solved together.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..core import orbits as core
from ..core.library import Cutting, numbers_of
from ..numerics.arrays import Array, Integers
from ..problem.reduced import StartProblem
from ..problem.trajectory import PLAIN
from .pieces import Arcs, Panels, Periodic

TIGHT = 1e-13  # tolerance of orbits that are as exact as floats allow


@dataclass(frozen=True, eq=False)
class Orbit(Periodic):
    """The orbits of B problems, ready to be read anywhere along the rod.

    arcs, panels: see there. since: (P,), time from the start to each panel. first, count: (2 B,), the panels of each
    arc. duration: (2 B,), of each arc. gain: (2 B, 3), what alpha, z and the swirl gain over it.

    The rest is known of equilibria, and None for other orbits. lengthens: (B,), 1 where the length of the orbit between
    the two end angles grows with its level, 0 where it shrinks, NaN where that is unknown; the Morse index needs it.
    response: (B,), largest |d beta(t)/d beta(L)| along the rod. passed: (B,), turning points passed. path: the level
    and the path of each, `levels.transit_times.LevelPaths`.
    """

    problem: StartProblem
    arcs: Arcs
    panels: Panels
    since: Array
    first: Integers
    count: Integers
    duration: Array
    gain: Array
    lengthens: Array | None = None
    response: Array | None = None
    passed: Array | None = None
    path: Any = None

    @property
    def kind(self) -> Integers:
        return self.arcs.kind

    @property
    def ahead(self) -> Array:
        return self.duration[0::2]

    @property
    def back(self) -> Array:
        return self.duration[1::2]

    @cached_property
    def turns(self) -> Array:
        return self.far_end[0] if self.passed is None else self.passed

    @property
    def evaluations(self) -> Integers:
        """Evaluations of G for each orbit, (B,)."""
        calls = np.bincount(self.panels.arc // 2, weights=self.panels.calls, minlength=self.problem.size)
        return calls.astype(np.int64)

    def at(self, t: Array) -> tuple[Array, Array, Array, Array]:
        """beta, beta_t, alpha, z at t (B, n), each (B, n)."""
        beta, dbeta, alpha, z, _ = core.read(self, t)
        return beta, dbeta, alpha, z

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
        arcs = Arcs(self.arcs.kind[rows], self.arcs.direction[rows])
        panels = replace(self.panels.take(panel_rows), arc=np.repeat(np.arange(count.size), count))
        known = [None if v is None else v[rows] for v in (self.lengthens, self.response, self.passed)]
        known.append(None if self.path is None else self.path.take(rows))
        parts = self.problem.take(rows), arcs, panels, self.since[panel_rows], np.cumsum(count) - count, count
        return Orbit(*parts, self.duration[arc_rows], self.gain[arc_rows], *known)

    def swirl(self, t: Array) -> Array:
        """The integral of sin(beta) cos(beta) from the start, (B, n)."""
        swirl: Array = core.read(self, t)[4]
        return swirl

    @property
    def exact(self) -> "Orbit":
        """The orbits by quadrature, which the Morse index needs: these themselves."""
        return self


def solve_orbit(
    problem: StartProblem, tol: float, pin: tuple[Array, Array, Array] | None = None, stretch: float = 1.0
) -> Orbit:
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
    n, length = (16, 0.6) if tol >= 1e-6 else (22, 0.45)
    cutting = Cutting(length, 0.05 * tol, stretch)
    numbers, pinned = numbers_of(problem), None if pin is None else np.stack(pin, axis=1)

    def solve(rows: Any) -> core.FoundOrbits | None:
        pins = None if pinned is None else np.ascontiguousarray(pinned[rows])
        return core.orbits(np.ascontiguousarray(numbers[rows]), pins, n, cutting)

    answer = solve(slice(None))
    if answer is not None:
        return orbit_of(problem, answer)
    fit = np.array([solve(slice(b, b + 1)) is not None for b in range(problem.size)])
    numbers[~fit] = [PLAIN[name] for name in vars(problem)]
    if pinned is not None:
        pinned[~fit] = PLAIN["beta0"], 0.0, 0.0
    answer = solve(slice(None))
    assert answer is not None
    answer.series[~fit[answer.arc // 2]] = np.nan
    return orbit_of(problem, answer)


def orbit_of(problem: StartProblem, found: core.FoundOrbits) -> Orbit:
    """The orbits that the core made."""
    duration, base, origin, fastest, error, time_error, time_rounding = found.columns
    calls = np.where(fastest == 0, 0, 2 * (found.series.shape[2] - 1))  # a panel at rest costs nothing
    angles, errors = (base, origin), (fastest, error, time_error, time_rounding)
    panels = Panels(found.arc, duration, *angles, found.series, *errors, calls)
    arcs = Arcs(found.kind, found.direction)
    return Orbit(problem, arcs, panels, found.since, found.first, found.counts, found.duration, found.gain)
