"""Equilibria with held ends over a parameter, as a curve of a coordinate of the path, of angles and of loads."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from ..core import branches as core
from ..equilibrium.charts import CORNER, Chart, charts, coordinate, path_at
from ..equilibrium.held_index import held_index
from ..equilibrium.orbit_rates import HOW, NUMBERS, OrbitRates, orbit_numbers, solve, start_rates
from ..equilibrium.system import FREE, Given, State, corner_state, is_hinged, rates_in, rows_of, values_of
from ..levels.line_point import LinePoint, Path
from ..mechanics.potential import load_size
from ..numerics.arrays import Array
from ..orbit.critical_points import grid
from ..orbit.variations import POINTS
from ..problem.reduced import EndsProblem
from .equilibrium_curve import AHEAD

_FAR = FREE.index("betaL")
_ROUNDING = 1e-12  # of beta_t


@dataclass(frozen=True, eq=False)
class HeldFamily:
    """The given numbers over one parameter p, and one equilibrium, as a problem under dead loads, to begin from.

    given: of p, None where there is no such problem. scale: the change of p over which the problem changes. names: of
    the given numbers. numbers: their values, span and A/C at p; the compiled core needs them.
    """

    given: Callable[[float], Given | None]
    begun: EndsProblem
    scale: float
    names: tuple[str, ...] = ()
    numbers: Callable[[float], Sequence[float] | None] | None = None

    @property
    def hinged(self) -> bool:
        """Whether an end moment is given."""
        return is_hinged(self.names)

    @cached_property
    def steps(self) -> core.Steps | None:
        """The core's functions on these problems; None without `numbers`, and for hinged rods:
        the core knows no corners."""
        if self.numbers is None or self.hinged:
            return None
        held = tuple((*NUMBERS, "turn").index(name) for name in self.names)
        return core.Steps(self.numbers, self.scale, grid(), POINTS, HOW, held)

    def start(self, path: Path, p: float) -> "tuple[HeldCurve, Array] | None":
        """The curve through the equilibrium to begin from, which is that at p, and its w."""
        place = LinePoint(self.begun)
        chart = charts(place, path, self.hinged)[0]
        if not np.isfinite(coordinate(chart)):
            return None
        curve = HeldCurve(self, chart, 1 + float(load_size(self.begun)[0]))
        free = [float(getattr(self.begun, name)[0]) for name in FREE]
        return curve, np.array([coordinate(chart), p, *free]) / curve.scales


@dataclass(frozen=True, eq=False)
class HeldCurve:
    """The zeros of the given numbers and the length less those of the path, in w = (x, p, `FREE`) over their scales.

    loads: the scale of the loads. ahead: of p's scale, over which differences are taken.
    """

    family: HeldFamily
    chart: Chart
    loads: float
    ahead: float = AHEAD
    _rates: dict[bytes, OrbitRates] = field(default_factory=dict, repr=False)  # at the last w

    @property
    def scales(self) -> Array:
        """Of x, p, the two angles and the three loads."""
        return np.array([self.chart.scale, self.family.scale, 1.0, 1.0, *[self.loads] * 3])

    def at(self, w: Array) -> tuple[LinePoint, Path] | None:
        """The problem under dead loads and the path at w."""
        x, p, *free = w * self.scales
        given = self.family.given(float(p))
        if given is None:
            return None
        numbers = {name: np.array([value]) for name, value in zip(FREE, free, strict=True)}
        for name, value in zip(given.names, given.values, strict=True):
            if name in FREE:  # exactly as given
                numbers[name] = np.array([value])
        problem = EndsProblem(**numbers, span=np.array([given.span]))
        if self.chart.kind == CORNER:
            rest = given.number("dbeta0", float(x))  # what is given, but for rounding
            state = self._corner(problem, rest if abs(rest - x) < _ROUNDING * self.loads else float(x))
            return None if state is None else (LinePoint(state.problem), state.path)
        place = LinePoint(problem)
        path = path_at(place, self.chart, float(x))
        return None if path is None or path.turns < 0 else (place, path)

    def _corner(self, problem: EndsProblem, x: float) -> State | None:
        """The orbit that starts with beta_t = x, whatever its angle at the far end."""
        rates = start_rates(problem.started(np.array([x])))
        return corner_state(rates, x) if np.isfinite(rates.rows[0, :-1]).all() else None

    def value(self, w: Array) -> Array | None:
        """The numbers and the length of the path less the given ones, (6,)."""
        at, given = self.at(w), self.family.given(float(w[1] * self.scales[1]))
        if at is None or given is None:
            return None
        if self.chart.kind == CORNER:
            rates = start_rates(at[0].problem.started(w[:1] * self.scales[:1]))
            return self._less(rates.values[0], given.span, given, w)
        numbers, length = orbit_numbers(at[0].problem, at[1])
        return self._less(numbers, length, given, w)

    def _less(self, numbers: Array, length: float, given: Given, w: Array) -> Array | None:
        """The numbers less the given ones; those that are unknowns and given are read from w."""
        off = values_of(numbers, length, given) - given.values
        free = w[2:] * self.scales[2:]
        for k, name in enumerate(given.names):
            if name in FREE:
                off[k] = free[FREE.index(name)] - given.values[k]
        corner = self.chart.kind == CORNER
        off = np.append(off, free[_FAR] - numbers[NUMBERS.index("betaL")] if corner else length - given.span)
        return off if np.isfinite(off).all() else None

    def jacobian(self, w: Array) -> Array | None:
        """The derivatives, (6, 7)."""
        at, p = self.at(w), float(w[1] * self.scales[1])
        given, ahead = self.family.given(p), self.ahead * self.family.scale
        beyond = self.family.given(p + ahead)
        if beyond is None:
            ahead = -ahead
            beyond = self.family.given(p + ahead)
        if at is None or given is None or beyond is None:
            return None
        rates = rates_in(*(at[0].problem, at[1]), self.chart, float(w[0] * self.scales[0]))
        numbers, length = rates.values[0], float(rates.length[0])
        here, there = (self._less(numbers, length, one, w) for one in (given, beyond))
        if here is None or there is None:
            return None
        answers, by_span = self._answers(rates, given, float(w[0] * self.scales[0]))
        drift = (there - here + by_span * (beyond.span - given.span)) / ahead
        for k, name in enumerate(given.names):  # an unknown that is given follows p, whatever its place in w
            if name in FREE and not (name == "betaL" and self.chart.kind == CORNER):
                own, others = 1 + FREE.index(name), np.arange(6) != k
                drift[others] -= answers[others, own] * drift[k]
                answers[others, own] = 0
        found = np.column_stack([answers[:, 0], drift, answers[:, 1:]]) * self.scales
        self._rates.clear()
        self._rates[w.tobytes()] = rates
        return found if np.isfinite(found).all() else None

    def _answers(self, rates: OrbitRates, given: Given, x: float) -> tuple[Array, Array]:
        """The derivatives of the six equations by x and `FREE`, (6, 6), and what a unit of the length adds, (6,)."""
        names = [NUMBERS.index(name) for name in FREE]
        rows, by_span = rows_of(rates, given.names, given.ratio)
        known = np.column_stack([rates.rows[0], rates.by_span[0]])
        if self.chart.kind != CORNER:
            matrix = np.vstack([self._row(known, x), known[names]])
            every = np.vstack([np.column_stack([rows, by_span]), np.eye(6)[5]])
            return every @ solve(matrix[None], np.eye(6)[None])[0], np.zeros(6)
        far, start = names[_FAR], [k for k in (0, *range(1, 6)) if k != 1 + _FAR]  # the orbit knows no beta(L)
        parts = np.zeros((5, 6))
        matrix = np.vstack([self._row(known, x), known[names]])[start, :5]
        parts[:, start] = solve(matrix[None], np.eye(5)[None])[0]
        every = np.vstack([rows @ parts, np.eye(6)[1 + _FAR] - rates.rows[0, far] @ parts])
        return every, np.append(by_span, -rates.by_span[0, far])

    def _row(self, known: Array, x: float) -> Array:
        """What the parts of a change of the orbit, and a change of its length, add to the coordinate."""
        if self.chart.kind == "saddle":
            return np.asarray(known[NUMBERS.index("y")])
        rate = known[NUMBERS.index("dbetaL" if self.chart.kind == "end" else "dbeta0")]
        if not self.chart.logarithmic:
            return np.asarray(rate)
        direction = self.chart.at.leaving if self.chart.kind == "start" else self.chart.at.arriving
        return np.asarray(2 * rate / (direction * float(np.exp(x / 2))))

    def index(self, w: Array, path: Path, _: Array) -> int | None:
        """The Morse index under the ends that are meant; None where an eigenvalue is zero to rounding."""
        given = self.family.given(float(w[1] * self.scales[1]))
        rates = self._rates.get(w.tobytes())
        if rates is None:
            at = self.at(w)
            assert at is not None
            rates = rates_in(*(at[0].problem, at[1]), self.chart, float(w[0] * self.scales[0]))
        assert given is not None
        way = np.array([path.leaving]), np.array([path.turns])
        index = float(held_index(rates, np.array([given.ratio]), given.names, *way)[0])
        return int(index) if np.isfinite(index) else None
