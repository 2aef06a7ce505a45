"""Whole fold curves: stretches traced in beta_t(0), and stretches next to a separatrix, joined."""

from dataclasses import replace

import numpy as np

from ..numerics.arrays import Array
from .fold_newton import CurvePoint, CurveSystem, FoldSystem, correct
from .fold_tracing import CLOSED, LEFT, STOPPED, Trace, one_way, stretch
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
    return [_turn(trace) for trace in back[::-1]] + ahead, (start, end)


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
        taken = _hand_over(system, last, lower)
        if taken is None:
            break
        system, seed = taken
    return found, STOPPED if end == LEFT else end


def _turn(trace: Trace) -> Trace:
    points = [replace(point, tangent=-point.tangent) for point in trace.points[::-1]]
    return stretch(trace.system, [point for point in points if point.bend != 0])


def _hand_over(system: CurveSystem, last: CurvePoint, lower: int) -> tuple[CurveSystem, CurvePoint] | None:
    """The other equations of the curve and its point there, with its tangent in the same direction."""
    if isinstance(system, FoldSystem):
        found = deep_system(system.plane, system.scale, last.shares, system.start_rate(last.x), lower + 1, system.kind)
        point = None if found is None else _on(*found, last)
        return None if found is None or point is None else (found[0], point)
    assert isinstance(system, SeparatrixSystem)
    same = system.moved(last.x) if system.leaves(last.x) else None
    if same is not None:
        return same, last
    following = FoldSystem(system.plane, system.kind, system.scale)
    x = np.concatenate([[system.start_rate(last.x) / system.scale], last.shares, np.zeros(following.size - 3)])
    point = _on(following, x, last)
    if point is None or not following.is_true(point) or not following.has_index(point, lower):
        return None
    return following, point


def _on(system: CurveSystem, x: Array, near: CurvePoint) -> CurvePoint | None:
    """The point of the curve near x, its tangent in the direction of that of `near`."""
    for row in np.eye(x.size)[1:3][np.argsort(-np.abs(near.tangent[1:3]))]:
        point = correct(system, x, row, float(row @ x))
        if point is not None and np.abs(point.shares - x[1:3]).max() < 0.02:
            if point.tangent[1:3] @ near.tangent[1:3] < 0:
                point = replace(point, tangent=-point.tangent)
            return point
    return None
