"""A line of special points of one kind, folds or pitchforks, over two numbers z in the unit square."""

from collections.abc import Callable, Iterator
from typing import Protocol, TypeVar

import numpy as np

from ..numerics.arclength import LEFT, Lengths, Node, Stride, advance, node_at, trace
from ..numerics.arrays import Array

NARROW = 1e-3  # a step, below which other coordinates are tried
CLOSE = 1e-9  # to the border
BORDER, STOPPED = "border", "stopped"
TURNS = "the sense of the line turns, as it does where its equation is lost in rounding"


class SpecialPoint(Protocol):
    """A special point, and the equation of its line nearby, a `numerics.arclength.Curve`."""

    @property
    def z(self) -> Array:
        """Its place, (2,)."""
        ...

    @property
    def w(self) -> Array:
        """The same in the coordinates of the equation, (2,)."""
        ...

    def value(self, w: Array) -> Array | None:
        """As of `numerics.arclength.Curve`."""
        ...

    def jacobian(self, w: Array) -> Array | None:
        """As of `numerics.arclength.Curve`."""
        ...

    def ahead(self, node: Node, step: float) -> Array:
        """z a step along the tangent at its own node."""
        ...

    def after(self: "Point", node: Node) -> "Ahead[Point] | None":
        """The special point at a node of the equation, and the direction of travel in its own coordinates."""
        ...

    def at_border(self: "Point", node: Node) -> "Point | None":
        """The one on the border that the line meets next from its own node; None where it meets none nearby."""
        ...

    def in_other_coordinates(self: "Point") -> "Iterator[Point]":
        """The same point, where its equation has several forms."""
        ...


Point = TypeVar("Point", bound=SpecialPoint)
Ahead = tuple[Point, Array]
# Of a point, its node, a step and where that leads: the points on the way, in order, and why the line ends, else "";
# None where they are not located
Between = Callable[[Point, Node, float, Ahead[Point]], tuple[list[Point], str] | None]


def special_line(
    first: Point, direction: Array, lengths: Lengths, most: int, between: Between[Point]
) -> tuple[list[Point], str]:
    """The points of a line after the first, to the border of 0 < z < 1, and how it ends; direction: of travel, (2,)."""

    def stride(here: tuple[Point, Node], step: float, _: list[Point]) -> Stride[Point, tuple[Point, Node]] | str:
        point, node = here
        if _is_beyond(point.ahead(node, step)):
            last = point.at_border(node)
            if last is not None:
                return Stride([last] * bool(np.abs(last.z - point.z).max() > CLOSE), here, step, BORDER)
        taken = step_from(point, node, step)
        for other in point.in_other_coordinates() if isinstance(taken, str) and step < NARROW else ():
            own = node_at(other, other.w, node.tangent)
            again = own if isinstance(own, str) else step_from(other, own, step)
            if not isinstance(own, str) and not isinstance(again, str):
                point, node, taken = other, own, again
                break
        if isinstance(taken, str):
            return taken
        if _is_beyond(taken[0].z):
            return BORDER
        there = node_at(taken[0], taken[0].w, taken[1])
        if isinstance(there, str) or there.sign != node.sign:
            return there if isinstance(there, str) else TURNS
        met = between(point, node, step, taken)
        if met is None:
            return "a point on the way could not be located"
        passed, end = met
        return Stride([*passed, taken[0]], (taken[0], there), step * (1.0 if passed else 1.5), end)

    begin = node_at(first, first.w, direction)
    if isinstance(begin, str):
        return [], STOPPED
    points, end = trace((first, begin), stride, lengths, most)
    return points, end or STOPPED


def step_from(point: Point, node: Node, step: float) -> Ahead[Point] | str:
    """The special point after a step and the direction there, or why there is none."""
    found = advance(point, node, step)
    return found if isinstance(found, str) else point.after(found) or LEFT


def _is_beyond(z: Array) -> bool:
    return bool((np.abs(z - 0.5) > 0.5).any())
