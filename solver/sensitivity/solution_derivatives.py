"""The derivatives of a solution with respect to the fields of its case.

What is given answers directly; the loads that are found follow from the equations of the equilibrium
(`motions.Motion.parts`).
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..mechanics.potential import Loads, slope
from ..numerics.arrays import EPS, Array
from ..problem.case_fields import check_fields
from ..problem.field_rates import FieldRates, field_rates
from ..problem.reduced import EndsProblem, flat, given_numbers
from ..problem.trajectory import SHAPELESS, SOLVED
from ..shape import Shape
from .motions import Motion, motions
from .observable_rates import Moving, check_observables, derivative_of, measure_of, why_missing
from .varying_rates import STEP, varying_rates


def ends_field_rates(sol: Shape, fields: Sequence[str]) -> FieldRates:
    """The derivatives of the numbers of an ends problem by fields of its case, but those of loads that are found."""
    rates = field_rates(sol.case, fields)
    assert rates.given is not None
    turn = np.array(given_numbers(sol.case)) == "turn"  # ratio mu span less the swirl: the ratio changes it at once
    by_ratio = (sol.problem.mu * sol.problem.span)[:, None] * rates.of("ratio")
    return replace(rates, given=rates.given - turn[:, None] * by_ratio[:, None])


def amounts(motion: Motion, rates: FieldRates) -> Array:
    """How far a unit of each field moves the cases in the five directions of a motion, (b, 5, F)."""
    if rates.given is None:
        return np.matmul(motion.parts, rates.table[[4, 5, 0, 1, 2]].swapaxes(0, 1))
    return np.matmul(motion.parts, np.concatenate([rates.given, rates.of("span")[:, None]], axis=1))


def along(sol: Shape, motion: Motion, unit: Array, rates: FieldRates) -> dict[str, Array]:
    """The derivatives of beta, dbeta, alpha, z and gamma at the stations, (b, F, n) each.

    unit: (b, 5, F), of `amounts`. rates: of these cases.
    """
    rows, t, problem = motion.rows, sol.t[motion.rows], motion.problem
    change = motion.change(t, unit)
    beta, v, z = (getattr(sol.trajectory, name)[rows][:, None, :] for name in ("beta", "dbeta", "z"))
    later = rates.of("span")[:, :, None] * (t / problem.span[:, None])[:, None, :]  # the change of t at a constant s/L
    case = sol.case
    ratio, rho = (flat(value, case.shape)[rows, None, None] for value in (case.rod.stiffness_ratio, case.rho))
    d_mu, d_ratio, d_rho, alpha0, gamma0 = (
        rates.of(name)[:, :, None] for name in ("mu", "ratio", "rho", "alpha", "gamma")
    )

    s, c = np.sin(beta), np.cos(beta)
    force = slope(Loads.columns(problem), beta[:, 0])[:, None, :]
    alpha, minus_swirl, height = (change.integrals[..., k].swapaxes(1, 2) for k in range(3))
    mu = problem.mu[:, None, None]
    twist = (d_mu * ratio + mu * d_ratio) * t[:, None, :] + mu * ratio * later
    return {
        "beta": change.beta.swapaxes(1, 2) + v * later,
        "dbeta": (change.rate.swapaxes(1, 2) - force * later - v / rho * d_rho) / rho,
        "alpha": alpha0 + alpha + s * later,
        "z": rho * (height + c * later) + z * d_rho,
        "gamma": gamma0 + twist + minus_swirl - s * c * later,
    }


_ROUNDING = 32 * EPS  # of a derivative, times the condition number
_CARRIED = 4  # of the error of the shape, on which the derivatives depend through beta, H, alpha and z
_ALONG = ("beta", "dbeta", "alpha", "z", "gamma")


@dataclass(frozen=True, eq=False)
class Sensitivity:
    """The derivatives of a solution with respect to F fields of its case; `Solution.sensitivity` makes it.

    The stations keep their place s/L when a field changes. The unit of each derivative is that of the quantity over
    that of the field (`solver.problem.quantities`).

    Attributes
    ----------
    solution : Shape
        The solution.
    fields : tuple of str
        The names of the F fields.
    beta, alpha, gamma : array, (*cases, F, n)
        Derivatives of the angle, the azimuth and the rotation of the section at the stations.
    dbeta, z : array, (*cases, F, n)
        Derivatives of beta' and of the height.
    solved : bool or array, (*cases)
        Whether a case has derivatives; where not, all of them are NaN.
    outcome : str or array, (*cases)
        "solved", or "failed: " and the reason.
    error : float or array, (*cases)
        Estimated error of the derivatives along the rod, relative to the largest of each: rounding, grown, and the
        error of the solution, which its tolerance allows.
    observables : dict
        Name of an observable -> its derivatives, (*cases, F).
    remarks : dict
        Name of an observable -> (*cases), a sentence where one of its derivatives does not exist and is NaN, else "".
    """

    solution: Shape = field(repr=False)
    fields: tuple[str, ...]
    beta: Array = field(repr=False)
    dbeta: Array = field(repr=False)
    alpha: Array = field(repr=False)
    z: Array = field(repr=False)
    gamma: Array = field(repr=False)
    solved: Any
    outcome: Any
    error: Any
    observables: dict[str, Any] = field(default_factory=dict)
    remarks: dict[str, Any] = field(default_factory=dict)


def sensitivity(sol: Shape, fields: Iterable[str], observables: Iterable[str] = ()) -> Sensitivity:
    """The derivatives of a solution; see `Solution.sensitivity`."""
    names, wanted = check_fields(sol.case, fields), check_observables(observables)
    ends, growth = isinstance(sol.problem, EndsProblem), np.asarray(sol.trajectory.condition)
    with np.errstate(all="ignore"):
        error = _ROUNDING * (growth**2 if ends else growth)
    if sol.case.varies:
        known = np.where(sol.trajectory.solved, SOLVED, sol.trajectory.outcome).astype(object)
        with np.errstate(all="ignore"):
            return _judge(sol, names, *varying_rates(sol, names, _ALONG, wanted), known, error / STEP)
    rates = ends_field_rates(sol, names) if ends else field_rates(sol.case, names)
    B, n = sol.t.shape
    out = {name: np.full((B, len(names), n), np.nan) for name in _ALONG}
    outcome = np.where(sol.trajectory.solved, SOLVED, sol.trajectory.outcome).astype(object)
    read = Moving(sol, rates, (key for name in wanted for key in measure_of(name))) if wanted else None
    with np.errstate(all="ignore"):  # what leaves the finite numbers is told by the outcome
        for motion in motions(sol, outcome):
            unit = amounts(motion, rates.take(motion.rows))
            for name, moved in zip(("lam", "mu", "phi"), unit[:, 2:].swapaxes(0, 1), strict=True):
                rates.of(name)[motion.rows] = moved  # held ends find them
            own = rates.take(motion.rows)
            for name, values in along(sol, motion, unit, own).items():
                out[name][motion.rows] = values
            if read is not None:
                read.add(motion, unit, own)
        found = {name: derivative_of(name, read) for name in wanted if read is not None}
    return _judge(sol, names, out, found, outcome, error)


def _judge(
    sol: Shape, names: tuple[str, ...], out: dict[str, Array], found: dict[str, Array], outcome: Array, error: Array
) -> Sensitivity:
    """The result; a case in which no digit is left gets an outcome that says so. error: (B,), by rounding."""
    growth, held = np.asarray(sol.trajectory.condition), isinstance(sol.problem, EndsProblem)
    finite = np.logical_and.reduce([np.isfinite(value).all(axis=(1, 2)) for value in out.values()])
    begun = outcome == SOLVED
    where = "at a fold, or next to one" if held else "next to a separatrix"
    for i in np.flatnonzero(begun & ~((error < SHAPELESS) & finite)):
        outcome[i] = f"failed: {where}, condition {growth[i]:.1e} leaves no digit of the derivatives"
    solved, shape = outcome == SOLVED, sol.case.shape
    shaped = {
        name: np.where(solved[:, None, None], value, np.nan).reshape(*shape, *value.shape[1:])
        for name, value in out.items()
    }
    stated = np.where(solved, error + _CARRIED * np.asarray(sol.trajectory.error), np.inf)
    each = {"solved": solved, "outcome": outcome, "error": stated}
    table = np.array([*found.values()]).reshape(len(found), solved.size, len(names))
    missing = solved & ~np.isfinite(table).all(axis=2)
    table[:, ~solved] = np.nan
    values = {name: rows.reshape(*shape, len(names)) for name, rows in zip(found, table, strict=True)}
    remarks = {}
    for name, rows in zip(found, missing, strict=True):
        remark = np.full(solved.size, "", dtype=object)
        if rows.any():
            remark[rows] = why_missing(name, sol)
        remarks[name] = sol._each(remark)
    told = {name: sol._each(value) for name, value in each.items()}
    return Sensitivity(sol, names, **shaped, **told, observables=values, remarks=remarks)
