"""A curve traced by `fold_line` as the stretch of a curve of `fold_search`."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..numerics.arclength import FOLD, node_at
from ..numerics.arrays import Array
from .fold_line import Equilibrium, FoldPoint, fold_line, lower_index
from .fold_search import WholeCurve, lies_on
from .fold_system import CurvePoint

MOST = 500  # points in each sense


@dataclass(frozen=True, eq=False)
class Line:
    """A curve as `fold_search` has it. places: (N, 2 + m), z and the signature of the equilibrium at each point."""

    kind: str
    points: list[CurvePoint]
    cusps: list[int]
    slopes: list[float]
    places: Array

    def holds(self, z: Array, signature: Array) -> bool:
        """Whether the special point of a branch at z lies on the curve."""
        return lies_on(self.places, np.concatenate([z, signature]))


def is_on_curves(curves: Sequence[WholeCurve], kind: str, z: Array, signature: Array) -> bool:
    """Whether an equilibrium at z lies on one of the curves that are of a kind."""
    lines = (line for curve in curves for line in curve.stretches if isinstance(line, Line) and line.kind == kind)
    return any(line.holds(z, signature) for line in lines)


def curve_points(places: Array, ways: list[Array], sides: list[Array], cusps: list[int]) -> list[CurvePoint]:
    """Points of a curve at places (N, 2) with tangents along `ways`, in the order of the points."""
    chord = np.gradient(places, axis=0) if len(places) > 1 else np.zeros_like(places)
    found = []
    for i, (place, way, side) in enumerate(zip(places, ways, sides, strict=True)):
        tangent = np.zeros(2) if i in cusps else way * np.sign(way @ chord[i])
        found.append(CurvePoint(np.append(0.0, place), np.append(0.0, tangent), 0.0, side))
    return found


def fold_through(
    z: Array, axis: int, equilibrium: Equilibrium, slope: Callable[[Any], float], signature: Callable[[Any], Array]
) -> WholeCurve:
    """The curve of the fold at z of a branch along number `axis`, in the unit square.

    slope, signature: beta_t(0) of an equilibrium, and numbers that tell it from others.
    """
    across, along = np.eye(2)[[axis, 1 - axis]]
    first = FoldPoint(z, along, across, equilibrium)
    node = node_at(first, first.w, np.array([0.0, 1.0]))
    turned = None if isinstance(node, str) else first.after(node)
    first = first if turned is None else turned[0]
    (back, begin), (ahead, end) = (fold_line(first, sense, MOST) for sense in (-1.0, 1.0))
    points = [*back[::-1], first, *ahead]
    cusps = [i for i, point in enumerate(points) if point.more == 0 and point is not first]
    places = np.array([point.z for point in points])
    marks = curve_points(places, [p.along for p in points], [p.more * p.across for p in points], cusps)
    each = [point.equilibrium for point in points]
    signatures = np.array([signature(one) for one in each])
    line = Line(FOLD, marks, cusps, [slope(one) for one in each], np.column_stack([places, signatures]))
    return WholeCurve([line], (begin, end), lower_index(first))
