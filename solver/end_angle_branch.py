"""The branch of the equilibrium of a start problem while one field of its ends problem changes, up to its fold."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from .equilibrium_branch import Branch
from .follow import follow
from .numerics.arclength import FOLD
from .numerics.arrays import Array
from .problem.case import Case, Start
from .problem.case_fields import value_of, with_field
from .problem.errors import InputError
from .solution import Solution
from .solve import ends_case, solve

_BEFORE = 1e-10  # of the way to the fold: at the fold the condition number is infinite, and half the digits are lost


@dataclass(frozen=True, eq=False)
class EndAngleBranch:
    """Equilibria over one field, the other fields of the ends problem held.

    field: its name, for example betaL. values: (count,), from the start problem's own to the limit, or next to the
    fold. dbeta0: (count,), beta'(0) [rad/length]. fold: the value at which the equilibrium ceases to exist;
    fold_dbeta0: beta'(0) there; None where the limit comes before the fold. ends: the ends problems, one case for each
    value.
    """

    field: str
    values: Array
    dbeta0: Array
    fold: float | None
    fold_dbeta0: float | None
    ends: Case


def own_ends(case: Case) -> Case:
    """The ends problem that the solution of a start problem solves, its loads held.

    Raises
    ------
    InputError
        For an ends problem, a grid of cases, and a start problem that is not solved.
    """
    return ends_case(_solve_start(case))


def _solve_start(case: Case) -> Solution:
    if not isinstance(case.given, Start) or case.shape:
        raise InputError("follow takes one start problem at a time")
    solution = solve(case, tol=1e-12, stations=2)
    if not solution.solved:
        raise InputError(f"the start problem is not solved: {solution.outcome}")
    return solution


def to_fold(case: Case, limit: float, count: int = 9, field: str = "betaL") -> EndAngleBranch:
    """Follow the equilibrium of a start problem while a field changes to a limit or to the fold before it.

    At the fold d field/d beta'(0) = 0: two equilibria with one value of the field meet there and both end.

    Parameters
    ----------
    case : Case
        One start problem.
    limit : float
        The last value. To an angle beta(L) whole turns are added so that it lies on the rod's own turn of beta.
    count : int
        Number of values.
    field : str
        A numeric field of the rod, the cylinder or the ends problem.

    Raises
    ------
    InputError
        For an ends problem, a grid of cases, fewer than two values, a limit of beta(L) below the rod's own, a limit
        that no case can have, or a branch that cannot be followed.
    """
    if count < 2:
        raise InputError(f"count must be at least 2, got {count}")
    solution = _solve_start(case)
    ends = ends_case(solution)
    begin = value_of(ends, field)
    if field == "betaL":
        limit += 2 * np.pi * np.round(begin / (2 * np.pi))
        if limit <= begin:
            raise InputError(
                f"the rod itself already ends at beta(L) = {begin:.6g} rad, beyond the limit of {limit:.6g} rad"
            )
    last: dict[str, Any] = {field: limit}
    fold = _fold(follow(solution, **last), limit)
    values = np.linspace(begin, limit if fold is None else fold - _BEFORE * (fold - begin), count)
    every: dict[str, Any] = {field: [*values[1:].tolist(), limit]}
    branch = follow(solution, **every)
    places = [next(i for i, point in enumerate(branch.points) if point.value == value) for value in values.tolist()]
    slopes = np.array([float(branch.points[i].solution.dbeta[0]) for i in places])
    at_fold = None
    if fold is not None:
        place = next(point.position for point in branch.special if point.kind == FOLD)
        at_fold = float(branch.points[place].solution.dbeta[0])
    return EndAngleBranch(field, values, slopes, fold, at_fold, with_field(ends, field, values))


def _fold(branch: Branch, limit: float) -> float | None:
    """The first fold of a branch; None where it reaches the limit before. Raises `InputError` where it does neither."""
    fold = next((point.value for point in branch.special if point.kind == FOLD), None)
    if fold is None and branch.values[-1] != limit:
        name = "beta(L)" if branch.field == "betaL" else branch.field
        raise InputError(f"the branch stops at {name} = {branch.end.value:.6g}: {branch.end.reason}")
    return fold
