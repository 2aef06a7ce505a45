"""The equations of one equilibrium with held ends: the level of its orbit, its loads and its end angles together.

The unknowns are a coordinate of the path (`charts.Chart`), the three loads and the two end angles. The
equations are the five given numbers and the length. All derivatives are those of `orbit_rates`, so the system is
regular wherever the problem with these ends has no fold, at folds under dead loads too.
"""

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np

from ..levels.line_point import LinePoint, Path
from ..levels.transit_times import DOWN, UP
from ..mechanics.potential import load_size, slope, steepest
from ..numerics.arrays import EPS, Array
from ..numerics.roots import DIVERGED, Ending, newton, solve
from ..orbit.periodic_orbit import TIGHT, solve_orbit
from ..problem.held_ends import HeldProblem
from ..problem.reduced import EndsProblem
from .charts import CORNER, Chart, charts, coordinate, path_at
from .orbit_rates import NUMBERS, OrbitRates, orbit_numbers, orbit_rates, start_rates

FREE = ("beta0", "betaL", "lam", "mu", "phi")  # what a state consists of, beside its path
LEFT = "no orbit of its path joins the two ends there"
REACH = 0.25  # largest size of a change in one step
_LEAST = 9 * EPS  # share by which rounding may change an angle, or a load
_MET = 1e-3  # of the length: by how much the length of an equilibrium may be off
_SWING = 1e-7  # beta_t and H at a start below which an orbit is its helix, in units of the loads
_STILL = 1e-11  # beta_t below which an end is at rest, in units of the loads
_NEAR = 0.1  # rad: farthest angle with the given beta_t
AT_REST = -300.0  # log of the square of beta_t at a start at rest
_ENDING = Ending(rounds=14, goal=1e-15, small=1e-10, growth=0.5)
_AT = {name: k for k, name in enumerate(NUMBERS)}


def is_hinged(names: Collection[str]) -> bool:
    """Whether an end moment is among the given numbers."""
    return "dbeta0" in names or "dbetaL" in names


@dataclass(frozen=True, eq=False)
class State:
    """One equilibrium under held ends: as an ends problem under dead loads, its path, and how its numbers answer.

    rates: of the problem and the path, or of a state that differs from it by a small correction. corrected: the size
    of the corrections from the guess to it.
    """

    problem: EndsProblem
    path: Path
    rates: OrbitRates
    corrected: float = 0.0


@dataclass(frozen=True, eq=False)
class Given:
    """The five given numbers of one problem at a point of a line: their names and values (5,), L/rho, and A/C."""

    names: tuple[str, ...]
    values: Array
    span: float
    ratio: float

    @property
    def hinged(self) -> bool:
        """Whether an end moment is given."""
        return is_hinged(self.names)

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
        """Those of one held problem."""
        return cls(problem.numbers, problem.values[0], float(problem.span[0]), float(problem.ratio[0]))

    def at(self, state: State) -> "Given":
        """The same numbers as a state has them."""
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


def rows_of(rates: OrbitRates, names: tuple[str, ...], ratio: float) -> tuple[Array, Array]:
    """The rows (5, 5) and the derivatives by the length (5,) of the given numbers of one equilibrium."""
    rows, by_span = [], []
    for name in names:
        if name == "turn":  # ratio mu span - swirl
            mu, swirl, span = _AT["mu"], _AT["swirl"], float(rates.length[0])
            rows.append(ratio * span * rates.rows[0, mu] - rates.rows[0, swirl])
            by_span.append(ratio * rates.values[0, mu] - rates.by_span[0, swirl])
        else:
            k = _AT[name]
            rows.append(rates.rows[0, k])
            by_span.append(rates.by_span[0, k])
    return np.array(rows), np.array(by_span)


def parts_by_given(rates: OrbitRates, names: tuple[str, ...], ratio: float) -> Array:
    """The five parts of a change of one equilibrium by a unit of each given number, and last of the length, (5, 6)."""
    rows, by_span = rows_of(rates, names, ratio)
    return solve(rows[None], np.column_stack([np.eye(5), -by_span])[None])[0]


def answer(rates: OrbitRates, given: Given, values: Array, span: Array) -> Array:
    """The changes of the `NUMBERS` by changes of the given numbers (5, k) and of the length (k,), (11, k)."""
    parts = parts_of(rates, given, values, span)
    with np.errstate(invalid="ignore", over="ignore"):
        return np.asarray(rates.rows[0] @ parts + rates.by_span[0][:, None] * span)


def parts_of(rates: OrbitRates, given: Given, values: Array, span: Array) -> Array:
    """The five parts of the changes of the orbit by the same changes, (5, k)."""
    rows, by_span = rows_of(rates, given.names, given.ratio)
    return solve(rows[None], (values - by_span[:, None] * span)[None])[0]


