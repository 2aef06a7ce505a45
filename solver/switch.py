"""Go from one branch to another that crosses it: at a pitchfork, as where a straight pipe buckles."""

from typing import Any

import numpy as np

from .equilibria import equilibria
from .follow import follow
from .follow_result import Branch, SpecialPoint
from .numerics.arclength import FEW_POINTS, FOLD
from .numerics.arrays import ALIKE, Array
from .problem.case_fields import with_field
from .problem.dimensionless import fields_held
from .problem.errors import InputError, check_type, choices
from .solution import Solution

# of the range of the branch: distances from the special point, tried in this order. x10: beyond where another branch
# crosses
_BESIDE = (1e-3, 1e-4, 1e-2)
_WAY = 0.1  # of the same: how far beyond the point a branch is followed that may lead through it. x10: only time
_MOST = 4  # equilibria that are tried, those with the nearest shape. x10: only time


def switch(branch: Branch, special: SpecialPoint) -> tuple[Solution, ...]:
    """The equilibria of the branch that crosses another one at a pitchfork or branch point, next to that point.

    They are found among all equilibria at a value next to the special point: those that are not on the branch itself,
    and whose own branch leads through the same point. At a pitchfork from a symmetric branch, as where a straight pipe
    buckles, they are two mirror images. `follow` goes on from each.

    Parameters
    ----------
    branch : Branch
        A branch under dead loads, without weight and friction.
    special : SpecialPoint
        One of `branch.special`, of the kind "pitchfork" or "branch point".

    Returns
    -------
    tuple of Solution
        In the order of the value of the field, and of beta'(0).

    Raises
    ------
    InputError
        For a special point of another branch, a fold, held ends, weight or friction, and where no crossing branch is
        found.

    Examples
    --------
    >>> from solver import Case, Cylinder, Ends, Rod, follow, solve, switch
    >>> pipe = Case(Rod(EI=1.0, GJ=0.8, a=0.01, L=10.0), Cylinder(R=0.99), Ends(beta0=0.0, betaL=0.0, FZ=1.0))
    >>> straight = follow(solve(pipe), FZ=-0.2)
    >>> euler = straight.special[0]
    >>> [round(float(one.dbeta[0]), 4) for one in switch(straight, euler)]
    [-0.0089, 0.0089]
    """
    _check(branch, special)
    reach = float(np.ptp(branch.values))
    for share in _BESIDE:
        solutions = [
            solution
            for side in (-1, 1)
            for solution in _equilibria_across(branch, special, special.value + side * share * reach, reach)
        ]
        if solutions:
            return tuple(solutions)
    at = f"{branch.field} = {special.value:.10g}"
    raise InputError(f"no branch that crosses at {at} was found within {max(_BESIDE):g} of the range on either side")


def _check(branch: Branch, special: SpecialPoint) -> None:
    """Raise `InputError` unless another branch crosses at the point."""
    if check_type("switch", special, SpecialPoint) not in check_type("switch", branch, Branch).special:
        raise InputError(f"switch takes one of the special points of the branch, got {special!r}")
    if special.kind == FOLD:
        raise InputError(f"no other branch crosses at the fold at {special.value:.10g}: follow passes it")
    case = branch.points[0].case
    if case.varies or branch.points[-1].case.varies:
        raise InputError("switch takes a branch without weight and friction, where all equilibria are known")
    if held := fields_held(case):
        raise InputError(f"switch takes a branch under dead loads, where all equilibria are known, got {choices(held)}")


def _equilibria_across(branch: Branch, special: SpecialPoint, value: float, reach: float) -> list[Solution]:
    """The equilibria at a value next to the special point that are on the branch that crosses there."""
    point = branch.points[special.position]
    stations = point.solution.t.shape[-1]
    try:
        every = equilibria(with_field(point.case, branch.field, value), point.solution.tol, stations)
    except InputError:  # beyond the values that the field can have
        return []
    shapes = _own_shapes(branch, special, value)
    others = [
        equilibrium.solution
        for equilibrium in every
        if all(np.abs(equilibrium.solution.beta - beta).max() > ALIKE for beta in shapes)  # rad: they are different
    ]
    others.sort(key=lambda solution: float(np.abs(solution.beta - point.solution.beta).max()))
    solutions = [other for other in others[:_MOST] if _leads_through(other, branch.field, special.value, value, reach)]
    return sorted(solutions, key=lambda solution: float(solution.dbeta[0]))


def _own_shapes(branch: Branch, special: SpecialPoint, value: float) -> list[Array]:
    """beta of the branch itself at a value next to a special point, on both sides of it."""
    shapes = []
    for position in (special.position - 1, special.position + 1):
        if not 0 <= position < len(branch):
            continue
        neighbour = branch.points[position]
        if (neighbour.value - special.value) * (value - special.value) <= 0:
            continue
        if neighbour.value == value:
            shapes.append(neighbour.solution.beta)
            continue
        field: dict[str, Any] = {branch.field: value}
        way = follow(neighbour.solution, **field)
        shapes += [point.solution.beta for point in way.points if point.value == value]
    return shapes


def _leads_through(solution: Solution, field: str, at: float, value: float, reach: float) -> bool:
    """Whether the branch of a solution at a value has a special point at another one; reach: the range of the field."""
    beyond = at + np.sign(at - value) * _WAY * reach
    try:
        last: dict[str, Any] = {field: beyond if _is_valid(solution, field, beyond) else 2 * at - value}
        way = follow(solution, points=FEW_POINTS, **last)
    except InputError:
        return False
    return any(point.kind != FOLD and abs(point.value - at) <= ALIKE * reach for point in way.special)


def _is_valid(solution: Solution, field: str, value: float) -> bool:
    try:
        with_field(solution.case, field, value)
    except InputError:
        return False
    return True
