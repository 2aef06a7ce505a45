"""The arcs of an orbit, cut into monotone pieces of G, each with a variable in which time is smooth: eq. (36).

The arcs lead from the start forward and backward to the turning points. On each piece one change of variables makes
dt/du smooth however near a saddle the orbit passes: x = a sinh(u) over a saddle that the orbit passes, x = x1 cosh(u)
where it turns before the saddle, x = x1 sin(u) where it turns nearer the centre. x is the distance from that saddle or
centre. The core makes them (arcs.c), and cuts them into panels, on which beta and the developed curve are Chebyshev
series in time.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..numerics.arrays import Array, Columns, Integers
from ..problem.reduced import StartProblem

HELIX, LIBRATION, ROTATION = 0, 1, 2


@dataclass(frozen=True, eq=False)
class Arcs:
    """The arcs of B orbits. kind: (B,), HELIX, LIBRATION or ROTATION; direction: (B,), sign of beta_t after the start.

    A libration has a forward and a backward arc, from its start to the turning points; together they are half a period.
    A rotation has a forward arc only, one whole turn. A helix has none.
    """

    kind: Integers
    direction: Array


MOST = 10_000  # panels of one orbit beyond which none is halved any more


@dataclass(frozen=True, eq=False)
class Panels(Columns):
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

    @property
    @abstractmethod
    def kind(self) -> Integers:
        """HELIX, LIBRATION or ROTATION, (B,)."""

    @property
    @abstractmethod
    def ahead(self) -> Array:
        """Time from the start to the turning point ahead, or of a whole turn of a rotation, (B,)."""

    @property
    @abstractmethod
    def back(self) -> Array:
        """Time from the turning point behind to the start; 0 in a rotation, (B,)."""

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
