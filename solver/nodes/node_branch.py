"""Curves of equilibria of a rod that depends on one number p, and the way along them through folds.

A point is found by Newton's method with p unknown and one more condition. The unknowns are the states at the nodes, in
fixed scales, and p over its size. The nodes keep their shares of the span.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from ..branches.branch_events import Bounds, Place, Stop, arrive, both_ways, events_between
from ..core.tuning import NUDGE
from ..numerics.arclength import BRANCH_POINT, CLOSED, COSINE, FOLD, OFF, PITCHFORK, Lengths, Stride, trace
from ..numerics.arrays import ALIKE, NEGLIGIBLE, ROUGHLY, Array
from ..numerics.roots import DIVERGED, enclose, locate, newton
from .banded_newton import (
    ENDING,
    correct,
    gaps_after,
    is_same,
    linear_at,
    open_at,
    share_within,
    size_of,
    with_known_loads,
)
from .descent import is_near
from .loaded_rod import ALPHA, BETA, LoadedRod
from .shape_index import index_of_any
from .varying_shapes import Shape
from .weak_modes import Held, hold, weakest_modes

# of the angles, in their scales: how far from a branch those that split off it are entered. x10: Newton's method leads
# elsewhere, or back
SPLIT = 0.05
UNSOLVED = "Newton's method did not converge from it"
LOST = "Newton's method did not converge on the way"
# of steps, in the sizes of the angles and of p. x10: steps land on other branches
LENGTHS = Lengths(first=0.02, longest=0.1, least=1e-5)
# in the sizes of the angles and of p: how far beside a point of a curve its bend, or an index, is read. x10: that of
# another part, beyond a neighbouring fold
BESIDE = 0.02
LOOSE = 1e-4  # of the scales: a correction that is enough on the way. x10: another branch may be as near
# of dp along the curve next to a fold: its square is lost of p. x10: the place of a fold has a digit less
FLAT = 1e-7
# of a step: how closely a branch point is enclosed, before it is solved for. x10: Newton's method begins farther off
NARROW = 0.01


@dataclass(frozen=True, eq=False)
class CurvePoint:
    """A point of a curve, a `branches.branch_events.Point`. tangent: (8 N + 1,), of length 1 by `inner`."""

    shape: Shape
    p: float
    tangent: Array

    @property
    def rises(self) -> float:
        """dp along the curve."""
        return float(self.tangent[-1])

    @cached_property
    def index(self) -> int:
        """The Morse index, by `index_of_any`."""
        return index_of_any(self.shape)

    def record(self, kind: str = "") -> Place:
        """Its equilibrium, without an index where it has friction."""
        return Place(self.p, self.shape, None, None if self.shape.rod.has_friction else self.index, kind)


def inner(u: Array, v: Array) -> float:
    """The product of two directions (8 N + 1,): the mean over the nodes of that of the angles, and that of p."""
    a, b = (w[:-1].reshape(-1, 8)[:, [BETA, ALPHA]] for w in (u, v))
    return float((a * b).sum() / len(a) + u[-1] * v[-1])


def unit(direction: Array) -> Array:
    """A direction with length 1 by `inner`."""
    return np.asarray(direction / np.sqrt(inner(direction, direction)))


@dataclass(frozen=True, eq=False)
class NodeCurve:
    """rod_at: the rod at each p. size: the size of p. scale: (8,), that of the states.

    natural: of steps where p must rise, and all that is wanted is the equilibrium at its last value: points on the way
    are rough, and the branch ends where their index would rise. None where p may fall.
    """

    rod_at: Callable[[float], LoadedRod]
    size: float
    scale: Array
    natural: Lengths | None = None

    def shape(self, like: Shape, y: Array, p: float) -> Shape:
        """The rod at p with the states y, on the nodes of another shape."""
        rod = self.rod_at(p).in_scales(self.scale)
        return Shape(rod, like.t * (rod.span / like.t[-1]), y)

    def in_sizes(self, change: Array, p: float) -> Array:
        """A change (N, 8) of the states and of p in their sizes, (8 N + 1,)."""
        return np.append((change / self.scale).reshape(-1), p / self.size)

    def split_off(self, shape: Shape, mode: Array, sizes: Sequence[float], p: float) -> Iterator[CurvePoint]:
        """The equilibria near p that differ from a shape by so much of a mode (N, 8): p is what follows."""
        across = unit(self.in_sizes(mode, 0.0))
        points = (self.correct(replace(shape, y=shape.y + size * mode), p, across) for size in sizes)
        return (point for point in points if point is not None)

    def rate(self, shape: Shape, p: float) -> Array:
        """The derivative of what is open by p over its size, (8 N,)."""
        h = NUDGE * self.size
        sides = [self.shape(shape, shape.y, p + sign * h) for sign in (1, -1)]
        (numbers, span), (others, length) = ((side.rod.numbers, side.rod.span) for side in sides)
        alone = span == length and (numbers == others).all()  # only the ends answer p: the stretches are not marched
        above, below = (gaps_after(side, side.y[1:]) if alone else open_at(side) for side in sides)
        return np.asarray((above - below) / (2 * NUDGE))

    def correct(self, guess: Shape, p: float, across: Array, most: int = 12) -> CurvePoint | None:
        """The point of the curve in the plane through a guess with the normal `across` (8 N + 1,); None without one."""

        def step(now: CurvePoint) -> tuple[CurvePoint, float] | str:
            shape = now.shape
            linear = linear_at(shape)
            right = np.stack([linear.open, self.rate(shape, now.p)], axis=1)
            columns = linear.solve(right, soft=True)
            if columns is None:
                return DIVERGED
            whole, by_x = np.append(columns[:, 0], 0.0), np.append(-columns[:, 1], 1.0)
            passed = self.in_sizes(shape.y - guess.y, now.p - p)
            along = inner(across, by_x)
            if not along:
                return DIVERGED
            whole = whole - by_x * (inner(across, whole - passed) / along)
            change = whole[:-1].reshape(shape.y.shape)
            share = share_within(change)
            at = now.p - share * whole[-1] * self.size
            ahead = self.shape(guess, shape.y - share * change * self.scale, at)
            size = max(size_of(change), abs(whole[-1]))
            return CurvePoint(replace(ahead, steps=shape.steps + 1), float(at), by_x), size

        corrected = newton(CurvePoint(self.shape(guess, guess.y, p), p, across), step, replace(ENDING, rounds=most))
        if isinstance(corrected, str):
            return None
        solved, tangent = with_known_loads(corrected.shape), unit(corrected.tangent)
        return CurvePoint(solved, corrected.p, tangent if inner(tangent, across) >= 0 else -tangent)

    def begin(self, shape: Shape, p: float) -> CurvePoint | None:
        """The equilibrium at p near a shape; None where Newton's method reaches none."""
        level = np.zeros(shape.y.size + 1)
        level[-1] = 1
        return self.correct(shape, p, level)

    def ahead(self, before: CurvePoint, step: float) -> CurvePoint | None:
        """The point after a step; None where the step is too long."""
        shape, change = before.shape, step * before.tangent
        guess = replace(shape, y=shape.y + change[:-1].reshape(shape.y.shape) * self.scale)
        p = before.p + change[-1] * self.size
        if self.natural:
            return self.rough_point(before, guess, p)
        point = self.correct(guess, p, before.tangent, most=8)
        if point is None or inner(point.tangent, before.tangent) < COSINE:
            return None
        off = self.in_sizes(point.shape.y - guess.y, point.p - p)
        return None if inner(off, off) > (OFF * step) ** 2 else point

    def rough_point(self, before: CurvePoint, guess: Shape, p: float) -> CurvePoint | None:
        """The point near a guess at p, in the direction from the one before, with dp = 1; None where it may be on
        another branch."""
        shape = correct(replace(guess, rod=self.rod_at(p)), most=10, enough=LOOSE)
        if shape is None or not is_near(before.shape, shape):
            return None
        change = self.in_sizes(shape.y - before.shape.y, p - before.p)
        point = CurvePoint(shape, p, change / change[-1])
        return None if point.index > before.index else point

    def between(self, before: CurvePoint, after: CurvePoint, p: float) -> Place | None:
        """The equilibrium at p between two neighbours."""
        share = (p - before.p) / (after.p - before.p)
        point = self.begin(replace(before.shape, y=before.shape.y + share * (after.shape.y - before.shape.y)), p)
        return None if point is None else point.record()