def orientation(rates: OrbitRates, given: Given) -> float:
    """The sign of the determinant of the equations: along a branch it changes at folds and branching points alone.

    It does not depend on the coordinates of the path, as the flow and its transversal always span a unit area.
    """
    rows, _ = rows_of(rates, given.names, given.ratio)
    with np.errstate(all="ignore"):
        column = 1 / np.abs(rows).max(axis=0)
        return float(np.linalg.slogdet(rows * column)[0])


def move(chart: Chart, x: float, change: Array) -> float:
    """The change of the coordinate of a chart; change: of the `NUMBERS`, (11,), of a path with the pin of the chart."""
    if chart.kind == "saddle":
        return float(change[_AT["y"]])
    rate = float(change[_AT["dbetaL" if chart.kind == "end" else "dbeta0"]])
    if not chart.logarithmic:
        return rate
    direction = chart.at.leaving if chart.kind == "start" else chart.at.arriving
    return 2 * rate / (direction * float(np.exp(x / 2)))


def size_of(problem: EndsProblem, chart: Chart, dx: float, change: Array) -> float:
    """The size of a change: about 1 where the orbit changes its form."""
    if not chart.scale > 0:  # the level is that of a saddle to rounding: every change is large
        return np.inf
    sizes, loads = [abs(dx) / chart.scale], 1 + float(load_size(problem)[0])
    sizes += [abs(float(change[_AT[name]])) / (1 if name in FREE[:2] else loads) for name in FREE]
    return max(sizes) if np.isfinite(sizes).all() else np.inf


def problem_after(problem: EndsProblem, given: Given, change: Array, factor: float = 1.0) -> EndsProblem:
    """The problem after a change; what is given is exactly what is given."""
    new = {name: getattr(problem, name) + factor * change[_AT[name]] for name in FREE}
    for name, value in zip(given.names, given.values, strict=True):
        if name in FREE:
            new[name] = np.array([value])
    return replace(problem, **new, span=np.array([given.span]))


def correct(problem: EndsProblem, given: Given, chart: Chart, x: float, goal: float = 0.0) -> State | str:
    """The equilibrium with the given numbers next to a guess, by Newton's rule; or why there is none.

    goal: the size of a correction at which it ends; 0: rounding. The rates are computed anew where corrections made
    with older ones do not shrink fast.
    """
    last: State | None = None  # before the last correction, and its coordinate and length
    at, length = x, np.nan

    def step(guess: tuple[EndsProblem, float]) -> tuple[tuple[EndsProblem, float], float] | str:
        nonlocal last, at, length
        at = given.number("dbeta0", guess[1]) if chart.kind == CORNER else guess[1]
        here = problem_at(guess[0], given, chart, at)
        if here is None:
            return LEFT
        problem, path = here
        if last is None or goal == 0 or chart.kind == CORNER:
            rates = rates_in(problem, path, chart, at)
            numbers, length = rates.values[0], float(rates.length[0])
        else:
            rates = last.rates
            numbers, length = orbit_numbers(problem, path)
        if not np.isfinite(numbers).all():
            return LEFT
        off = given.values - values_of(numbers, length, given)
        change = answer(rates, given, off[:, None], np.array([given.span - length]))[:, 0]
        dx = move(chart, at, change)
        size = size_of(problem, chart, dx, change)
        last = State(problem, path, rates, size + (0.0 if last is None else last.corrected))
        if not last.corrected <= 2 * REACH:
            return DIVERGED
        return (problem_after(problem, given, change), at + dx), size

    found = newton((problem, x), step, replace(_ENDING, goal=max(goal, _ENDING.goal)))
    if isinstance(found, str):
        return found
    assert last is not None
    if not abs(given.span - length) < _MET * given.span:  # swings that fell to rounding have no length
        return DIVERGED
    if chart.kind != CORNER:
        return last if LinePoint(last.problem).joins_at(last.path) else LEFT
    return LEFT if is_still(last.problem, at) else replace(corner_state(last.rates, at), corrected=last.corrected)


def settle(problem: EndsProblem, path: Path, given: Given | None = None) -> State | str:
    """The equilibrium next to a path, in whichever coordinate Newton's rule converges; or why there is none.

    given: default: the dead loads of the problem.
    """
    given, reason = given or Given.dead(problem), ""
    for chart in charts(LinePoint(problem), path, given.hinged):
        found = correct(problem, given, chart, coordinate(chart))
        if not isinstance(found, str):
            return found
        reason = reason or found
    return reason


def problem_at(problem: EndsProblem, given: Given, chart: Chart, x: float) -> tuple[EndsProblem, Path] | None:
    """The problem and the path at a coordinate; None where there is no such path."""
    numbers = [float(value[0]) for value in vars(problem).values()]
    if not np.isfinite(numbers).all():
        return None
    if chart.kind == CORNER:
        return problem, chart.at
    place = LinePoint(problem)
    path = path_at(place, chart, x)
    if path is None or path.turns < 0:
        return None
    return at_given_speeds(problem, place, path, given), path


