"""A grid over the levels at which an orbit can join two end angles.

The lowest level is the height of G at an end, or at a saddle between the ends; the heights of the higher saddles divide
the rest. Next to each of these heights the grid is even in log gap, as the transit times are smooth in it; between two
heights the grids from either side meet in the middle. So the sign of an orbit's length less the rod's, compared from
point to point, shows every level where the two are equal.

Where G is almost level without a critical point (a shelf: H' = 0 and H small), an orbit that turns there stays long. So
the length has a narrow peak about the height of the shelf. The grid there is even in the log of the distance from it.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..core.tuning import LOWEST
from ..numerics.arrays import Array, Booleans
from ..numerics.roots import sign_changes
from ..problem.dimensionless import EndsProblem
from .boundary import Boundary, Levels, fall, height_scale
from .potential import slope, slope_higher_rates, slope_rate

# H' is a sum of harmonics up to the fourth: 45 places on the shortest. x10: only time
_SCAN = np.linspace(-np.pi, np.pi, 181)


@dataclass(frozen=True, eq=False)
class LevelGrid:
    """M levels in rising order.

    at_saddle: (M,), whether the point stands for the height of a saddle itself, of gap zero; its pin and sign are those
    of the next point (of the one before, for the last).
    """

    levels: Levels
    at_saddle: Booleans
    at_end: bool  # whether the lowest level is measured from an end of the rod, where beta_t is 0

    def cell(self, k: int) -> tuple[int, float, float, float] | None:
        """Pin, sign and the two y of the levels between point k and the next; None beside a saddle's own height."""
        if self.at_saddle[k] or self.at_saddle[k + 1]:
            return None
        levels, y = self.levels, self.levels.y
        return int(levels.pin[k + 1]), float(levels.sign[k + 1]), float(y[k]), float(y[k + 1])


def level_grid_of(boundary: Boundary, step: float = 0.25) -> tuple[Boundary, LevelGrid]:
    """The boundary with its pins, and the grid of its levels, in steps of `step` in log gap where it is dense."""
    problem, angles, saddles, ends = boundary.problem, boundary.angles, boundary.saddles, (boundary.low, boundary.high)
    floor, at_end = boundary.floor()
    over = np.array([fall(problem, s, floor, True) for s in saddles])
    above = np.argsort(over)
    above = above[over[above] > 0]
    groups: list[int] = []  # saddles of one height are one
    for i in above:  # higher by both measures: of two that differ by rounding, one may say that they are level
        last = groups[-1] if groups else None
        if last is None or (over[i] > over[last] and fall(problem, saddles[i], saddles[last], True) > 0):
            groups.append(int(i))
    pins = np.array([floor, *saddles[groups]])
    height = np.array([0.0, *over[groups]])
    falls = np.array([[fall(problem, p, beta, k > 0 or not at_end) for beta in ends] for k, p in enumerate(pins)])
    falls = np.maximum(falls, height[:, None])
    features = [_features(problem, p, angles, ends, k > 0 or not at_end) for k, p in enumerate(pins)]
    angle, size = _shelves(problem)
    gaps = [np.array([-fall(problem, p, beta, k > 0 or not at_end) for beta in angle]) for k, p in enumerate(pins)]
    width = np.diff(height)
    tops = [np.log(w / 2) for w in width]
    if boundary.whole_turns > 0 or boundary.high != boundary.low:
        reach = abs(float(problem.betaL[0] - problem.beta0[0])) / float(problem.span[0])
        tops.append(np.log((2 * reach) ** 2 + 1e-3 * height_scale(problem)))
    lowest = min([*tops, *(f for feature in features for f in feature)])
    deepest = max(LOWEST, lowest - (80 if at_end else 40))
    boundary = replace(boundary, pins=pins, falls=falls, deepest=deepest)
    shelves = [[_beside(sign * gap, size, step) for sign in (1, -1)] for gap in gaps]
    return boundary, _levels_between(tops, features, shelves, deepest, step, len(groups), at_end)


