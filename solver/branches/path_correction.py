"""The equations of one equilibrium with held ends: the level of its orbit, its loads and its end angles together.

The unknowns are a coordinate of the path (`charts.Chart`), the three loads and the two end angles. The
equations are the five given numbers and the length. All derivatives are those of `orbit_rates`, so the system is
regular wherever the problem with these ends has no fold, at folds under dead loads too.
"""

from dataclasses import replace

import numpy as np

from ..numerics.arrays import DOUBTFUL, EPS, ROUGHLY
from ..numerics.roots import DIVERGED, REACH, Ending, newton
from ..orbits.boundary import DOWN, UP, Path, boundary_of
from ..orbits.periodic_orbit import TIGHT, Pin, solve_orbit
from ..orbits.potential import load_size, slope, steepest
from ..problem.dimensionless import EndsProblem
from .charts import Chart, charts, coordinate, path_at
from .given_numbers import Given, OrbitState, answer, move, problem_after, size_of, values_of
from .orbit_rates import NUMBERS, OrbitRates, orbit_rates

LEFT = "no orbit of its path joins the two ends there"
# share by which rounding may change an angle, or a load: a few operations. x10: ends at rest are moved onto saddles
_LEAST = 9 * EPS
# what the sums along an orbit leave of the numbers of an equilibrium, in their sizes. x10: corrections end a digit
# early
_ROUNDED = 256 * EPS
# rad: the farthest that an end is moved, well below half the distance of two critical points. x10: to another well
_NEAR = 0.1
# log of the square of beta_t at a start at rest: of no size beside 1, and its root a float. x10: the root leaves the
# range of floats
AT_REST = -300.0
# of one equation whose root is simple: it ends by rounding. x10: no change
_ANGLE_ENDING = Ending(rounds=8, goal=0.0, small=_NEAR, stall=np.inf)
# corrections end by rounding: Newton's method doubles the digits, so 14 are enough from any step. x10: no answer
# changes, only those that fail take longer
_ENDING = Ending(rounds=14, goal=1e-15, small=1e-10, growth=0.5)


def correct_equilibrium(problem: EndsProblem, given: Given, chart: Chart, x: float) -> OrbitState | str:
    """The equilibrium with the given numbers next to a guess, by Newton's rule; or why there is none."""
    last: OrbitState | None = None  # before the last correction, and its coordinate
    at, corrected_by = x, 0.0

    def step(guess: tuple[EndsProblem, float]) -> tuple[tuple[EndsProblem, float], float] | str:
        nonlocal last, at, corrected_by
        at = guess[1]
        path = path_on(guess[0], chart, at)
        if path is None:
            return LEFT
        problem, rates = guess[0], orbit_rates(guess[0], [path])
        numbers, length = rates.values[0], float(rates.length[0])
        if not np.isfinite(numbers).all():
            return LEFT
        off = given.values - values_of(numbers, length, given)
        change = answer(rates, given, off[:, None], np.array([given.span - length]))[:, 0]
        dx = float(move(chart, at, change))
        size = size_of(problem, chart, dx, change)
        last, corrected_by = OrbitState(problem, path, rates), corrected_by + size
        if not corrected_by <= REACH:
            return DIVERGED
        left = np.append(off, given.span - length) / (1 + np.abs(np.append(given.values, given.span)))
        if size > _ENDING.small and np.abs(left).max() < _ROUNDED:  # a taut rod: rounding of its ends moves its loads
            size = 0.0
        return (problem_after(problem, given, change), at + dx), size

    corrected = newton((problem, x), step, _ENDING)
    if isinstance(corrected, str):
        return corrected
    assert last is not None
    # an orbit that is off by a larger share of the length is no equilibrium
    if not abs(given.span - float(last.rates.length[0])) < ROUGHLY * given.span:
        return DIVERGED  # swings that fell to rounding have no length
    return last if boundary_of(last.problem).joins_at(last.path) else LEFT


