"""The equations of one equilibrium with held ends: the level of its orbit, its loads and its end angles together.

The unknowns are a coordinate of the path (`charts.Chart`), the three loads and the two end angles. The
equations are the five given numbers and the length. All derivatives are those of `orbit_rates`, so the system is
regular wherever the problem with these ends has no fold, at folds under dead loads too.
"""

from dataclasses import replace

import numpy as np

from ..levels.boundary import DOWN, UP, Boundary, Path, boundary_of
from ..mechanics.potential import load_size, slope, steepest
from ..numerics.arrays import EPS
from ..numerics.roots import DIVERGED, Ending, newton
from ..orbit.periodic_orbit import TIGHT, Pin, solve_orbit
from ..problem.reduced import EndsProblem
from .charts import CORNER, Chart, charts, coordinate, path_at
from .given_numbers import Given, OrbitState, answer, move, problem_after, size_of, values_of
from .orbit_rates import NUMBERS, OrbitRates, orbit_rates, start_rates

LEFT = "no orbit of its path joins the two ends there"
_REACH = 0.5  # largest size of all corrections together
_LEAST = 9 * EPS  # share by which rounding may change an angle, or a load
_MET = 1e-3  # of the length: by how much the length of an equilibrium may be off
_ROUNDED = 256 * EPS  # what the sums along an orbit leave of the numbers of an equilibrium, in their sizes
_SWING = 1e-7  # beta_t and H at a start below which an orbit is its helix, in units of the loads
_CORNER = 1e-6  # rad: a rod that its start determines ends as near to its angle there
_STILL = 1e-11  # beta_t below which an end is at rest, in units of the loads
_NEAR = 0.1  # rad: farthest angle with the given beta_t
AT_REST = -300.0  # log of the square of beta_t at a start at rest
_ANGLE_ENDING = Ending(rounds=8, goal=0.0, small=_NEAR, stall=np.inf)
_ENDING = Ending(rounds=14, goal=1e-15, small=1e-10, growth=0.5)


def correct_equilibrium(problem: EndsProblem, given: Given, chart: Chart, x: float) -> OrbitState | str:
    """The equilibrium with the given numbers next to a guess, by Newton's rule; or why there is none."""
    last: OrbitState | None = None  # before the last correction, and its coordinate
    at, corrected_by = x, 0.0

    def step(guess: tuple[EndsProblem, float]) -> tuple[tuple[EndsProblem, float], float] | str:
        nonlocal last, at, corrected_by
        at = given.number("dbeta0", guess[1]) if chart.kind == CORNER else guess[1]
        equilibrium = problem_at(guess[0], given, chart, at)
        if equilibrium is None:
            return LEFT
        problem, path = equilibrium
        rates = rates_in(problem, path, chart, at)
        numbers, length = rates.values[0], float(rates.length[0])
        if not np.isfinite(numbers).all():
            return LEFT
        off = given.values - values_of(numbers, length, given)
        change = answer(rates, given, off[:, None], np.array([given.span - length]))[:, 0]
        dx = float(move(chart, at, change))
        size = size_of(problem, chart, dx, change)
        last, corrected_by = OrbitState(problem, path, rates), corrected_by + size
        if not corrected_by <= _REACH:
            return DIVERGED
        left = np.append(off, given.span - length) / (1 + np.abs(np.append(given.values, given.span)))
        if size > _ENDING.small and np.abs(left).max() < _ROUNDED:  # a taut rod: rounding of its ends moves its loads
            size = 0.0
        return (problem_after(problem, given, change), at + dx), size

    corrected = newton((problem, x), step, _ENDING)
    if isinstance(corrected, str):
        return corrected
    assert last is not None
    if not abs(given.span - float(last.rates.length[0])) < _MET * given.span:
        return DIVERGED  # swings that fell to rounding have no length
    if chart.kind != CORNER:
        return last if boundary_of(last.problem).joins_at(last.path) else LEFT
    return LEFT if is_still(last.problem, at) else corner_state(last.rates, at)


