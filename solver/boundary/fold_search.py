"""All fold and pitchfork curves that cross a rectangle of two fields, searched for on a lattice of points."""

from dataclasses import dataclass

import numpy as np

from ..mechanics.potential import load_size
from ..numerics.arrays import Array
from .census import Census
from .curve_crossings import Pieces, joined_pieces
from .fold_newton import CurvePoint
from .fold_seeds import Counted, seed_between, unexplained
from .fold_system import turns_at
from .fold_tracing import Trace, dense, traced
from .parameter_plane import ParameterPlane

_INSIDE = 1e-4  # shares of the ranges: how far the lattice stays away from the border, where the curves end
_SAME = 1e-3  # distance at which a point lies on a known curve
_EACH = 6  # curves at most that are searched for on one line


@dataclass(frozen=True, eq=False)
class Searched:
    """The curves of a plane.

    traces, lower: the curves, and the lower Morse index of the two equilibria that meet on each. counted: the censuses
    of all points that were looked at. open_lines: ends (2, 2) of short lines across which the numbers change and where
    no curve was found.
    """

    plane: ParameterPlane
    traces: list[Trace]
    lower: list[int]
    pieces: Pieces
    counted: Counted
    open_lines: list[Array]


def search_curves(plane: ParameterPlane, lattice: int) -> Searched:
    """The curves that cross the lines of a lattice of so many points along each field."""
    counted = Counted(plane)
    ticks = np.linspace(_INSIDE, 1 - _INSIDE, lattice)
    scale = float(np.sqrt(load_size(plane.problems(np.array([0.5, 0.5])))[0] + 1))
    traces: list[Trace] = []
    lower: list[int] = []
    pieces = joined_pieces([], [])
    failed: list[Array] = []
    for start, end in _edges(ticks):
        for _ in range(_EACH):
            if not unexplained(counted, pieces, start, end):
                break
            found = seed_between(counted, pieces, start, end, scale)
            if found is None:
                break
            if isinstance(found[0], np.ndarray):
                failed.append(np.array(found))
                break
            system, seed = found
            if any(_lies_on(trace, seed) for trace in traces):
                break  # the line ends so near to a known curve that its polyline is on the wrong side
            trace = traced(system, seed)
            traces.append(trace)
            lower.append(turns_at(plane, float(seed.x[0]) * scale, seed.shares) - 1)
            pieces = joined_pieces([dense(one) for one in traces], lower)
    return Searched(plane, traces, lower, pieces, counted, failed)


def _lies_on(trace: Trace, seed: CurvePoint) -> bool:
    """Whether a point lies on a curve that is known already."""
    if seed.x.size != trace.points[0].x.size:
        return False
    first, last = (np.array([point.x for point in some]) for some in (trace.points[:-1], trace.points[1:]))
    chord = last - first
    share = np.clip(((seed.x - first) * chord).sum(axis=1) / (chord * chord).sum(axis=1), 0, 1)
    far = np.linalg.norm(first + share[:, None] * chord - seed.x, axis=1)
    return bool((far < _SAME + 0.1 * np.linalg.norm(chord, axis=1)).any())


def _edges(ticks: Array) -> list[tuple[Array, Array]]:
    """The edges of the lattice, those of its border first."""
    lines = [(np.array([a, w]), np.array([b, w])) for w in ticks for a, b in zip(ticks, ticks[1:], strict=False)]
    lines += [(start[::-1].copy(), end[::-1].copy()) for start, end in lines]

    def inner(line: tuple[Array, Array]) -> float:
        return float(np.abs(line[0] + line[1] - 1).max() < 1 - 1e-9)

    return sorted(lines, key=inner)


def census_at(searched: Searched, shares: Array) -> Census:
    """The census of one point."""
    return searched.counted.at(shares)
