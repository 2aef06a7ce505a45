"""Fold curves that hang together with known equilibria: of rods with weight or friction, and with held ends."""

from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import product
from typing import Any

import numpy as np

from .branches.branch_events import Bounds, Place, Stop
from .branches.branch_following import branch_through
from .branches.family import Family, scale_of
from .branches.fold_curves import FoldCurve, FoldCurves, fold_curve
from .branches.fold_lattice import curve_through
from .branches.fold_tracing import point_on_line
from .branches.linked_folds import IsKnown, Meeting, lattice_ticks, place_on, search_linked
from .branches.orbit_folds import GivenAt, guess_at, mark_of, numbers_on
from .branches.orbit_rates import NUMBERS
from .branches.parameter_plane import ParameterPlane, reflect
from .branches.path_correction import state_of
from .branches.whole_curve import WholeCurve, fold_alone
from .equilibria import default_ranges, equilibria
from .equilibria_result import Equilibrium, ranges_in_words
from .follow_result import Branch
from .nodes.banded_newton import marks_of
from .nodes.constant_loads import shape_of_solution
from .nodes.loaded_rod import VARYING, densest_nodes, rod_over
from .nodes.node_branch import SPLIT, NodeCurve, shapes_through
from .nodes.shape_folds import RodAt, fold_through, pitchforks_through
from .nodes.shape_index import index_at, on_nodes
from .nodes.varying_shapes import Shape
from .nodes.weak_modes import weakest_modes
from .numerics.arclength import FEW_POINTS, FOLD, POINTS
from .numerics.arrays import Array
from .orbits.boundary import path_of
from .orbits.potential import load_size
from .problem.case_fields import value_of
from .problem.errors import InputError, check_type, choices, whole_number
from .problem.field_values import read_range
from .solve import between_ends


def trace_fold(branch: Branch, number: int = 0, **ranges: Any) -> FoldCurve:
    """The curve of a fold of a branch, while a second field changes too.

    Parameters
    ----------
    branch : Branch
        As of `follow`, over the first field.
    number : int
        Which of its folds, from 0.
    **ranges
        The second field with its range, such as ``weight=(0, 0.5)``, and, if wanted, the first one with another range
        than that of the branch. The curve ends at their borders.

    Returns
    -------
    FoldCurve
        As of `fold_curves`; its values are those of the first and of the second field. `lower` is 0 with friction,
        which has no index.

    Raises
    ------
    InputError
        For a branch without such a fold, a field that the case does not give, and a range that does not hold its value
        or that holds values that no case has.

    Examples
    --------
    >>> from solver import Case, Cylinder, Ends, Rod, follow, solve, trace_fold
    >>> rod, hole = Rod(E=1.07e4, nu=0.25, a=0.25, L=3.0, weight=0.1), Cylinder(R=0.75, inclination="60deg")
    >>> branch = follow(solve(Case(rod, hole, Ends(beta0=0.5, betaL=0.8, FZ=-40.0))), FZ=[-60, -20])
    >>> trace_fold(branch, weight=(0.09, 0.11)).ends
    ('border', 'border')
    """
    special = [point for point in check_type("trace_fold", branch, Branch).special if point.kind == FOLD]
    case = branch.points[0].case
    if not special:
        raise InputError("the branch has no fold")
    number = whole_number("number", number, 0, len(special) - 1)
    others = [name for name in ranges if name != branch.field]
    if len(others) != 1:
        raise InputError(f"trace_fold takes one second field with its range, got {choices(others) or 'none'}")
    names, place = (branch.field, others[0]), special[number].position
    value, second = float(branch.values[place]), value_of(case, names[1])
    span = float(branch.values.min()), float(branch.values.max())
    low, high = np.array([read_range(names[0], ranges.get(names[0], span)), read_range(names[1], ranges[names[1]])]).T
    if not low[1] <= second <= high[1]:
        raise InputError(
            f"the range of {names[1]} must hold its value {second:.10g}, got {low[1]:.10g} to {high[1]:.10g}"
        )
    plane = ParameterPlane(case, names, low, high)
    plane.case_at(np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]]))  # raises `InputError`
    points = branch.points[place - 1 : place + 2]
    on_nodes = isinstance(points[1].path, Shape)
    places = [Place(at.value, at.path, None if on_nodes else at.problem, at.index, FOLD) for at in points]
    z = plane.shares(np.array([value, second]))
    curves = system_on(plane, z).curves(Meeting(z, 0, (places[0], places[1], places[2])), lambda *_: False)
    assert curves is not None  # a fold has one
    return fold_curve(plane, curves[0])


def system_on(plane: ParameterPlane, middle: Array) -> "ShapesOnPlane | OrbitsOnPlane":
    """The equilibria over a plane: shapes on nodes of rods with weight, friction or a hinge, else orbits.

    middle: the z that the scales of shapes are of.
    """
    return ShapesOnPlane(rods_over(plane), middle) if plane.on_nodes else OrbitsOnPlane(plane)


def rods_over(plane: ParameterPlane) -> RodAt:
    """The rod at shares of a plane, a little beyond its border too."""
    over = rod_over(plane.case, *plane.names)
    return partial(reflect, lambda z: over(*plane.values(z).tolist()), names=VARYING)


def search_from_middle(plane: ParameterPlane, lattice: int) -> FoldCurves:
    """The curves that branches along the lines of a lattice meet, from the equilibria found at its middle."""
    ticks, middle = lattice_ticks(lattice), lattice // 2
    z, within = ticks[[middle, middle]], {} if plane.varies else ranges_over(plane)
    system, listed = system_on(plane, z), equilibria(plane.case_at(z), stations=2, within=within)
    places = [system.place_of(equilibrium) for equilibrium in listed]
    curves = search_linked(plane, system, ticks, {(middle, middle): places})
    if not within:
        return curves
    said = f"{curves.remark}; counted are equilibria that are searched with {ranges_in_words(within)}"
    return replace(curves, remark=said, within=within)