def state_of(problem: EndsProblem, path: Path, hinged: bool = False) -> OrbitState:
    """The state of an equilibrium under dead loads; an end that its orbit does not reach by rounding is moved.

    hinged: whether it is meant to have given end moments.
    """
    place = boundary_of(problem)
    if hinged and not path.helix and path.pin == place.start and path.sign > 0:
        v = path.leaving * float(np.exp(path.y / 2)) if path.y > AT_REST else 0.0
        rates = start_rates(problem.with_start(np.array([v])))
        if abs(float((rates.problem.betaL - problem.betaL)[0])) < _CORNER:
            return corner_state(rates, v)
    if not path.helix:
        gap = path.sign * float(np.exp(max(path.y, place.deepest)))
        ends = {"dbeta0": place.start, "dbetaL": place.end}
        pin = place.own_pin(path.pin)
        reached = {name: gap + place.fall(pin, angle) for name, angle in ends.items()}
        rest = tuple(name for name, square in reached.items() if square < least_square(problem, ends[name], False))
        problem = at_given_speeds(problem, place, path, Given(rest, np.zeros(len(rest)), 0.0, 0.0))
    return OrbitState(problem, path, orbit_rates(problem, [path]))


def settle(problem: EndsProblem, path: Path, given: Given | None = None) -> OrbitState | str:
    """The equilibrium next to a path, in whichever coordinate Newton's rule converges; or why there is none.

    given: default: the dead loads of the problem.
    """
    given, reason = given or Given.dead(problem), ""
    for chart in charts(boundary_of(problem), path, given.hinged):
        settled = correct_equilibrium(problem, given, chart, coordinate(chart))
        if not isinstance(settled, str):
            return settled
        reason = reason or settled
    return reason


def problem_at(problem: EndsProblem, given: Given, chart: Chart, x: float) -> tuple[EndsProblem, Path] | None:
    """The problem and the path at a coordinate; None where there is no such path."""
    numbers = [float(value[0]) for value in vars(problem).values()]
    if not np.isfinite(numbers).all():
        return None
    if chart.kind == CORNER:
        return problem, chart.at
    place = boundary_of(problem)
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


def corner_state(rates: OrbitRates, v: float, pin: Pin | None = None) -> OrbitState:
    """The orbit that starts with beta_t = v, as a state; rates, pin: of `start_rates`.

    A turning point at the start is not counted as passed, nor one at the far end.
    """
    problem, speed = rates.problem, float(rates.values[0, NUMBERS.index("dbetaL")])
    turns = int(solve_orbit(problem.with_start(np.array([v])), TIGHT, pin).turns[0])
    pace = float(np.sqrt(1 + load_size(problem)[0]))
    leaving = UP if v > 0 or (v == 0 and float(slope(problem, problem.beta0)[0]) < 0) else DOWN
    arriving = leaving if turns % 2 == 0 else -leaving
    if arriving * speed < 0 or abs(speed) < _STILL * pace:  # the last turning point is at the far end, to rounding
        toward = DOWN if float(slope(problem, problem.betaL)[0]) < 0 else UP  # before it
        turns -= int(arriving != toward and turns > 0)
    y = max(2 * float(np.log(max(abs(v), 1e-300))), AT_REST)
    return OrbitState(problem, Path(boundary_of(problem).start, 1.0, y, leaving, turns), rates)


def at_given_speeds(problem: EndsProblem, place: Boundary, path: Path, given: Given) -> EndsProblem:
    """The problem with the angle of an end, where beta_t is given instead, at which the orbit has that beta_t.

    Where the end is at rest, or nearly, other angles lie beyond a turning point, and no orbit would reach them.
    """
    pin, gap = place.own_pin(path.pin), path.sign * float(np.exp(max(path.y, place.deepest)))
    alone = not {"dbeta0", "dbetaL"} <= set(given.names)
    new = {}
    for name, speed, first in (("beta0", "dbeta0", place.start), ("betaL", "dbetaL", place.end)):
        if speed not in given.names or pin == first:
            continue
        square = max(float(given.values[given.names.index(speed)]) ** 2, least_square(problem, first, alone))

        def step(beta: float, square: float = square) -> tuple[float, float] | str:
            over, rate = gap + place.fall(pin, beta) - square, 2 * float(slope(problem, np.array([beta]))[0])
            return (beta + over / rate, abs(over / rate)) if abs(over) < _NEAR * abs(rate) else DIVERGED

        beta = newton(first, step, _ANGLE_ENDING)
        if not isinstance(beta, str) and abs(beta - first) < _NEAR:
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
