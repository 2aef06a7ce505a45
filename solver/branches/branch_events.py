"""What is met on a branch over one parameter p, in whatever system it is followed.

These are the values at which an equilibrium is wanted, special points, the end of the range, and the way back to the
first equilibrium.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, Protocol, TypeVar

from ..numerics.arclength import CLOSED, END, FOLD, Stride


@dataclass(frozen=True)
class Bounds:
    """The range of the parameter, the values at which an equilibrium is wanted, and the largest number of points."""

    low: float
    high: float
    wanted: tuple[float, ...]
    most: int

    def inside(self, p: float, q: float) -> list[float]:
        """The values at which to halt strictly between two, from p to q."""
        low, high = min(p, q) + self.round_off, max(p, q) - self.round_off
        every = sorted(v for v in {*self.wanted, self.low, self.high} if low < v < high)
        return every if p < q else every[::-1]

    def snap(self, p: float) -> float:
        """The value at which to halt that is p but for rounding, else p."""
        return next((v for v in (*self.wanted, self.low, self.high) if abs(v - p) <= self.round_off), p)

    @property
    def round_off(self) -> float:
        """Below which two parameters are one."""
        return 4e-15 * max(abs(self.low), abs(self.high))

    @property
    def limit(self) -> str:
        """Why there are no more than the largest number of points."""
        return f"the limit of {self.most} points"

    def is_end(self, p: float, rises: float) -> bool:
        """Whether p is at an end of the range and moves out of it."""
        return p >= self.high - self.round_off if rises > 0 else p <= self.low + self.round_off

    def next(self, p: float, rises: bool) -> float:
        """The next value beyond p at which to halt: a wanted one or the end of the range."""
        gap = self.round_off
        if rises:
            return min((v for v in (*self.wanted, self.high) if v > p + gap), default=self.high)
        return max((v for v in (*self.wanted, self.low) if v < p - gap), default=self.low)


@dataclass(frozen=True)
class Place:
    """An equilibrium of a branch.

    p: the parameter. path: an `orbits.boundary.Path`, of its orbit; with weight or friction its
    `nodes.varying_shapes.Shape`. problem: which the orbit solves under dead loads, an `EndsProblem`; None with
    weight or friction. index: Morse index, None where it is not known. kind: of special point.
    """

    p: float
    path: Any
    problem: Any
    index: int | None
    kind: str = ""


@dataclass(frozen=True)
class Stop:
    """Why and at which parameter a branch stops. helix: the parameter and the beta at which the helix ceases to exist
    that the rod lies along; None where that is not why."""

    reason: str
    p: float
    helix: tuple[float, float] | None = None


class Point(Protocol):
    """A point of a branch."""

    @property
    def p(self) -> float:
        """The parameter."""
        ...

    @property
    def rises(self) -> float:
        """dp along the branch."""
        ...

    def record(self, kind: str = "") -> Place:
        """Its equilibrium."""
        ...


Here = TypeVar("Here", bound=Point)


def events_between(
    before: Here,
    after: Here,
    special: Sequence[tuple[Here, str]],
    bounds: Bounds,
    place_at: Callable[[Here, Here, float], Place | None],
) -> list[Place] | None:
    """The places on the way from one point to the next, in order, and that one itself; None where one is not located.

    special: the special points between the two, with their kinds. A pitchfork or branch point that p passes without
    turning back changes the index, or it is none. place_at: the place at a wanted value, between two.
    """
    places = []
    special = [(point, kind) for point, kind in special if kind == FOLD or _turns_or_changes(before, after)]
    for (place_before, _), (other, kind) in pairwise([(before, ""), *special, (after, "")]):
        for value in bounds.inside(place_before.p, other.p):
            place = place_at(place_before, other, value)
            if place is None:
                return None
            places.append(replace(place, p=value))  # located to a rounding that is wider than that of halts
        places.append(other.record(kind))
    return places


def _turns_or_changes(before: Point, after: Point) -> bool:
    """Whether p turns back between two points, or their Morse indices differ, as far as they are known."""
    if before.rises * after.rises <= 0:
        return True
    indices = before.record().index, after.record().index
    return None in indices or indices[0] != indices[1]


def arrive(
    places: list[Place],
    passed: list[Place],
    before: Here,
    after: Here,
    step: float,
    bounds: Bounds,
    ends: Callable[[Place], str],
) -> Stride[Place, Here]:
    """The stride from one point to the next: the places before it, and those passed on it until the branch ends.

    ends: why the branch ends at a place, as where it is back where it began; else nothing.
    """
    p = before.p
    for place in passed:
        place = replace(place, p=bounds.snap(place.p))
        rises = place.p - p if abs(place.p - p) > bounds.round_off else after.rises
        places, p = [*places, place], place.p
        if why := ends(place):
            return Stride(places, after, step, why)
        if bounds.is_end(p, rises):
            return Stride(places, after, step, END)
    return Stride(places, after, step)


def both_ways(
    middle: Place, bounds: Bounds, side: Callable[[bool], tuple[list[Place], Stop]]
) -> tuple[list[Place], int, Stop, Stop]:
    """The places of a branch, that of a first one among them, and why there are no more at either end.

    side: the places after the first one where p rises, or falls, and why there are no more. Nothing is followed beyond
    a border, or again where the branch is closed. If places lie on the falling side alone, they come last: the branch
    begins at the first one.
    """
    sides: list[tuple[list[Place], Stop]] = []
    for rises, border in ((False, bounds.low), (True, bounds.high)):
        if sides and sides[0][1].reason == CLOSED:
            sides.append(([], sides[0][1]))
        else:
            sides.append(([], Stop(END, middle.p)) if middle.p == border else side(rises))
    if sides[0][0] and not sides[1][0]:
        sides.reverse()
    (before, begin), (after, end) = sides
    return [*before[::-1], middle, *after], len(before), begin, end
