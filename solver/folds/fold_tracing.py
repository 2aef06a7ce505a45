"""Fold and pitchfork curves by pseudo-arclength continuation: stretches in beta_t(0) and next to a separatrix."""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ..numerics.arclength import FOLD, Lengths, Stride, border_distances, trace
from ..numerics.arrays import Array
from .fold_system import CurvePoint, CurveSystem, FoldSystem, correct_curve_point
from .separatrix_folds import SeparatrixSystem, deep_system

_LENGTHS = Lengths(first=0.01, longest=0.04, least=2e-6)  # of steps, in shares of the ranges
_TURN, _EASY = 0.9, 0.985  # cosines of the angle between two tangents: a step too long, and one that may grow
PIECES = 8  # of the polyline between two points
_MOST = 4000  # points of a curve
_HALVINGS = 20
BORDER, CLOSED, STOPPED, LEFT = "border", "closed", "stopped", "left"


@dataclass(frozen=True, eq=False)
class Trace:
    """A stretch of a curve: its points in order, and the numbers of those that are cusps."""

    system: CurveSystem
    points: list[CurvePoint]
    cusps: list[int]

    @property
    def kind(self) -> str:
        return self.system.kind

    @property
    def slopes(self) -> list[float]:
        """beta_t(0) at each point."""
        return [self.system.start_rate(point.x) for point in self.points]


def one_way(system: CurveSystem, seed: CurvePoint) -> tuple[list[CurvePoint], str]:
    """The points after the seed, to the border of the rectangle or closed, and how the stretch ends."""

    def stride(here: CurvePoint, step: float, found: list[CurvePoint]) -> Stride[CurvePoint, CurvePoint] | str:
        guess = here.x + step * here.tangent
        there = correct_curve_point(system, guess, here.tangent, float(here.tangent @ guess))
        cosine = -1.0 if there is None else float(there.tangent @ here.tangent)
        far = there is not None and (cosine < _TURN or np.abs(there.x - guess).max() > 0.5 * step)
        beyond = not far and _is_beyond(guess if there is None else there.x)
        border = _border(system, here, step) if beyond else None
        if border is not None:
            return Stride([border], border, step, BORDER)
        if there is None or far or beyond:
            return BORDER if beyond and there is not None else STOPPED
        if len(found) > 3 and _returns(seed, here, there):
            return Stride([], here, step, CLOSED)
        return Stride([there], there, step * (1.6 if cosine > _EASY else 1.0), LEFT if system.leaves(there.x) else "")

    points, end = trace(seed, stride, _LENGTHS, _MOST)
    return points, end or STOPPED


def _is_beyond(x: Array) -> bool:
    """Whether x lies beyond the border."""
    return bool(np.maximum(x[1:3] - 1, -x[1:3]).max() > 0)


def _border(system: CurveSystem, here: CurvePoint, step: float) -> CurvePoint | None:
    """The first point of the border that the curve meets within about a step after a point."""
    rate = here.tangent[1:3]
    far = border_distances(here.shares, rate, np.zeros(2), np.ones(2))
    for k in np.argsort(far):
        if far[k] > 2 * step:
            return None
        row = np.zeros(here.x.size)
        row[1 + k] = 1.0
        value = 1.0 if rate[k] > 0 else 0.0
        guess = here.x + float(far[k]) * here.tangent
        found = correct_curve_point(system, guess, row, value)
        if found is None or np.abs(found.shares - 0.5).max() > 0.5 + 1e-9:
            continue
        if np.linalg.norm(found.x - here.x) <= 2.5 * step:
            tangent = found.tangent if found.tangent @ here.tangent > 0 else -found.tangent
            return replace(found, tangent=tangent)
    return None


def _returns(seed: CurvePoint, here: CurvePoint, there: CurvePoint) -> bool:
    """Whether the step from here to there passes the seed."""
    chord = there.x - here.x
    share = float((seed.x - here.x) @ chord / (chord @ chord))
    if not 0 <= share <= 1 or seed.tangent @ there.tangent < 0.8:
        return False
    return bool(np.linalg.norm(here.x + share * chord - seed.x) < 0.2 * np.linalg.norm(chord))


