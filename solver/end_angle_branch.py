"""The branch of one equilibrium while its end angle beta(L) rises, the loads held, up to the fold where it ends."""

from dataclasses import dataclass

import numpy as np

from .branch import FOLD, Branch
from .follow import follow
from .numerics.arrays import Array
from .problem.case import Case, Ends, Start
from .problem.errors import InputError
from .solve import between_ends, solve


@dataclass(frozen=True, eq=False)
class EndAngleBranch:
    """Equilibria with the same beta(0) and loads.

    betaL: (count,), end angles [rad], from that of the start problem on. dbeta0: (count,), beta'(0) [rad/length].
    fold: the largest beta(L) [rad] on the branch; fold_dbeta0: beta'(0) there; None where the limit comes before the
    fold. ends: the ends problems, one case for each value.
    """

    betaL: Array
    dbeta0: Array
    fold: float | None
    fold_dbeta0: float | None
    ends: Case


def to_fold(case: Case, limit: float, count: int = 9) -> EndAngleBranch:
    """Follow the equilibrium of a start problem while beta(L) rises to a limit or to the fold.

    At the fold d beta(L)/d beta'(0) = 0: two equilibria with one end angle meet there and both end.

    Parameters
    ----------
    case : Case
        One start problem.
    limit : float
        Largest beta(L) [rad]. Whole turns are added so that it lies on the rod's own turn of beta.
    count : int
        Number of values of beta(L).

    Raises
    ------
    InputError
        For an ends problem, a grid of cases, fewer than two values, a limit below the rod's own beta(L), or a branch
        that cannot be followed.
    """
    if not isinstance(case.given, Start) or case.shape:
        raise InputError("follow takes one start problem at a time")
    if count < 2:
        raise InputError(f"count must be at least 2, got {count}")
    solution = solve(case, tol=1e-12, stations=2)
    if not solution.solved:
        raise InputError(f"the start problem is not solved: {solution.outcome}")
    own = float(between_ends(solution).betaL[0])
    limit += 2 * np.pi * np.round(own / (2 * np.pi))
    if limit <= own:
        raise InputError(f"the rod itself already ends at beta(L) = {own:.6g} rad, beyond the limit of {limit:.6g} rad")
    fold = _fold(follow(solution, betaL=limit), limit)
    wanted = np.linspace(own, fold or limit, count)
    branch = follow(solution, betaL=[*wanted[1:-1].tolist(), limit])
    top = next(one.position for one in branch.special if one.kind == FOLD) if fold else len(branch) - 1
    places = [
        next(i for i, point in enumerate(branch.points) if point.value == value) for value in wanted[:-1].tolist()
    ]
    slopes = np.array([float(branch.points[i].solution.dbeta[0]) for i in [*places, top]])
    FZ, MZ, M3 = (float(load) for load in case.loads)
    ends = Ends(case.given.beta, wanted, FZ, MZ, M3, case.given.alpha, case.given.gamma)
    return EndAngleBranch(
        wanted, slopes, fold, float(slopes[-1]) if fold else None, Case(case.rod, case.cylinder, ends)
    )


def _fold(branch: Branch, limit: float) -> float | None:
    """The first fold of a branch; None where it reaches the limit before. Raises `InputError` where it does neither."""
    fold = next((one.value for one in branch.special if one.kind == FOLD), None)
    if fold is None and branch.values[-1] != limit:
        raise InputError(f"the branch stops at beta(L) = {branch.end.value:.6g} rad: {branch.end.reason}")
    return fold
