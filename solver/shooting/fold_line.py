"""The curve of a fold over two numbers z, of a rod whose loads vary along it.

The two numbers have local coordinates: u along the curve and n across it. At fixed u the equilibria lie on a branch
over n with a place a on it, along its direction at the last fold; the fold is where dn/da = 0. That is one equation in
(a, u), which is regular at cusps, where u turns back.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..folds.special_line import CLOSE, ROUNDS, Ahead, Tracing, cusps_between, special_line
from ..folds.whole_curve import WholeCurve, whole_curve
from ..numerics.arclength import FOLD, Lengths, Node, border_distances, difference_rates, node_at
from ..numerics.arrays import Array
from ..numerics.roots import Ending, newton
from ..problem.errors import InputError
from .curve import Curve, Point
from .descent import index_of_any
from .further_shapes import angles_of
from .loaded_rod import SPEED, LoadedRod
from .newton import Shape

RodAt = Callable[[Array], LoadedRod]
LENGTHS = Lengths(first=0.02, longest=0.1, least=1e-4)  # of steps, in the sizes of the equilibrium and of z
STEP = 1e-4  # of derivatives by a and u
MOST = 500  # points of a curve in each sense
BESIDE = 0.02  # how far beside a fold its two indices are read
NOT_MET = "the curve meets no border nearby"


@dataclass(frozen=True, eq=False)
class FoldPoint:
    """A fold, a `folds.special_line.SpecialPoint`, with the equation of its curve in (a, u).

    z: (2,), over their sizes. way, across: (2,), unit vectors of u and n there. point: on the branch over n, at n = 0.
    more: (2,), along n towards two more equilibria; zero at a cusp.
    """

    rod_at: RodAt
    z: Array
    way: Array
    across: Array
    point: Point
    more: Array

    @property
    def w(self) -> Array:
        """Its own (a, u)."""
        return np.zeros(2)

    @property
    def slope(self) -> float:
        """beta_t(0)."""
        return float(self.point.shape.y[0, SPEED])

    @property
    def mark(self) -> Array:
        """As of `SpecialPoint`."""
        return angles_of(self.point.shape)

    def rate(self, tangent: Array) -> Array:
        """As of `SpecialPoint`."""
        return np.asarray(tangent[1] * self.way)

    def at(self, w: Array) -> Point | None:
        """The equilibrium at (a, u), on the branch over n; None where there is none."""
        a, u = w.tolist()
        shape, tangent, begin = self.point.shape, self.point.tangent, self.z + u * self.way
        curve = Curve(lambda n: self.rod_at(begin + n * self.across), 1.0, shape.rod.scale)
        change = a * tangent[:-1].reshape(shape.y.shape) * shape.rod.scale
        try:
            return curve.correct(Shape(shape.rod, shape.t, shape.y + change), 0.0, tangent)
        except InputError:  # no case has such values
            return None

    def place(self, w: Array, point: Point) -> Array:
        """z of the equilibrium at (a, u), (2,)."""
        return self.z + w[1] * self.way + point.x * self.across

    def value(self, w: Array) -> Array | None:
        """dn/da at (a, u), (1,)."""
        point = self.at(w)
        return None if point is None else point.tangent[-1:]

    def jacobian(self, w: Array) -> Array | None:
        """Its derivatives by a and u, (1, 2)."""
        return difference_rates(self.value, w, STEP)

    def after(self, node: Node) -> "Ahead[FoldPoint] | None":
        """As of `SpecialPoint`."""
        point, h = self.at(node.w), np.array([0.0, STEP])
        high, low = self.at(node.w + h), self.at(node.w - h)
        if point is None or high is None or low is None:
            return None
        way = self.way + (high.x - low.x) / (2 * STEP) * self.across
        size = float(np.linalg.norm(way))
        way /= size
        across = np.array([-way[1], way[0]])
        across *= np.sign(across @ self.across)
        more = np.sign(node.jacobian[0, 0]) * across
        own = Point(point.shape, 0.0, np.append(point.tangent[:-1], 0.0))
        fold = FoldPoint(self.rod_at, self.place(node.w, point), way, across, own, more)
        there = node_at(fold, fold.w, node.tangent * np.array([1.0, size]))
        return None if isinstance(there, str) else (fold, there)

    def at_border(self, node: Node) -> "FoldPoint | None":
        """As of `SpecialPoint`, without values beyond the border."""
        onward = self.way * np.sign(node.tangent[1])
        ways = border_distances(self.z, onward, np.zeros(2), np.ones(2))
        k = int(np.argmin(ways))
        limit, rate = float(onward[k] > 0), node.jacobian[0, 0]

        def step(w: Array) -> tuple[Array, float] | str:
            point = self.at(w)
            if point is None:
                return NOT_MET
            off = limit - self.place(w, point)[k]
            change = np.array([-point.tangent[-1] / rate, off / self.way[k]])
            return w + change, float(np.abs(change).max())

        w = newton(node.tangent * (ways[k] / abs(node.tangent[1])), step, Ending(ROUNDS, CLOSE))
        point = None if isinstance(w, str) else self.at(w)
        if point is None or isinstance(w, str):
            return None
        z = self.place(w, point)
        z[k] = limit
        return replace(self, z=z, point=point, more=np.sign(rate) * self.across)

    @property
    def lower(self) -> int:
        """The lower index of the two equilibria that meet; 0 with friction."""
        sides = (self.at(np.array([a, 0.0])) for a in (BESIDE, -BESIDE))
        return min((index_of_any(side.shape) for side in sides if side is not None), default=0)


def fold_through(rod_at: RodAt, z: Array, axis: int, shapes: list[Shape]) -> WholeCurve:
    """The curve of the fold at z of a branch along number `axis`, from the shapes before, at and after it."""
    across, way = np.eye(2)[[axis, 1 - axis]]
    curve = Curve(lambda n: shapes[1].rod, 1.0, shapes[1].rod.scale)
    tangent = curve.direction(shapes[2].y - shapes[0].y, 0.0)
    first, onward = FoldPoint(rod_at, z, way, across, Point(shapes[1], 0.0, tangent), np.zeros(2)), np.array([0.0, 1.0])
    node = node_at(first, first.w, onward)
    turned = None if isinstance(node, str) else first.after(node)
    first = first if turned is None else turned[0]
    how: Tracing[FoldPoint] = Tracing(LENGTHS, MOST, cusps_between)
    return whole_curve(FOLD, special_line(first, onward, how), first.lower)
