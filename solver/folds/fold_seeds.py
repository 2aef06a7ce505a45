"""Points of fold and pitchfork curves between two points of the plane whose equilibria differ in number.

The equilibria at both ends of a line are counted by their Morse index, which nothing but a fold or a pitchfork changes.
The line is halved until Newton's rule, started between two equilibria that are about to meet, finds where they do.
"""

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import combinations, pairwise
from typing import Any

import numpy as np

from ..levels.level_search import MOST_PERIODS, Census, census, near_misses
from ..numerics.arclength import FOLD, PITCHFORK
from ..numerics.arrays import Array
from .curve_crossings import Pieces, change_along
from .orbit_folds import GivenAt, OrbitFold, fold_on_line, pitchfork_on_line
from .parameter_plane import ParameterPlane
from .separatrix_folds import DeadPoint, separatrix_guess
from .special_line import point_on_line

_FIRST, _LAST = 0.02, 1e-7  # lengths of a line, in shares: from where Newton's rule is tried, and where it ends
_DEEP = 1e-3  # length from which on the pair may be next to a separatrix
_PAIRS = 6  # of equilibria that are tried as those that meet
_FINER = 24  # parts of a range into which lines are cut whose ends differ in the levels that nearly meet
_NARROW = 1e-4  # shares: a strip between two curves that is narrower is not looked for


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


Known = Callable[[str, DeadPoint], bool]
Seed = tuple[str, DeadPoint]  # a point of a curve, of the kind FOLD or PITCHFORK


@dataclass(frozen=True, eq=False)
class Seeds:
    """What a search of points of curves needs. scale: of beta_t(0). known: whether a point lies on a known curve."""

    counted: Counted
    given_at: GivenAt
    scale: float
    known: Known

    def between(self, pieces: Pieces, start: Array, end: Array) -> Seed | tuple[Array, Array] | None:
        """A point of a curve on the line from start to end that is not among the known ones.

        Where Newton's rule finds none, the two ends of the short line between which the numbers change; None where they
        do not change.
        """
        while True:
            change = change_beyond(self.counted, pieces, start, end)
            if not change:
                return None
            if np.abs(end - start).max() <= _FIRST:
                seed = self._seed_on(change, start, end)
                if seed is not None:
                    return seed
            if np.abs(end - start).max() <= _LAST:
                return start, end
            middle = (start + end) / 2
            if change_beyond(self.counted, pieces, start, middle):
                end = middle
            else:
                start = middle

    def _seed_on(self, change: Counter[int], start: Array, end: Array) -> Seed | None:
        """The point of the line at which two equilibria meet."""
        rich, poor = (end, start) if sum(change.values()) > 0 else (start, end)
        equilibria, axis = self.counted.at(rich), int(np.argmax(np.abs(end - start)))
        lost = {index for index, n in change.items() if n}
        some = [i for i in range(equilibria.count) if int(equilibria.index[i]) in lost]
        pairs = [
            (i, j) for i, j in combinations(some, 2) if abs(int(equilibria.index[i]) - int(equilibria.index[j])) == 1
        ]
        pairs.sort(key=lambda pair: abs(equilibria.slope[pair[0]] - equilibria.slope[pair[1]]))
        is_short = bool(np.abs(end - start).max() < _DEEP)
        for pair in pairs[:_PAIRS]:
            lower = int(min(equilibria.index[i] for i in pair))
            for kind in (FOLD, PITCHFORK):
                for point in self._points(kind, equilibria, pair, (start + end) / 2, axis, is_short):
                    share = (point.z[axis] - poor[axis]) / (rich[axis] - poor[axis])
                    if point.lower == lower and -0.01 <= share <= 1.01 and not self.known(kind, point):
                        return kind, point
        return None

    def _points(
        self, kind: str, equilibria: Census, pair: tuple[int, int], z: Array, axis: int, is_short: bool
    ) -> Iterator[DeadPoint]:
        """Points of a kind next to z on the line along number `axis`, from two equilibria that are about to meet.

        is_short: whether the line is so short that they may lie next to a separatrix.
        """
        if kind == FOLD:
            w = np.append(equilibria.slope[list(pair)].mean() / self.scale, z)
            fold = OrbitFold(given_at=self.given_at, scales=np.array([self.scale]), w=w)
            point: DeadPoint | None = fold_on_line(fold, axis)
        else:
            point = pitchfork_on_line(self.given_at, z, axis)
        if point is not None:
            yield point
        for i in pair if is_short else ():
            slope, turns = float(equilibria.slope[i]), int(equilibria.turns[i])
            guess = separatrix_guess(self.given_at, self.scale, z, slope, turns, kind)
            deep = None if guess is None else point_on_line(guess, axis)
            if deep is not None:
                yield deep
