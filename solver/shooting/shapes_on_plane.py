"""Shapes of a rod whose loads vary along it, over a plane of two numbers z: their branches, and their curves."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ..branches.branch_events import Bounds
from ..folds.lattice_branches import Meeting, Stage, place_on
from ..folds.special_line import CROSSING, SpecialLine
from ..folds.whole_curve import WholeCurve, whole_curve
from ..numerics.arclength import CLOSED, END, FOLD, PITCHFORK
from ..numerics.arrays import Array
from .curve import Curve
from .descent import weakest_modes
from .fold_line import RodAt, fold_through
from .following import MOST_POINTS, shapes_through
from .further_shapes import angles_of
from .newton import Shape, is_same
from .pitchfork_line import PitchforkPoint, pitchfork_at, pitchfork_line

NARROW = 0.01  # of a step: how closely a branch point is enclosed, before its curve is solved for
SPLIT = 0.05  # of the angles, in their scales: how far from a branch those that cross it are entered


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
        shape = stage.equilibrium
        points = self.line(z, axis).split_off(shape, weakest_modes(shape)[0], (SPLIT, -SPLIT), stage.x)
        return [(point.x, point.shape) for point in points if 0 < point.x < 1]

    def curves(self, meeting: Meeting[Shape], is_known: Callable[[Array, Shape], bool]) -> list[WholeCurve] | None:
        shape = meeting.stages[1].equilibrium
        if meeting.stages[1].kind == FOLD:
            return [fold_through(self.rod_at, meeting.z, meeting.axis, [stage.equilibrium for stage in meeting.stages])]
        first = pitchfork_at(self.rod_at, meeting.z, meeting.axis, shape)
        if first is None:
            return None
        # where the sides differ, branches exchange their indices, and no number changes
        return [] if np.isnan(first.more).any() else pitchforks_of(first, is_known)


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