def stretch(system: CurveSystem, points: list[CurvePoint]) -> Trace:
    """The points as a stretch, with its cusps among them, or the points at which a pitchfork changes its side."""
    if not isinstance(system, FoldSystem):
        return Trace(system, points, [])
    out, cusps = points[:1], []
    for one, other in pairwise(points):
        if one.bend * other.bend < 0 and system.kind != FOLD:
            out += _side_change(system, one, other)
        elif one.bend * other.bend < 0:
            share = one.bend / (one.bend - other.bend)
            x = system.cusp((1 - share) * one.x + share * other.x)
            far = np.linalg.norm(other.x - one.x)
            if x is not None and np.linalg.norm(x - one.x) + np.linalg.norm(x - other.x) < 1.5 * far:
                tangent = np.zeros(x.size)
                tangent[0] = np.sign(other.x[0] - one.x[0])
                cusps.append(len(out))
                out.append(CurvePoint(x, tangent, 0.0, np.zeros(2)))
        out.append(other)
    return Trace(system, out, cusps)


def _side_change(system: FoldSystem, one: CurvePoint, other: CurvePoint) -> list[CurvePoint]:
    """Points between two on a pitchfork curve, of which one has d^3B/dv^3 = 0: there a fold curve ends, and the side of
    two more equilibria changes. The equations are singular in it, so it is interpolated between close neighbours."""
    low, high = one, other
    for _ in range(_HALVINGS):
        chord, x = high.x - low.x, (low.x + high.x) / 2
        between = correct_curve_point(
            system, x, chord / np.linalg.norm(chord), float(chord @ x / np.linalg.norm(chord))
        )
        if between is None or abs(between.bend) > max(abs(low.bend), abs(high.bend)):  # by rounding
            break
        low, high = (between, high) if between.bend * low.bend > 0 else (low, between)
    share = low.bend / (low.bend - high.bend)
    x = (1 - share) * low.x + share * high.x
    middle = replace(low, x=x, bend=0.0, more=np.zeros(2))
    some = [*([low] if low is not one else []), middle, *([high] if high is not other else [])]
    along = other.x - one.x
    return [replace(p, tangent=p.tangent if p.tangent @ along > 0 else -p.tangent) for p in some]


def dense(points: list[CurvePoint], pieces: int = PIECES) -> tuple[Array, Array]:
    """The curve as a fine polyline (N, 2) of shares, and towards which side two more equilibria exist, (N, 2).

    Between two points it is the cubic with the tangents of both.
    """
    if len(points) < 2:
        return np.array([point.shares for point in points]), np.array([point.more for point in points])
    xs = np.array([point.x for point in points])
    tangents = np.array([point.tangent for point in points])
    chord = np.linalg.norm(np.diff(xs, axis=0), axis=1)[:, None, None]
    t = (np.arange(pieces) / pieces)[None, :, None]
    a, b, m, n = xs[:-1, None], xs[1:, None], tangents[:-1, None] * chord, tangents[1:, None] * chord
    curve = (2 * t**3 - 3 * t**2 + 1) * a + (t**3 - 2 * t**2 + t) * m + (3 * t**2 - 2 * t**3) * b + (t**3 - t**2) * n
    line = np.vstack([curve.reshape(-1, xs.shape[1]), xs[-1:]])[:, 1:3]
    more = np.array([point.more for point in points])
    size = np.linalg.norm(more, axis=1)
    whole = np.where((size[:-1] > 0)[:, None], more[:-1], more[1:])  # a cusp has no side of its own
    return line, np.vstack([np.repeat(whole, pieces, axis=0), whole[-1:]])


_STRETCHES = 12  # stretches of a curve


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
    while len(found) < _STRETCHES:
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
    same = system.renew(last.x) if system.leaves(last.x) else None
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
        point = correct_curve_point(system, x, row, float(row @ x))
        if point is not None and np.abs(point.shares - x[1:3]).max() < 0.02:
            if point.tangent[1:3] @ near.tangent[1:3] < 0:
                point = replace(point, tangent=-point.tangent)
            return point
    return None