def rates_in(problem: EndsProblem, path: Path, chart: Chart, x: float) -> OrbitRates:
    """The numbers of the orbit at a coordinate of a chart, and how they answer."""
    return start_rates(problem.with_start(np.array([x]))) if chart.kind == CORNER else orbit_rates(problem, [path])


def is_still(problem: EndsProblem, v: float) -> bool:
    """Whether a rod that starts with beta_t = v swings about a helix by less than rounding leaves of it."""
    pull = abs(float(slope(problem, problem.beta0)[0]))
    return max(abs(v), pull) < _SWING * (1 + float(load_size(problem)[0]))


def corner_state(rates: OrbitRates, v: float) -> State:
    """The orbit that starts with beta_t = v, as a state; rates: of `start_rates`.

    A turning point at the start is not counted as passed, nor one at the far end.
    """
    problem, speed = rates.problem, float(rates.values[0, _AT["dbetaL"]])
    turns = int(solve_orbit(problem.with_start(np.array([v])), TIGHT).turns[0])
    pace = float(np.sqrt(1 + load_size(problem)[0]))
    leaving = UP if v > 0 or (v == 0 and float(slope(problem, problem.beta0)[0]) < 0) else DOWN
    arriving = leaving if turns % 2 == 0 else -leaving
    if arriving * speed < 0 or abs(speed) < _STILL * pace:  # the last turning point is at the far end, to rounding
        toward = DOWN if float(slope(problem, problem.betaL)[0]) < 0 else UP  # before it
        turns -= int(arriving != toward and turns > 0)
    y = max(2 * float(np.log(max(abs(v), 1e-300))), AT_REST)
    return State(problem, Path(LinePoint(problem).start, 1.0, y, leaving, turns), rates)


def at_given_speeds(problem: EndsProblem, place: LinePoint, path: Path, given: Given) -> EndsProblem:
    """The problem with the angle of an end, where beta_t is given instead, at which the orbit has that beta_t.

    Where the end is at rest, or nearly, other angles lie beyond a turning point, and no orbit would reach them.
    """
    gap = path.sign * float(np.exp(max(path.y, place.blank.deepest)))
    alone = not {"dbeta0", "dbetaL"} <= set(given.names)
    new = {}
    for name, speed, first in (("beta0", "dbeta0", place.start), ("betaL", "dbetaL", place.end)):
        if speed not in given.names or path.pin == first:
            continue
        square = max(float(given.values[given.names.index(speed)]) ** 2, least_square(problem, first, alone))
        beta, step = first, 0.0
        for _ in range(8):
            over, rate = gap + place.fall(path.pin, beta) - square, 2 * float(slope(problem, np.array([beta]))[0])
            if not abs(over) < _NEAR * abs(rate):
                step = np.inf
                break
            step = over / rate
            beta += step
        if abs(step) < _NEAR and abs(beta - first) < _NEAR:
            new[name] = getattr(problem, name) + (beta - first)
    return replace(problem, **new)


def least_square(problem: EndsProblem, beta: float, alone: bool) -> float:
    """The least square of beta_t at an end near beta that the rounding of the angle leaves positive.

    alone: whether the other end is held at an angle. If both ends are at rest, rounding of the loads decides whether
    the orbit reaches both.
    """
    if not alone:
        return _LEAST * (1 + float(load_size(problem)[0]))
    off = _LEAST * max(abs(beta), _LEAST)
    return off * (2 * abs(float(slope(problem, np.array([beta]))[0])) + off * float(steepest(problem)[0]))


def values_of(numbers: Array, length: float, given: Given) -> Array:
    """The given numbers of an equilibrium, (5,); numbers: the `NUMBERS`, (11,)."""
    turn = given.ratio * numbers[_AT["mu"]] * length - numbers[_AT["swirl"]]
    return np.array([turn if name == "turn" else numbers[_AT[name]] for name in given.names])


def predict(state: State, chart: Chart, given: Given, ahead: Given) -> tuple[Array, float, float]:
    """The changes of the numbers (11,) and of the coordinate to `ahead`, to first order, and their size."""
    path = None if chart.kind == CORNER else path_at(LinePoint(state.problem), chart, coordinate(chart))
    rates = state.rates
    if path is not None and path.pin != state.path.pin:
        rates = orbit_rates(state.problem, [path])
    values, span = ahead.values - given.values, np.array([ahead.span - given.span])
    change = answer(rates, given, values[:, None], span)[:, 0]
    dx = move(chart, coordinate(chart), change)
    return change, dx, size_of(state.problem, chart, dx, change)
