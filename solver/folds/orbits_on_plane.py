"""Equilibria of a rod without weight over a plane of two numbers z: their branches along a line, and their folds."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from ..branches.branch_events import Bounds, Place
from ..branches.branch_following import branch_through
from ..branches.branch_states import alike, correct_state
from ..branches.equilibrium_curve import EquilibriumCurve, curve_through
from ..branches.family import Family, family_of, given_over, numbers_at
from ..equilibrium.charts import charts, coordinate
from ..equilibrium.given_numbers import Given
from ..equilibrium.orbit_rates import NUMBERS
from ..equilibrium.system import state_of
from ..levels.line_point import Path
from ..mechanics.potential import load_size
from ..numerics.arclength import CLOSED, END, FOLD, Node, correct_point, node_at
from ..numerics.arrays import Array
from ..problem.reduced import EndsProblem
from .curve_points import fold_through
from .fold_search import WholeCurve
from .lattice_branches import Meeting, Stage
from .parameter_plane import ParameterPlane, reflect

GivenAt = Callable[[Array], Given]
MOST = 1000  # points of a branch in each sense
_SAME = 1e-5  # of the numbers of two equilibria that are one
_NUDGE = 1e-4  # along a branch, between two points that give its direction in another chart


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
        """The numbers in units of which they change by about 1, (10,)."""
        loads, span = 1 + float(load_size(self.problem)[0]), 1 + float(self.problem.span[0])
        return self.numbers / np.array([1, 1, *[np.sqrt(loads)] * 2, *[span] * 3, *[loads] * 3])


@dataclass(frozen=True, eq=False)
class OrbitOnLine:
    """An equilibrium on a line of z, a `fold_line.LineEquilibrium`. node: on the curve over n."""

    given_at: GivenAt
    curve: EquilibriumCurve
    node: Node

    @property
    def offset(self) -> float:
        return float(self.node.w[1])

    @property
    def rate(self) -> float:
        return float(self.node.tangent[1])

    @property
    def orbit(self) -> PlaneOrbit:
        """The equilibrium itself."""
        at = self.curve.at(self.node.w)
        assert at is not None
        return PlaneOrbit(at[0].problem, at[1], self.curve.family.hinged)

    @property
    def index(self) -> int | None:
        return self.curve.index(self.node.w, self.orbit.path, self.node.jacobian)

    def beside(self, begin: Array, across: Array, a: float) -> "OrbitOnLine | None":
        """As of `LineEquilibrium`."""
        curve, guess = curve_on(self.curve, self.given_at, begin, across), self.node.w + a * self.node.tangent
        found = correct_point(curve, guess, self.node.tangent, self.node.jacobian)
        if isinstance(found, str) and (fresh := curve.jacobian(guess)) is not None:
            found = correct_point(curve, guess, self.node.tangent, fresh)
        node = found if isinstance(found, str) else node_at(curve, found, self.node.tangent)
        return None if isinstance(node, str) else replace(self, curve=curve, node=node)

    def as_folds(self, z: Array, across: Array) -> "Iterator[OrbitOnLine]":
        """As of `LineEquilibrium`."""
        curve = curve_on(self.curve, self.given_at, z, across)
        at, beyond = (self.curve.at(self.node.w + nudge * self.node.tangent) for nudge in (0.0, _NUDGE))
        if at is None or beyond is None:
            return
        for chart in charts(*at, curve.family.hinged):
            other = next((one for one in charts(*beyond, curve.family.hinged) if alike(one, chart)), None)
            if other is None or not np.isfinite([coordinate(chart), coordinate(other)]).all():
                continue
            there = replace(curve, chart=chart)
            w, ahead = (
                np.append([coordinate(one), 0.0], (point * self.curve.scales)[2:]) / there.scales
                for one, point in ((chart, self.node.w), (other, self.node.w + _NUDGE * self.node.tangent))
            )
            node = node_at(there, w, ahead - w)
            if not isinstance(node, str):
                tangent = node.tangent * np.append([1.0, 0.0], np.ones(w.size - 2))
                yield replace(self, curve=there, node=replace(node, tangent=tangent))


def curve_on(curve: EquilibriumCurve, given_at: GivenAt, begin: Array, across: Array) -> EquilibriumCurve:
    """The same equilibria over n on the line begin + n across."""
    given = partial(_given_on, given_at, begin, across)
    family = Family(given, curve.family.begun, 1.0, curve.family.names, partial(numbers_at, given))
    return replace(curve, family=family, _rates={})


def _given_on(given_at: GivenAt, begin: Array, across: Array, n: float) -> Given:
    return given_at(begin + n * across)


@dataclass(frozen=True, eq=False)
class OrbitsOnPlane:
    """Equilibria over a plane, a `lattice_branches.PlaneSystem`."""

    plane: ParameterPlane

    @cached_property
    def given_at(self) -> GivenAt:
        """The given numbers at z, a little beyond the border too."""
        given = given_over(self.plane.case, *self.plane.names)
        return partial(reflect, lambda z: given(*self.plane.values(z).tolist()), names=("values", "span", "ratio"))

    def signature(self, orbit: PlaneOrbit) -> Array:
        return orbit.signature

    def are_same(self, one: PlaneOrbit, other: PlaneOrbit) -> bool:
        return bool(np.abs(one.signature - other.signature).max() < _SAME)

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
        """The curve of the fold at z of a branch along number `axis`."""
        given = partial(_given_on, self.given_at, z, np.eye(2)[axis])
        here = given(0.0)
        family = Family(given, orbit.problem, 1.0, here.names, partial(numbers_at, given))
        found = curve_through(family, orbit.path, 0.0)
        assert found is not None
        state = correct_state(*found, np.eye(found[1].size)[0])
        assert not isinstance(state, str), state
        fold = OrbitOnLine(self.given_at, state.curve, state.node)
        return fold_through(z, axis, fold, lambda one: one.orbit.slope, lambda one: one.orbit.signature)
