"""The search of a fit: a local search from the values of the case, then from the best of a Sobol' set."""

from collections.abc import Callable, Iterable, Mapping
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.optimize import brentq

from ..held.equilibrium_choice import NEAREST, Choose, check
from ..numerics.arrays import ALIKE, ROUGHLY, Array
from ..problem.case import Case, Ends, check_case
from ..problem.errors import LARGEST_SEED, InputError, check_tolerance, show, whole_number, yes_or_no
from ..problem.field_values import numbers_of
from .data import check_data, target_parts
from .fit_conclusion import ZERO, result
from .fit_result import Fit
from .local_search import STEP, search
from .model import FitMinimum, Model, NoValueError
from .parameters import check_parameters


def fit(
    case: Case,
    vary: "str | Iterable[str] | Mapping[str, tuple[Any, Any] | None]",
    targets: Mapping[str, float] | None = None,
    points: Mapping[str, Any] | None = None,
    *,
    sigma: Mapping[str, Any] | None = None,
    wrapped: bool = False,
    starts: int = 32,
    seed: int = 0,
    choose: Choose = NEAREST,
    tol: float = 1e-10,
    FZ0: float | None = None,
) -> Fit:
    """Values of fields of a case that fit observables and measured points, with their 95 % intervals.

    It makes the sum of ((computed - measured)/sigma)^2 least by steps of Gauss and Newton in a region of trust with the
    exact derivatives of `Solution.sensitivity`, first from the values of the case and then from Sobol' points. No step
    moves what the data do not determine: it stays near the values of the case.

    Parameters
    ----------
    case : Case
        A single case. Its values are the first guess; fields that are not varied are held.
    vary : str, iterable of str, or mapping
        Names of fields, as of `Solution.sensitivity`; or name -> (low, high), bounds in the unit of the field, or None.
        Without bounds, starts are drawn from a quarter to four times the value of ``E``, ``a``, ``L`` and ``R``, and
        elsewhere from the value plus and minus its size or the natural unit of the case, whichever is larger.
    targets : mapping, optional
        Observable -> wanted value, in its unit. ``FZ0@axial-backward`` is that of the same rod with friction that
        slides in this other way: so one coefficient is fitted to the hook loads of slack-off and pick-up together.
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
    FZ0 : float, optional
        Of an ends problem, the axial force at s = 0 [force], tension positive, that is given in place of FZ.

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
    parameters = check_parameters(check_case("fit", case), vary)
    data = check_data(case, targets, points, sigma, yes_or_no("wrapped", wrapped))
    starts, seed = whole_number("starts", starts, 0, 100_000), whole_number("seed", seed, 0, LARGEST_SEED)
    near = None if FZ0 is None else _start_force(case, [parameter.name for parameter in parameters], data.targets, FZ0)
    model = Model(case, parameters, data, check(choose), check_tolerance(tol), near)
    model.starts = starts
    origin = np.array([parameter.start for parameter in parameters])
    first = search(model, origin, lambda x: False)
    minima = [] if first is None else [first]
    others = _starts(model, starts, seed)
    idle = _idle(model, first, others)
    for start in others:
        minimum = search(
            model, np.where(idle, origin, start), lambda x: any(_close(x, minimum.x) for minimum in minima)
        )
        if minimum is not None:
            minima.append(minimum)
    moved = [minimum for minimum in minima if minimum.jacobian.any()]  # the others may be maxima
    return result(model, _distinct(moved or minima, first, origin, data.size))


def _start_force(case: Case, varied: list[str], targets: Iterable[str], FZ0: Any) -> float:
    """The force at s = 0 that is given in place of FZ. Raises `InputError`."""
    if not isinstance(case.given, Ends):
        raise InputError("FZ0 stands in place of FZ, which a start problem does not have")
    force = numbers_of("fit", "FZ0", FZ0)
    if not isinstance(force, float):
        raise InputError(f"fit takes a single FZ0, got {show(FZ0)}")
    if "FZ" in varied:
        raise InputError("FZ0 is given, and FZ follows from it: vary another field, or give FZ")
    if given := [name for name in targets if target_parts(name)[0] == "FZ0"]:
        raise InputError(f"FZ0 is given, so that it is no target: omit {given[0]}, or give FZ")
    return force


def _idle(model: Model, first: FitMinimum | None, starts: list[Array]) -> Array:
    """Which parameters change no datum, (F,): not only at the first minimum, where a symmetry may be why."""
    F = len(model.parameters)
    idle: Array = np.asarray(np.zeros(F, dtype=bool) if first is None else ~first.jacobian.any(axis=0))
    for start in starts:
        if not idle.any():
            break
        model.begin()
        try:
            idle &= ~model.jacobian(start).any(axis=0)
        except NoValueError:
            continue
    return idle


def _starts(model: Model, count: int, seed: int) -> list[Array]:
    """The points of a Sobol' set that are lower than their nearest neighbours, lowest first.

    Of one datum and one parameter also the places between neighbours where the residual changes its sign.
    """
    if not count:
        return []
    from scipy.stats import qmc  # takes half a second to import

    F = len(model.parameters)
    u = qmc.Sobol(F, rng=np.random.default_rng(seed)).random_base2(int(np.ceil(np.log2(count))))[:count]
    low, high = np.array([parameter.span for parameter in model.parameters]).T
    x = low + u * (high - low)
    residuals = np.empty((count, model.data.size))
    for i, place in enumerate(x):
        model.begin()
        residuals[i] = model.residuals(place)
    costs = (np.where(np.isfinite(residuals), residuals, np.inf) ** 2).sum(axis=1)
    order = np.argsort(costs, kind="stable")
    distances = np.linalg.norm(u[:, None] - u, axis=2)
    neighbours = np.argsort(distances, axis=1, kind="stable")[:, 1 : 2 * F + 1]
    crossings = _crossings(model, x[:, 0], residuals[:, 0]) if (F, model.data.size) == (1, 1) else []
    return crossings + [x[i] for i in order if costs[i] < np.inf and (costs[i] <= costs[neighbours[i]]).all()]


def _crossings(model: Model, x: Array, residuals: Array) -> list[Array]:
    """The zeros of the only residual between neighbours of different sign, by Brent's rule."""
    order, zeros = np.argsort(x), []
    for i, j in pairwise(order):
        if residuals[i] * residuals[j] < 0:
            model.begin()
            try:
                zeros.append(brentq(lambda v: float(model.residuals(np.array([v]))[0]), x[i], x[j], rtol=STEP))
            except ValueError:  # there is no value between them
                continue
    return [np.array([zero]) for zero in zeros]


