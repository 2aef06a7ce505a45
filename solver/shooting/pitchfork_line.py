"""The curve of a pitchfork over two numbers z, of a rod whose loads vary along it.

An equilibrium that its symmetry keeps, such as the straight rod, exists on both sides of the curve, and on it a push
along one mode meets no resistance. The stiffness against that push, smooth over z, is the equation of the curve.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ..folds.special_line import MOST, Ahead, SpecialLine, SpecialPoint, Tracing, point_on_line, special_line, step_from
from ..numerics.arclength import Lengths, Node, node_at
from ..numerics.arrays import Array
from ..numerics.roots import enclose
from .curve import Curve
from .descent import index_at, weakest_modes
from .fold_line import STEP, RodAt
from .further_shapes import angles_of
from .loaded_rod import ALPHA, BETA, SPEED, Q
from .newton import Shape, correct, linear_at

LENGTHS = Lengths(first=0.03, longest=0.1, least=2e-4)  # of steps, in the sizes of z
BESIDE = 1e-3  # in the sizes of z: how far beside the curve the indices are read
CROSSED = 3e-3  # how closely the place is enclosed where another curve crosses
NEAR = 3  # weakest modes: where another such curve crosses, that of this one is not the weakest
SMALL = 0.02  # of the angles, in their scales: of the shapes that split off


@dataclass(frozen=True, eq=False, kw_only=True)
class PitchforkPoint(SpecialPoint):
    """A pitchfork. w: z over their sizes. more: NaN where the two others lie on different sides.

    shape: the equilibrium there that the symmetry keeps. mode: (N, 8), along which others split off. index: the lower
    one of that equilibrium beside the curve.
    """

    rod_at: RodAt
    shape: Shape
    mode: Array
    index: int = 0
    nudge = STEP

    @property
    def lower(self) -> int:
        """As of `SpecialPoint`."""
        return self.index

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

    def after(self, node: Node) -> "Ahead[PitchforkPoint] | None":
        """As of `SpecialPoint`, with its index and its mode."""
        across = node.jacobian[0] / np.linalg.norm(node.jacobian[0])
        beside = (self.shape_at(node.w + sign * BESIDE * across) for sign in (1, -1))
        sides = [one for one in beside if one is not None]
        if len(sides) < 2:
            return None
        shape = replace(sides[0], rod=self.rod_at(node.w).in_scales(self.shape.rod.scale))
        shape = replace(shape, y=(sides[0].y + sides[1].y) / 2, t=shape.t * (shape.rod.span / shape.t[-1]))
        mode = max(weakest_modes(sides[0], NEAR), key=lambda one: abs(likeness(one, self.mode)))
        curve = Curve(lambda n: self.rod_at(node.w + n * across), 1.0, shape.rod.scale)
        turns = {float(np.sign(one.x)) for one in curve.split_off(shape, mode, (SMALL, -SMALL), 0.0)}
        more = across * turns.pop() if len(turns) == 1 else np.full(2, np.nan)
        index, way = min(map(index_at, sides)), node.tangent
        there = replace(self, w=node.w, way=way, more=more, shape=shape, mode=mode, index=index)
        own = node_at(there, there.w, node.tangent)
        return None if isinstance(own, str) else (there, own)

    @property
    def slope(self) -> float:
        """beta_t(0)."""
        return float(self.shape.y[0, SPEED])

    @property
    def mark(self) -> Array:
        """As of `SpecialPoint`."""
        return angles_of(self.shape)


def likeness(one: Array, other: Array) -> float:
    """The cosine of the angle between the azimuths of two modes (N, 8)."""
    a, b = one[:, ALPHA], other[:, ALPHA]
    return float(a @ b / np.sqrt((a @ a) * (b @ b)))


def pitchfork_at(rod_at: RodAt, z: Array, axis: int, shape: Shape) -> PitchforkPoint | None:
    """The pitchfork near z on the line along number `axis`, of an equilibrium that its symmetry keeps; None without."""
    return point_on_line(PitchforkPoint(w=z, rod_at=rod_at, shape=shape, mode=weakest_modes(shape)[0]), axis)


def pitchfork_line(first: PitchforkPoint, known: Callable[[Array, Shape], bool]) -> SpecialLine[PitchforkPoint]:
    """The curve through a pitchfork, to the border of 0 <= z <= 1.

    known: whether a place and its shape lie on a known curve.
    """
    how = Tracing(LENGTHS, MOST, crossing_between, is_known=lambda there: known(there.z, there.shape))
    return special_line(first, how)


def crossing_between(
    point: PitchforkPoint, node: Node, step: float, taken: Ahead[PitchforkPoint]
) -> list[PitchforkPoint]:
    """As of `Between`: pitchforks on either side of where another curve crosses, and close to it."""
    if taken[0].lower == point.lower:
        return []
    sides = enclose(
        partial(step_from, point, node), {0.0: (point, node), step: taken},
        lambda there: there[0].lower != point.lower, CROSSED,
    )  # fmt: skip
    return [there for _, (there, _) in sides if there is not point and there is not taken[0]]
