"""A line of special points of one kind, folds or pitchforks, over two numbers z in the unit square."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from typing import ClassVar, Generic, TypeVar

import numpy as np

from ..core.tuning import NARROW
from ..numerics.arclength import (
    FOLD,
    LEFT,
    Lengths,
    Node,
    Stride,
    advance,
    border_distances,
    correct_point,
    difference_rates,
    node_at,
    trace,
)
from ..numerics.arrays import ASIDE, NEGLIGIBLE, Array
from ..numerics.roots import REACH, enclose, locate, root

BORDER, CLOSED, CROSSING, STOPPED = ENDS = "border", "closed", "crossing", "stopped"  # how a line ends
# cosine to the first step, and distance over that of a step, of one that closes the line. x10: lines close beside
# themselves
SENSE, BESIDE = 0.8, 0.2
MOST = 4000  # points of a line in each sense. x10: a line that winds without end costs minutes
ALONE = 3  # points after the first before a line can close. x10: small closed lines are traced twice


@dataclass(frozen=True, eq=False, kw_only=True)
class LinePoint(ABC):
    """A special point, and the equation of its line nearby, a `numerics.arclength.Curve`.

    w: (n + 1,), in the coordinates of the equation, z last. kind: FOLD or PITCHFORK. way: (2,), the direction of the
    line there, in either sense, of length 1. more: (2,), towards the side of two more equilibria; zero where that
    changes, as at a cusp, NaN where there is none.
    """

    w: Array
    kind: str = FOLD
    way: Array = field(default_factory=lambda: np.zeros(2))
    more: Array = field(default_factory=lambda: np.zeros(2))
    nudge: ClassVar[float | Array]  # of each coordinate, for the derivatives of the equation

    @property
    def z(self) -> Array:
        """Its place, (2,)."""
        return self.w[-2:]

    @property
    @abstractmethod
    def dbeta0(self) -> float:
        """beta_t(0) of the equilibrium."""

    @property
    @abstractmethod
    def mark(self) -> Array:
        """Numbers of about 1 that tell the equilibrium from others."""

    @property
    @abstractmethod
    def lower(self) -> int:
        """The lower Morse index of the two equilibria that meet."""

    @property
    def is_true(self) -> bool:
        """Whether the zero of its equation is such a point."""
        return True

    @abstractmethod
    def value(self, w: Array) -> Array | None:
        """F(w) of the equation of its line (`numerics.arclength.Curve`); None where there is none."""

    def jacobian(self, w: Array) -> Array | None:
        """F'(w) of that equation; None where there is none."""
        return difference_rates(self.value, w, self.nudge)

    def side_of(self, node: Node) -> Array:
        """What `more` is at a node of the equation; of a fold, whose last equation is a determinant.

        Along the left null vector of the derivatives of the others by the unknowns, these are to second order a change
        by z and a square of the distance along the right one; its sign is that of the change of the determinant.
        """
        jacobian, n = node.jacobian, node.w.size - 2
        left, _, right = np.linalg.svd(jacobian[:-1, :n])
        bend = float(jacobian[-1, :n] @ right[-1]) * np.linalg.det(left) * np.linalg.det(right)
        return np.asarray(-np.sign(bend) * (left[:, -1] @ jacobian[:-1, n:]))

    def after(self: "Point", node: Node) -> "Ahead[Point] | None":
        """The special point at a node of the equation, and its own node, travelled in the same direction."""
        way = node.tangent[-2:]
        return replace(self, w=node.w, way=way / np.linalg.norm(way), more=self.side_of(node)), node


Point = TypeVar("Point", bound=LinePoint)
Ahead = tuple[Point, Node]
# Of a point, its node, a step and where that leads: the points on the way, in order; None where they are not located
Between = Callable[[Point, Node, float, Ahead[Point]], list[Point] | None]
# Of a point, its node, and whether no step succeeds from it: the same point where other forms of the equation suit the
# line better
Others = Callable[[Point, Node, bool], Iterator[Ahead[Point]]]


@dataclass(frozen=True, eq=False)
class Tracing(Generic[Point]):
    """How lines of one kind are traced. is_known: of a point where another line passes, at which this one ends."""

    lengths: Lengths
    between: Between[Point]
    others: Others[Point] = lambda *_: iter(())
    is_known: Callable[[Point], bool] = lambda _: False


@dataclass(frozen=True, eq=False)
class SpecialLine(Generic[Point]):
    """The points of a line in order, how it ends at either side, and the point with which it was begun."""

    points: list[Point]
    ends: tuple[str, str]
    first: Point


def special_line(first: Point, how: Tracing[Point]) -> SpecialLine[Point]:
    """The line through a point to the border of 0 < z < 1, or closed."""
    along = np.append(np.zeros(first.w.size - 2), first.way)
    ahead, end = line_from(first, along, how)
    if end == CLOSED:
        return SpecialLine([first, *ahead, first], (CLOSED, CLOSED), first)
    back, begin = line_from(first, -along, how)
    return SpecialLine([*back[::-1], first, *ahead], (begin, end), first)


