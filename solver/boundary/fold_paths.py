"""Whole fold curves: stretches traced in beta_t(0), and stretches next to a separatrix, joined."""

from dataclasses import replace

import numpy as np

from ..numerics.arrays import Array
from .fold_newton import CurvePoint, CurveSystem, FoldSystem, corrected
from .fold_tracing import CLOSED, LEFT, STOPPED, Trace, one_way, stretch
from .parameter_plane import ParameterPlane
from .separatrix_folds import SeparatrixSystem, deep_system

_MOST = 12  # stretches of a curve


def whole_curve(system: CurveSystem, seed: CurvePoint, lower: int) -> tuple[list[Trace], tuple[str, str]]:
    """The stretches of a curve in order, from one of its points, and how the curve ends at either side.

    lower: the lower Morse index of the two equilibria that meet.
    """
    ahead, end = _ahead(system, seed, lower)
    if end == CLOSED:
        return ahead, (CLOSED, CLOSED)
    back, start = _ahead(system, replace(seed, tangent=-seed.tangent), lower)
    return [_turned(trace) for trace in back[::-1]] + ahead, (start, end)


def _ahead(system: CurveSystem, seed: CurvePoint, lower: int) -> tuple[list[Trace], str]:
    """The stretches from a point on, each with the point at which it begins."""
    found: list[Trace] = []
    end = LEFT
    while len(found) < _MOST:
        points, end = one_way(system, seed)
        closing = [seed] if end == CLOSED else []
        found.append(stretch(system, [seed, *points, *closing]))
        if end != LEFT and not (end == STOPPED and isinstance(system, SeparatrixSystem)):
            break
        last = found[-1].points[-1]
        taken = _handed_over(system, last, lower)
        if taken is None:
            break
        system, seed = taken
    return found, STOPPED if end == LEFT else end


def _turned(trace: Trace) -> Trace:
    points = [replace(point, tangent=-point.tangent) for point in trace.points[::-1]]
    return stretch(trace.system, [point for point in points if point.bend != 0])


def _handed_over(system: CurveSystem, last: CurvePoint, lower: int) -> tuple[CurveSystem, CurvePoint] | None:
    """The other equations of the curve and its point there, with its tangent in the same direction."""
    if isinstance(system, FoldSystem):
        slope = float(last.x[0]) * system.scale
        return deep_point(system.plane, system.scale, last.shares, slope, lower + 1, system.kind, last)
    assert isinstance(system, SeparatrixSystem)
    same = system.moved(last.x) if system.leaves(last.x) else None
    if same is not None:
        return same, last
    following = FoldSystem(system.plane, system.kind, system.scale)
    for slope in system.slopes(last.x):
        x = np.concatenate([[slope / system.scale], last.shares, np.zeros(following.size - 3)])
        point = _on(following, x, last)
        if point is not None and following.is_true(point) and following.has_index(point, lower):
            return following, point
    return None


def deep_point(
    plane: ParameterPlane, scale: float, shares: Array, slope: float, turns: int, kind: str, near: CurvePoint | None
) -> tuple[CurveSystem, CurvePoint] | None:
    """The point next to a separatrix of the curve near some shares, and its system."""
    found = deep_system(plane, scale, shares, slope, turns, kind)
    if found is None:
        return None
    system, x = found
    point = _on(system, x, near)
    return None if point is None else (system, point)


def _on(system: CurveSystem, x: Array, near: CurvePoint | None) -> CurvePoint | None:
    """The point of the curve near x, its tangent in the direction of that of `near`."""
    rows = np.eye(x.size)[1:3]
    if near is not None:
        rows = rows[np.argsort(-np.abs(near.tangent[1:3]))]
    for row in rows:
        point = corrected(system, x, row, float(row @ x))
        if point is not None and np.abs(point.shares - x[1:3]).max() < 0.02:
            if near is not None and point.tangent[1:3] @ near.tangent[1:3] < 0:
                point = replace(point, tangent=-point.tangent)
            return point
    return None
