"""Points of fold and pitchfork curves between two points of the plane whose equilibria differ in number.

The equilibria at both ends of a line are counted by their Morse index, which nothing but a fold or a pitchfork changes.
The line is halved until Newton's rule, started between two equilibria that are about to meet, finds where they do.
"""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import combinations, pairwise
from typing import Any

import numpy as np

from ..levels.census import Census, census
from ..levels.level_search import MOST_PERIODS, near_misses
from ..numerics.arclength import FOLD, PITCHFORK
from ..numerics.arrays import Array
from .curve_crossings import Pieces, change_along
from .fold_system import CurvePoint, CurveSystem, FoldSystem, correct_curve_point
from .parameter_plane import ParameterPlane
from .separatrix_folds import deep_system

_FIRST, _LAST = 0.02, 1e-7  # lengths of a line, in shares: from where Newton's rule is tried, and where it ends
_DEEP = 1e-3  # length from which on the pair may be next to a separatrix
_PAIRS = 6  # of equilibria that are tried as those that meet
_FINER = 24  # parts of a range into which lines are cut whose ends differ in the levels that nearly meet
_NARROW = 1e-4  # shares: a strip between two curves that is narrower is not looked for


@dataclass(frozen=True, eq=False)
class CurveSeed:
    """A point of a curve, its equations, and the lower Morse index of the two equilibria that meet."""

    system: CurveSystem
    point: CurvePoint
    lower: int


@dataclass(eq=False)
class Counted:
    """The censuses of points of a plane, each made once."""

    plane: ParameterPlane
    known: dict[tuple[float, float], Census] = field(default_factory=dict)
    _missed: dict[tuple[float, float], tuple[int, Counter[Any]]] = field(default_factory=dict)

    def at(self, shares: Array) -> Census:
        key = float(shares[0]), float(shares[1])
        if key not in self.known:
            self.known[key] = census(self.plane.problems(shares))
        return self.known[key]

    def near_misses(self, shares: Array) -> tuple[int, Counter[Any]]:
        key = float(shares[0]), float(shares[1])
        if key not in self._missed:
            self._missed[key] = near_misses(self.plane.problems(shares), MOST_PERIODS)
        return self._missed[key]


def change_beyond(counted: Counted, pieces: Pieces, start: Array, end: Array) -> Counter[int]:
    """The change of the numbers of equilibria of each index from start to end that no known curve explains."""
    change = Counter(counted.at(end).indices)
    change.subtract(counted.at(start).indices)
    change.subtract(change_along(pieces, start, end))
    return Counter({index: n for index, n in change.items() if n})


def strip_between(counted: Counted, pieces: Pieces, start: Array, end: Array) -> Array | None:
    """A point between two others, of numbers that the known curves explain, at which they do not explain the numbers.

    On some path two levels have met before and two others part beyond, so that two curves lie between the points and
    undo each other's change. None where no path shows it, or where the strip is narrower than `_NARROW`.
    """
    differ = counted.near_misses(start) != counted.near_misses(end)
    parts = int(np.ceil(_FINER * np.abs(end - start).max())) if differ else 1
    points = [start + share * (end - start) for share in np.linspace(0, 1, parts + 1)]
    strips = (_strip(counted, pieces, *two) for two in pairwise(points) if _may_hide_two(counted, pieces, *two))
    return next((strip for strip in strips if strip is not None), None)


def _strip(counted: Counted, pieces: Pieces, start: Array, end: Array) -> Array | None:
    """As `strip_between`, by halves."""
    if change_beyond(counted, pieces, start, end):
        return np.asarray(end)
    while np.abs(end - start).max() > _NARROW:
        middle = (start + end) / 2
        if change_beyond(counted, pieces, start, middle):
            return np.asarray(middle)
        if _may_hide_two(counted, pieces, start, middle):
            end = middle
        else:
            start = middle
    return None


