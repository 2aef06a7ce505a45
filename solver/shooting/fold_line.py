"""The curve of a fold over two numbers, of a rod whose loads vary along it.

Two numbers z have local coordinates: u along the curve and n across it. At fixed u the equilibria lie on a `Curve` over
n with a place a on it, along the tangent at the last fold; the fold is where dn/da = 0. That is one equation in (a, u),
which is regular at cusps, where u turns back.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..numerics.arclength import LEFT, Lengths, Node, Stride, advance, border_distances, node_at, trace
from ..numerics.arrays import Array
from ..numerics.roots import enclose
from ..problem.errors import InputError
from .curve import Curve, Point
from .descent import index_of_any
from .loaded_rod import LoadedRod
from .newton import Shape

LENGTHS = Lengths(first=0.02, longest=0.1, least=1e-4)  # of steps, in the sizes of the angles and of z
STEP = 1e-4  # of derivatives by a and u
CLOSE, ROUNDS = 1e-9, 25  # to the border; steps of a search of it or of a cusp
FLAT = 1e-6  # of the rate of u at a cusp: its square is lost of z
BESIDE = 0.02  # how far beside a fold its two indices are read
BORDER, STOPPED = "border", "stopped"


@dataclass(frozen=True, eq=False)
class FoldPoint:
    """A fold, and the equation of its curve nearby, a `numerics.arclength.Curve` in (a, u).

    z: (2,), over their sizes. along, across: (2,), unit vectors of u and n there. point: on the curve over n. more: 1
    or -1, the sense of n in which two more equilibria lie; 0 at a cusp.
    """

    rod_at: Callable[[Array], LoadedRod]
    z: Array
    along: Array
    across: Array
    point: Point
    more: float = 0.0

    def curve(self, u: float) -> Curve:
        """The equilibria over n at u."""
        begin = self.z + u * self.along
        return Curve(lambda n: self.rod_at(begin + n * self.across), 1.0, self.point.shape.rod.scale)

    def at(self, w: Array) -> Point | None:
        """The equilibrium at (a, u)."""
        a, u = w
        shape, tangent = self.point.shape, self.point.tangent
        change = a * tangent[:-1].reshape(shape.y.shape) * shape.rod.scale
        try:
            return self.curve(float(u)).correct(Shape(shape.rod, shape.t, shape.y + change), 0.0, tangent)
        except InputError:  # no case has such values
            return None

    def value(self, w: Array) -> Array | None:
        """dn/da at (a, u), (1,)."""
        found = self.at(w)
        return None if found is None else found.tangent[-1:]

    def jacobian(self, w: Array) -> Array | None:
        """Its derivatives by a and u, (1, 2)."""
        pairs = [(self.value(w + h), self.value(w - h)) for h in STEP * np.eye(2)]
        if any(one is None for pair in pairs for one in pair):
            return None
        return np.array([[(high[0] - low[0]) / (2 * STEP) for high, low in pairs]])  # type: ignore[index]

    def fold_at(self, node: Node) -> tuple["FoldPoint", Array] | None:
        """The fold at a node (a, u), and the direction there in its own (a, u)."""
        found, h = self.at(node.w), np.array([0.0, STEP])
        high, low = self.at(node.w + h), self.at(node.w - h)
        if found is None or high is None or low is None:
            return None
        along = self.along + (high.x - low.x) / (2 * STEP) * self.across
        size = float(np.linalg.norm(along))
        along /= size
        across = np.array([-along[1], along[0]])
        across *= np.sign(across @ self.across)
        z = self.z + node.w[1] * self.along + found.x * self.across
        tangent = np.append(found.tangent[:-1], 0.0)
        point = Point(found.shape, 0.0, tangent)
        there = replace(self, z=z, along=along, across=across, point=point, more=float(np.sign(node.jacobian[0, 0])))
        return there, node.tangent * np.array([1.0, size])


@dataclass(frozen=True, eq=False)
class FoldLine:
    """A stretch of the curve of a fold: its points, the numbers of those that are cusps, and how it ends."""

    points: list[FoldPoint]
    cusps: list[int]
    end: str


def fold_line(first: FoldPoint, sense: float, low: Array, high: Array, most: int) -> FoldLine:
    """The curve from a fold on, in one sense of its u, to the border low < z < high."""
    cusps: list[int] = []

    def is_beyond(z: Array) -> bool:
        return bool((z < low).any() or (z > high).any())

    def stride(
        here: tuple[FoldPoint, Array], step: float, points: list[FoldPoint]
    ) -> Stride[FoldPoint, tuple[FoldPoint, Array]] | str:
        fold, direction = here
        node = node_at(fold, np.zeros(2), direction)
        if isinstance(node, str):
            return node
        if is_beyond(fold.z + step * node.tangent[1] * fold.along):
            last = border_point(fold, node, low, high)
            if last is not None:
                return Stride([last] * bool(np.abs(last.z - fold.z).max() > CLOSE), here, step, BORDER)
        taken = step_from(fold, node, step)
        if isinstance(taken, str):
            return taken
        there, onward = taken
        if is_beyond(there.z):
            return BORDER
        if onward[1] * direction[1] < 0:
            cusp = cusp_between(fold, node, step, float(onward[1]))
            cusps.append(len(points))
            return Stride([cusp, there], taken, step)
        return Stride([there], taken, step * 1.5)

    points, end = trace((first, np.array([0.0, sense])), stride, LENGTHS, most)
    return FoldLine(points, cusps, BORDER if end == BORDER else STOPPED)


def border_point(fold: FoldPoint, node: Node, low: Array, high: Array) -> FoldPoint | None:
    """The fold on the border that the curve meets next, without values beyond it; None where it meets none nearby."""
    onward = fold.along * np.sign(node.tangent[1])
    ways = border_distances(fold.z, onward, low, high)
    k = int(np.argmin(ways))
    limit = (high if onward[k] > 0 else low)[k]
    w = node.tangent * (ways[k] / abs(node.tangent[1]))
    rate = node.jacobian[0, 0]
    for _ in range(ROUNDS):
        found = fold.at(w)
        if found is None:
            return None
        off = limit - fold.z[k] - w[1] * fold.along[k] - found.x * fold.across[k]
        step = np.array([-found.tangent[-1] / rate, off / fold.along[k]])
        if np.abs(step).max() < CLOSE:
            z = fold.z + w[1] * fold.along + found.x * fold.across
            z[k] = limit
            return replace(fold, z=z, point=found, more=float(np.sign(rate)))
        w = w + step
    return None


def step_from(fold: FoldPoint, node: Node, step: float) -> tuple[FoldPoint, Array] | str:
    """The fold after a step and the direction there, or why there is none."""
    found = advance(fold, node, step)
    if isinstance(found, str):
        return found
    return fold.fold_at(found) or LEFT


def cusp_between(fold: FoldPoint, node: Node, step: float, after: float) -> FoldPoint:
    """The cusp within a step after which the rate of u is `after`, of the other sign."""

    def rate_at(place: float) -> tuple[FoldPoint, float] | None:
        found = step_from(fold, node, place)
        return None if isinstance(found, str) else (found[0], float(found[1][1]))

    cusp, rates = fold, (float(node.tangent[1]), after)
    for _, found, rate in enclose(rate_at, step, rates, ROUNDS, kept=0.5):
        cusp = found
        if abs(rate) < FLAT:
            break
    return replace(cusp, more=0.0)


def indices_beside(fold: FoldPoint) -> tuple[int, int]:
    """The indices of the two equilibria that meet at a fold; 0 with friction."""
    sides = [fold.at(np.array([a, 0.0])) for a in (BESIDE, -BESIDE)]
    one, other = (0 if side is None else index_of_any(side.shape) for side in sides)
    return min(one, other), max(one, other)