def ranges_over(plane: ParameterPlane) -> dict[str, tuple[float, float]]:
    """The range of each reaction over which a map searches: that of all its corners and middles, for all its points."""
    every = [default_ranges(plane.case_at(np.array(z))) for z in product((0.0, 0.5, 1.0), repeat=2)]
    return {name: (min(at[name][0] for at in every), max(at[name][1] for at in every)) for name in every[0]}


@dataclass(frozen=True, eq=False)
class ShapesOnPlane:
    """Shapes of a rod on nodes, with weight, friction or a hinge, a `branches.linked_folds.PlaneSystem`.

    rod_at: the rod at z. middle: the z that the scales of all states are of.
    """

    rod_at: RodAt
    middle: Array

    @cached_property
    def scale(self) -> Array:
        """(8,), of all states."""
        return self.rod_at(self.middle).scale

    @cached_property
    def shares(self) -> Array:
        """Of the span, at which the nodes of all shapes lie: dense enough anywhere in the plane."""
        return densest_nodes(self.rod_at(np.array(z)) for z in product((0.0, 0.5, 1.0), repeat=2))

    def place_of(self, equilibrium: Equilibrium) -> Place:
        """An equilibrium at the middle."""
        sol = equilibrium.solution
        shape = shape_of_solution(self.rod_at(self.middle), sol.trajectory, between_ends(sol), sol.t[0])
        shape = on_nodes(shape, self.shares * shape.rod.span)
        shape = replace(shape, rod=shape.rod.in_scales(self.scale))
        return Place(np.nan, shape, None, index_at(shape))

    def signature(self, place: Place) -> Array:
        return marks_of(place.path)

    def line(self, z: Array, axis: int) -> NodeCurve:
        """The equilibria along number `axis` of z through a point."""
        return NodeCurve(lambda x: self.rod_at(place_on(z, axis, x)), 1.0, self.scale)

    def branch(self, z: Array, axis: int, place: Place, wanted: Array) -> tuple[list[Place], int, Stop, Stop] | str:
        bounds = Bounds(0.0, 1.0, tuple(wanted.tolist()), FEW_POINTS)
        return shapes_through(self.line(z, axis), place.path, float(z[axis]), bounds)

    def splits(self, z: Array, axis: int, place: Place) -> list[Place]:
        shape: Shape = place.path
        points = self.line(z, axis).split_off(shape, weakest_modes(shape)[0], (SPLIT, -SPLIT), place.p)
        return [point.record() for point in points if 0 < point.p < 1]

    def curves(self, meeting: Meeting, is_known: IsKnown) -> list[WholeCurve] | None:
        shapes = [place.path for place in meeting.places]
        if meeting.places[1].kind == FOLD:
            return [fold_through(self.rod_at, meeting.z, meeting.axis, shapes)]
        return pitchforks_through(self.rod_at, meeting.z, meeting.axis, shapes[1], is_known)


@dataclass(frozen=True, eq=False)
class OrbitsOnPlane:
    """Equilibria of a rod without weight, a `branches.linked_folds.PlaneSystem`."""

    plane: ParameterPlane

    @cached_property
    def numbers_at(self) -> GivenAt:
        """The given numbers at z."""
        return numbers_on(self.plane)

    def place_of(self, equilibrium: Equilibrium) -> Place:
        """An equilibrium somewhere in the plane."""
        path, problem = path_of(equilibrium.path, 0), between_ends(equilibrium.solution)
        return Place(np.nan, path, problem, equilibrium.index)

    def numbers(self, place: Place) -> Array:
        """The `NUMBERS` but the level, (10,)."""
        return state_of(place.problem, place.path).rates.values[0, :-1]

    def signature(self, place: Place) -> Array:
        """What tells this equilibrium from others nearby, by `orbit_folds.mark_of`."""
        return mark_of(self.numbers(place), float(load_size(place.problem)[0]), float(place.problem.span[0]))

    def branch(self, z: Array, axis: int, place: Place, wanted: Array) -> tuple[list[Place], int, Stop, Stop] | str:
        def numbers(x: float) -> list[float]:
            given = self.numbers_at(place_on(z, axis, x))
            return [*given.values.tolist(), given.span, given.ratio]

        x, names = float(z[axis]), self.numbers_at(z).names
        family = Family(numbers, place.problem, scale_of(numbers, names, x, 1.0), names)
        return branch_through(family, place.path, x, Bounds(0.0, 1.0, tuple(wanted.tolist()), POINTS))

    def splits(self, z: Array, axis: int, place: Place) -> list[Place]:
        """None: branches of mirror images, which meet where the rod is at rest at both ends, are not entered."""
        return []

    def curves(self, meeting: Meeting, is_known: IsKnown) -> list[WholeCurve] | None:
        fold = meeting.places[1]
        return [self.fold_of(meeting.z, meeting.axis, fold)] if fold.kind == FOLD else None

    def fold_of(self, z: Array, axis: int, place: Place) -> WholeCurve:
        """The curve of the fold at z of a branch along number `axis`; the point alone where it has no equation."""
        numbers = dict(zip(NUMBERS, self.numbers(place).tolist(), strict=False))
        fold = point_on_line(guess_at(FOLD, self.numbers_at, z, numbers), axis)
        if fold is None:
            return fold_alone(z, numbers["dbeta0"], self.signature(place))
        return curve_through(fold)