def _may_hide_two(counted: Counted, pieces: Pieces, start: Array, end: Array) -> bool:
    """Whether the length of some path has one least value above the rod's less at one point than at the other, and one
    largest value below it more; or the number of equilibria changes as the known curves do not explain."""
    (before, _), (after, missed) = counted.near_misses(start), counted.near_misses(end)
    if after - before != sum(change_along(pieces, start, end).values()):
        return True
    change = Counter(missed)
    change.subtract(counted.near_misses(start)[1])
    return any(n * change[(*key[:2], not key[2])] < 0 for key, n in list(change.items()) if key[2])


def seed_between(
    counted: Counted, pieces: Pieces, start: Array, end: Array, scale: float, known: Callable[[CurveSeed], bool]
) -> CurveSeed | tuple[Array, Array] | None:
    """A point of a curve on the line from start to end that is not among the known ones; known: whether it is.

    Where Newton's rule finds none, the two ends of the short line between which the numbers change; None where they do
    not change.
    """
    while True:
        change = change_beyond(counted, pieces, start, end)
        if not change:
            return None
        if np.abs(end - start).max() <= _FIRST:
            found = _met(counted, change, start, end, scale, known)
            if found is not None:
                return found
        if np.abs(end - start).max() <= _LAST:
            return start, end
        middle = (start + end) / 2
        if change_beyond(counted, pieces, start, middle):
            end = middle
        else:
            start = middle


def _met(
    counted: Counted, change: Counter[int], start: Array, end: Array, scale: float, known: Callable[[CurveSeed], bool]
) -> CurveSeed | None:
    """The point of the line at which two equilibria meet."""
    rich, poor = (end, start) if sum(change.values()) > 0 else (start, end)
    here = counted.at(rich)
    lost = {index for index, n in change.items() if n}
    some = [i for i in range(here.count) if int(here.index[i]) in lost]
    pairs = [(i, j) for i, j in combinations(some, 2) if abs(int(here.index[i]) - int(here.index[j])) == 1]
    pairs.sort(key=lambda pair: abs(here.slope[pair[0]] - here.slope[pair[1]]))
    along = int(np.argmax(np.abs(end - start)))
    for i, j in pairs[:_PAIRS]:
        lower = int(min(here.index[i], here.index[j]))
        v = float(here.slope[i] + here.slope[j]) / 2
        for kind in (FOLD, PITCHFORK):
            found = _on_line(counted.plane, kind, scale, v, lower, (start, end, along))
            if found is None and np.abs(end - start).max() < _DEEP:
                found = _deep_on_line(counted.plane, kind, scale, here, (i, j), (start, end, along))
            if found is None:
                continue
            share = (found.point.shares[along] - poor[along]) / (rich[along] - poor[along])
            if -0.01 <= share <= 1.01 and not known(found):
                return found
    return None


def _on_line(
    plane: ParameterPlane, kind: str, scale: float, v: float, lower: int, line: tuple[Array, Array, int]
) -> CurveSeed | None:
    """A point of a curve on a line, from a guess of beta_t(0)."""
    start, end, along = line
    system = FoldSystem(plane, kind, scale)
    row = np.zeros(system.size)
    row[2 - along] = 1.0  # the other share is held
    x = np.concatenate([[v / scale], (start + end) / 2, np.zeros(system.size - 3)])
    point = correct_curve_point(system, x, row, float(x[2 - along]))
    if point is None or not system.is_true(point) or not system.has_index(point, lower):
        return None
    return CurveSeed(system, point, lower)


def _deep_on_line(
    plane: ParameterPlane, kind: str, scale: float, here: Census, pair: tuple[int, int], line: tuple[Array, Array, int]
) -> CurveSeed | None:
    """A point of a curve next to a separatrix on a line."""
    start, end, along = line
    middle = (start + end) / 2
    lower = int(min(here.index[i] for i in pair))
    for i in pair:
        made = deep_system(plane, scale, middle, float(here.slope[i]), int(here.turns[i]), kind)
        if made is not None:
            system, x = made
            row = np.zeros(3)
            row[2 - along] = 1.0
            point = correct_curve_point(system, x, row, float(x[2 - along]))
            if point is not None and system.has_index(point.x, lower):
                return CurveSeed(system, point, lower)
    return None