def special_between(
    curve: NodeCurve, before: CurvePoint, after: CurvePoint, step: float
) -> list[tuple[CurvePoint, str]] | None:
    """The special point within a step after which the index or the sense of p differs, and its kind; None where it is
    not enclosed.

    A change of branch has no place at which the points on both sides meet, so it is not enclosed.
    """
    way, ends = partial(curve.ahead, before), {0.0: before, step: after}
    if before.rises * after.rises < 0:
        flat = FLAT * max(abs(before.rises), abs(after.rises))  # these are small where p has a far wider range
        turn = locate(way, ends, lambda point: point.rises, flat)
        is_fold = before.index != after.index or after.shape.rod.has_friction
        return None if turn is None else [(turn, FOLD if is_fold else PITCHFORK)]
    if before.index == after.index:
        return []
    (near, low), (far, high) = enclose(way, ends, lambda point: point.index != before.index, NARROW * step)
    change = curve.in_sizes(high.shape.y - low.shape.y, high.p - low.p)
    if far - near > 2 * NARROW * step or inner(change, change) > (2 * (far - near) + ALIKE) ** 2:
        return None
    return [(branch_point_between(curve, low, high) or high, BRANCH_POINT)]


def branch_point_between(curve: NodeCurve, low: CurvePoint, high: CurvePoint) -> CurvePoint | None:
    """The point between two close ones at which the rod gives way along a mode that the symmetry of the branch keeps it
    from; None where no symmetry does."""
    mode, apart = weakest_modes(low.shape)[0], high.shape.y - low.shape.y

    def at(share: float) -> tuple[float, Held] | None:
        p = low.p + share * (high.p - low.p)
        held = hold(curve.shape(low.shape, low.shape.y + share * apart, p), mode)
        return None if held is None else (p, held)

    first, last = at(0.0), at(1.0)
    if first is None or last is None:
        return None
    crossing = locate(at, {0.0: first, 1.0: last}, lambda place: place[1].stiffness)
    if crossing is None:
        return None
    p, held = crossing
    flat = FLAT * abs(last[1].stiffness - first[1].stiffness)  # its sign changes where it is infinite, too
    is_one = abs(held.stiffness) < flat and abs(held.force) < NEGLIGIBLE
    return CurvePoint(held.shape, p, low.tangent) if is_one else None


