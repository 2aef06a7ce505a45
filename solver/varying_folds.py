"""The curve of a fold over two fields of a rod whose loads vary along it."""

from dataclasses import replace
from typing import Any

import numpy as np

from .branch import Branch
from .folds.fold_curves import FoldCurve
from .folds.parameter_plane import read_range, with_two
from .numerics.arclength import FOLD
from .numerics.arrays import Array
from .problem.case import Case
from .problem.case_fields import value_of
from .problem.errors import InputError, choices
from .shooting.curve import Curve, Point
from .shooting.fold_line import FoldPoint, fold_line, indices_beside
from .shooting.loaded_rod import SPEED, LoadedRod
from .shooting.numbers import rods_of

MOST = 500  # points in each sense


def trace_fold(branch: Branch, number: int = 0, **ranges: Any) -> FoldCurve:
    """The curve of a fold of a branch of a rod with weight or friction, while a second field changes too.

    Parameters
    ----------
    branch : Branch
        As of `follow`, over the first field.
    number : int
        Which of its folds, from 0.
    **ranges
        The second field with its range, such as ``weight=(0, 0.5)``, and, if wanted, the first one with its own.

    Returns
    -------
    FoldCurve
        As of `fold_curves`; its values are those of the first and of the second field. `more` is relative to the range
        of the branch and that of the second field. `lower` is 0 with friction, which has no index.

    Raises
    ------
    InputError
        For a branch without weight and friction, one without such a fold, a field that the case does not give, and a
        range that does not hold its value.

    Examples
    --------
    >>> from solver import Case, Cylinder, Ends, Rod, follow, solve, trace_fold
    >>> rod, hole = Rod(E=1.07e4, nu=0.25, a=0.25, L=3.0, weight=0.1), Cylinder(R=0.75, inclination="60deg")
    >>> branch = follow(solve(Case(rod, hole, Ends(beta0=0.5, betaL=0.8, FZ=-40.0))), FZ=[-60, -20])
    >>> trace_fold(branch, weight=(0.09, 0.11)).ends
    ('border', 'border')
    """
    special = [one for one in branch.special if one.kind == FOLD]
    case = branch.points[0].case
    if not case.varies:
        raise InputError("trace_fold takes a branch of a rod with weight or friction; fold_curves has those of others")
    if not 0 <= number < len(special):
        raise InputError(f"the branch has {len(special)} folds, got number {number!r}")
    others = [name for name in ranges if name != branch.field]
    if len(others) != 1:
        raise InputError(f"trace_fold takes one second field with its range, got {choices(others) or 'none'}")
    names, place = (branch.field, others[0]), special[number].position
    own, second = float(branch.values[place]), value_of(case, names[1])
    read = [read_range(name, ranges[name]) if name in ranges else (-np.inf, np.inf) for name in names]
    low, high = np.array(read).T
    if not low[1] <= second <= high[1]:
        raise InputError(
            f"the range of {names[1]} must hold its value {second:.10g}, got {low[1]:.10g} to {high[1]:.10g}"
        )
    sizes = np.array([np.ptp(branch.values), high[1] - low[1]])

    def case_at(z: Array) -> Case:
        return with_two(case, dict(zip(names, z * sizes, strict=True)))

    def rod_at(z: Array) -> LoadedRod:
        try:
            return rods_of(case_at(z))[1][0]
        except InputError:  # beyond the border, where differences reach: the rod is extrapolated
            border = np.clip(z, low / sizes, high / sizes)
            one, other = (rods_of(case_at(place))[1][0] for place in (border, 2 * border - z))
            numbers = {
                name: 2 * getattr(one, name) - getattr(other, name) for name in ("numbers", "span", "near", "far")
            }
            return replace(one, **numbers)

    first = _fold_point(branch, place, rod_at, np.array([own, second]) / sizes)
    bend = first.jacobian(np.zeros(2))
    first = first if bend is None else replace(first, more=float(np.sign(bend[0, 0])))
    lower = indices_beside(first)[0]
    back, ahead = (fold_line(first, sense, low / sizes, high / sizes, MOST) for sense in (-1.0, 1.0))
    points = [*back.points[::-1], first, *ahead.points]
    middle = len(back.points)
    cusps = [*(middle - 1 - i for i in back.cusps), *(middle + 1 + i for i in ahead.cusps)]
    values = np.array([point.z * sizes for point in points])
    rho = np.array([case_at(point.z).rho for point in points])
    dbeta0 = np.array([point.point.shape.y[0, SPEED] for point in points]) / rho
    more = np.array([point.more * point.across for point in points])
    exact = np.ones(len(points), dtype=bool)
    return FoldCurve(FOLD, values, exact, dbeta0, values[cusps], dbeta0[cusps], lower, more, (back.end, ahead.end))


def _fold_point(branch: Branch, place: int, rod_at: Any, z: Array) -> FoldPoint:
    """A fold of a branch with the direction of the branch there."""
    shapes = [branch.points[i].path.shape for i in (place - 1, place, place + 1)]
    curve = Curve(lambda n: shapes[1].rod, 1.0, shapes[1].rod.scale)
    tangent = curve.direction(shapes[2].y - shapes[0].y, 0.0)
    along, across = np.eye(2)[::-1]
    return FoldPoint(rod_at, z, along, across, Point(shapes[1], 0.0, tangent))
