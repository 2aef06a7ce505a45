"""The equilibria of one path over a parameter p, as a curve in the plane of p and a coordinate of the level."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from ..core import branches as core
from ..equilibrium.charts import Chart, charts, coordinate, excess, path_at
from ..levels.line_point import LinePoint, Path
from ..levels.transit_times import CUTTING, NODES
from ..numerics.arrays import Array
from ..orbit.critical_points import grid
from ..problem.reduced import EndsProblem

_NUDGE = 1e-5  # of the unknown's scale, for differences
AHEAD = 1e-6  # of the parameter's scale, for differences
_KEPT = 6  # problems kept, as one is needed several times in a step


@dataclass(frozen=True, eq=False)
class Family:
    """Ends problems (of size 1) over one parameter p; None from `problem`: there is none.

    scale: the change of p over which the problem changes. numbers: lam, mu, phi, span, beta(0) and beta(L) of the same
    problems; the compiled core needs them.
    """

    problem: Callable[[float], EndsProblem | None]
    scale: float
    numbers: Callable[[float], Sequence[float] | None] | None = None
    _known: dict[float, LinePoint | None] = field(default_factory=dict, repr=False)  # the last few

    @cached_property
    def steps(self) -> core.Steps | None:
        """The core's functions on these problems; None without `numbers`."""
        if self.numbers is None:
            return None
        return core.Steps(self.numbers, self.scale, grid(), NODES, (CUTTING, CUTTING))

    def place(self, p: float) -> LinePoint | None:
        """The problem at p with its critical points."""
        if p not in self._known:
            problem = self.problem(p)
            while len(self._known) >= _KEPT:
                del self._known[next(iter(self._known))]
            self._known[p] = None if problem is None else LinePoint(problem)
        return self._known[p]

    def start(self, path: Path, p: float) -> "tuple[EquilibriumCurve, Array] | None":
        """The curve through an equilibrium at p, in its best coordinate, and its w."""
        place = self.place(p)
        if place is None:
            return None
        curve = EquilibriumCurve(self, charts(place, path)[0])
        return curve, np.array([coordinate(curve.chart), p]) / curve.scales


def scale_of(problem: Callable[[float], EndsProblem | None], p: float, reach: float) -> float:
    """The change of p over which a number of the problem changes by about itself or by one; at most `reach`."""
    nudge = 1e-6 * min(reach, max(abs(p), 1e-3 * reach))
    sides = [one for one in (problem(p + nudge), problem(p - nudge)) if one is not None]
    here = problem(p)
    assert here is not None
    if not sides:
        return reach
    numbers, moved = (np.concatenate(list(vars(one).values())) for one in (here, sides[0]))
    rate = float((np.abs(moved - numbers) / nudge / (1 + np.abs(numbers))).max())
    return reach if rate * reach < 1 else 1 / rate


@dataclass(frozen=True, eq=False)
class EquilibriumCurve:
    """The zeros of length(x, p) less the rod's, in w = (x, p) over their scales.

    ahead: of p's scale, over which differences are taken.
    """

    family: Family
    chart: Chart
    ahead: float = AHEAD

    @property
    def scales(self) -> Array:
        """Of x and p."""
        return np.array([self.chart.scale, self.family.scale])

    def at(self, w: Array) -> tuple[LinePoint, Path] | None:
        """The problem and the path at w."""
        x, p = w * self.scales
        place = self.family.place(float(p))
        path = None if place is None else path_at(place, self.chart, float(x))
        return None if place is None or path is None or path.turns < 0 else (place, path)

    def value(self, w: Array) -> Array | None:
        """The excess of length, (1,)."""
        x, p = w * self.scales
        return self._excess(float(p), np.array([x]))

    def jacobian(self, w: Array) -> Array | None:
        """Its derivatives, (1, 2), by differences."""
        x, p = w * self.scales
        nudge, ahead = _NUDGE * self.chart.scale, self.ahead * self.family.scale
        off = self._excess(float(p), x + nudge * np.array([-1.0, 0.0, 1.0]))
        beyond = self._excess(float(p) + ahead, np.array([x]))
        if beyond is None:
            ahead = -ahead
            beyond = self._excess(float(p) + ahead, np.array([x]))
        if off is None or beyond is None:
            return None
        rates = np.array([(off[2] - off[0]) / (2 * nudge), (beyond[0] - off[1]) / ahead])
        return np.asarray(rates * self.scales)[None]

    def _excess(self, p: float, x: Array) -> Array | None:
        if self.family.steps is not None:
            found = self.family.steps.excess(core.chart_of(self.chart), p, x)
            if found is not None:
                return found
        place = self.family.place(p)
        if place is None:
            return None
        off = excess(place, self.chart, x)
        return off if np.isfinite(off).all() else None

    def index(self, w: Array, path: Path, jacobian: Array) -> int | None:
        """The Morse index under dead loads."""
        return index_of(self.chart, path, float(w[0] * self.chart.scale), float(jacobian[0, 0]))


def index_of(chart: Chart, path: Path, x: float, rate: float) -> int:
    """The Morse index under dead loads at x, as in `morse_index.jacobi_zeros`; rate: d length/dx."""
    lengthens = rate * (path.sign if chart.logarithmic else x) > 0
    return max(path.turns - int(lengthens), 0)
