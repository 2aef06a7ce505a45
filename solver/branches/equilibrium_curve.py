"""The equilibria of one path over a parameter p, as a curve of p, a coordinate of the path and what is not given."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from ..core import branch_calls as core
from ..core.tuning import AHEAD
from ..numerics.arrays import Array
from ..numerics.roots import solve
from ..orbits.boundary import Boundary, Path, boundary_of
from ..orbits.potential import load_size
from ..problem.dimensionless import EndsProblem
from .charts import Chart, charts, coordinate, path_at
from .family import Family
from .given_numbers import FREE, Given, move, problem_of, values_of
from .held_index import held_index
from .orbit_rates import NUMBERS, OrbitRates, orbit_rates


@dataclass(frozen=True, eq=False)
class EquilibriumCurve:
    """The zeros of the given numbers and the length less those of the path, in w = (x, p, unknowns) over their scales.

    The unknowns are `FREE`, those that are given too; under dead loads there are none, and the length is all that must
    vanish. loads: the scale of the loads. ahead: of p's scale, over which differences are taken.
    """

    family: Family
    chart: Chart
    loads: float
    ahead: float = AHEAD
    _rates: dict[bytes, OrbitRates] = field(default_factory=dict, repr=False)  # at the last w

    @property
    def unknowns(self) -> tuple[str, ...]:
        """Of `FREE`."""
        return () if self.family.is_dead else FREE

    @property
    def scales(self) -> Array:
        """Of x, p, and the two angles and the three loads."""
        return np.array([self.chart.scale, self.family.scale, *[1.0, 1.0, *[self.loads] * 3][: len(self.unknowns)]])

    def at(self, w: Array) -> tuple[Boundary, Path] | None:
        """The problem under dead loads and the path at w."""
        x, p = (w * self.scales)[:2].tolist()
        problem = None if self.family.is_dead else self._problem(w)
        boundary = self.family.boundary(p) if self.family.is_dead else None if problem is None else boundary_of(problem)
        path = None if boundary is None else path_at(boundary.problem, self.chart, x)
        return None if boundary is None or path is None or path.turns < 0 else (boundary, path)

    def _problem(self, w: Array) -> EndsProblem | None:
        """The problem under dead loads at w, with held ends."""
        _, p, *free = (w * self.scales).tolist()
        given = self.family.given(p)
        return None if given is None else problem_of(given, dict(zip(FREE, free, strict=True)))

    def _orbit(self, w: Array) -> OrbitRates | None:
        """The orbit at w with held ends."""
        at = self.at(w)
        return None if at is None else orbit_rates(at[0].problem, [at[1]])

    def value(self, w: Array) -> Array | None:
        """The equations at w, (6,), or (1,) under dead loads."""
        x, p = (w * self.scales)[:2].tolist()
        if self.family.is_dead:
            return self._excess(p, np.array([x]))
        rates, given = self._orbit(w), self.family.given(p)
        return None if rates is None or given is None else self._less(rates, given, w)

    def _excess(self, p: float, x: Array) -> Array | None:
        """The length of the path less that of the rod under dead loads, at each x."""
        return self.family.steps.excess(core.chart_of(self.chart), p, x)

    def _less(self, rates: OrbitRates, given: Given, w: Array) -> Array | None:
        """The numbers less the given ones; those that are unknowns and given are read from w."""
        numbers, length = rates.values[0], float(rates.length[0])
        off = values_of(numbers, length, given) - given.values
        free = w[2:] * self.scales[2:]
        for k, name in enumerate(given.names):
            if name in FREE:
                off[k] = free[FREE.index(name)] - given.values[k]
        off = np.append(off, length - given.span)
        return off if np.isfinite(off).all() else None

    def jacobian(self, w: Array) -> Array | None:
        """The derivatives, (6, 7), or (1, 2) under dead loads."""
        x, p = (w * self.scales)[:2].tolist()
        ahead = self.ahead * self.family.scale
        if self.family.is_dead:
            return self._differences(x, p, ahead)
        rates, given, beyond = self._orbit(w), self.family.given(p), self.family.given(p + ahead)
        if beyond is None:
            ahead = -ahead
            beyond = self.family.given(p + ahead)
        if rates is None or given is None or beyond is None:
            return None
        off, off_beyond = (self._less(rates, numbers_at, w) for numbers_at in (given, beyond))
        if off is None or off_beyond is None:
            return None
        answers = self._answers(rates, given, x)
        drift = (off_beyond - off) / ahead
        for k, name in enumerate(given.names):  # an unknown that is given follows p, whatever its place in w
            if name in FREE:
                column, others = 1 + FREE.index(name), np.arange(6) != k
                drift[others] -= answers[others, column] * drift[k]
                answers[others, column] = 0
        matrix = np.column_stack([answers[:, 0], drift, answers[:, 1:]]) * self.scales
        self._rates.clear()
        self._rates[w.tobytes()] = rates
        return matrix if np.isfinite(matrix).all() else None

    def _differences(self, x: float, p: float, ahead: float) -> Array | None:
        """The derivatives under dead loads: a rod may rest at both ends, where `orbit_rates` has none of its length."""
        nudge = self.chart.nudge
        off, beyond = self._excess(p, x + nudge * np.array([-1.0, 0.0, 1.0])), self._excess(p + ahead, np.array([x]))
        if beyond is None:
            ahead = -ahead
            beyond = self._excess(p + ahead, np.array([x]))
        if off is None or beyond is None:
            return None
        return np.array([[(off[2] - off[0]) / (2 * nudge), (beyond[0] - off[1]) / ahead]]) * self.scales

    def _answers(self, rates: OrbitRates, given: Given, x: float) -> Array:
        """The derivatives of the six equations by x and `FREE`, (6, 6)."""
        names = [NUMBERS.index(name) for name in FREE]
        (rows,), (by_span,) = rates.rows_of(given.names, given.ratio)
        known = np.column_stack([rates.rows[0], rates.by_span[0]])
        matrix = np.vstack([move(self.chart, x, known), known[names]])
        every = np.vstack([np.column_stack([rows, by_span]), np.eye(6)[5]])
        return np.asarray(every @ solve(matrix[None], np.eye(6)[None])[0])

    def index(self, w: Array, path: Path, jacobian: Array) -> int | None:
        """The Morse index under the ends that are meant; None where an eigenvalue is zero to rounding."""
        x, p = (w * self.scales)[:2].tolist()
        if self.family.is_dead:
            return _dead_index(self.chart, path, x, float(jacobian[0, 0]))
        given, rates = self.family.given(p), self._rates.get(w.tobytes())
        rates = self._orbit(w) if rates is None else rates
        assert given is not None
        assert rates is not None
        way = np.array([path.leaving]), np.array([path.turns])
        index = float(held_index(rates, np.array([given.ratio]), given.names, *way)[0])
        return int(index) if np.isfinite(index) else None


def curves_through(family: Family, path: Path, p: float) -> Iterator[tuple[EquilibriumCurve, Array]]:
    """The curve through an equilibrium at p in each of its coordinates, the best first, and its w."""
    boundary = family.boundary(p) if family.is_dead else boundary_of(family.begun)
    for chart in () if boundary is None else charts(boundary.problem, path):
        if boundary is not None and np.isfinite(coordinate(chart)):
            curve = EquilibriumCurve(family, chart, 1 + float(load_size(boundary.problem)[0]))
            free = [float(getattr(boundary.problem, name)[0]) for name in curve.unknowns]
            yield curve, np.array([coordinate(chart), p, *free]) / curve.scales


def _dead_index(chart: Chart, path: Path, x: float, rate: float) -> int:
    """The Morse index under dead loads at x, as in `periodic_orbit.jacobi_zeros`; rate: d length/dx."""
    lengthens = rate * (path.sign if chart.logarithmic else x) > 0
    return max(path.turns - int(lengthens), 0)