def line_from(first: Point, direction: Array, how: Tracing[Point]) -> tuple[list[Point], str]:
    """The points of a line after the first, and how it ends; direction: of travel, (n + 1,)."""

    def stride(before: Ahead[Point], step: float, points: list[Point]) -> Stride[Point, Ahead[Point]] | str:
        point, node = next(how.others(*before, False), before)
        if _is_beyond(point.z + step * node.tangent[-2:]):
            last = border_point(point, node)
            if last is not None:
                return Stride([last] * bool(np.abs(last.z - point.z).max() > NEGLIGIBLE), before, step, BORDER)
        taken = step_from(point, node, step)
        for other in how.others(point, node, True) if isinstance(taken, str) and step < NARROW else ():
            again = step_from(*other, step)
            if not isinstance(again, str):
                (point, node), taken = other, again
                break
        if isinstance(taken, str):
            return taken
        if _is_beyond(taken[0].z):
            return BORDER
        if taken[1].sign != node.sign:
            return "the sense of the line turns, as it does where its equation is lost in rounding"
        end = CROSSING if how.is_known(taken[0]) else ""
        passed = [] if end else how.between(point, node, step, taken)
        if passed is None:
            return "a point on the way could not be located"
        if len(points) > ALONE and _passes(first, points[0], point, taken[0]):
            return Stride(passed, taken, step, CLOSED)
        return Stride([*passed, taken[0]], taken, step * (1.0 if passed else 1.5), end)

    begin = node_at(first, first.w, direction)
    if isinstance(begin, str):
        return [], STOPPED
    points, end = trace((first, begin), stride, how.lengths, MOST)
    return points, end if end in ENDS else STOPPED


def step_from(point: Point, node: Node, step: float) -> Ahead[Point] | str:
    """The special point after a step and its node, or why there is none."""
    ahead = advance(point, node, step)
    following = ahead if isinstance(ahead, str) else point.after(ahead)
    if following is None or (not isinstance(following, str) and np.isnan(following[0].more).any()):
        return LEFT
    return following


def point_on_line(guess: Point, axis: int) -> Point | None:
    """The point next to a guess on the line along number `axis` of z; None where Newton's rule reaches none."""
    across = np.eye(guess.w.size)[-1 - axis]

    def equations(w: Array) -> tuple[Array, Array] | None:
        within = np.abs(w[-2:] - 0.5).max() <= 0.5 + ASIDE
        value, rates = (f(w) if within else None for f in (guess.value, guess.jacobian))
        if value is None or rates is None:
            return None
        return np.append(value, across @ (w - guess.w)), np.vstack([rates, across])

    w = root(equations, guess.w, REACH)
    point = None if w is None else point_at(guess, w, across)
    return point if point is not None and point.is_true else None


def point_at(near: Point, w: Array, along: Array) -> Point | None:
    """The point at w, in the coordinates of another one nearby, travelled in a direction like `along`."""
    node = node_at(near, w, along)
    following = None if isinstance(node, str) else near.after(node)
    return None if following is None else following[0]


def change_within(
    point: Point, node: Node, step: float, taken: Ahead[Point], value: Callable[[Ahead[Point]], object], width: float
) -> list[Point]:
    """The points of a step before and after a change of a value, so close to each other; none where it is the same."""
    begin = point, node
    if value(begin) == value(taken):
        return []
    sides = enclose(
        partial(step_from, point, node),
        {0.0: begin, step: taken},
        lambda ahead: value(ahead) != value(begin),
        width,
    )
    return [ahead[0] for _, ahead in sides]


def cusps_between(point: Point, node: Node, step: float, taken: Ahead[Point]) -> list[Point] | None:
    """Folds within a step (`Between`): a cusp where z turns back."""
    before = node.tangent[-2:]
    if before @ taken[1].tangent[-2:] >= 0:
        return []
    cusp = locate(
        partial(step_from, point, node),
        {0.0: (point, node), step: taken},
        lambda ahead: float(before @ ahead[1].tangent[-2:]),
    )
    return None if cusp is None else [with_no_side(cusp[0])]


def with_no_side(point: Point) -> Point:
    """The point where the side of two more equilibria changes, hence with none."""
    return replace(point, more=np.zeros(2))


def border_point(point: Point, node: Node) -> Point | None:
    """The point on the border that a line meets next from its own node; None where it meets none nearby."""
    rate = node.tangent[-2:]
    ways = border_distances(point.z, rate, np.zeros(2), np.ones(2))
    for k in np.argsort(ways):
        across = np.eye(node.w.size)[k - 2]
        w = correct_point(point, node.w + ways[k] * node.tangent, across, node.jacobian) if ways[k] < 1 else LEFT
        if isinstance(w, str) or np.abs(w[-2:] - 0.5).max() > 0.5 + NEGLIGIBLE:
            continue
        w[k - 2] = float(rate[k] > 0)
        return point_at(point, w, node.tangent)
    return None


def _passes(first: LinePoint, second: LinePoint, before: LinePoint, after: LinePoint) -> bool:
    """Whether the step from a point to the next one passes the first point in the sense in which the line left it."""
    if not first.mark.size == second.mark.size == before.mark.size == after.mark.size:
        return False
    begin, beyond, a, b = (np.append(point.z, point.mark) for point in (first, second, before, after))
    chord, way = b - a, beyond - begin
    share = float((begin - a) @ chord / (chord @ chord))
    if not 0 <= share <= 1 or chord @ way < SENSE * np.linalg.norm(chord) * np.linalg.norm(way):
        return False
    return bool(np.linalg.norm(a + share * chord - begin) < BESIDE * np.linalg.norm(chord))


def _is_beyond(z: Array) -> bool:
    return bool((np.abs(z - 0.5) > 0.5).any())
