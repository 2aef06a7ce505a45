"""Follow an equilibrium of a rod whose loads vary along it, while one number x changes, through folds."""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ..branches.branch_events import Bounds, Place, Stop, arrive, both_ways, events_between
from ..numerics.arclength import BRANCH_POINT, FOLD, PITCHFORK, Lengths, Stride, trace
from ..numerics.roots import enclose, locate
from ..problem.errors import InputError
from .curve import REACH, Curve, Point, inner
from .descent import index_of_any
from .newton import SAME, Shape, correct, is_same

UNSOLVED = "Newton's method did not converge from it"
LOST = "Newton's method did not converge on the way"
LENGTHS = Lengths(first=0.02, longest=0.1, least=1e-5)  # of steps, in the sizes of the angles and of x
MOST_POINTS = 150  # in each sense, of a branch that a search follows
SHORT = 1e-3  # step, within which several branch points are one
COSINE = 0.9  # least, of the turn of the tangent in a step
FLAT = 1e-6  # of dx along the curve at a fold: its square is lost of x
NARROW = 1e-4  # of a step: how closely a branch point is enclosed, at which the equations are singular


@dataclass(frozen=True, eq=False)
class ShapeOnBranch:
    """A point of a branch, a `branches.branch_events.Point`. index: as of `index_of_any`."""

    point: Point
    index: int

    @property
    def p(self) -> float:
        """The number x that changes."""
        return self.point.x

    @property
    def rises(self) -> float:
        """dx along the branch."""
        return float(self.point.tangent[-1])

    def record(self, kind: str = "") -> Place:
        """Its equilibrium."""
        return place_of(self.point.shape, self.p, self.index, kind)


def place_of(shape: Shape, x: float, index: int, kind: str = "") -> Place:
    """A shape as an equilibrium of a branch, without an index where it has friction."""
    return Place(x, shape, None, None if shape.rod.rubbed else index, kind)


def on_branch(point: Point) -> ShapeOnBranch:
    """A point with its index."""
    return ShapeOnBranch(point, index_of_any(point.shape))


def begin(curve: Curve, shape: Shape, x: float) -> ShapeOnBranch | None:
    """The equilibrium at x near a shape; None where Newton's method reaches none."""
    level = np.zeros(shape.y.size + 1)
    level[-1] = 1
    point = curve.correct(shape, x, level)
    return None if point is None else on_branch(point)


def ahead(curve: Curve, before: ShapeOnBranch, step: float) -> ShapeOnBranch | None:
    """The point of the curve after a step; None where the step is too long."""
    p = before.point
    change = step * p.tangent
    guess = Shape(p.shape.rod, p.shape.t, p.shape.y + change[:-1].reshape(p.shape.y.shape) * curve.scale)
    try:
        point = curve.correct(guess, p.x + change[-1] * curve.size, p.tangent, most=8)
    except InputError:  # no case has such a value
        return None
    if point is None or inner(point.tangent, p.tangent) < COSINE:
        return None
    return on_branch(point)


def place_between(curve: Curve, one: ShapeOnBranch, other: ShapeOnBranch, x: float) -> Place | None:
    """The equilibrium at x between two neighbours of a branch."""
    a, b = one.point, other.point
    share = (x - a.x) / (b.x - a.x)
    shape = correct(curve.shape(a.shape, a.shape.y + share * (b.shape.y - a.shape.y), x), reach=REACH, most=12)
    return None if shape is None else place_of(shape, x, index_of_any(shape))


def special_between(
    curve: Curve, before: ShapeOnBranch, after: ShapeOnBranch, step: float, narrow: float
) -> list[tuple[ShapeOnBranch, str]] | None:
    """The special point within a step after which the index or the sense of x differs, and its kind; None where it is
    not enclosed. narrow: of the step, how closely a branch point is enclosed.

    A change of branch has no place at which the points on both sides meet, so it is not enclosed.
    """
    way, ends = partial(ahead, curve, before), {0.0: before, step: after}
    if before.rises * after.rises < 0:
        turn = locate(way, ends, lambda point: point.rises, FLAT)
        is_fold = before.index != after.index or after.point.shape.rod.rubbed
        return None if turn is None else [(turn, FOLD if is_fold else PITCHFORK)]
    if before.index == after.index:
        return []
    (near, low), (far, high) = enclose(way, ends, lambda point: point.index != before.index, narrow * step)
    change = curve.direction_between(low.point, high.point)
    return None if inner(change, change) > (2 * (far - near) + SAME) ** 2 else [(high, BRANCH_POINT)]


def trace_shapes(
    curve: Curve, first: ShapeOnBranch, rises: bool, bounds: Bounds, narrow: float = NARROW
) -> tuple[list[Place], Stop]:
    """The equilibria after the first one where x rises, or falls, from it, and why there are no more.

    narrow: how closely a branch point is enclosed, of a step.
    """
    sense = (1.0 if rises else -1.0) * np.sign(first.rises or 1.0)

    def closes(place: Place) -> bool:
        return place.p == bounds.snap(first.p) and is_same(place.path, first.point.shape)

    def stride(before: ShapeOnBranch, step: float, _: list[Place]) -> Stride[Place, ShapeOnBranch] | str:
        after = ahead(curve, before, step)
        if after is None or (abs(after.index - before.index) > 1 and step > SHORT):  # several branch points
            return LOST
        special = special_between(curve, before, after, step, narrow)
        if special is None:
            return LOST
        places = events_between(before, after, special, bounds, lambda *between: place_between(curve, *between))
        if places is None:
            return LOST
        longer = step * (1.6 if after.point.shape.steps <= 4 else 1.0)
        return arrive([], places, before, after, longer, bounds, closes)

    begun = replace(first, point=replace(first.point, tangent=sense * first.point.tangent))
    places, why = trace(begun, stride, LENGTHS, bounds.most)
    return places, Stop(why or bounds.limit, places[-1].p if places else first.p)


def shapes_through(
    curve: Curve, shape: Shape, x: float, bounds: Bounds, narrow: float = NARROW
) -> tuple[list[Place], int, Stop, Stop] | str:
    """The equilibria of the branch of a shape at x, the place of its own, and why there are no more at either end; or
    why it cannot be followed."""
    first = begin(curve, shape, x)
    if first is None:
        return UNSOLVED
    middle = replace(first.record(), p=x)
    return both_ways(middle, bounds, lambda rises: trace_shapes(curve, first, rises, bounds, narrow))
