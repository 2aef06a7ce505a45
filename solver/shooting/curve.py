"""Curves of equilibria of a rod that depends on one number x: Newton's method with x unknown and one more condition.

The unknowns are the states at the nodes, in fixed scales, and x over its size. The nodes keep their shares of the span.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..numerics.arrays import Array
from ..numerics.roots import DIVERGED, newton
from .loaded_rod import ALPHA, BETA, LoadedRod
from .newton import ENDING, Shape, linear_at, open_at, share_within, size_of, with_known_loads

DIFFERENCE = 1e-5  # of x over its size: for derivatives by x
SOFT = 1e-14  # springs that hardly change the equations, in the scales
REACH = 1.0  # the longest step of the angles, in their scales


def angles_of(shape: Shape) -> Array:
    """The angles at the nodes in their scales, such that the length of a difference is its mean size."""
    return angles_in(shape.y / shape.rod.scale)


def angles_in(change: Array) -> Array:
    """Those of a change (N, 8) in the scales."""
    return np.asarray(change[:, [BETA, ALPHA]].reshape(-1) / np.sqrt(len(change)))


@dataclass(frozen=True, eq=False)
class Point:
    """A point of a curve. tangent: (8 N + 1,), of length 1 by `inner`."""

    shape: Shape
    x: float
    tangent: Array


def inner(u: Array, v: Array) -> float:
    """The product of two directions (8 N + 1,): the mean over the nodes of that of the angles, and that of x."""
    a, b = (w[:-1].reshape(-1, 8)[:, [BETA, ALPHA]] for w in (u, v))
    return float((a * b).sum() / len(a) + u[-1] * v[-1])


@dataclass(frozen=True, eq=False)
class Curve:
    """rod_at: the rod at each x. size: the size of x. scale: (8,), that of the states."""

    rod_at: Callable[[float], LoadedRod]
    size: float
    scale: Array

    def shape(self, like: Shape, y: Array, x: float) -> Shape:
        """The rod at x with the states y, on the nodes of another shape."""
        rod = self.rod_at(x).in_scales(self.scale)
        return Shape(rod, like.t * (rod.span / like.t[-1]), y)

    def direction(self, change: Array, x: float) -> Array:
        """The direction of a change (N, 8) of the states and of x, of length 1."""
        direction = np.append((change / self.scale).reshape(-1), x / self.size)
        return np.asarray(direction / np.sqrt(inner(direction, direction)))

    def direction_between(self, a: Point, b: Point) -> Array:
        """From one point to another, (8 N + 1,)."""
        return np.append(((b.shape.y - a.shape.y) / self.scale).reshape(-1), (b.x - a.x) / self.size)

    def split_off(self, shape: Shape, mode: Array, sizes: Sequence[float], x: float) -> Iterator[Point]:
        """The equilibria near x that differ from a shape by so much of a mode (N, 8): x is what follows."""
        across = self.direction(mode, 0.0)
        points = (self.correct(replace(shape, y=shape.y + size * mode), x, across) for size in sizes)
        return (point for point in points if point is not None)

    def rate(self, shape: Shape, x: float) -> Array:
        """The derivative of what is open by x over its size, (8 N,)."""
        h = DIFFERENCE * self.size
        above, below = (open_at(self.shape(shape, shape.y, x + sign * h)) for sign in (1, -1))
        return np.asarray((above - below) / (2 * DIFFERENCE))

    def correct(self, guess: Shape, x: float, across: Array, most: int = 12) -> Point | None:
        """The point of the curve in the plane through a guess with the normal `across` (8 N + 1,); None without one."""

        def step(now: Point) -> tuple[Point, float] | str:
            shape = now.shape
            linear = linear_at(shape)
            right = np.stack([linear.open, self.rate(shape, now.x)], axis=1)
            columns = linear.solve(right)
            if columns is None:  # at a fold, where a pivot may vanish
                columns = replace(linear, stiffness=np.full((shape.t.size, 2), SOFT)).solve(right)
            if columns is None:
                return DIVERGED
            whole, by_x = np.append(columns[:, 0], 0.0), np.append(-columns[:, 1], 1.0)
            passed = np.append(((shape.y - guess.y) / self.scale).reshape(-1), (now.x - x) / self.size)
            along = inner(across, by_x)
            if not along:
                return DIVERGED
            whole = whole - by_x * (inner(across, whole - passed) / along)
            change = whole[:-1].reshape(shape.y.shape)
            share = share_within(REACH, change)
            at = now.x - share * whole[-1] * self.size
            ahead = self.shape(guess, shape.y - share * change * self.scale, at)
            return Point(replace(ahead, steps=shape.steps + 1), float(at), by_x), max(size_of(change), abs(whole[-1]))

        corrected = newton(Point(self.shape(guess, guess.y, x), x, across), step, replace(ENDING, rounds=most))
        if isinstance(corrected, str):
            return None
        solved, tangent = corrected.shape, corrected.tangent / np.sqrt(inner(corrected.tangent, corrected.tangent))
        solved = replace(solved, y=with_known_loads(solved.rod, solved.t, solved.y))
        return Point(solved, corrected.x, tangent if inner(tangent, across) >= 0 else -tangent)
