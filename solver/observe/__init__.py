"""Observables: numbers of a whole rod, and how they are computed."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..shape import Shape


def observe(sol: "Shape", names: Iterable[str], errors: bool = False) -> dict[str, Any]:
    """Observables of a solution: one number a case.

    Parameters
    ----------
    sol : Shape
    names : iterable of str
        Names of `observables.OBSERVABLES`, for example ``["turns", "energy"]``; their units are in
        `solver.problem.quantities`.
    errors : bool
        Whether to add the estimated error of each, as ``<name>_error`` in the same unit, except for the whole numbers
        `turns`, `loops`, `overlaps` and `index`, and for the loads `FZ`, `MZ` and `M3`.

    Returns
    -------
    dict
        Name -> array (*cases), or a number for a single case; NaN for a case without a shape. An error is NaN if it
        cannot be estimated: the method does not know the orbit, and the stations do not resolve every bend or cover
        only a part of the rod.

    Raises
    ------
    InputError
        For an unknown name.

    Examples
    --------
    >>> from solver import Case, Cylinder, Rod, Start, observe, solve
    >>> rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0)
    >>> solution = solve(Case(rod, Cylinder(R=0.75), Start(beta="30deg", dbeta=0.5, F1=5.0, F3=10.0)))
    >>> seen = observe(solution, ["turns", "kappa_max"])
    >>> print(f"{seen['turns']} bends, largest curvature {seen['kappa_max']:.4f}")
    5 bends, largest curvature 2.6140
    """
    from . import observables  # only a call needs the modules behind it

    return observables.observe(sol, names, errors)
