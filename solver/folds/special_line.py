"""A line of special points of one kind, folds or pitchforks, over two numbers z in the unit square."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Generic, Protocol, TypeVar

import numpy as np

from ..numerics.arclength import (
    LEFT,
    Lengths,
    Node,
    Stride,
    advance,
    border_distances,
    correct_point,
    node_at,
    trace,
)
from ..numerics.arrays import Array
from ..numerics.roots import enclose

NARROW = 1e-3  # a step, below which other coordinates are tried
CLOSE = 1e-9  # to the border
BORDER, CLOSED, CROSSING, STOPPED = ENDS = "border", "closed", "crossing", "stopped"  # how a line ends
TURNS = "the sense of the line turns, as it does where its equation is lost in rounding"
ROUNDS = 25  # steps of a search of the border, of a cusp, or of a change of side
FLAT, ENCLOSED = 1e-6, 1e-6  # of the rate of z at a cusp, whose square is lost of z; of the step that holds it
SENSE, ASIDE = 0.8, 0.2  # cosine to the first step, and distance over that of a step, of one that closes the line
ALONE = 3  # points after the first before a line can close


class SpecialPoint(Protocol):
    """A special point, and the equation of its line nearby, a `numerics.arclength.Curve`."""

    @property
    def z(self) -> Array:
        """Its place, (2,)."""
        ...

    @property
    def way(self) -> Array:
        """The direction of the line there, in either sense, (2,), of length 1."""
        ...

    @property
    def more(self) -> Array:
        """A vector towards the side of two more equilibria, (2,); zero at a cusp."""
        ...

    @property
    def slope(self) -> float:
        """beta_t(0) of the equilibrium."""
        ...

    @property
    def mark(self) -> Array:
        """Numbers of about 1 that tell the equilibrium from others."""
        ...

    @property
    def w(self) -> Array:
        """The same in the coordinates of the equation, (n + 1,)."""
        ...

    def value(self, w: Array) -> Array | None:
        """As of `numerics.arclength.Curve`."""
        ...

    def jacobian(self, w: Array) -> Array | None:
        """As of `numerics.arclength.Curve`."""
        ...

    def rate(self, tangent: Array) -> Array:
        """The change of z by a tangent at its own w, (2,)."""
        ...

    def after(self: "Point", node: Node) -> "Ahead[Point] | None":
        """The special point at a node of the equation, and its own node, travelled in the same direction."""
        ...

    def at_border(self: "Point", node: Node) -> "Point | None":
        """The one on the border that the line meets next from its own node; None where it meets none nearby."""
        ...


Point = TypeVar("Point", bound=SpecialPoint)
Ahead = tuple[Point, Node]
# Of a point, its node, a step and where that leads: the points on the way, in order, and why the line ends, else "";
# None where they are not located
Between = Callable[[Point, Node, float, Ahead[Point]], tuple[list[Point], str] | None]
# Of a point, its node, and whether no step succeeds from it: the same point where other forms of the equation suit the
# line better
Others = Callable[[Point, Node, bool], Iterator[Ahead[Point]]]


@dataclass(frozen=True, eq=False)
class Tracing(Generic[Point]):
    """How lines of one kind are traced. most: points in each sense."""

    lengths: Lengths
    most: int
    between: Between[Point]
    others: Others[Point] = lambda *_: iter(())


@dataclass(frozen=True, eq=False)
class SpecialLine(Generic[Point]):
    """The points of a line in order, and how it ends at either side."""

    points: list[Point]
    ends: tuple[str, str]


def special_line(first: Point, along: Array, how: Tracing[Point]) -> SpecialLine[Point]:
    """The line through a point to the border of 0 < z < 1, or closed.

    along: its direction at the point in the coordinates of that, (n + 1,).
    """
    ahead, end = line_from(first, along, how)
    if end == CLOSED:
        return SpecialLine([first, *ahead, first], (CLOSED, CLOSED))
    back, begin = line_from(first, -along, how)
    return SpecialLine([*back[::-1], first, *ahead], (begin, end))


def line_from(first: Point, direction: Array, how: Tracing[Point]) -> tuple[list[Point], str]:
    """The points of a line after the first, and how it ends; direction: of travel, (n + 1,)."""

    def stride(here: Ahead[Point], step: float, before: list[Point]) -> Stride[Point, Ahead[Point]] | str:
        point, node = next(how.others(*here, False), here)
        if _is_beyond(point.z + step * point.rate(node.tangent)):
            last = point.at_border(node)
            if last is not None:
                return Stride([last] * bool(np.abs(last.z - point.z).max() > CLOSE), here, step, BORDER)
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
            return TURNS
        met = how.between(point, node, step, taken)
        if met is None:
            return "a point on the way could not be located"
        passed, end = met
        if len(before) > ALONE and _passes(first, before[0], point, taken[0]):
            return Stride(passed, taken, step, CLOSED)
        return Stride([*passed, taken[0]], taken, step * (1.0 if passed else 1.5), end)

    begin = node_at(first, first.w, direction)
    if isinstance(begin, str):
        return [], STOPPED
    points, end = trace((first, begin), stride, how.lengths, how.most)
    return points, end if end in ENDS else STOPPED


def step_from(point: Point, node: Node, step: float) -> Ahead[Point] | str:
    """The special point after a step and its node, or why there is none."""
    ahead = advance(point, node, step)
    return ahead if isinstance(ahead, str) else point.after(ahead) or LEFT


def cusps_between(point: Point, node: Node, step: float, taken: Ahead[Point]) -> tuple[list[Point], str] | None:
    """As of `Between`, of folds: a cusp where z turns back within a step."""
    before = point.rate(node.tangent)
    before = before / np.linalg.norm(before)
    after = float(before @ taken[0].rate(taken[1].tangent))
    if after >= 0:
        return [], ""

    def rate_at(place: float) -> tuple[Point, float] | None:
        there = step_from(point, node, place)
        return None if isinstance(there, str) else (there[0], float(before @ there[0].rate(there[1].tangent)))

    ends = float(before @ point.rate(node.tangent)), after
    for width, cusp, rate in enclose(rate_at, step, ends, ROUNDS, kept=0.5):
        if abs(rate) < FLAT or width < ENCLOSED * step:
            return [with_no_side(cusp)], ""
    return None


def with_no_side(point: Point) -> Point:
    """The same where the side of two more equilibria changes."""
    return replace(point, more=np.zeros(2))  # type: ignore[type-var]


def border_point(point: Point, node: Node) -> Point | None:
    """The point on the border that a line meets next from its own node; the last two coordinates of its w are z."""
    rate = node.tangent[-2:]
    ways = border_distances(point.z, rate, np.zeros(2), np.ones(2))
    for k in np.argsort(ways):
        across = np.eye(node.w.size)[node.w.size - 2 + k]
        w = correct_point(point, node.w + ways[k] * node.tangent, across, node.jacobian) if ways[k] < 1 else LEFT
        if isinstance(w, str) or np.abs(w[-2:] - 0.5).max() > 0.5 + CLOSE:
            continue
        w[node.w.size - 2 + k] = float(rate[k] > 0)
        at = node_at(point, w, node.tangent)
        there = None if isinstance(at, str) else point.after(at)
        return None if there is None else there[0]
    return None


def _passes(first: SpecialPoint, second: SpecialPoint, here: SpecialPoint, there: SpecialPoint) -> bool:
    """Whether the step from here to there passes the first point in the sense in which the line left it."""
    if not first.mark.size == second.mark.size == here.mark.size == there.mark.size:
        return False
    begin, beyond, a, b = (np.append(one.z, one.mark) for one in (first, second, here, there))
    chord, way = b - a, beyond - begin
    share = float((begin - a) @ chord / (chord @ chord))
    if not 0 <= share <= 1 or chord @ way < SENSE * np.linalg.norm(chord) * np.linalg.norm(way):
        return False
    return bool(np.linalg.norm(a + share * chord - begin) < ASIDE * np.linalg.norm(chord))


def _is_beyond(z: Array) -> bool:
    return bool((np.abs(z - 0.5) > 0.5).any())