def _levels_between(
    tops: list[float], features: list[Any], shelves: list[Any], deepest: float, step: float, groups: int, at_end: bool
) -> LevelGrid:
    """The levels from the lowest, past the heights of the saddles, to the highest."""
    rows: list[tuple[Any, ...]] = []

    def add(pin: int, sign: float, y: Array, at_saddle: bool = False) -> None:
        rows.append((np.full(y.size, pin), np.full(y.size, sign), y, np.full(y.size, at_saddle)))

    height = np.array([deepest])
    for k, top in enumerate(tops):
        add(k, 1.0, height, True)
        up = grid_levels(top, features[k], shelves[k][0], deepest, step)[::-1]
        if at_end and k == 0:  # next to rest the times are linear in beta_t at that end
            law = min([top, *features[0]]) - 36
            up = up[(up == deepest) | (up >= law)]
        add(k, 1.0, up)
        if k < groups:
            add(k + 1, -1.0, grid_levels(top, features[k + 1], shelves[k + 1][1], deepest, step)[1:])
    if len(tops) == groups and groups:
        add(groups, -1.0, height, True)
    if not rows:  # no level joins the ends but a helix's own
        empty = np.empty(0)
        return LevelGrid(Levels(empty.astype(int), empty, empty), empty.astype(bool), at_end)
    pin, sign, y, at_saddle = (np.concatenate(column) for column in zip(*rows, strict=True))
    return LevelGrid(Levels(pin, sign, y), at_saddle, at_end)


def grid_levels(top: float, features: Array, shelves: Array, deepest: float, step: float) -> Array:
    """Values of log gap from `top` down to `deepest`.

    They are dense below the top and about the `features`, where the transit times change their law, and sparse between,
    where the times are linear in log gap. shelves: values beside shelves (`_beside`).
    """
    parts = [top - np.arange(0, 8, step), np.arange(top - 8, deepest, -8 * step), np.array([deepest])]
    parts += [f + np.arange(-8, 5, 2 * step) for f in np.unique(np.round(features))]
    y = np.unique(np.concatenate(parts))[::-1]
    y = y[(y <= top) & (y >= deepest)]
    kept = [0]
    for k in range(1, y.size):
        if y[kept[-1]] - y[k] > 0.4 * step:
            kept.append(k)
    y = y[kept]
    y[-1] = deepest
    if shelves.size:
        y = np.unique(np.concatenate([y, shelves[(shelves < top) & (shelves > deepest)]]))[::-1]
    return y


def _shelves(problem: EndsProblem) -> tuple[Array, Array]:
    """Angles at which G falls or rises least between two of its bends (H' = 0, H H'' > 0), and the half heights of the
    stretches about them in which G is almost level."""
    falls = slope_rate(problem, _SCAN) < 0
    at = sign_changes(lambda x: slope_rate(problem, x), _SCAN, np.where(falls, -1, 1), 25)
    second, _ = slope_higher_rates(problem, at)
    H = slope(problem, at)
    shelf = H * second > 0
    H, second = H[shelf], second[shelf]
    return at[shelf], 2 * np.abs(H) * np.sqrt(6 * np.abs(H / second))


def _beside(gap: Array, size: Array, step: float) -> Array:
    """Values of log gap on both sides of the shelves whose peak is narrower than the grid; gap: above the pin."""
    out = [np.empty(0)]
    for depth, w in zip(gap, size, strict=True):
        if 0 < w < step * depth:
            off = w / 8 * np.exp(np.arange(0.0, np.log(8 * step * depth / w), 2 * step))
            out.append(np.log(np.concatenate([[depth], depth - off, depth + off])))
    return np.concatenate(out)


def _features(problem: EndsProblem, pin: float, angles: Array, ends: tuple[float, float], extremum: bool) -> Array:
    """Values of log gap about which the transit times change their law, measured from a pin.

    They are the heights of the other critical points and of the ends above the pin, and where G stops being a parabola.
    """
    apart = [abs(fall(problem, a, pin, True)) for a in angles]
    apart += [abs(fall(problem, pin, beta, extremum)) for beta in ends]
    if extremum:
        at = np.array([pin])
        bend = abs(float(slope_rate(problem, at)[0]))
        second, third = (abs(float(v[0])) for v in slope_higher_rates(problem, at))
        reach = min(bend / max(second, 1e-300), np.sqrt(bend / max(third, 1e-300)), 1.0)
        apart.append(bend * reach**2)
    apart = [a for a in apart if a > 0]
    return np.maximum(np.log(apart), LOWEST + 40)
