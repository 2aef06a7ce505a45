"""All fold and pitchfork curves that cross a rectangle of two fields under dead loads, searched for on a lattice.

The equilibria at both ends of a line are counted by their Morse index, which nothing but a fold or a pitchfork changes.
The line is halved until Newton's rule, started between two equilibria that are about to meet, finds where they do.
"""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial
from itertools import combinations, pairwise
from typing import Any

import numpy as np

from ..numerics.arclength import FOLD, PITCHFORK
from ..numerics.arrays import Array
from ..numerics.roots import CLOSE
from ..orbits.level_search import MOST_PERIODS, Census, census, near_misses
from .fold_tracing import Tracing, cusps_between, point_on_line, special_line
from .orbit_folds import (
    DEEP,
    LENGTHS,
    SHALLOW,
    GivenAt,
    OrbitPoint,
    guess_at,
    in_log_gap,
    in_other_form,
    numbers_on,
    sides_between,
)
from .parameter_plane import ParameterPlane
from .whole_curve import CurvePieces, WholeCurve, change_along, pieces_of, whole_curve, without_zeros

# shares of the ranges: nearer to their border, where curves end, and in a narrower strip none is sought. x10: folds
# there are not found
_FINEST = 1e-4
# of a gap: lines of the lattice stay off lines of symmetry, on which cusps lie. x10: the last ones leave the range
_ASKEW = np.array([0.13, -0.17])
_PROBES = 30  # random points that are looked at beside the lattice. x10: 2.5 times the time, and no other curve
_EACH = 6  # curves at most that are searched for on one line. x10: time, where a change of numbers cannot be explained
# length of a line, in shares, from where Newton's rule is tried. x10: it starts too far off and fails, which costs time
_FIRST = 0.02
_PAIRS = 6  # of equilibria that are tried as those that meet, the most alike first. x10: only time
# parts of a range into which lines are cut whose ends differ in the levels that nearly meet. x10: 2.8 times the time
_FINER = 24


@dataclass(eq=False)
class Searched:
    """The curves of a plane, and the points at which equilibria were counted, each once.

    pieces: of the curves. counted: the censuses of the points. open_lines: ends (2, 2) of short lines across which the
    numbers change and where no curve was found.
    """

    plane: ParameterPlane
    curves: list[WholeCurve] = field(default_factory=list)
    pieces: CurvePieces = field(default_factory=partial(pieces_of, ()))
    counted: dict[tuple[float, ...], Census] = field(default_factory=dict)
    open_lines: list[Array] = field(default_factory=list)
    _missed: dict[tuple[float, ...], tuple[int, Counter[Any]]] = field(default_factory=dict)

    def add(self, curves: list[WholeCurve]) -> None:
        """Take more curves."""
        self.curves += curves
        self.pieces = pieces_of(self.curves)

    def holds(self, kind: str, z: Array, mark: Array, lower: int | None = None) -> bool:
        """Whether an equilibrium at z with a mark lies on a known curve of a kind; lower: and of that lower index."""
        alike = (curve for curve in self.curves if curve.kind == kind and lower in (None, curve.lower))
        return any(curve.holds(z, mark) for curve in alike)

    def at(self, shares: Array) -> Census:
        """The equilibria at a point."""
        key = tuple(shares.tolist())
        if key not in self.counted:
            self.counted[key] = census(self.plane.problems(shares))
        return self.counted[key]

    def near_misses(self, shares: Array) -> tuple[int, Counter[Any]]:
        """How many near misses `orbits.level_search` counts at a point, and of which kinds."""
        key = tuple(shares.tolist())
        if key not in self._missed:
            self._missed[key] = near_misses(self.plane.problems(shares), MOST_PERIODS)
        return self._missed[key]

    def change_beyond(self, start: Array, end: Array) -> Counter[int]:
        """The change of the numbers of equilibria of each index from start to end that no known curve explains."""
        change = Counter(self.at(end).indices)
        change.subtract(self.at(start).indices)
        change.subtract(change_along(self.pieces, start, end))
        return without_zeros(change)

    def strip_between(self, start: Array, end: Array) -> Array | None:
        """A point between two others, of numbers that the known curves explain, where they do not explain the numbers.

        On some path two levels have met before and two others part beyond, so that two curves lie between the points
        and undo each other's change. None where no path shows it, or where the strip is narrower than `_FINEST`.
        """
        differ = self.near_misses(start) != self.near_misses(end)
        parts = int(np.ceil(_FINER * np.abs(end - start).max())) if differ else 1
        points = [start + share * (end - start) for share in np.linspace(0, 1, parts + 1)]
        strips = (self._strip(*two) for two in pairwise(points) if self._may_hide_two(*two))
        return next((strip for strip in strips if strip is not None), None)

    def _strip(self, start: Array, end: Array) -> Array | None:
        """As `strip_between`, by halves."""
        if self.change_beyond(start, end):
            return end
        while np.abs(end - start).max() > _FINEST:
            middle = np.asarray((start + end) / 2)
            if self.change_beyond(start, middle):
                return middle
            start, end = (start, middle) if self._may_hide_two(start, middle) else (middle, end)
        return None

    def _may_hide_two(self, start: Array, end: Array) -> bool:
        """Whether the length of some path has one least value above the rod's less at one point than at the other, and
        one largest value below it more; or the number of equilibria changes as the known curves do not explain."""
        (before, _), (after, missed) = self.near_misses(start), self.near_misses(end)
        if after - before != sum(change_along(self.pieces, start, end).values()):
            return True
        change = Counter(missed)
        change.subtract(self.near_misses(start)[1])
        return any(n * change[(*key[:2], not key[2])] < 0 for key, n in list(change.items()) if key[2])


