"""Pseudo-arclength continuation of a curve F(w) = 0, with n equations in n + 1 unknowns.

A step leads along the tangent and back to the curve in the plane across the tangent, so it passes folds, where one
unknown has an extremum. The sign of det [F'; t], t being the tangent, is constant along a smooth curve. It is opposite
on the two neighbours of a curve, so a step onto a neighbour would turn the tangent round, and is refused.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Generic, Protocol, TypeVar

import numpy as np

from .arrays import Array
from .roots import Ending, newton, null_vector

# as small as floats allow with a margin for their sums; Newton's method doubles the digits, so 10 are enough after a
# step that is accepted. x10: no answer changes
ENDING = Ending(rounds=10, goal=1e-12, small=1e-9, growth=0.5, stall=0.5)
# the most on a branch: that is asked for; in each sense, that a search follows. x10: ten times the time of a branch
# that winds
POINTS, FEW_POINTS = 1000, 150
# most of the distance from the predictor over a step; least of the turn of the tangent: 23 degrees. x10: steps land on
# other branches; the cosine, that no step reaches, follows none
OFF, COSINE = 0.25, 0.92

LEFT = "the curve ends"
REVERSED = "the determinant changes its sign"  # and the curve does not turn: it goes on, or is a neighbour
FOLD, PITCHFORK, BRANCH_POINT = "fold", "pitchfork", "branch point"  # what is met on the way
END, CLOSED = "the end of the range", "the branch is closed"  # why there is no more of a branch
Place = TypeVar("Place")
State = TypeVar("State")


class Curve(Protocol):
    """F and its Jacobian, (n,) and (n, n + 1); None where they do not exist."""

    def value(self, w: Array) -> Array | None:
        """F(w)."""
        ...

    def jacobian(self, w: Array) -> Array | None:
        """F'(w)."""
        ...


@dataclass(frozen=True, eq=False)
class Node:
    """A point of a curve.

    w: (n + 1,). jacobian: (n, n + 1). tangent: (n + 1,), of length 1, in the direction of travel. sign: of det [F'; t].
    bend: distance from the predictor as a share of the step that led here.
    """

    w: Array
    jacobian: Array
    tangent: Array
    sign: float
    bend: float = 0.0


@dataclass(frozen=True)
class Lengths:
    """The length of the first step, of the longest, and that below which a curve is given up."""

    first: float
    longest: float
    least: float


# where a parameter must rise from 0 to 1, in its scale. x10: a step is the whole way, and branches are given up where
# their steps are short
RISING = Lengths(first=0.1, longest=0.25, least=1e-4)


@dataclass(frozen=True, eq=False)
class Stride(Generic[Place, State]):
    """What a step leads to: points in order, from where to go on, the next step, and why the curve ends, if it does."""

    points: list[Place]
    state: State
    step: float
    end: str = ""


def trace(
    state: State,
    stride: Callable[[State, float, list[Place]], Stride[Place, State] | str],
    lengths: Lengths,
    most: int,
) -> tuple[list[Place], str]:
    """The points of a curve after the first, and why there are no more; "" where there are `most` of them.

    Every curve of the solver is traced here: branches, fold curves, and branches of rods with weight.

    Parameters
    ----------
    state : any type
        Where the curve begins.
    stride : callable
        Of where it is, the length of a step and the points before: the step, with what happens on the way; or why it is
        refused, and is tried at half the length.
    lengths : Lengths
    most : int
    """
    points, step = list[Place](), lengths.first
    while len(points) < most:
        move = stride(state, step, points)
        if isinstance(move, str):
            step /= 2
            if step < lengths.least:
                return points, move
            continue
        points += move.points
        if move.end:
            return points, move.end
        state, step = move.state, min(lengths.longest, move.step)
    return points, ""


def border_distances(x: Array, rate: Array, low: Array, high: Array) -> Array:
    """How far along a direction `rate` each coordinate of a point x meets the border low < x < high, (n,)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(rate > 0, (high - x) / rate, np.where(rate < 0, (low - x) / rate, np.inf))


def node_at(curve: Curve, w: Array, along: Array) -> Node | str:
    """The point of a curve at w, travelled in a direction like `along` (n + 1,)."""
    jacobian = curve.jacobian(w)
    if jacobian is None or not jacobian.any():  # without a direction
        return LEFT
    tangent = _null(jacobian)
    tangent = tangent if tangent @ along >= 0 else -tangent
    return Node(w, jacobian, tangent, _sign(jacobian, tangent))


def advance(curve: Curve, node: Node, step: float, across: Array | None = None, goal: float = 0.0) -> Node | str:
    """The point after a step, or why there is none.

    across: (n + 1,), the normal of the plane in which the predictor is corrected; default: the tangent. goal: the size
    of a correction that may be the last one, if that is larger than the ordinary one.
    """
    guess = node.w + step * node.tangent
    point = correct_point(curve, guess, node.tangent if across is None else across, node.jacobian, goal)
    if isinstance(point, str):
        return point
    bend = max(float(np.linalg.norm(point - guess)) - ENDING.small, 0.0) / step
    if bend > OFF:
        return "the step is too long"
    jacobian = curve.jacobian(point)
    if jacobian is None or not jacobian.any():
        return LEFT
    tangent = _null(jacobian)
    tangent = tangent if _sign(jacobian, tangent) == node.sign else -tangent
    turn = tangent @ node.tangent
    if turn < COSINE:
        return REVERSED if turn < -COSINE else "the tangent turns"
    return Node(point, jacobian, tangent, node.sign, bend)


def correct_point(curve: Curve, guess: Array, across: Array, jacobian: Array, goal: float = 0.0) -> Array | str:
    """The point of the curve in the plane through a guess with the normal `across`, by Broyden's method.

    goal: as of `advance`.
    """
    system, move, off = np.vstack([jacobian, across]), np.zeros_like(guess), np.zeros_like(guess)

    def step(w: Array) -> tuple[Array, float] | str:
        nonlocal system, move, off
        value = curve.value(w)
        if value is None:
            return LEFT
        now = np.append(value, across @ (w - guess))
        if square := move @ move:
            system = system + np.outer(now - off - system @ move, move) / square
        off = now
        try:
            move = -np.linalg.solve(system, off)
        except np.linalg.LinAlgError:
            return "the linearised equations are singular"
        with np.errstate(over="ignore"):
            return w + move, float(np.linalg.norm(move))

    return newton(guess, step, replace(ENDING, goal=max(goal, ENDING.goal)))


def difference_rates(value: Callable[[Array], Array | None], w: Array, step: float | Array) -> Array | None:
    """The derivatives of a function of w (n + 1,), (n, n + 1), by central differences; None where it has no value.

    step: of all coordinates, or of each.
    """
    pairs = [(value(w + nudge), value(w - nudge)) for nudge in step * np.eye(w.size)]
    columns = [high - low for high, low in pairs if high is not None and low is not None]
    return np.column_stack(columns) / (2 * step) if len(columns) == w.size else None


def _null(jacobian: Array) -> Array:
    """A unit vector t with F' t = 0."""
    if jacobian.shape[0] == 1:
        t = np.array([-jacobian[0, 1], jacobian[0, 0]])
        return np.asarray(t / np.linalg.norm(t))
    return null_vector(jacobian)


def _sign(jacobian: Array, tangent: Array) -> float:
    return float(np.sign(np.linalg.det(np.vstack([jacobian, tangent]))))
