"""The curves of folds and pitchforks over two numbers z, of a rod whose loads vary along it.

Through each z a line goes along n, across the curve of a fold. On it the equilibria lie on a branch with a place a,
along its direction at the last fold. At a fold the branch passes n = 0 where dn/da = 0: two equations in a and z,
regular at cusps too, where z turns back.

Along the curve of a pitchfork an equilibrium that its symmetry keeps, such as the straight rod, exists on both sides,
and on it a push along one mode meets no resistance. The stiffness against that push, smooth over z, is the equation.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ..branches.fold_tracing import (
    CROSSING,
    Ahead,
    LinePoint,
    SpecialLine,
    Tracing,
    change_within,
    cusps_between,
    point_at,
    point_on_line,
    special_line,
)
from ..branches.whole_curve import WholeCurve, whole_curve
from ..numerics.arclength import PITCHFORK, Node, node_at
from ..numerics.arrays import ASIDE, Array
from .banded_newton import marks_of
from .loaded_rod import ALPHA, SPEED, LoadedRod
from .node_branch import BESIDE, LENGTHS, SPLIT, CurvePoint, NodeCurve, unit
from .shape_index import index_at
from .varying_shapes import Shape
from .weak_modes import Held, hold, weakest_modes

RodAt = Callable[[Array], LoadedRod]
# of a step: how closely the place is enclosed where another curve crosses. x10: the two points beside it are farther
# apart
CROSSED = 3e-3
NEAR = 3  # weakest modes: where another such curve crosses, that of this one is not the weakest. x10: only time


@dataclass(frozen=True, eq=False, kw_only=True)
class _ShapePoint(LinePoint):
    """A fold or pitchfork. shape: the equilibrium there."""

    rod_at: RodAt
    shape: Shape
    nudge = 1e-4  # of derivatives by a and z

    def line(self, z: Array, across: Array) -> NodeCurve:
        """The equilibria along a line through z."""
        return NodeCurve(lambda n: self.rod_at(z + n * across), 1.0, self.shape.rod.scale)

    @property
    def dbeta0(self) -> float:
        """beta_t(0)."""
        return float(self.shape.y[0, SPEED])

    @property
    def mark(self) -> Array:
        """Numbers of about 1 that tell the equilibrium from others."""
        return marks_of(self.shape)


@dataclass(frozen=True, eq=False, kw_only=True)
class _FoldPoint(_ShapePoint):
    """A fold. w: a, and z over their sizes.

    across: (2,), the unit vector of n. tangent: that of the branch over n at the shape, where a and n are 0.
    """

    across: Array
    tangent: Array

    def at(self, w: Array) -> CurvePoint | None:
        """The equilibrium at a on the branch over n through z; None where there is none."""
        shape = self.shape
        change = w[0] * self.tangent[:-1].reshape(shape.y.shape) * shape.rod.scale
        return self.line(w[1:], self.across).correct(replace(shape, y=shape.y + change), 0.0, self.tangent)

    def value(self, w: Array) -> Array | None:
        """n and dn/da, (2,)."""
        point = self.at(w)
        return None if point is None else np.array([point.p, point.rises])

    def after(self, node: Node) -> "Ahead[_FoldPoint] | None":
        """The point a step ahead (`LinePoint.after`); a is counted from there on."""
        point = self.at(node.w)
        if point is None:
            return None
        across = -node.jacobian[0, 1:] / np.linalg.norm(node.jacobian[0, 1:])  # n falls as z moves along it
        tangent = np.append(point.tangent[:-1], 0.0)
        fold = replace(self, w=np.append(0.0, node.w[1:]), across=across, shape=point.shape, tangent=tangent)
        following = node_at(fold, fold.w, node.tangent)
        return None if isinstance(following, str) else LinePoint.after(fold, following)

    @property
    def lower(self) -> int:
        """The lower index of the two equilibria that meet; 0 with friction."""
        sides = (self.at(self.w + np.array([a, 0.0, 0.0])) for a in (BESIDE, -BESIDE))
        return min((side.index for side in sides if side is not None), default=0)


def fold_through(rod_at: RodAt, z: Array, axis: int, shapes: list[Shape]) -> WholeCurve:
    """The curve of the fold at z of a branch along number `axis`, from the shapes before, at and after it."""
    (before, shape, after), (across, way) = shapes, np.eye(2)[[axis, 1 - axis]]
    tangent = unit(NodeCurve(lambda n: shape.rod, 1.0, shape.rod.scale).in_sizes(after.y - before.y, 0.0))
    w = np.append(0.0, z)
    guess = _FoldPoint(w=w, way=way, rod_at=rod_at, across=across, shape=shape, tangent=tangent)
    first = point_at(guess, w, np.append(0.0, way)) or guess
    how: Tracing[_FoldPoint] = Tracing(LENGTHS, cusps_between)
    return whole_curve(special_line(first, how))


@dataclass(frozen=True, eq=False, kw_only=True)
class _PitchforkPoint(_ShapePoint):
    """A pitchfork. w: z over their sizes. more: NaN where the two others lie on different sides.

    shape: that which the symmetry keeps. mode: (N, 8), along which others split off. index: the lower one beside the
    curve.
    """

    mode: Array
    index: int = 0
    kind: str = PITCHFORK

    @property
    def lower(self) -> int:
        """The lower Morse index of the equilibria that meet."""
        return self.index

    def shape_at(self, z: Array) -> Held | None:
        """The equilibrium that the symmetry keeps, at z, as it is held along the mode."""
        return hold(self.line(z, np.zeros(2)).shape(self.shape, self.shape.y, 0.0), self.mode)

    def value(self, w: Array) -> Array | None:
        """The stiffness against a push along the mode at z = w, (1,)."""
        held = self.shape_at(w)
        return None if held is None else np.array([held.stiffness])

    def after(self, node: Node) -> "Ahead[_PitchforkPoint] | None":
        """The point a step ahead (`LinePoint.after`), with its index and its mode."""
        across = node.jacobian[0] / np.linalg.norm(node.jacobian[0])
        # ASIDE: how far beside a pitchfork its two indices are read
        sides = [self.shape_at(node.w + sign * ASIDE * across) for sign in (-1, 1)]
        shapes = [side.shape for side in sides if side is not None]
        if len(shapes) < 2:
            return None
        low, high = shapes
        curve = self.line(node.w, across)
        shape = curve.shape(high, (low.y + high.y) / 2, 0.0)
        mode = max(weakest_modes(high, NEAR), key=lambda near: abs(likeness(near, self.mode)))
        turns = {float(np.sign(point.p)) for point in curve.split_off(shape, mode, (SPLIT, -SPLIT), 0.0)}
        more = across * turns.pop() if len(turns) == 1 else np.full(2, np.nan)
        index = min(index_at(low), index_at(high))
        following = replace(self, w=node.w, way=node.tangent, more=more, shape=shape, mode=mode, index=index)
        node_there = node_at(following, following.w, node.tangent)
        return None if isinstance(node_there, str) else (following, node_there)


def likeness(mode: Array, other: Array) -> float:
    """The cosine of the angle between the azimuths of two modes (N, 8)."""
    a, b = mode[:, ALPHA], other[:, ALPHA]
    return float(a @ b / np.sqrt((a @ a) * (b @ b)))


def pitchforks_through(
    rod_at: RodAt, z: Array, axis: int, shape: Shape, is_known: Callable[[Array, Array], bool]
) -> list[WholeCurve] | None:
    """The curve of the pitchfork near z on the line along number `axis`, in parts of equal index; None without one.

    The index changes where another such curve crosses. shape: an equilibrium near it that its symmetry keeps.
    is_known: whether a z and a mark there lie on a known curve; where the shape becomes that of one, this one ends.
    """
    guess = _PitchforkPoint(w=z, rod_at=rod_at, shape=shape, mode=weakest_modes(shape)[0])
    first = point_on_line(guess, axis)
    if first is None:
        return None
    if np.isnan(first.more).any():  # where the sides differ, branches exchange their indices, and no number changes
        return []
    how = Tracing(LENGTHS, pitchforks_between, is_known=lambda point: is_known(point.z, point.mark))
    line = special_line(first, how)
    points, last = line.points, len(line.points) - 1
    cuts = [0, *(i + 1 for i, (point, other) in enumerate(pairwise(points)) if point.lower != other.lower), last]
    curves = []
    for a, b in pairwise(dict.fromkeys(cuts)):
        ends = line.ends[0] if a == 0 else CROSSING, line.ends[1] if b == last else CROSSING
        curves.append(whole_curve(SpecialLine(points[a : b + 1], ends, points[a])))
    return curves


def pitchforks_between(
    point: _PitchforkPoint, node: Node, step: float, taken: Ahead[_PitchforkPoint]
) -> list[_PitchforkPoint]:
    """Pitchforks within a step (`Between`): on either side of where another curve crosses, and close to it."""
    sides = change_within(point, node, step, taken, lambda ahead: ahead[0].lower, CROSSED)
    return [side for side in sides if side is not point and side is not taken[0]]
