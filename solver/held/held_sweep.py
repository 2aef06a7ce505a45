"""Equilibria under dead loads over ranges of the unknown loads, and those from which the held ends can be reached.

With one unknown, equilibria at neighbouring values are joined: on each path (direction at the start, number of turning
points) they keep the order of their levels. Where what is held passes its wanted value between two neighbours, one of
them is a start, and also where a cubic through their values and slopes comes back to it. Of the equilibria that have no
neighbour, next to a fold or where a turning point leaves the rod, the nearest on either side are starts too, and those
that a tangent takes to the wanted value between the two neighbours or a little beyond.

With several unknowns, equilibria are starts if the first-order change of the unknowns is short, in steps of the grid.
"""

from collections import defaultdict
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ..equilibrium.given_numbers import FREE, Given, OrbitState, problem_of
from ..equilibrium.orbit_rates import NUMBERS, OrbitRates, orbit_rates
from ..levels.level_search import MOST_PERIODS, search_levels
from ..levels.line_point import path_of
from ..mechanics.potential import potential
from ..numerics.arrays import Array
from ..problem.reduced import EndsProblem
from .held_ranges import Ranges

_STEPS_AWAY = 1.5  # of the grid: the longest first-order change from a start
_FEWEST, _MOST = 16, 100  # starts with several unknowns


@dataclass(frozen=True, eq=False)
class Point:
    """The equilibria of one dead-load problem that are no helices.

    off: (K, k), what is held less the wanted values. slope: (K, k, k), its derivatives by the unknowns.
    """

    states: list[OrbitState]
    off: Array
    slope: Array


def swept(given: Given, ranges: Ranges, most_periods: int) -> list[Point]:
    """The equilibria at all points of the grid."""
    unknown = list(ranges.bounds)
    return [_point(problem_of(given, values), given, unknown, most_periods) for values in ranges.points()]


def dead_states(
    problem: EndsProblem, most_periods: int = MOST_PERIODS, most_turns: int | None = None
) -> tuple[list[OrbitState], OrbitRates] | None:
    """The equilibria of one problem under dead loads that are no helices, and the rates of all; None where none is.

    most_periods, most_turns: as of `search_levels`.
    """
    every = search_levels(problem, most_periods, most_turns)
    paths = [] if every is None else [path_of(every.path, i) for i in range(every.slope.size)]
    paths = [path for path in paths if not path.helix]
    if not paths:
        return None
    rates = orbit_rates(problem.take(np.zeros(len(paths), dtype=int)), paths)
    return [OrbitState(problem, path, rates.take(slice(i, i + 1))) for i, path in enumerate(paths)], rates


def _point(problem: EndsProblem, given: Given, unknown: list[str], most_periods: int) -> Point:
    dead, k = dead_states(problem, most_periods), len(unknown)
    if dead is None:
        return Point([], np.empty((0, k)), np.empty((0, k, k)))
    states, rates = dead
    off, slope = _held(rates, given, unknown)
    fine = np.flatnonzero(np.isfinite(off).all(axis=1))
    return Point([states[i] for i in fine], off[fine], slope[fine])


def _held(rates: OrbitRates, given: Given, unknown: list[str]) -> tuple[Array, Array]:
    response = rates.response(FREE)[:, :, [FREE.index(name) for name in unknown]]
    off, slope = [], []
    for name, value in zip(given.names, given.values, strict=True):
        if name == "turn":
            twist = given.ratio * rates.length
            mu, swirl = NUMBERS.index("mu"), NUMBERS.index("swirl")
            off.append(twist * rates.values[:, mu] - rates.values[:, swirl] - value)
            slope.append(twist[:, None] * response[:, mu] - response[:, swirl])
        elif name not in FREE:
            off.append(rates.value(name) - value)
            slope.append(response[:, NUMBERS.index(name)])
    return np.stack(off, axis=1), np.stack(slope, axis=1)


def starts_of(points: list[Point], ranges: Ranges) -> list[list[OrbitState]]:
    """The starts, each with others that may lead to the same equilibrium, the best first."""
    if len(ranges.bounds) == 1:
        (axis,) = ranges.axes().values()
        return [
            group
            for i, (lower, upper) in enumerate(pairwise(points))
            for group in _between(lower, upper, axis[i + 1] - axis[i])
        ]
    return _nearest(points, ranges)


def _between(lower: Point, upper: Point, step: float) -> list[list[OrbitState]]:
    """Starts between two neighbouring values of one unknown."""
    starts, alone = list[list[OrbitState]](), list[tuple[float, OrbitState]]()
    first, second = _classes(lower), _classes(upper)
    for kind in first.keys() | second.keys():
        below, above = first[kind], second[kind]
        if len(below) != len(above):
            for point, indices, inward in ((lower, below, step), (upper, above, -step)):
                for i in indices:
                    off, slope = float(point.off[i, 0]), float(point.slope[i, 0, 0])
                    alone.append((off, point.states[i]))
                    if 0 < -off / (slope * inward or np.inf) <= _STEPS_AWAY:
                        starts.append([point.states[i]])
            continue
        for i, j in zip(below, above, strict=True):
            a, b = float(lower.off[i, 0]), float(upper.off[j, 0])
            pair = [lower.states[i], upper.states[j]][:: 1 if abs(a) <= abs(b) else -1]
            if a * b <= 0 or _returns(a, b, step * float(lower.slope[i, 0, 0]), step * float(upper.slope[j, 0, 0])):
                starts.append(pair)
    sides = [[entry for entry in alone if entry[0] * sign > 0] for sign in (1, -1)]
    if all(sides):
        starts += [[min(side, key=lambda entry: abs(entry[0]))[1]] for side in sides]
    return starts


def _classes(point: Point) -> dict[tuple[int, int], list[int]]:
    """The equilibria on each path, in the order of their levels."""
    classes = defaultdict[tuple[int, int], list[int]](list)
    for i, state in enumerate(point.states):
        classes[state.path.leaving, state.path.turns].append(i)

    def level(i: int) -> tuple[float, float]:
        path = point.states[i].path
        gap = path.sign * float(np.exp(max(path.y, -300.0)))
        return float(potential(point.states[i].problem, np.array([path.pin]))[0]) + gap, path.sign * path.y

    for members in classes.values():
        members.sort(key=level)
    return classes


def _returns(a: float, b: float, a_slope: float, b_slope: float) -> bool:
    """Whether the cubic with these end values and slopes, of one sign at both ends, reaches zero between."""
    if not np.isfinite([a_slope, b_slope]).all():
        return True
    u = np.linspace(0, 1, 21)
    cubic = (
        a * (1 + 2 * u) * (1 - u) ** 2
        + b * u * u * (3 - 2 * u)
        + a_slope * u * (1 - u) ** 2
        - b_slope * u * u * (1 - u)
    )
    return bool((cubic * a <= 0).any())


def _nearest(points: list[Point], ranges: Ranges) -> list[list[OrbitState]]:
    step = np.array([float(np.ptp(axis)) / (axis.size - 1) for axis in ranges.axes().values()])
    ranked: list[tuple[float, OrbitState]] = []
    for point in points:
        for state, off, slope in zip(point.states, point.off, point.slope, strict=True):
            away = np.inf
            if np.isfinite(slope).all() and np.linalg.cond(slope) < 1e12:
                away = float(np.abs(np.linalg.solve(slope, off) / step).max())
            ranked.append((away, state))
    ranked.sort(key=lambda entry: entry[0])
    count = sum(away <= _STEPS_AWAY for away, _ in ranked)
    return [[state] for _, state in ranked[: min(max(count, _FEWEST), _MOST)]]
