"""Fold curves that hang together with known equilibria: of rods with weight or friction, and with held ends."""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from .equilibria import equilibria
from .equilibrium.given_numbers import is_hinged
from .equilibrium_branch import Branch
from .folds.fold_curves import FoldCurve, FoldCurves, fold_curve
from .folds.linked_search import lattice_ticks, search_linked
from .folds.orbits_on_plane import OrbitsOnPlane, PlaneOrbit
from .folds.parameter_plane import ParameterPlane, read_range, reflect
from .levels.line_point import path_of
from .numerics.arclength import FOLD
from .numerics.arrays import Array
from .problem.case_fields import value_of
from .problem.errors import InputError, choices
from .problem.reduced import given_numbers
from .shooting.descent import index_at, on_nodes
from .shooting.fold_line import RodAt, fold_through
from .shooting.loaded_rod import LoadedRod
from .shooting.numbers import rods_of
from .shooting.shapes_on_plane import ShapesOnPlane
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
        curve = fold_through(rods_over(plane), z, 0, shapes)
    else:
        curve = OrbitsOnPlane(plane).fold_of(
            z, 0, PlaneOrbit(point.problem, point.path, is_hinged(given_numbers(case)))
        )
    return fold_curve(plane, curve)


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
