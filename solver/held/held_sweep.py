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
from itertools import pairwise, product

import numpy as np

from ..branches.given_numbers import FREE, Given, OrbitState, problem_of, values_of
from ..branches.orbit_rates import OrbitRates, orbit_rates
from ..numerics.arrays import Array
from ..orbits.boundary import path_of
from ..orbits.level_search import MOST_PERIODS, search_levels
from ..orbits.potential import potential
from ..problem.dimensionless import EndsProblem

# of a straight rod: pushed as hard as it needs to buckle into so many, or pulled as hard. x10: a list of 8 is one of
# 42, of more waves
HALF_WAVES = 4
_SURFACE = 2.0  # bound of what the cylinder's curvature adds to a load. x10: a list of 8 is one of 14
_SAFE = 4.0  # times the load that holds a nearly straight rod. x10: coarser steps over the wider range
_HARDEST = 1e6  # the largest load of the sweep, in units of A/rho^2. x10: as good
# of each of so many unknowns: 60 to 256 rods in all. x10: ten to 100,000 times the time
VALUES = {1: 61, 2: 13, 3: 6, 4: 4, 5: 3}
# of the grid: the longest first-order change from a start. x10: starts that lead nowhere, which take time
_STEPS_AWAY = 1.5
_FEWEST, _MOST = 16, 100  # starts with several unknowns. x10: only time


@dataclass(frozen=True)
class Ranges:
    """The lowest and the highest value of each unknown number, by its name, and how many values of each are taken.

    root: of the load under which a straight rod buckles into `HALF_WAVES`. turns: whether no end angle is given or has
    a range that is asked for, so that the angles of starts bound nothing: shapes are those of one turn of beta(0).
    """

    bounds: dict[str, tuple[float, float]]
    count: int
    root: float
    turns: bool

    def holds(self, values: dict[str, float]) -> bool:
        """Whether numbers lie within."""
        judged = self.bounds.keys() - (FREE[:2] if self.turns else ())
        return all(self.bounds[name][0] - 1e-9 <= values[name] <= self.bounds[name][1] + 1e-9 for name in judged)

    def axes(self) -> dict[str, Array]:
        """The values of each; of a force or MZ by its root, as half waves go with it.

        The steps of the root are equal up to `root`, and grow in proportion to it beyond: a slender rod on a cylinder
        buckles at loads far below those that the cylinder's curvature adds.
        """
        rooted = {name: self.root if name in ("phi", "lam") else None for name in self.bounds}
        return {name: _steps(*ends, self.count, rooted[name]) for name, ends in self.bounds.items()}

    def points(self) -> list[dict[str, float]]:
        """All combinations of the values."""
        axes = self.axes()
        return [dict(zip(axes, values, strict=True)) for values in product(*(axis.tolist() for axis in axes.values()))]


def ranges_of(given: Given, within: dict[str, tuple[float, float]], count: int | None) -> Ranges:
    """The ranges of the unknown numbers of a problem, those of `within` as they are, with `count` values of each."""
    known = dict(zip(given.names, given.values.tolist(), strict=True))
    bounds = {name: within.get(name) or _default(name, known, given) for name in FREE if name not in known}
    turns = {*FREE[:2]} <= bounds.keys() and not {*FREE[:2]} & within.keys()
    return Ranges(bounds, VALUES[len(bounds)] if count is None else count, HALF_WAVES * np.pi / given.span, turns)


def _default(name: str, known: dict[str, float], given: Given) -> tuple[float, float]:
    span = given.span
    if name in ("beta0", "betaL"):
        other = known.get("betaL" if name == "beta0" else "beta0", 0.0)
        return other - np.pi, other + np.pi
    if name == "mu":  # turn = ratio mu span - swirl, and |swirl| is at most span/2
        low, high = ((known["turn"] + sign * span / 2) / (given.ratio * span) for sign in (-1, 1))
        return low, high
    dead = sum(abs(known.get(load, 0.0)) for load in ("phi", "lam", "mu"))
    waves = (HALF_WAVES * np.pi / span) ** 2
    most = float(min(waves + _SURFACE + dead + _load_of_straight(name, known, span), _HARDEST))
    return -most, most


