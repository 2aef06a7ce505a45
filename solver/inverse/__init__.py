"""Inverse problems: the values of fields of a case that fit targets and measured points."""

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from ..choose.selection import NEAREST, Choose
from ..problem.case import Case

if TYPE_CHECKING:
    from .fit_result import Fit

STARTS = 32


def fit(
    case: Case,
    vary: "str | Iterable[str] | Mapping[str, tuple[Any, Any] | None]",
    targets: Mapping[str, float] | None = None,
    points: Mapping[str, Any] | None = None,
    *,
    sigma: Mapping[str, Any] | None = None,
    wrapped: bool = False,
    starts: int = STARTS,
    seed: int = 0,
    choose: Choose = NEAREST,
    tol: float = 1e-10,
) -> "Fit":
    """Values of fields of a case that fit observables and measured points, with their 95 % intervals.

    It makes the sum of ((computed - measured)/sigma)^2 least by `scipy.optimize.least_squares` with the exact
    derivatives of `Solution.sensitivity`, first from the values of the case and then from Sobol' points.

    Parameters
    ----------
    case : Case
        A single case. Its values are the first guess; fields that are not varied are held.
    vary : str, iterable of str, or mapping
        Names of fields, as of `Solution.sensitivity`; or name -> (low, high), bounds in the unit of the field, or None.
        Without bounds, starts are drawn from a quarter to four times the value of ``E``, ``a``, ``L`` and ``R``, and
        elsewhere from the value plus and minus its size or the natural unit of the case, whichever is larger.
    targets : mapping, optional
        Observable -> wanted value, in its unit.
    points : mapping, optional
        Measured points (n,): "alpha" [rad], "z" [length], "beta" [rad], and "s" [length] where known; z = 0 at s = 0.
        With s, each given column is compared at its arc length. Without s, the distance from the curve on the unrolled
        cylinder to each point is used, which needs alpha and z.
    sigma : mapping, optional
        Standard deviation of targets by name, and of the points as "alpha", "z" and "beta": a number, or (n,). Of all
        data or of none. Without it the residual variance is used; a target then counts by its relative error, and an
        error of 1 rad as one of rho.
    wrapped : bool
        Whether measured azimuths are known only up to whole turns. Default: alpha grows from turn to turn.
    starts : int
        Number of Sobol' points that are tried beside the values of the case; 0: none.
    seed : int
        Seed of the Sobol' points.
    choose : {"nearest", "lowest"} or int
        Of an ends problem, which equilibrium a search starts from, as of `solve`; it then stays on its branch.
    tol : float
        Tolerance of the solutions.

    Returns
    -------
    Fit
        Its `values`, `intervals`, `correlation`, `shares`, `minima`, `remarks` and `outcome`.

    Raises
    ------
    InputError
        For an unknown or repeated field, an observable that is a count or unknown, invalid bounds, sigma or points, no
        data, and a grid of cases.

    Examples
    --------
    >>> from solver import Case, Cylinder, Rod, Start, fit
    >>> rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0)
    >>> case = Case(rod, Cylinder(R=0.75), Start(beta="30deg", dbeta=0.5, F1=5.0, F3=10.0))
    >>> found = fit(case, {"F1": (1.0, 9.0)}, {"height": 9.0})
    >>> found.outcome
    'solved'
    >>> print(f"F1 = {found.values['F1']:.4f}")
    F1 = 6.0274
    """
    from .fit_search import fit_from

    return fit_from(case, vary, targets, points, sigma, wrapped, starts, seed, choose, tol)
