"""Shapes of a rod whose loads vary along it, over a plane of two numbers z: their branches, and their curves."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ..branches.branch_events import Bounds
from ..folds.fold_line import fold_through
from ..folds.lattice_branches import Meeting, Stage, place_on
from ..folds.special_line import CROSSING, SpecialLine
from ..folds.whole_curve import WholeCurve, whole_curve
from ..numerics.arclength import CLOSED, END, FOLD, PITCHFORK
from ..numerics.arrays import Array
from ..problem.errors import InputError
from .curve import Curve, Point
from .descent import index_of_any, weakest_modes
from .following import MOST_POINTS, shapes_through
from .further_shapes import angles_of
from .loaded_rod import SPEED, LoadedRod
from .newton import Shape, is_same
from .pitchfork_line import PitchforkPoint, pitchfork_at, pitchfork_line

NARROW = 0.01  # of a step: how closely a branch point is enclosed, before its curve is solved for
SPLIT = 0.05  # of the angles, in their scales: how far from a branch those that cross it are entered
RodAt = Callable[[Array], LoadedRod]


@dataclass(frozen=True, eq=False)
class ShapeOnLine:
    """A shape on a line of z, a `folds.fold_line.LineEquilibrium`; point: on the curve over n."""

    rod_at: RodAt
    point: Point

    @property
    def offset(self) -> float:
        return self.point.x

    @property
    def rate(self) -> float:
        return float(self.point.tangent[-1])

    @property
    def index(self) -> int:
        return index_of_any(self.point.shape)

    @property
    def slope(self) -> float:
        return slope_of(self.point.shape)

    @property
    def mark(self) -> Array:
        return angles_of(self.point.shape)

    def beside(self, begin: Array, across: Array, a: float) -> "ShapeOnLine | None":
        """As of `LineEquilibrium`."""
        shape, tangent = self.point.shape, self.point.tangent
        curve = Curve(lambda n: self.rod_at(begin + n * across), 1.0, shape.rod.scale)
        change = a * tangent[:-1].reshape(shape.y.shape) * shape.rod.scale
        try:
            found = curve.correct(Shape(shape.rod, shape.t, shape.y + change), 0.0, tangent)
        except InputError:  # no case has such values
            return None
        return None if found is None else replace(self, point=found)

    def as_fold(self) -> "ShapeOnLine":
        """As of `LineEquilibrium`."""
        return replace(self, point=Point(self.point.shape, 0.0, np.append(self.point.tangent[:-1], 0.0)))


@dataclass(frozen=True, eq=False)
class ShapesOnPlane:
    """Shapes over a plane, a `folds.lattice_branches.PlaneSystem`.

    rod_at: the rod at z. scale: (8,), of all states.
    """

    rod_at: RodAt
    scale: Array

    def signature(self, shape: Shape) -> Array:
        return angles_of(shape)

    def are_same(self, one: Shape, other: Shape) -> bool:
        return is_same(one, other)

    def line(self, z: Array, axis: int) -> Curve:
        """The equilibria along number `axis` of z through a point."""
        return Curve(lambda x: self.rod_at(place_on(z, axis, x)), 1.0, self.scale)

    def branch(self, z: Array, axis: int, shape: Shape, wanted: Array) -> tuple[list[Stage[Shape]], bool] | None:
        bounds = Bounds(0.0, 1.0, tuple(wanted.tolist()), MOST_POINTS)
        found = shapes_through(self.line(z, axis), shape, float(z[axis]), bounds, NARROW)
        if isinstance(found, str):
            return None
        places, _, *stops = found
        whole = all(stop.reason in (END, CLOSED) for stop in stops)
        index = (-1 if place.index is None else place.index for place in places)
        return [Stage(one.p, one.path, k, one.kind) for one, k in zip(places, index, strict=True)], whole

    def splits(self, z: Array, axis: int, stage: Stage[Shape]) -> list[tuple[float, Shape]]:
        shape, x, curve = stage.equilibrium, stage.x, self.line(z, axis)
        mode = weakest_modes(shape)[0]
        across = curve.direction(mode, 0.0)
        found = (curve.correct(replace(shape, y=shape.y + sign * SPLIT * mode), x, across) for sign in (1, -1))
        return [(one.x, one.shape) for one in found if one is not None and 0 < one.x < 1]

    def curves(self, meeting: Meeting[Shape], is_known: Callable[[Array, Shape], bool]) -> list[WholeCurve] | None:
        shape = meeting.stages[1].equilibrium
        if meeting.stages[1].kind == FOLD:
            return [self.fold_curve(meeting.z, meeting.axis, [stage.equilibrium for stage in meeting.stages])]
        first = pitchfork_at(self.rod_at, meeting.z, meeting.axis, shape)
        if first is None:
            return None
        # where the sides differ, branches exchange their indices, and no number changes
        return [] if np.isnan(first.more).any() else pitchforks_of(first, is_known)

    def fold_curve(self, z: Array, axis: int, shapes: list[Shape]) -> WholeCurve:
        """The curve of the fold at z of a branch along number `axis`, from the shapes before, at and after it."""
        curve = Curve(lambda n: shapes[1].rod, 1.0, shapes[1].rod.scale)
        tangent = curve.direction(shapes[2].y - shapes[0].y, 0.0)
        fold = ShapeOnLine(self.rod_at, Point(shapes[1], 0.0, tangent))
        return fold_through(z, axis, fold)


def slope_of(shape: Shape) -> float:
    """beta_t(0) of a shape."""
    return float(shape.y[0, SPEED])


def pitchforks_of(first: PitchforkPoint, known: Callable[[Array, Shape], bool]) -> list[WholeCurve]:
    """The curve of a pitchfork in parts of equal index: it changes where another such curve crosses.

    known: whether a point lies on a known curve; where the shape becomes that of a known curve this one ends.
    """
    line = pitchfork_line(first, known)
    points, last = line.points, len(line.points) - 1
    cuts = [0, *(i + 1 for i, (one, other) in enumerate(pairwise(points)) if one.lower != other.lower), last]
    found = []
    for a, b in pairwise(dict.fromkeys(cuts)):
        ends = line.ends[0] if a == 0 else CROSSING, line.ends[1] if b == last else CROSSING
        found.append(whole_curve(PITCHFORK, SpecialLine(points[a : b + 1], ends), points[a].lower))
    return found
