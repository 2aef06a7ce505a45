"""What is given of one equilibrium, and how all its numbers answer a change of it, to first order.

Five numbers are given, among the end angles, their slopes, the displacements and the loads; dead loads give both angles
and all three loads. All derivatives are those of `orbit_rates`.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..numerics.arrays import Array
from ..numerics.roots import solve
from ..orbits.boundary import Path
from ..orbits.potential import TAU, load_size
from ..problem.dimensionless import EndsProblem, HeldProblem
from .charts import Chart
from .orbit_rates import NUMBERS, OrbitRates

FREE = ("beta0", "betaL", "lam", "mu", "phi")  # what a state consists of, beside its path
ANGLES, LOADS = FREE[:2], FREE[2:]  # of the ends; each load is one of the five parts itself
_AT = {name: k for k, name in enumerate(NUMBERS)}
_ODD = ({"alpha", "turn", "lam", "mu"}, {"z", "turn", "phi", "mu"})  # what beta -> -beta and beta -> pi - beta negate
_REVERSED = {"beta0": "betaL", "betaL": "beta0", "dbeta0": "dbetaL", "dbetaL": "dbeta0"}


@dataclass(frozen=True, eq=False)
class OrbitState:
    """One equilibrium under held ends: as an ends problem under dead loads, its path, and how its numbers answer.

    rates: of the problem and the path, or of a state that differs from it by a small correction. known_index,
    known_energy: Morse index under what its ends hold, and energy as of `path_orbits.energies`, of a shape on nodes.
    """

    problem: EndsProblem
    path: Path
    rates: OrbitRates
    known_index: int | None = None
    known_energy: float | None = None


@dataclass(frozen=True, eq=False)
class Given:
    """The five given numbers of one problem at a point of a line: their names and values (5,), L/rho, and A/C."""

    names: tuple[str, ...]
    values: Array
    span: float
    ratio: float

    @property
    def has_hinge(self) -> bool:
        """Whether an end moment is given."""
        return bool({"dbeta0", "dbetaL"} & {*self.names})

    def number(self, name: str, otherwise: float) -> float:
        """The value of a given number, or another one where it is not given."""
        return float(self.values[self.names.index(name)]) if name in self.names else otherwise

    @classmethod
    def dead(cls, problem: EndsProblem) -> "Given":
        """The end angles and the loads of one problem under dead loads."""
        values = np.array([float(getattr(problem, name)[0]) for name in FREE])
        return cls(FREE, values, float(problem.span[0]), np.nan)

    @classmethod
    def of(cls, problem: HeldProblem) -> "Given":
        """The given numbers of one held problem."""
        return cls(problem.numbers, problem.values[0], float(problem.span[0]), float(problem.ratio[0]))

    def at(self, state: OrbitState) -> "Given":
        """The numbers that are given, with the values that a state has."""
        length = float(state.rates.length[0])
        return replace(self, values=values_of(state.rates.values[0], length, self), span=length)

    def towards(self, other: "Given", share: float) -> "Given":
        """A share of the way to another problem."""
        if share >= 1:
            return other
        values, span, ratio = (
            (1 - share) * getattr(self, name) + share * getattr(other, name) for name in ("values", "span", "ratio")
        )
        return Given(self.names, values, span, ratio)


def problem_of(given: Given, numbers: dict[str, float]) -> EndsProblem:
    """The problem under dead loads of the given numbers, which count exactly, and of the others."""
    numbers = numbers | {name: float(v) for name, v in zip(given.names, given.values, strict=True) if name in FREE}
    return EndsProblem(**{name: np.array([v]) for name, v in numbers.items()}, span=np.array([given.span]))


def answer(rates: OrbitRates, given: Given, values: Array, span: Array) -> Array:
    """The changes of the `NUMBERS` by changes of the given numbers (5, k) and of the length (k,), (11, k)."""
    parts = parts_of(rates, given, values, span)
    with np.errstate(invalid="ignore", over="ignore"):
        return np.asarray(rates.rows[0] @ parts + rates.by_span[0][:, None] * span)


def parts_of(rates: OrbitRates, given: Given, values: Array, span: Array) -> Array:
    """The five parts of the changes of the orbit by the same changes, (5, k).

    The part of a load that is given is its change, exactly: along a rod that is long and rests near a helix, what a
    solve rounds off grows beyond all bounds.
    """
    rows, by_span = rates.rows_of(given.names, given.ratio)
    parts: Array = solve(rows, values - by_span[..., None] * span)[0]
    for name, change in zip(given.names, values, strict=True):
        if name in LOADS:
            parts[FREE.index(name)] = change
    return parts


def move(chart: Chart, x: float, change: Array) -> Array:
    """The changes of the coordinate of a chart, (...,), by changes of the `NUMBERS`, (11, ...), of a path with the pin
    of the chart."""
    if chart.kind == "saddle":
        return np.asarray(change[_AT["y"]])
    rate = np.asarray(change[_AT["dbetaL" if chart.kind == "end" else "dbeta0"]])
    if not chart.logarithmic:
        return rate
    direction = chart.at.leaving if chart.kind == "start" else chart.at.direction_at_end
    return 2 * rate / (direction * float(np.exp(x / 2)))


def size_of(problem: EndsProblem, chart: Chart, dx: float, change: Array) -> float:
    """The size of a change: about 1 where the orbit changes its form."""
    if not chart.scale > 0:  # the level is that of a saddle to rounding: every change is large
        return np.inf
    sizes, loads = [abs(dx) / chart.scale], 1 + float(load_size(problem)[0])
    sizes += [abs(float(change[_AT[name]])) / (1 if name in ANGLES else loads) for name in FREE]
    return max(sizes) if np.isfinite(sizes).all() else np.inf


def problem_after(problem: EndsProblem, given: Given, change: Array, factor: float = 1.0) -> EndsProblem:
    """The problem after a change; what is given is exactly what is given."""
    new = {name: getattr(problem, name) + factor * change[_AT[name]] for name in FREE}
    for name, value in zip(given.names, given.values, strict=True):
        if name in FREE:
            new[name] = np.array([value])
    return replace(problem, **new, span=np.array([given.span]))


def values_of(numbers: Array, length: float, given: Given) -> Array:
    """The given numbers of an equilibrium, (5,); numbers: the `NUMBERS`, (11,)."""
    turn = given.ratio * numbers[_AT["mu"]] * length - numbers[_AT["swirl"]]
    return np.array([turn if name == "turn" else numbers[_AT[name]] for name in given.names])


@dataclass(frozen=True)
class Mirror:
    """Whether beta becomes -beta, whether then pi - beta, whether the rod is run through from its far end; then whole
    turns are added to beta."""

    negated: bool
    turned: bool
    backward: bool
    whole_turns: int = 0

    @property
    def direction(self) -> int:
        """The sign by which beta, but for a constant, is multiplied."""
        return -1 if self.negated != self.turned else 1

    def angle(self, beta: Any) -> Any:
        """The image of an angle, or of several."""
        beta = -beta if self.negated else beta
        return (np.pi - beta if self.turned else beta) + TAU * self.whole_turns

    def number(self, name: str, value: float) -> tuple[str, float]:
        """The image of one of the numbers: its name and value."""
        to = _REVERSED.get(name, name) if self.backward else name
        if name in ("beta0", "betaL"):
            return to, self.angle(value)
        if name in ("dbeta0", "dbetaL"):
            return to, self.direction * (-value if self.backward else value)
        odd = sum(on and name in signs for on, signs in zip((self.negated, self.turned), _ODD, strict=True))
        return to, -value if odd == 1 else value
