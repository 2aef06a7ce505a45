"""Equilibria of a rod without weight over a plane of two numbers z: their branches along a line, and their folds."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

from ..branches.branch_events import Bounds, Place
from ..branches.branch_following import branch_through
from ..branches.deflation import are_same
from ..branches.family import family_of
from ..equilibrium.orbit_rates import NUMBERS
from ..equilibrium.system import state_of
from ..levels.line_point import Path
from ..mechanics.potential import load_size
from ..numerics.arclength import CLOSED, END, FOLD
from ..numerics.arrays import Array
from ..problem.reduced import EndsProblem
from .fold_search import curve_through
from .lattice_branches import Meeting, Stage
from .orbit_folds import fold_near, given_on, mark_of
from .parameter_plane import ParameterPlane
from .whole_curve import WholeCurve, point_alone

MOST = 1000  # points of a branch in each sense


@dataclass(frozen=True, eq=False)
class PlaneOrbit:
    """An equilibrium, as a problem under dead loads and its path; hinged: whether an end moment is given."""

    problem: EndsProblem
    path: Path
    hinged: bool

    @cached_property
    def numbers(self) -> Array:
        """The `NUMBERS` but the level, (10,)."""
        return state_of(self.problem, self.path, self.hinged).rates.values[0, :-1]

    @property
    def slope(self) -> float:
        """beta_t(0)."""
        return float(self.numbers[NUMBERS.index("dbeta0")])

    @cached_property
    def signature(self) -> Array:
        """As of `orbit_folds.mark_of`."""
        return mark_of(self.numbers, float(load_size(self.problem)[0]), float(self.problem.span[0]))


@dataclass(frozen=True, eq=False)
class OrbitsOnPlane:
    """Equilibria over a plane, a `lattice_branches.PlaneSystem`."""

    plane: ParameterPlane

    def signature(self, orbit: PlaneOrbit) -> Array:
        return orbit.signature

    def are_same(self, one: PlaneOrbit, other: PlaneOrbit) -> bool:
        return are_same(one.numbers, other.numbers)

    def branch(
        self, z: Array, axis: int, orbit: PlaneOrbit, wanted: Array
    ) -> tuple[list[Stage[PlaneOrbit]], bool] | None:
        low, high = self.plane.low[axis], self.plane.high[axis]
        share_of = {float(low + (high - low) * x): float(x) for x in (*wanted, z[axis])}
        first = float(low + (high - low) * z[axis])
        bounds = Bounds(min(share_of), max(share_of), tuple(share_of), MOST)
        family = family_of(self.plane.unchecked_case_at(z), self.plane.names[axis], orbit.problem, bounds)
        found = branch_through(family, orbit.path, first, bounds)
        if isinstance(found, str):
            return None
        places, _, *stops = found

        def stage(place: Place) -> Stage[PlaneOrbit]:
            x = share_of.get(place.p, (place.p - low) / (high - low))
            index = -1 if place.index is None else place.index
            return Stage(float(x), PlaneOrbit(place.problem, place.path, family.hinged), index, place.kind)

        return [stage(place) for place in places], all(stop.reason in (END, CLOSED) for stop in stops)

    def splits(self, z: Array, axis: int, stage: Stage[PlaneOrbit]) -> list[tuple[float, PlaneOrbit]]:
        """None: branches of mirror images, which meet where the rod is at rest at both ends, are not entered."""
        return []

    def curves(
        self, meeting: Meeting[PlaneOrbit], is_known: Callable[[Array, PlaneOrbit], bool]
    ) -> list[WholeCurve] | None:
        fold = meeting.stages[1]
        return [self.fold_of(meeting.z, meeting.axis, fold.equilibrium)] if fold.kind == FOLD else None

    def fold_of(self, z: Array, axis: int, orbit: PlaneOrbit) -> WholeCurve:
        """The curve of the fold at z of a branch along number `axis`; the point alone where it has no equation."""
        fold = fold_near(given_on(self.plane), z, axis, orbit.numbers)
        return point_alone(FOLD, z, orbit.slope, orbit.signature) if fold is None else curve_through(FOLD, fold)