def search_curves(plane: ParameterPlane, lattice: int) -> Searched:
    """The curves that cross the lines of a lattice of so many points along each field."""
    searched, ticks = Searched(plane), _ticks(lattice)
    seeds, edges = _LineSearch(searched, numbers_on(plane)), lattice_edges(*ticks)
    edges.sort(key=lambda edge: bool(np.abs(edge[0] + edge[1] - 1).max() < 1 - 3 * _FINEST))  # the border first
    for line in [*edges, *_probes(ticks)]:
        seeds.search_line(*line)
    for start, end in edges:
        middle = searched.strip_between(start, end)
        if middle is not None:
            seeds.search_line(start, middle)
            seeds.search_line(middle, end)
    return searched


def curve_through(point: OrbitPoint) -> WholeCurve:
    """The curve of a rod without weight through one of its points."""
    how: Tracing[OrbitPoint] = Tracing(LENGTHS, cusps_between if point.kind == FOLD else sides_between, in_other_form)
    return whole_curve(special_line(point, how))


@dataclass(frozen=True, eq=False)
class _LineSearch:
    """The search for points of curves."""

    searched: Searched
    numbers_at: GivenAt

    def search_line(self, start: Array, end: Array) -> None:
        """Add curves that cross a line until they explain its change of numbers."""
        for _ in range(_EACH):
            seed = self._between(start, end)
            if seed is None:
                break
            if isinstance(seed, tuple):
                self.searched.open_lines.append(np.array(seed))
                break
            self.searched.add([curve_through(seed)])

    def _between(self, start: Array, end: Array) -> OrbitPoint | tuple[Array, Array] | None:
        """A point of a curve on the line from start to end that is not among the known ones.

        Where Newton's rule finds none, the two ends of the short line between which the numbers change; None where they
        do not change.
        """
        while change := self.searched.change_beyond(start, end):
            length = np.abs(end - start).max()
            seed = self._point_of_both(change, start, end) if length <= _FIRST else None
            if seed is not None:
                return seed
            if length <= CLOSE:
                return start, end
            middle = (start + end) / 2
            start, end = (start, middle) if self.searched.change_beyond(start, middle) else (middle, end)
        return None

    def _point_of_both(self, change: Counter[int], start: Array, end: Array) -> OrbitPoint | None:
        """The point of the line at which two equilibria meet."""
        rich, poor = (end, start) if sum(change.values()) > 0 else (start, end)
        equilibria, axis = self.searched.at(rich), int(np.argmax(np.abs(end - start)))
        index = equilibria.index.tolist()
        lost = [i for i in range(equilibria.count) if change[index[i]]]
        pairs = [(i, j) for i, j in combinations(lost, 2) if abs(index[i] - index[j]) == 1]
        marks = np.stack([equilibria.dbeta0, _depths(equilibria)], axis=1)
        pairs.sort(key=lambda pair: float(np.abs(marks[pair[0]] - marks[pair[1]]).sum()))
        for i, j in pairs[:_PAIRS]:
            for point in self._points(equilibria, [i, j], rich, poor):
                share = (point.z[axis] - poor[axis]) / (rich[axis] - poor[axis])
                if point.lower != min(index[i], index[j]) or not -0.01 <= share <= 1.01:
                    continue
                if not self.searched.holds(point.kind, point.z, point.mark, point.lower):
                    return point
        return None

    def _points(self, equilibria: Census, pair: list[int], rich: Array, poor: Array) -> Iterator[OrbitPoint]:
        """Points on the line between two others, folds first, from two equilibria at the rich one that are about to
        meet. Next to a saddle their log gaps, too, lie on both sides of that of the fold, about as far from it.
        """
        axis, middle = int(np.argmax(np.abs(rich - poor))), (rich + poor) / 2
        dbeta0, y = (float(numbers[pair].mean()) for numbers in (equilibria.dbeta0, equilibria.y))
        saddle, sign = equilibria.saddle[pair], equilibria.sign[pair]
        is_beside = bool(saddle[0] == saddle[1] and sign[0] == sign[1])
        for kind in (FOLD, PITCHFORK):
            plain = guess_at(kind, self.numbers_at, middle, {"dbeta0": dbeta0})
            beside = in_log_gap(plain, SHALLOW, (float(saddle[0]), float(sign[0]), y)) if is_beside else None
            for guess in (beside, plain):
                point = None if guess is None else point_on_line(guess, axis)
                if point is not None and point.saddle is None:
                    other = in_log_gap(point, DEEP)
                    point = point if other is None else point_on_line(other, axis)
                if point is not None:
                    yield point