def trace_shapes(
    curve: NodeCurve,
    first: CurvePoint,
    rises: bool,
    bounds: Bounds,
    lengths: Lengths = LENGTHS,
    to_fold: bool = False,
) -> tuple[list[Place], Stop]:
    """The equilibria after the first one where p rises, or falls, from it, and why there are no more.

    lengths: of the steps of a curve that is not natural.
    to_fold: whether the branch ends at a fold.
    """
    sense = (1.0 if rises else -1.0) * np.sign(first.rises or 1.0)

    def ends(place: Place) -> str:
        if to_fold and place.kind == FOLD:
            return FOLD
        return CLOSED if place.p == bounds.snap(first.p) and is_same(place.path, first.shape) else ""

    def stride(before: CurvePoint, step: float, _: list[Place]) -> Stride[Place, CurvePoint] | str:
        step = min(step, (bounds.high - before.p) / curve.size) if curve.natural else step
        after = curve.ahead(before, step)
        if after is None or (abs(after.index - before.index) > 1 and step > ROUGHLY):  # several branch points
            return LOST
        special = [] if curve.natural else special_between(curve, before, after, step)
        if special is None:
            return LOST
        places = events_between(before, after, special, bounds, curve.between)
        if places is None:
            return LOST
        longer = step * (1.6 if after.shape.steps <= 4 else 1.0)
        return arrive([], places, before, after, longer, bounds, ends)

    begun = replace(first, tangent=sense * first.tangent)
    places, why = trace(begun, stride, curve.natural or lengths, bounds.most)
    return places, Stop(why or bounds.limit, places[-1].p if places else first.p)


def shapes_through(
    curve: NodeCurve, shape: Shape, p: float, bounds: Bounds
) -> tuple[list[Place], int, Stop, Stop] | str:
    """The equilibria of the branch of a shape at p, the place of its own, and why there are no more at either end; or
    why it cannot be followed."""
    first = curve.begin(shape, p)
    if first is None:
        return UNSOLVED
    middle = replace(first.record(), p=p)
    return both_ways(middle, bounds, lambda rises: trace_shapes(curve, first, rises, bounds))
