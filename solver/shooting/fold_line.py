"""The curve of a fold over two numbers z, of a rod whose loads vary along it.

Through each z a line goes along n, across the curve. On it the equilibria lie on a branch with a place a, along its
direction at the last fold. At a fold the branch passes n = 0 where dn/da = 0: two equations in a and z, regular at
cusps too, where z turns back.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..folds.special_line import MOST, Ahead, SpecialPoint, Tracing, cusps_between, point_at, special_line
from ..folds.whole_curve import WholeCurve, whole_curve
from ..numerics.arclength import FOLD, Lengths, Node, node_at
from ..numerics.arrays import Array
from ..problem.errors import InputError
from .curve import Curve, Point
from .descent import index_of_any
from .further_shapes import angles_of
from .loaded_rod import SPEED, LoadedRod
from .newton import Shape

RodAt = Callable[[Array], LoadedRod]
LENGTHS = Lengths(first=0.02, longest=0.1, least=1e-4)  # of steps, in the sizes of the equilibrium and of z
STEP = 1e-4  # of derivatives by a and z
BESIDE = 0.02  # how far beside a fold its two indices are read


@dataclass(frozen=True, eq=False, kw_only=True)
class FoldPoint(SpecialPoint):
    """A fold. w: a, and z over their sizes.

    across: (2,), the unit vector of n. point: that of the branch over n where a and n are 0.
    """

    rod_at: RodAt
    across: Array
    point: Point
    nudge = STEP

    @property
    def slope(self) -> float:
        """beta_t(0)."""
        return float(self.point.shape.y[0, SPEED])

    @property
    def mark(self) -> Array:
        """As of `SpecialPoint`."""
        return angles_of(self.point.shape)

    def at(self, w: Array) -> Point | None:
        """The equilibrium at a on the branch over n through z; None where there is none."""
        shape, tangent = self.point.shape, self.point.tangent
        curve = Curve(lambda n: self.rod_at(w[1:] + n * self.across), 1.0, shape.rod.scale)
        change = w[0] * tangent[:-1].reshape(shape.y.shape) * shape.rod.scale
        try:
            return curve.correct(Shape(shape.rod, shape.t, shape.y + change), 0.0, tangent)
        except InputError:  # no case has such values
            return None

    def value(self, w: Array) -> Array | None:
        """n and dn/da, (2,)."""
        point = self.at(w)
        return None if point is None else np.array([point.x, point.tangent[-1]])

    def after(self, node: Node) -> "Ahead[FoldPoint] | None":
        """As of `SpecialPoint`; a is counted from there on."""
        point = self.at(node.w)
        if point is None:
            return None
        across = -node.jacobian[0, 1:] / np.linalg.norm(node.jacobian[0, 1:])  # n falls as z moves along it
        own = Point(point.shape, 0.0, np.append(point.tangent[:-1], 0.0))
        fold = replace(self, w=np.append(0.0, node.w[1:]), across=across, point=own)
        there = node_at(fold, fold.w, node.tangent)
        return None if isinstance(there, str) else SpecialPoint.after(fold, there)

    @property
    def lower(self) -> int:
        """The lower index of the two equilibria that meet; 0 with friction."""
        sides = (self.at(self.w + np.array([a, 0.0, 0.0])) for a in (BESIDE, -BESIDE))
        return min((index_of_any(side.shape) for side in sides if side is not None), default=0)


def fold_through(rod_at: RodAt, z: Array, axis: int, shapes: list[Shape]) -> WholeCurve:
    """The curve of the fold at z of a branch along number `axis`, from the shapes before, at and after it."""
    across, way = np.eye(2)[[axis, 1 - axis]]
    curve = Curve(lambda n: shapes[1].rod, 1.0, shapes[1].rod.scale)
    tangent, w = curve.direction(shapes[2].y - shapes[0].y, 0.0), np.append(0.0, z)
    guess = FoldPoint(w=w, way=way, rod_at=rod_at, across=across, point=Point(shapes[1], 0.0, tangent))
    first = point_at(guess, w, np.append(0.0, way)) or guess
    how: Tracing[FoldPoint] = Tracing(LENGTHS, MOST, cusps_between)
    return whole_curve(FOLD, special_line(first, how), first.lower)
