"""The curve of a fold over two numbers z, traced in any system whose equilibria form branches over a line of z.

The two numbers have local coordinates: u along the curve and n across it. At fixed u the equilibria lie on a branch
over n with a place a on it, along its direction at the last fold; the fold is where dn/da = 0. That is one equation in
(a, u), which is regular at cusps, where u turns back.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Generic, Protocol, TypeVar

import numpy as np

from ..numerics.arclength import Lengths, Node, border_distances
from ..numerics.arrays import Array
from ..numerics.roots import Ending, enclose, newton
from .special_line import BORDER, CLOSE, STOPPED, Ahead, special_line, step_from

LENGTHS = Lengths(first=0.02, longest=0.1, least=1e-4)  # of steps, in the sizes of the equilibrium and of z
STEP = 1e-4  # of derivatives by a and u
ROUNDS = 25  # steps of a search of the border or of a cusp
FLAT, ENCLOSED = 1e-6, 1e-6  # of the rate of u at a cusp, whose square is lost of z; of the step that holds it
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

    def beside(self: "Equilibrium", begin: Array, across: Array, a: float) -> "Equilibrium | None":
        """The equilibrium of the line begin + n across, at a distance a along the direction of this one, a fold; None
        where there is none."""
        ...

    def as_folds(self: "Equilibrium", z: Array, across: Array) -> "Iterator[Equilibrium]":
        """The same as a fold of the line z + n across that begins with it, with the direction in the same sense: in
        each of its coordinates, the best first."""
        ...


Equilibrium = TypeVar("Equilibrium", bound=LineEquilibrium)


@dataclass(frozen=True, eq=False)
class FoldPoint(Generic[Equilibrium]):
    """A fold, and the equation of its curve nearby, a `numerics.arclength.Curve` in (a, u).

    z: (2,), over their sizes. along, across: (2,), unit vectors of u and n there. equilibrium: of the line along n.
    more: 1 or -1, the sense of n in which two more equilibria lie; 0 at a cusp.
    """

    z: Array
    along: Array
    across: Array
    equilibrium: Equilibrium
    more: float = 0.0

    @property
    def w(self) -> Array:
        """Its own (a, u)."""
        return np.zeros(2)

    def ahead(self, node: Node, step: float) -> Array:
        """z a step along the tangent."""
        return self.z + step * node.tangent[1] * self.along

    def at(self, w: Array) -> Equilibrium | None:
        """The equilibrium at (a, u)."""
        a, u = w.tolist()
        return self.equilibrium.beside(self.z + u * self.along, self.across, a)

    def place(self, w: Array, found: Equilibrium) -> Array:
        """z of the equilibrium at (a, u), (2,)."""
        return self.z + w[1] * self.along + found.offset * self.across

    def value(self, w: Array) -> Array | None:
        """dn/da at (a, u), (1,)."""
        found = self.at(w)
        return None if found is None else np.array([found.rate])

    def jacobian(self, w: Array) -> Array | None:
        """Its derivatives by a and u, (1, 2)."""
        pairs = [(self.value(w + h), self.value(w - h)) for h in STEP * np.eye(2)]
        if any(one is None for pair in pairs for one in pair):
            return None
        return np.array([[(high[0] - low[0]) / (2 * STEP) for high, low in pairs]])  # type: ignore[index]

    def after(self, node: Node) -> "tuple[FoldPoint[Equilibrium], Array] | None":
        """The fold at a node (a, u), and the direction there in its own (a, u)."""
        found, h = self.at(node.w), np.array([0.0, STEP])
        high, low = self.at(node.w + h), self.at(node.w - h)
        if found is None or high is None or low is None:
            return None
        along = self.along + (high.offset - low.offset) / (2 * STEP) * self.across
        size = float(np.linalg.norm(along))
        along /= size
        across = np.array([-along[1], along[0]])
        across *= np.sign(across @ self.across)
        z = self.place(node.w, found)
        best = next(found.as_folds(z, across), None)
        if best is None:
            return None
        fold = FoldPoint(z, along, across, best, float(np.sign(node.jacobian[0, 0])))
        return fold, node.tangent * np.array([1.0, size])

    def at_border(self, node: Node) -> "FoldPoint[Equilibrium] | None":
        """As of `SpecialPoint`, without values beyond the border."""
        onward = self.along * np.sign(node.tangent[1])
        ways = border_distances(self.z, onward, np.zeros(2), np.ones(2))
        k = int(np.argmin(ways))
        limit, rate = float(onward[k] > 0), node.jacobian[0, 0]

        def step(w: Array) -> tuple[Array, float] | str:
            found = self.at(w)
            if found is None:
                return NOT_MET
            off = limit - self.place(w, found)[k]
            change = np.array([-found.rate / rate, off / self.along[k]])
            return w + change, float(np.abs(change).max())

        w = newton(node.tangent * (ways[k] / abs(node.tangent[1])), step, Ending(ROUNDS, CLOSE))
        found = None if isinstance(w, str) else self.at(w)
        if found is None or isinstance(w, str):
            return None
        z = self.place(w, found)
        z[k] = limit
        return replace(self, z=z, equilibrium=found, more=float(np.sign(rate)))

    def in_other_coordinates(self) -> "Iterator[FoldPoint[Equilibrium]]":
        """The same fold."""
        for other in self.equilibrium.as_folds(self.z, self.across):
            yield replace(self, equilibrium=other)


def fold_line(first: FoldPoint[Equilibrium], sense: float, most: int) -> tuple[list[FoldPoint[Equilibrium]], str]:
    """The curve after a fold, in one sense of its u, to the border of 0 < z < 1, and how it ends."""

    def between(
        fold: FoldPoint[Equilibrium], node: Node, step: float, taken: Ahead[FoldPoint[Equilibrium]]
    ) -> tuple[list[FoldPoint[Equilibrium]], str] | None:
        after = float(taken[1][1])
        if after * node.tangent[1] >= 0:
            return [], ""
        cusp = cusp_between(fold, node, step, after)
        return None if cusp is None else ([cusp], "")

    points, end = special_line(first, np.array([0.0, sense]), LENGTHS, most, between)
    return points, BORDER if end == BORDER else STOPPED


def cusp_between(fold: FoldPoint[Equilibrium], node: Node, step: float, after: float) -> FoldPoint[Equilibrium] | None:
    """The cusp within a step after which the rate of u is `after`, of the other sign; None where it is not enclosed."""

    def rate_at(place: float) -> tuple[FoldPoint[Equilibrium], float] | None:
        found = step_from(fold, node, place)
        return None if isinstance(found, str) else (found[0], float(found[1][1]))

    for width, cusp, rate in enclose(rate_at, step, (float(node.tangent[1]), after), ROUNDS, kept=0.5):
        if abs(rate) < FLAT or width < ENCLOSED * step:
            return replace(cusp, more=0.0)
    return None


def lower_index(fold: FoldPoint[Equilibrium]) -> int:
    """The lower index of the two equilibria that meet at a fold; 0 with friction."""
    sides = (fold.at(np.array([a, 0.0])) for a in (BESIDE, -BESIDE))
    return min((side.index for side in sides if side is not None and side.index is not None), default=0)
