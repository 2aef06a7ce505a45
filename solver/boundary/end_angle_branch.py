"""The branch of one equilibrium while its end angle beta(L) changes, the loads held, up to the fold where it ends."""

from dataclasses import dataclass

import numpy as np
import scipy

from ..numerics.arrays import Array
from ..orbit.periodic_orbit import solve_orbit
from ..problem.case import Case, Ends, Start
from ..problem.errors import InputError
from ..problem.reduced import Reduced, reduce

_STEP, _STEPS, _CHUNK = 2e-3, 5000, 50  # in beta_t(0); at most 10 in all


@dataclass(frozen=True, eq=False)
class Branch:
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


def follow(case: Case, limit: float, count: int = 9, tol: float = 1e-12) -> Branch:
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
    tol : float
        Allowed error of beta(L) [rad].

    Raises
    ------
    InputError
        For an ends problem, a grid of cases, fewer than two values, or a limit below the rod's own beta(L).
    """
    if not isinstance(case.given, Start) or case.shape:
        raise InputError("follow takes one start problem at a time")
    if count < 2:
        raise InputError(f"count must be at least 2, got {count}")
    problem = reduce(case)
    assert problem.dbeta0 is not None
    first = float(problem.dbeta0[0])
    own = float(_far(problem, np.array([first]), tol)[0])
    limit += 2 * np.pi * np.round(own / (2 * np.pi))
    if limit <= own:
        raise InputError(f"the rod itself already ends at beta(L) = {own:.6g} rad, beyond the limit of {limit:.6g} rad")
    sign = float(np.sign(_rate(problem, first, tol)))
    slopes, ends = _stepped(problem, first, sign, limit, tol)
    falls = np.flatnonzero(np.diff(ends) <= 0)
    over = np.flatnonzero(ends >= limit)
    fold: tuple[float, float] | None = None
    if falls.size and (not over.size or falls[0] < over[0]):
        k = int(falls[0])
        at = scipy.optimize.brentq(lambda v: _rate(problem, v, tol), slopes[max(k - 1, 0)], slopes[k + 1], xtol=1e-13)
        fold = float(_far(problem, np.array([at]), tol)[0]), float(at)
    elif not over.size:
        raise InputError(f"beta(L) stays below the limit {limit:.6g} rad and shows no fold; choose a lower limit")
    last = fold[0] if fold and fold[0] < limit else limit
    wanted = np.linspace(own, last, count)
    top = fold[1] if fold else float(slopes[over[0]])
    found = np.array([first, *(_reach(problem, target, first, top, tol) for target in wanted[1:-1])])
    final = top if fold else _reach(problem, last, first, top, tol)
    rho = float(case.rho)
    FZ, MZ, M3 = (float(load) for load in case.loads)
    given = Ends(case.given.beta, wanted, FZ, MZ, M3, case.given.alpha, case.given.gamma)
    return Branch(
        wanted,
        np.append(found, final) / rho,
        fold[0] if fold else None,
        fold[1] / rho if fold else None,
        Case(case.rod, case.cylinder, given),
    )


def _stepped(problem: Reduced, first: float, sign: float, limit: float, tol: float) -> tuple[Array, Array]:
    """beta_t(0) in small steps and beta(L) there, until it falls or passes the limit."""
    slopes, ends = np.array([first]), _far(problem, np.array([first]), tol)
    while slopes.size <= _STEPS and ends[-1] < limit and (np.diff(ends[-_CHUNK - 1 :]) > 0).all():
        more = slopes[-1] + sign * _STEP * np.arange(1, _CHUNK + 1)
        slopes, ends = np.append(slopes, more), np.append(ends, _far(problem, more, tol))
    return slopes, ends


def _far(problem: Reduced, slopes: Array, tol: float) -> Array:
    """beta(L) of rods that start with these beta_t(0), (K,)."""
    lam, mu, phi, span, beta0 = (np.repeat(v, slopes.size) for v in _fixed(problem))
    wide = Reduced(lam, mu, phi, span, beta0, dbeta0=slopes)
    return solve_orbit(wide, tol).at(wide.span[:, None])[0][:, 0]


def _fixed(problem: Reduced) -> tuple[Array, ...]:
    return problem.lam, problem.mu, problem.phi, problem.span, problem.beta0


def _rate(problem: Reduced, slope: float, tol: float, nudge: float = 1e-4) -> float:
    """d beta(L)/d beta_t(0), by differences of order four."""
    e = _far(problem, slope + nudge * np.array([-2.0, -1.0, 1.0, 2.0]), tol)
    return float((e[0] - 8 * e[1] + 8 * e[2] - e[3]) / (12 * nudge))


def _reach(problem: Reduced, target: float, low: float, high: float, tol: float) -> float:
    """beta_t(0) that ends at `target`, between two that end below and above it."""
    return float(
        scipy.optimize.brentq(
            lambda v: float(_far(problem, np.array([v]), tol)[0]) - target, low, high, xtol=1e-14, rtol=1e-14
        )
    )
