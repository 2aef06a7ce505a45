"""The curve of a fold over two numbers z, traced in any system whose equilibria form branches over a line of z.

The two numbers have local coordinates: u along the curve and n across it. At fixed u the equilibria lie on a branch
over n with a place a on it, along its direction at the last fold; the fold is where dn/da = 0. That is one equation in
(a, u), which is regular at cusps, where u turns back.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Generic, Protocol, TypeVar

import numpy as np

from ..numerics.arclength import FOLD, Lengths, Node, border_distances, difference_rates, node_at
from ..numerics.arrays import Array
from ..numerics.roots import Ending, newton
from .special_line import CLOSE, ROUNDS, Ahead, Tracing, cusps_between, special_line
from .whole_curve import WholeCurve, whole_curve

LENGTHS = Lengths(first=0.02, longest=0.1, least=1e-4)  # of steps, in the sizes of the equilibrium and of z
STEP = 1e-4  # of derivatives by a and u
MOST = 500  # points of a curve in each sense
BESIDE = 0.02  # how far beside a fold its two indices are read
NOT_MET = "the curve meets no border nearby"


class LineEquilibrium(Protocol):
    """An equilibrium of a line in the plane of z, and the direction of its branch over that line, of length 1."""

    @property
    def offset(self) -> float:
        """Its n, by which it lies off the begin of the line."""
        ...

    @property
    def rate(self) -> float:
        """dn along the branch."""
        ...

    @property
    def index(self) -> int | None:
        """Its Morse index; None where it is not decided."""
        ...

    @property
    def slope(self) -> float:
        """beta_t(0)."""
        ...

    @property
    def mark(self) -> Array:
        """Numbers of about 1 that tell it from others."""
        ...

    def beside(self: "Equilibrium", begin: Array, across: Array, a: float) -> "Equilibrium | None":
        """The equilibrium of the line begin + n across, at a distance a along the direction of this one, a fold; None
        where there is none."""
        ...

    def as_fold(self: "Equilibrium") -> "Equilibrium":
        """The same as a fold of the line that begins with it, with the direction in the same sense."""
        ...


Equilibrium = TypeVar("Equilibrium", bound=LineEquilibrium)


@dataclass(frozen=True, eq=False)
class FoldPoint(Generic[Equilibrium]):
    """A fold, and the equation of its curve nearby, a `numerics.arclength.Curve` in (a, u).

    z: (2,), over their sizes. way, across: (2,), unit vectors of u and n there. equilibrium: of the line along n.
    more: (2,), along n towards two more equilibria; zero at a cusp.
    """

    z: Array
    way: Array
    across: Array
    equilibrium: Equilibrium
    more: Array

    @property
    def w(self) -> Array:
        """Its own (a, u)."""
        return np.zeros(2)

    @property
    def slope(self) -> float:
        """beta_t(0)."""
        return self.equilibrium.slope

    @property
    def mark(self) -> Array:
        """As of `SpecialPoint`."""
        return self.equilibrium.mark

    def rate(self, tangent: Array) -> Array:
        """As of `SpecialPoint`."""
        return np.asarray(tangent[1] * self.way)

    def at(self, w: Array) -> Equilibrium | None:
        """The equilibrium at (a, u)."""
        a, u = w.tolist()
        return self.equilibrium.beside(self.z + u * self.way, self.across, a)

    def place(self, w: Array, found: Equilibrium) -> Array:
        """z of the equilibrium at (a, u), (2,)."""
        return self.z + w[1] * self.way + found.offset * self.across

    def value(self, w: Array) -> Array | None:
        """dn/da at (a, u), (1,)."""
        found = self.at(w)
        return None if found is None else np.array([found.rate])

    def jacobian(self, w: Array) -> Array | None:
        """Its derivatives by a and u, (1, 2)."""
        return difference_rates(self.value, w, STEP)

    def after(self, node: Node) -> "Ahead[FoldPoint[Equilibrium]] | None":
        """As of `SpecialPoint`."""
        equilibrium, h = self.at(node.w), np.array([0.0, STEP])
        high, low = self.at(node.w + h), self.at(node.w - h)
        if equilibrium is None or high is None or low is None:
            return None
        way = self.way + (high.offset - low.offset) / (2 * STEP) * self.across
        size = float(np.linalg.norm(way))
        way /= size
        across = np.array([-way[1], way[0]])
        across *= np.sign(across @ self.across)
        more = np.sign(node.jacobian[0, 0]) * across
        fold = FoldPoint(self.place(node.w, equilibrium), way, across, equilibrium.as_fold(), more)
        there = node_at(fold, fold.w, node.tangent * np.array([1.0, size]))
        return None if isinstance(there, str) else (fold, there)

    def at_border(self, node: Node) -> "FoldPoint[Equilibrium] | None":
        """As of `SpecialPoint`, without values beyond the border."""
        onward = self.way * np.sign(node.tangent[1])
        ways = border_distances(self.z, onward, np.zeros(2), np.ones(2))
        k = int(np.argmin(ways))
        limit, rate = float(onward[k] > 0), node.jacobian[0, 0]

        def step(w: Array) -> tuple[Array, float] | str:
            found = self.at(w)
            if found is None:
                return NOT_MET
            off = limit - self.place(w, found)[k]
            change = np.array([-found.rate / rate, off / self.way[k]])
            return w + change, float(np.abs(change).max())

        w = newton(node.tangent * (ways[k] / abs(node.tangent[1])), step, Ending(ROUNDS, CLOSE))
        found = None if isinstance(w, str) else self.at(w)
        if found is None or isinstance(w, str):
            return None
        z = self.place(w, found)
        z[k] = limit
        return replace(self, z=z, equilibrium=found, more=np.sign(rate) * self.across)


def in_one_form(point: FoldPoint[Equilibrium], node: Node, stuck: bool) -> Iterator[Ahead[FoldPoint[Equilibrium]]]:
    """As of `special_line.Others`: there are none."""
    return iter(())


def fold_through(z: Array, axis: int, equilibrium: Equilibrium) -> WholeCurve:
    """The curve of the fold at z of a branch along number `axis`, in the unit square."""
    across, way = np.eye(2)[[axis, 1 - axis]]
    first, onward = FoldPoint(z, way, across, equilibrium, np.zeros(2)), np.array([0.0, 1.0])
    node = node_at(first, first.w, onward)
    turned = None if isinstance(node, str) else first.after(node)
    first = first if turned is None else turned[0]
    how: Tracing[FoldPoint[Equilibrium]] = Tracing(LENGTHS, MOST, cusps_between, in_one_form)
    return whole_curve(FOLD, special_line(first, onward, how), lower_index(first))


def lower_index(fold: FoldPoint[Equilibrium]) -> int:
    """The lower index of the two equilibria that meet at a fold; 0 with friction."""
    sides = (fold.at(np.array([a, 0.0])) for a in (BESIDE, -BESIDE))
    return min((side.index for side in sides if side is not None and side.index is not None), default=0)
