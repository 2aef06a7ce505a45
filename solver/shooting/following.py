"""Follow an equilibrium of a rod whose loads vary along it, while one number x changes, through folds."""

from dataclasses import dataclass, replace

import numpy as np

from ..numerics.arclength import BRANCH_POINT, CLOSED, END, FOLD, PITCHFORK, Lengths, Stride, both_senses, trace
from ..numerics.arrays import Array
from ..numerics.roots import enclose
from ..problem.errors import InputError
from .curve import Curve, Point, inner
from .descent import index_of_any
from .newton import SAME, Shape, is_same

LOST = "Newton's method did not converge on the way"
LENGTHS = Lengths(first=0.02, longest=0.1, least=1e-5)  # of steps, in the sizes of the angles and of x
SHORT = 1e-3  # step, within which several branch points are one
COSINE = 0.9  # least, of the turn of the tangent in a step
NARROW = 1e-4  # of a step: how closely a branch point is enclosed, at which the equations are singular
FLAT = 1e-6  # of dx along the curve at a fold: its square is lost of x


@dataclass(frozen=True, eq=False)
class Stage:
    """A point of a branch. index: as of `index_of_any`. kind: of special point, else ""."""

    point: Point
    index: int
    kind: str = ""

    @property
    def x(self) -> float:
        """The number that changes."""
        return self.point.x


def stage(point: Point) -> Stage:
    """A point with its index."""
    return Stage(point, index_of_any(point.shape))


def begin(curve: Curve, shape: Shape, x: float) -> Stage | None:
    """The equilibrium at x near a shape; None where Newton's method reaches none."""
    level = np.zeros(shape.y.size + 1)
    level[-1] = 1
    found = curve.correct(shape, x, level)
    return None if found is None else stage(found)


def ahead(curve: Curve, here: Stage, step: float) -> Stage | None:
    """The point of the curve after a step; None where the step is too long."""
    p = here.point
    change = step * p.tangent
    guess = Shape(p.shape.rod, p.shape.t, p.shape.y + change[:-1].reshape(p.shape.y.shape) * curve.scale)
    try:
        found = curve.correct(guess, p.x + change[-1] * curve.size, p.tangent, most=8)
    except InputError:  # no case has such a value
        return None
    if found is None or inner(found.tangent, p.tangent) < COSINE:
        return None
    return stage(found)


def at_value(curve: Curve, here: Stage, there: Stage, x: float) -> Stage | None:
    """The point at x between two neighbours of a branch."""
    a, b = here.point, there.point
    share = (x - a.x) / (b.x - a.x)
    found = begin(curve, replace(a.shape, y=a.shape.y + share * (b.shape.y - a.shape.y)), x)
    if found is None:
        return None
    tangent = found.point.tangent if inner(found.point.tangent, a.tangent) >= 0 else -found.point.tangent
    return replace(found, point=replace(found.point, x=x, tangent=tangent))


def special_between(curve: Curve, here: Stage, there: Stage, step: float, narrow: float = NARROW) -> Stage | None:
    """The special point within a step after which the index or the sense of x differs; None where it is not enclosed.

    A change of branch has no place at which the points on both sides meet, so it is not enclosed.
    """
    turned = here.point.tangent[-1] * there.point.tangent[-1] < 0
    width, before, after = step, here, there

    def sense_at(place: float) -> tuple[Stage, float] | None:
        found = ahead(curve, here, place)
        if found is None:
            return None
        return found, float(found.point.tangent[-1]) if turned else 1.0 if found.index == here.index else -1.0

    ends = (float(here.point.tangent[-1]), float(there.point.tangent[-1])) if turned else (1.0, -1.0)
    for width, found, value in enclose(sense_at, step, ends, 60, kept=0.5 if turned else 1.0):
        if turned and abs(value) < FLAT:
            return replace(found, kind=FOLD if here.index != there.index or found.point.shape.rod.rubbed else PITCHFORK)
        before, after = (found, after) if value * ends[0] > 0 else (before, found)
        if not turned and width < narrow * step:
            break
    change = curve.direction_between(before.point, after.point)
    return None if turned or inner(change, change) > (2 * width + SAME) ** 2 else replace(after, kind=BRANCH_POINT)


def stages(
    curve: Curve,
    first: Stage,
    sense: float,
    limits: tuple[float, float],
    wanted: Array,
    most: int,
    narrow: float = NARROW,
) -> tuple[list[Stage], str]:
    """The points after the first one while x leaves it in a sense, 1 or -1, and why there are no more.

    wanted: values at which there are points, those of the first and of both limits included. narrow: how closely a
    branch point is enclosed, of a step.
    """
    tangent = first.point.tangent * np.sign(first.point.tangent[-1] or 1.0) * sense

    def stride(here: Stage, step: float, _: list[Stage]) -> Stride[Stage, Stage] | str:
        there = ahead(curve, here, step)
        if there is None or (abs(there.index - here.index) > 1 and step > SHORT):  # several branch points
            return LOST
        targets = [there]
        if here.point.tangent[-1] * there.point.tangent[-1] < 0 or there.index != here.index:
            special = special_between(curve, here, there, step, narrow)
            if special is None:
                return LOST
            targets.insert(0, special)
        points: list[Stage] = []
        for target in targets:
            a, b = here.x, target.x
            inside = sorted((v for v in wanted if min(a, b) < v < max(a, b)), reverse=bool(b < a))
            for value in inside:
                met = at_value(curve, here, target, float(value))
                if met is None:
                    continue
                points.append(met)
                if value in limits:
                    return Stride(points, there, step, END)
                if value == first.x and is_same(met.point.shape, first.point.shape):
                    return Stride(points, there, step, CLOSED)
            points.append(target)
            here = target
        return Stride(points, there, step * (1.6 if there.point.shape.steps <= 4 else 1.0))

    begun = replace(first, point=replace(first.point, tangent=tangent))
    found, why = trace(begun, stride, LENGTHS, most)
    return found, why or f"the limit of {most} points"


def both_ways(
    curve: Curve, shape: Shape, x: float, low: float, high: float, wanted: Array, most: int, narrow: float = NARROW
) -> tuple[list[Stage], int, str, str] | None:
    """The points of the branch of a shape at x with the place of its own, and why it stops at its begin and end.

    None where the shape is no equilibrium.
    """
    first = begin(curve, shape, x)
    if first is None:
        return None

    def side(rises: bool) -> tuple[list[Stage], str]:
        return stages(curve, first, 1.0 if rises else -1.0, (low, high), wanted, most, narrow)

    sides = both_senses(x, low, high, side, END, lambda why: why == CLOSED)
    (before, why), (after, then) = sides
    return [*before[::-1], first, *after], len(before), why, then