def _depths(equilibria: Census) -> Array:
    """How deep the levels lie next to a saddle, in log gap below `SHALLOW` and with the sign of the gap, (K,)."""
    return np.nan_to_num(equilibria.sign * np.maximum(np.log(SHALLOW) - equilibria.y, 0.0))


def _ticks(lattice: int) -> Array:
    """The shares of the lines of the lattice along both fields, (2, lattice)."""
    ticks = np.tile(np.linspace(_FINEST, 1 - _FINEST, lattice), (2, 1))
    ticks[:, 1:-1] += _ASKEW[:, None] / (lattice - 1)
    return ticks


def _probes(ticks: Array) -> list[tuple[Array, Array]]:
    """Lines from points of the lattice to random points, along one field and then along the other."""
    lines = []
    for point in np.random.default_rng(0).uniform(_FINEST, 1 - _FINEST, (_PROBES, 2)):
        near = np.array([row[np.abs(row - share).argmin()] for row, share in zip(ticks, point, strict=True)])
        corner = np.array([point[0], near[1]])
        lines += [(near, corner), (corner, point)]
    return lines


def lattice_edges(across: Array, up: Array) -> list[tuple[Array, Array]]:
    """The edges of the lattice with lines at some values of either share, along the first one before the second."""
    lines = [(np.array([a, w]), np.array([b, w])) for w in up for a, b in pairwise(across)]
    return lines + [(np.array([u, a]), np.array([u, b])) for u in across for a, b in pairwise(up)]