def _load_of_straight(load: str, known: dict[str, float], span: float) -> float:
    """The load that pulls a clamped rod to its held height or azimuth.

    Each end falls 2 (1 - cos(b/2))/sqrt(load) short, b being its angle from the pull.
    """
    held = known["z" if load == "phi" else "alpha"]
    pull = {"phi": 0.0, "lam": np.pi / 2}[load] if held >= 0 else {"phi": np.pi, "lam": -np.pi / 2}[load]
    short = sum(2 * (1 - abs(np.cos((known[name] - pull) / 2))) for name in ("beta0", "betaL") if name in known)
    slack = span - abs(held)
    return float(_SAFE * (short / slack) ** 2) if slack > 1e-9 * span else 0.0


def _steps(low: float, high: float, count: int, root: float | None) -> Array:
    if root is None:
        return np.linspace(low, high, count)
    first, last = (float(np.arcsinh(np.sign(end) * np.sqrt(abs(end)) / root)) for end in (low, high))
    roots = root * np.sinh(np.linspace(first, last, count))
    steps = np.sign(roots) * roots * roots
    steps[[0, -1]] = low, high
    return np.asarray(steps)


@dataclass(frozen=True, eq=False)
class SweepPoint:
    """The equilibria of one dead-load problem that are no helices.

    off: (K, k), what is held less the wanted values. slope: (K, k, k), its derivatives by the unknowns.
    """

    states: list[OrbitState]
    off: Array
    slope: Array


def swept(given: Given, ranges: Ranges, most_periods: int) -> list[SweepPoint]:
    """The equilibria at all points of the grid."""
    unknown = list(ranges.bounds)
    return [_point(problem_of(given, values), given, unknown, most_periods) for values in ranges.points()]


def dead_states(
    problem: EndsProblem, most_periods: int = MOST_PERIODS, most_turns: int | None = None
) -> tuple[list[OrbitState], OrbitRates] | None:
    """The equilibria of one problem under dead loads that are no helices, and the rates of all; None where none is.

    most_periods, most_turns: as of `search_levels`.
    """
    equilibria = search_levels(problem, most_periods, most_turns)
    paths = [] if equilibria is None else [path_of(equilibria.orbit.paths, i) for i in range(equilibria.dbeta0.size)]
    paths = [path for path in paths if not path.helix]
    if not paths:
        return None
    rates = orbit_rates(problem.take(np.zeros(len(paths), dtype=int)), paths)
    return [OrbitState(problem, path, rates.take(slice(i, i + 1))) for i, path in enumerate(paths)], rates


def _point(problem: EndsProblem, given: Given, unknown: list[str], most_periods: int) -> SweepPoint:
    dead, k = dead_states(problem, most_periods), len(unknown)
    if dead is None:
        return SweepPoint([], np.empty((0, k)), np.empty((0, k, k)))
    states, rates = dead
    held = [i for i, name in enumerate(given.names) if name not in FREE]
    values = [values_of(*numbers, given) for numbers in zip(rates.values, rates.length.tolist(), strict=True)]
    off = (np.array(values) - given.values)[:, held]
    by_unknown = rates.parts(FREE)[:, :, [FREE.index(name) for name in unknown]]
    with np.errstate(invalid="ignore", over="ignore"):
        slope = rates.rows_of(given.names, given.ratio)[0][:, held] @ by_unknown
    fine = np.flatnonzero(np.isfinite(off).all(axis=1))
    return SweepPoint([states[i] for i in fine], off[fine], slope[fine])


def starts_of(points: list[SweepPoint], ranges: Ranges) -> list[list[OrbitState]]:
    """The starts, each with others that may lead to the same equilibrium, the best first."""
    if len(ranges.bounds) == 1:
        (axis,) = ranges.axes().values()
        return [
            group
            for i, (lower, upper) in enumerate(pairwise(points))
            for group in _between(lower, upper, axis[i + 1] - axis[i])
        ]
    return _nearest(points, ranges)


def _between(lower: SweepPoint, upper: SweepPoint, step: float) -> list[list[OrbitState]]:
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


def _classes(point: SweepPoint) -> dict[tuple[int, int], list[int]]:
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


def _nearest(points: list[SweepPoint], ranges: Ranges) -> list[list[OrbitState]]:
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
