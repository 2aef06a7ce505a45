"""All fold and pitchfork curves that cross a rectangle of two fields, searched for on a lattice of points."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol

import numpy as np

from ..mechanics.potential import load_size
from ..numerics.arrays import Array, Booleans
from .curve_crossings import Pieces, join_pieces
from .fold_seeds import Counted, CurveSeed, change_beyond, seed_between, strip_between
from .fold_system import CurvePoint
from .fold_tracing import PIECES, Trace, dense, whole_curve
from .parameter_plane import ParameterPlane

_INSIDE = 1e-4  # shares of the ranges: how far the lattice stays away from the border, where the curves end
_ASKEW = np.array([0.13, -0.17])  # of a gap: lines of the lattice stay off lines of symmetry, on which cusps lie
_SAME = 1e-3  # distance at which a point lies on a known curve
_PROBES = 30  # random points that are looked at beside the lattice
_EACH = 6  # curves at most that are searched for on one line


class Stretch(Protocol):
    """Points of a curve, the numbers of those that are cusps, and beta_t(0) at each."""

    @property
    def kind(self) -> str: ...
    @property
    def points(self) -> list[CurvePoint]: ...
    @property
    def cusps(self) -> list[int]: ...
    @property
    def slopes(self) -> list[float]: ...


@dataclass(frozen=True, eq=False)
class WholeCurve:
    """A curve in stretches, how it ends at either side, and the lower Morse index of the two equilibria that meet."""

    stretches: Sequence[Stretch]
    ends: tuple[str, str]
    lower: int

    @property
    def kind(self) -> str:
        return self.stretches[0].kind

    def dense(self) -> tuple[Array, Array]:
        """As `fold_tracing.dense`."""
        lines = [dense(stretch.points) for stretch in self.stretches]
        return np.concatenate([line for line, _ in lines]), np.concatenate([side for _, side in lines])

    @property
    def exact(self) -> Booleans:
        """Which of the points of `dense` are points of the curve itself, (N,)."""
        return np.concatenate(
            [np.arange(PIECES * (len(stretch.points) - 1) + 1) % PIECES == 0 for stretch in self.stretches]
        )


@dataclass(frozen=True, eq=False)
class Searched:
    """The curves of a plane.

    counted: the censuses of all points that were looked at. open_lines: ends (2, 2) of short lines across which the
    numbers change and where no curve was found.
    """

    plane: ParameterPlane
    curves: list[WholeCurve]
    pieces: Pieces
    counted: Counted
    open_lines: list[Array]


def search_curves(plane: ParameterPlane, lattice: int) -> Searched:
    """The curves that cross the lines of a lattice of so many points along each field."""
    counted = Counted(plane)
    ticks = _ticks(lattice)
    scale = float(np.sqrt(load_size(plane.problems(np.array([0.5, 0.5])))[0] + 1))
    curves: list[WholeCurve] = []
    traces: list[Trace] = []
    pieces = join_pieces([], [])
    failed: list[Array] = []

    def known(found: CurveSeed) -> bool:
        return any(_lies_on(trace, found) for trace in traces)

    def search_line(start: Array, end: Array) -> None:
        nonlocal pieces
        for _ in range(_EACH):
            if not change_beyond(counted, pieces, start, end):
                break
            found = seed_between(counted, pieces, start, end, scale, known)
            if found is None:
                break
            if not isinstance(found, CurveSeed):
                failed.append(np.array(found))
                break
            stretches, ends = whole_curve(found.system, found.point, found.lower)
            traces.extend(stretches)
            curves.append(WholeCurve(stretches, ends, found.lower))
            pieces = join_pieces([one.dense() for one in curves], [one.lower for one in curves])

    edges = _edges(ticks)
    for line in [*edges, *_probes(ticks)]:
        search_line(*line)
    for start, end in edges:
        middle = strip_between(counted, pieces, start, end)
        if middle is not None:
            search_line(start, middle)
            search_line(middle, end)
    return Searched(plane, curves, pieces, counted, failed)


def _lies_on(trace: Trace, found: CurveSeed) -> bool:
    """Whether a point lies on a curve that is known already."""
    if type(trace.system) is not type(found.system) or trace.kind != found.system.kind:
        return False
    return lies_on(np.array([point.x for point in trace.points]), found.point.x)


def lies_on(points: Array, x: Array) -> bool:
    """Whether x (n,) lies on the polyline through points (N, n), as closely as such a polyline follows its curve."""
    first, last = (points[:-1], points[1:]) if len(points) > 1 else (points, points)
    chord = last - first
    share = np.clip(((x - first) * chord).sum(axis=1) / np.maximum((chord * chord).sum(axis=1), 1e-300), 0, 1)
    far = np.linalg.norm(first + share[:, None] * chord - x, axis=1)
    return bool((far < _SAME + 0.1 * np.linalg.norm(chord, axis=1)).any())


def _ticks(lattice: int) -> Array:
    """The shares of the lines of the lattice along both fields, (2, lattice)."""
    ticks = np.tile(np.linspace(_INSIDE, 1 - _INSIDE, lattice), (2, 1))
    ticks[:, 1:-1] += _ASKEW[:, None] / (lattice - 1)
    return ticks


def _probes(ticks: Array) -> list[tuple[Array, Array]]:
    """Lines from points of the lattice to random points, along one field and then along the other."""
    lines = []
    for point in np.random.default_rng(0).uniform(_INSIDE, 1 - _INSIDE, (_PROBES, 2)):
        near = np.array([row[np.abs(row - share).argmin()] for row, share in zip(ticks, point, strict=True)])
        corner = np.array([point[0], near[1]])
        lines += [(near, corner), (corner, point)]
    return lines


def _edges(ticks: Array) -> list[tuple[Array, Array]]:
    """The edges of the lattice, those of its border first."""
    across, up = ticks
    lines = [(np.array([a, w]), np.array([b, w])) for w in up for a, b in pairwise(across)]
    lines += [(np.array([u, a]), np.array([u, b])) for u in across for a, b in pairwise(up)]

    def inner(line: tuple[Array, Array]) -> float:
        return float(np.abs(line[0] + line[1] - 1).max() < 1 - 3 * _INSIDE)

    return sorted(lines, key=inner)