def state_of(problem: EndsProblem, path: Path) -> OrbitState:
    """The state of an equilibrium under dead loads; an end that its orbit does not reach by rounding is moved."""
    if not path.helix:
        problem = _with_ends_reached(problem, path)
    return OrbitState(problem, path, orbit_rates(problem, [path]))


def settle(problem: EndsProblem, path: Path, given: Given | None = None) -> OrbitState | str:
    """The equilibrium next to a path, in whichever coordinate Newton's rule converges; or why there is none.

    given: default: the dead loads of the problem.
    """
    given, reason = given or Given.dead(problem), ""
    for chart in charts(problem, path):
        settled = correct_equilibrium(problem, given, chart, coordinate(chart))
        if not isinstance(settled, str):
            return settled
        reason = reason or settled
    return reason


def path_on(problem: EndsProblem, chart: Chart, x: float) -> Path | None:
    """The path of a problem at a coordinate; None where there is none."""
    if not np.isfinite([float(value[0]) for value in vars(problem).values()]).all():
        return None
    path = path_at(problem, chart, x)
    return None if path is None or path.turns < 0 else path


def state_from_start(rates: OrbitRates, dbeta0: float, pin: Pin | None = None) -> OrbitState:
    """The orbit that starts with beta_t = dbeta0, as a state; rates, pin: of `start_rates`.

    A turning point at the start is not counted as passed, nor one at the far end.
    """
    problem, speed = rates.problem, float(rates.values[0, NUMBERS.index("dbetaL")])
    turns = int(solve_orbit(problem.with_start(np.array([dbeta0])), TIGHT, pin).turns[0])
    pace = float(np.sqrt(1 + load_size(problem)[0]))
    leaving = UP if dbeta0 > 0 or (dbeta0 == 0 and float(slope(problem, problem.beta0)[0]) < 0) else DOWN
    arriving = leaving if turns % 2 == 0 else -leaving
    if arriving * speed < 0 or abs(speed) < DOUBTFUL * pace:  # the last turning point is at the far end, to rounding
        toward = DOWN if float(slope(problem, problem.betaL)[0]) < 0 else UP  # before it
        turns -= int(arriving != toward and turns > 0)
    y = max(2 * float(np.log(max(abs(dbeta0), 1e-300))), AT_REST)
    return OrbitState(problem, Path(boundary_of(problem).start, 1.0, y, leaving, turns), rates)


def _with_ends_reached(problem: EndsProblem, path: Path) -> EndsProblem:
    """The problem with the angle of each end that rests moved so far that the orbit reaches it."""
    boundary, new = boundary_of(problem), {}
    pin, gap = boundary.own_pin(path.pin), path.sign * float(np.exp(max(path.y, boundary.deepest)))
    ends = {"beta0": boundary.start, "betaL": boundary.end}
    least = _LEAST * (1 + float(load_size(problem)[0]))
    rest = [name for name, angle in ends.items() if gap + boundary.fall(pin, angle) < least]
    for name in rest:
        first = ends[name]
        if pin == first:
            continue
        square = least if len(rest) == 2 else _least_square(problem, first)

        def step(beta: float, square: float = square) -> tuple[float, float] | str:
            over, rate = gap + boundary.fall(pin, beta) - square, 2 * float(slope(problem, np.array([beta]))[0])
            return (beta + over / rate, abs(over / rate)) if abs(over) < _NEAR * abs(rate) else DIVERGED

        beta = newton(first, step, _ANGLE_ENDING)
        if not isinstance(beta, str) and abs(beta - first) < _NEAR:
            new[name] = getattr(problem, name) + (beta - first)
    return replace(problem, **new)


def _least_square(problem: EndsProblem, beta: float) -> float:
    """What the rounding of an angle changes of the square of beta_t there; if both ends are at rest, that of the loads
    decides whether the orbit reaches both."""
    off = _LEAST * max(abs(beta), _LEAST)
    return off * (2 * abs(float(slope(problem, np.array([beta]))[0])) + off * float(steepest(problem)[0]))
