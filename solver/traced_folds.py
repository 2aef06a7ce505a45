"""Fold curves that hang together with known equilibria: of rods with weight or friction, and with held ends."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from .branches.branch_events import Bounds, Place, Stop
from .branches.branch_following import branch_through
from .branches.family import family_of
from .equilibria import equilibria
from .equilibrium.given_numbers import is_hinged
from .equilibrium.orbit_rates import NUMBERS
from .equilibrium.system import state_of
from .equilibrium_branch import Branch
from .folds.fold_curves import FoldCurve, FoldCurves, fold_curve
from .folds.fold_search import curve_through
from .folds.linked_search import Meeting, lattice_ticks, place_on, search_linked
from .folds.orbit_folds import fold_near, given_on, mark_of
from .folds.parameter_plane import ParameterPlane, read_range, reflect
from .folds.whole_curve import WholeCurve, point_alone
from .levels.line_point import Path, path_of
from .mechanics.potential import load_size
from .numerics.arclength import FOLD
from .numerics.arrays import Array
from .problem.case_fields import value_of
from .problem.errors import InputError, choices
from .problem.reduced import EndsProblem, given_numbers
from .shooting.curve import MOST_POINTS, Curve, angles_of, shapes_through
from .shooting.descent import index_at, on_nodes, weakest_modes
from .shooting.loaded_rod import LoadedRod
from .shooting.newton import Shape
from .shooting.numbers import rods_of
from .shooting.shape_folds import RodAt, fold_through, pitchforks_through
from .solve import between_ends

MOST = 1000  # points of a branch of orbits in each sense
NARROW = 0.01  # of a step: how closely a branch point is enclosed, before its curve is solved for
SPLIT = 0.05  # of the angles, in their scales: how far from a branch those that cross it are entered


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
        which has no index. With held ends it stops next to a separatrix, where the gap to the saddle is lost in
        rounding.

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
    special = [point for point in branch.special if point.kind == FOLD]
    case = branch.points[0].case
    if not 0 <= number < len(special):
        raise InputError(f"the branch has {len(special)} folds, got number {number!r}")
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
    z, point = plane.shares(np.array([value, second])), branch.points[place]
    if case.varies:
        shapes = [branch.points[i].path for i in (place - 1, place, place + 1)]
        return fold_curve(plane, fold_through(rods_over(plane), z, 0, shapes))
    orbit = PlaneOrbit(point.problem, point.path, is_hinged(given_numbers(case)))
    return fold_curve(plane, OrbitsOnPlane(plane).fold_of(z, 0, orbit))


def rods_over(plane: ParameterPlane) -> RodAt:
    """The rod at shares of a plane, a little beyond its border too."""

    def rod_of(z: Array) -> LoadedRod:
        return rods_of(plane.unchecked_case_at(z))[0]

    return partial(reflect, rod_of, names=("numbers", "span", "near", "far"))


def search_varying(plane: ParameterPlane, lattice: int) -> FoldCurves:
    """The curves that branches along the lines of a lattice meet, from the equilibria found at its middle."""
    rod_at, ticks, middle = rods_over(plane), lattice_ticks(lattice), lattice // 2
    z = ticks[[middle, middle]]
    rods = [rod_at(np.array([u, w])) for u in (0.0, 0.5, 1.0) for w in (0.0, 0.5, 1.0)]
    u = max((rod.nodes() / rod.span for rod in rods), key=len)
    scale = rod_at(z).scale
    shapes = [
        on_nodes(equilibrium.path.shape, u * equilibrium.path.shape.rod.span)
        for equilibrium in equilibria(plane.case_at(z))
    ]
    shapes = [replace(shape, rod=shape.rod.in_scales(scale)) for shape in shapes]
    begin = {(middle, middle): [(shape, index_at(shape)) for shape in shapes]}
    return search_linked(plane, ShapesOnPlane(rod_at, scale), ticks, begin)


def search_held(plane: ParameterPlane, lattice: int) -> FoldCurves:
    """The same of a rod without weight whose ends are held."""
    ticks, middle = lattice_ticks(lattice), lattice // 2
    listed = equilibria(plane.case_at(ticks[[middle, middle]]), stations=2)
    hinged = is_hinged(given_numbers(plane.case))
    orbits = [
        (PlaneOrbit(between_ends(equilibrium.solution), path_of(equilibrium.path, 0), hinged), equilibrium.index)
        for equilibrium in listed
    ]
    return search_linked(plane, OrbitsOnPlane(plane), ticks, {(middle, middle): orbits})


@dataclass(frozen=True, eq=False)
class ShapesOnPlane:
    """Shapes of a rod whose loads vary along it, a `folds.linked_search.PlaneSystem`.

    rod_at: the rod at z. scale: (8,), of all states.
    """

    rod_at: RodAt
    scale: Array

    def signature(self, shape: Shape) -> Array:
        return angles_of(shape)

    def line(self, z: Array, axis: int) -> Curve:
        """The equilibria along number `axis` of z through a point."""
        return Curve(lambda x: self.rod_at(place_on(z, axis, x)), 1.0, self.scale)

    def branch(self, z: Array, axis: int, shape: Shape, wanted: Array) -> tuple[list[Place], int, Stop, Stop] | str:
        bounds = Bounds(0.0, 1.0, tuple(wanted.tolist()), MOST_POINTS)
        return shapes_through(self.line(z, axis), shape, float(z[axis]), bounds, NARROW)

    def splits(self, z: Array, axis: int, place: Place) -> list[tuple[float, Shape]]:
        shape: Shape = place.path
        points = self.line(z, axis).split_off(shape, weakest_modes(shape)[0], (SPLIT, -SPLIT), place.p)
        return [(point.p, point.shape) for point in points if 0 < point.p < 1]

    def curves(self, meeting: Meeting, is_known: Callable[[Array, Shape], bool]) -> list[WholeCurve] | None:
        shapes = [place.path for place in meeting.places]
        if meeting.places[1].kind == FOLD:
            return [fold_through(self.rod_at, meeting.z, meeting.axis, shapes)]
        return pitchforks_through(self.rod_at, meeting.z, meeting.axis, shapes[1], is_known)


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

    @cached_property
    def mark(self) -> Array:
        """As of `orbit_folds.mark_of`."""
        return mark_of(self.numbers, float(load_size(self.problem)[0]), float(self.problem.span[0]))


@dataclass(frozen=True, eq=False)
class OrbitsOnPlane:
    """Equilibria of a rod without weight, a `folds.linked_search.PlaneSystem`."""

    plane: ParameterPlane

    def signature(self, orbit: PlaneOrbit) -> Array:
        return orbit.mark

    def branch(
        self, z: Array, axis: int, orbit: PlaneOrbit, wanted: Array
    ) -> tuple[list[Place], int, Stop, Stop] | str:
        low, high = self.plane.low[axis], self.plane.high[axis]
        share_of = {float(low + (high - low) * x): float(x) for x in (*wanted, z[axis])}
        first = float(low + (high - low) * z[axis])
        bounds = Bounds(min(share_of), max(share_of), tuple(share_of), MOST)
        family = family_of(self.plane.unchecked_case_at(z), self.plane.names[axis], orbit.problem, bounds)
        followed = branch_through(family, orbit.path, first, bounds)
        if isinstance(followed, str):
            return followed

        def place_of(place: Place) -> Place:
            x = share_of.get(place.p, (place.p - low) / (high - low))
            return replace(place, p=float(x), path=PlaneOrbit(place.problem, place.path, family.hinged))

        return [place_of(place) for place in followed[0]], *followed[1:]

    def splits(self, z: Array, axis: int, place: Place) -> list[tuple[float, PlaneOrbit]]:
        """None: branches of mirror images, which meet where the rod is at rest at both ends, are not entered."""
        return []

    def curves(self, meeting: Meeting, is_known: Callable[[Array, PlaneOrbit], bool]) -> list[WholeCurve] | None:
        fold = meeting.places[1]
        return [self.fold_of(meeting.z, meeting.axis, fold.path)] if fold.kind == FOLD else None

    def fold_of(self, z: Array, axis: int, orbit: PlaneOrbit) -> WholeCurve:
        """The curve of the fold at z of a branch along number `axis`; the point alone where it has no equation."""
        fold = fold_near(given_on(self.plane), z, axis, orbit.numbers)
        slope = float(orbit.numbers[NUMBERS.index("dbeta0")])
        return point_alone(FOLD, z, slope, orbit.mark) if fold is None else curve_through(FOLD, fold)
