"""The curve of a pitchfork over two numbers z, of a rod whose loads vary along it.

An equilibrium that its symmetry keeps, such as the straight rod, exists on both sides of the curve, and on it a push
along one mode meets no resistance. The stiffness against that push, smooth over z, is the equation of the curve.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from ..folds.special_line import (
    CROSSING,
    Ahead,
    SpecialLine,
    Tracing,
    border_point,
    special_line,
    step_from,
)
from ..numerics.arclength import Lengths, Node, correct_point, difference_rates, node_at
from ..numerics.arrays import Array
from .curve import Curve
from .descent import index_at, weakest_modes
from .fold_line import MOST, STEP, RodAt
from .further_shapes import angles_of
from .loaded_rod import ALPHA, BETA, SPEED, Q
from .newton import Shape, correct, linear_at

LENGTHS = Lengths(first=0.03, longest=0.1, least=2e-4)  # of steps, in the sizes of z
BESIDE = 1e-3  # in the sizes of z: how far beside the curve the indices are read
CROSSED = 3e-3  # how closely the place is enclosed where another curve crosses
NEAR = 3  # weakest modes: where another such curve crosses, that of this one is not the weakest
SMALL = 0.02  # of the angles, in their scales: of the shapes that split off


@dataclass(frozen=True, eq=False)
class PitchforkPoint:
    """A pitchfork, and the equation of its curve nearby, a `numerics.arclength.Curve` in z.

    z: (2,), over their sizes. shape: the equilibrium there that the symmetry keeps. mode: (N, 8), along which others
    split off. lower: the lower index of that equilibrium beside the curve. more: (2,), towards the side of the two
    others, of length 1; NaN where they lie on different sides.
    """

    rod_at: RodAt
    z: Array
    shape: Shape
    mode: Array
    lower: int = 0
    more: Array = field(default_factory=lambda: np.full(2, np.nan))

    def shape_at(self, z: Array) -> Shape | None:
        """The equilibrium that the symmetry keeps, at z."""
        rod = self.rod_at(z).in_scales(self.shape.rod.scale)
        return correct(Shape(rod, self.shape.t * (rod.span / self.shape.t[-1]), self.shape.y))

    def value(self, w: Array) -> Array | None:
        """The stiffness against a push along the mode at z = w, (1,)."""
        shape = self.shape_at(w)
        if shape is None:
            return None
        push = (self.mode / shape.rod.scale)[:, [BETA, ALPHA]]
        right = np.zeros(self.mode.shape)
        right[:-1, [SPEED, Q]] = push[1:]
        found = linear_at(shape).solve(np.concatenate([np.zeros(4), right[:-1].reshape(-1), np.zeros(4)])[:, None])
        if found is None:
            return np.zeros(1)
        return 1 / np.array([(push * found.reshape(self.mode.shape)[:, [BETA, ALPHA]]).sum()])

    def jacobian(self, w: Array) -> Array | None:
        """Its derivatives by z, (1, 2)."""
        return difference_rates(self.value, w, STEP)

    def at(self, node: Node) -> "PitchforkPoint | None":
        """The pitchfork at a node, with its index and its side."""
        across = node.jacobian[0] / np.linalg.norm(node.jacobian[0])
        beside = (self.shape_at(node.w + sign * BESIDE * across) for sign in (1, -1))
        sides = [one for one in beside if one is not None]
        if len(sides) < 2:
            return None
        shape = replace(sides[0], rod=self.rod_at(node.w).in_scales(self.shape.rod.scale))
        shape = replace(shape, y=(sides[0].y + sides[1].y) / 2, t=shape.t * (shape.rod.span / shape.t[-1]))
        mode = max(weakest_modes(sides[0], NEAR), key=lambda one: abs(likeness(one, self.mode)))
        curve = Curve(lambda n: self.rod_at(node.w + n * across), 1.0, shape.rod.scale)
        split = [curve.correct(replace(shape, y=shape.y + sign * SMALL * mode), 0.0, curve.direction(mode, 0.0))
                 for sign in (1, -1)]  # fmt: skip
        turns = {float(np.sign(one.x)) for one in split if one is not None}
        more = across * turns.pop() if len(turns) == 1 else np.full(2, np.nan)
        return replace(self, z=node.w, shape=shape, mode=mode, lower=min(map(index_at, sides)), more=more)

    @property
    def w(self) -> Array:
        """The same as z."""
        return self.z

    @property
    def way(self) -> Array:
        """As of `SpecialPoint`."""
        return np.array([-self.more[1], self.more[0]])

    @property
    def slope(self) -> float:
        """beta_t(0)."""
        return float(self.shape.y[0, SPEED])

    @property
    def mark(self) -> Array:
        """As of `SpecialPoint`."""
        return angles_of(self.shape)

    def rate(self, tangent: Array) -> Array:
        """As of `SpecialPoint`."""
        return tangent

    def after(self, node: Node) -> "Ahead[PitchforkPoint] | None":
        """As of `SpecialPoint`; None where the two others lie on different sides."""
        there = self.at(node)
        if there is None or np.isnan(there.more).any():
            return None
        own = node_at(there, there.w, node.tangent)
        return None if isinstance(own, str) else (there, own)

    def at_border(self, node: Node) -> "PitchforkPoint | None":
        """As of `SpecialPoint`."""
        return border_point(self, node)


def likeness(one: Array, other: Array) -> float:
    """The cosine of the angle between the azimuths of two modes (N, 8)."""
    a, b = one[:, ALPHA], other[:, ALPHA]
    return float(a @ b / np.sqrt((a @ a) * (b @ b)))


def pitchfork_at(rod_at: RodAt, z: Array, axis: int, shape: Shape) -> PitchforkPoint | None:
    """The pitchfork near z on the line along number `axis`, of an equilibrium that its symmetry keeps; None without."""
    guess = PitchforkPoint(rod_at, z, shape, weakest_modes(shape)[0])
    jacobian = guess.jacobian(z)
    if jacobian is None:
        return None
    w = correct_point(guess, z, np.eye(2)[1 - axis], jacobian)
    node = w if isinstance(w, str) else node_at(guess, w, np.eye(2)[1 - axis])
    return None if isinstance(node, str) else guess.at(node)


def pitchfork_line(first: PitchforkPoint, known: Callable[[Array, Shape], bool]) -> SpecialLine[PitchforkPoint]:
    """The curve through a pitchfork, to the border of 0 <= z <= 1.

    known: whether a place and its shape lie on a known curve.
    """

    def between(
        point: PitchforkPoint, node: Node, step: float, taken: Ahead[PitchforkPoint]
    ) -> tuple[list[PitchforkPoint], str]:
        there = taken[0]
        if known(there.z, there.shape):
            return [], CROSSING
        return [] if there.lower == point.lower else crossing_between(point, node, step, there), ""

    how = Tracing(LENGTHS, MOST, between)
    return special_line(first, first.way, how)


def crossing_between(point: PitchforkPoint, node: Node, step: float, there: PitchforkPoint) -> list[PitchforkPoint]:
    """Pitchforks within a step, on either side of where another curve crosses and close to it."""
    low, high, before, after = 0.0, step, point, there
    while high - low > CROSSED:
        taken = step_from(point, node, (low + high) / 2)
        if isinstance(taken, str):  # so close to it that the index is not clear
            high = (low + high) / 2
            continue
        same = taken[0].lower == point.lower
        low, high = ((low + high) / 2, high) if same else (low, (low + high) / 2)
        before, after = (taken[0], after) if same else (before, taken[0])
    return [one for one in (before, after) if one is not point and one is not there]