def _distinct(minima: list[FitMinimum], first: FitMinimum | None, origin: Array, size: int) -> list[FitMinimum]:
    """The different minima, lowest first; of equal ones, that of the first search and then the nearest to its origin.

    No rounding decides: of two that are as near, as mirrored ones are, that with the larger x comes first.
    """
    costs = np.array([minimum.cost for minimum in minima])
    x = np.array([minimum.x for minimum in minima]).reshape(-1, origin.size)
    keys = [
        np.array([bool(minimum.stop) for minimum in minima]),
        _ranks(costs, lambda low: low * ALIKE + size * ZERO),
        np.array([minimum is not first for minimum in minima]),
        *(_ranks(values, lambda low: ROUGHLY) for values in (np.linalg.norm(x - origin, axis=1), *-x.T)),
    ]
    different: list[FitMinimum] = []
    for i in np.lexsort(keys[::-1]):
        if not any(_close(x[i], other.x) for other in different):
            different.append(minima[i])
    return different


def _ranks(values: Array, gap: Callable[[Array], Array | float]) -> Array:
    """The rank of each of n values, 0 for the lowest; one that is at most gap(lower) above a lower one has its rank."""
    order = np.argsort(values)
    lower, higher = values[order[:-1]], values[order[1:]]
    ranks = np.zeros(values.size, dtype=int)
    ranks[order[1:]] = np.cumsum(higher > lower + gap(lower))
    return ranks


def _close(x: Array, y: Array) -> bool:
    # two minima that are nearer, in x, are one
    return bool(np.abs(x - y).max() <= ROUGHLY * max(1.0, float(np.abs(y).max())))
