"""Curves of equilibria of a rod that depends on one number x: Newton's method with x unknown and one more condition.

The unknowns are the states at the nodes, in fixed scales, and x over its size. The nodes keep their shares of the span.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..numerics.arrays import Array
from .loaded_rod import ALPHA, BETA, PHI, LoadedRod
from .newton import ROUNDING, Shape, linear_at, open_at, with_known_loads

DIFFERENCE = 1e-5  # of x over its size: for derivatives by x
REACH = 1.0  # the longest step of the angles, in their scales


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
        found = np.append((change / self.scale).reshape(-1), x / self.size)
        return np.asarray(found / np.sqrt(inner(found, found)))

    def direction_between(self, a: Point, b: Point) -> Array:
        """From one point to another, (8 N + 1,)."""
        return np.append(((b.shape.y - a.shape.y) / self.scale).reshape(-1), (b.x - a.x) / self.size)

    def rate(self, shape: Shape, x: float) -> Array:
        """The derivative of what is open by x over its size, (8 N,)."""
        h = DIFFERENCE * self.size
        above, below = (open_at(self.shape(shape, shape.y, x + sign * h)) for sign in (1, -1))
        return np.asarray((above - below) / (2 * DIFFERENCE))

    def correct(self, guess: Shape, x: float, across: Array, most: int = 12) -> Point | None:
        """The point of the curve in the plane through a guess with the normal `across` (8 N + 1,); None without one."""
        y, begun, best = guess.y, x, np.inf
        for count in range(1, most + 1):
            now = self.shape(guess, y, x)
            linear = linear_at(now)
            right = np.stack([linear.open, self.rate(now, x)], axis=1)
            found = linear.solve(right) if np.isfinite(right).all() else None
            if found is None or not np.isfinite(found).all():
                return None
            step, by_x = np.append(found[:, 0], 0.0), np.append(-found[:, 1], 1.0)
            passed = np.append(((y - guess.y) / self.scale).reshape(-1), (x - begun) / self.size)
            step = step - by_x * (inner(across, step - passed) / inner(across, by_x))
            change = step[:-1].reshape(y.shape)
            size = float(np.abs(change[:, [BETA, ALPHA]]).max())
            share = min(1.0, REACH / size) if size else 1.0
            y, x = y - share * change * self.scale, x - share * step[-1] * self.size
            whole = max(float(np.abs(change[:, :PHI]).max()), abs(step[-1]))
            if not np.isfinite(whole):
                return None
            if whole < ROUNDING or (whole < 1e-7 and whole > best / 4):
                last = self.shape(guess, y, x)
                tangent = by_x / np.sqrt(inner(by_x, by_x))
                solved = Shape(last.rod, last.t, with_known_loads(last.rod, last.t, y), count)
                return Point(solved, float(x), tangent if inner(tangent, across) >= 0 else -tangent)
            best = min(best, whole)
        return None
