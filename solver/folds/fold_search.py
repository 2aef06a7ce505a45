"""All fold and pitchfork curves that cross a rectangle of two fields, searched for on a lattice of points."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ..mechanics.potential import load_size
from ..numerics.arclength import FOLD
from ..numerics.arrays import Array
from .curve_crossings import Pieces, join_pieces
from .fold_seeds import Counted, Seeds, change_beyond, strip_between
from .orbit_folds import LENGTHS, given_on, sides_between
from .parameter_plane import ParameterPlane
from .separatrix_folds import DeadPoint, in_other_form
from .special_line import MOST, Tracing, cusps_between, special_line
from .whole_curve import WholeCurve, whole_curve

_INSIDE = 1e-4  # shares of the ranges: how far the lattice stays away from the border, where the curves end
_ASKEW = np.array([0.13, -0.17])  # of a gap: lines of the lattice stay off lines of symmetry, on which cusps lie
_PROBES = 30  # random points that are looked at beside the lattice
_EACH = 6  # curves at most that are searched for on one line


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
    pieces = join_pieces([], [])
    failed: list[Array] = []

    def known(kind: str, point: DeadPoint) -> bool:
        alike = (curve for curve in curves if (curve.kind, curve.lower) == (kind, point.lower))
        return any(curve.holds(point.z, point.mark) for curve in alike)

    seeds = Seeds(counted, given_on(plane), scale, known)

    def search_line(start: Array, end: Array) -> None:
        nonlocal pieces
        for _ in range(_EACH):
            if not change_beyond(counted, pieces, start, end):
                break
            seed = seeds.between(pieces, start, end)
            if seed is None:
                break
            if not isinstance(seed[0], str):
                failed.append(np.array(seed))
                break
            curves.append(curve_through(*seed))
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


def curve_through(kind: str, point: DeadPoint) -> WholeCurve:
    """The curve of a kind under dead loads through one of its points."""
    how = Tracing(LENGTHS, MOST, cusps_between if kind == FOLD else sides_between, in_other_form)
    return whole_curve(kind, special_line(point, how), point.lower)


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
