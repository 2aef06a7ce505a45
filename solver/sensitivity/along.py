"""The derivatives along the rod, in the units of the case."""

from dataclasses import fields

import numpy as np

from ..mechanics.potential import Loads, slope
from ..numerics.arrays import Array
from ..problem.field_rates import FieldRates
from ..problem.reduced import flat
from ..shape import Shape
from .motions import Motion


def of_rows(rates: FieldRates, rows: Array) -> FieldRates:
    """The rates of some of the cases."""
    names = (one.name for one in fields(rates) if one.name not in ("fields", "given"))
    given = None if rates.given is None else rates.given[rows]
    return FieldRates(rates.fields, **{name: getattr(rates, name)[rows] for name in names}, given=given)


def amounts(motion: Motion, rates: FieldRates) -> Array:
    """How far a unit of each field moves the cases in the five directions of a motion, (b, 5, F)."""
    if motion.parts is None or rates.given is None:
        return np.stack([rates.beta0, rates.end, rates.lam, rates.mu, rates.phi], axis=1)
    return np.matmul(motion.parts, np.concatenate([rates.given, rates.span[:, None]], axis=1))


def along(sol: Shape, motion: Motion, unit: Array, rates: FieldRates) -> dict[str, Array]:
    """The derivatives of beta, dbeta, alpha, z and gamma at the stations, (b, F, n) each.

    unit: (b, 5, F), of `amounts`. rates: of these cases.
    """
    rows, change, t = motion.rows, motion.along, sol.t[motion.rows]
    problem = motion.problem
    beta, v, z = (getattr(sol.trajectory, name)[rows][:, None, :] for name in ("beta", "dbeta", "z"))
    later = rates.span[:, :, None] * (t / problem.span[:, None])[:, None, :]  # the change of t at a constant s/L
    case = sol.case
    ratio, rho = (flat(value, case.shape)[rows, None, None] for value in (case.rod.stiffness_ratio, case.rho))
    d_mu, d_ratio, d_rho, alpha0, gamma0 = (
        getattr(rates, name)[:, :, None] for name in ("mu", "ratio", "rho", "alpha", "gamma")
    )

    def by(values: Array) -> Array:
        return np.matmul(values, unit).swapaxes(1, 2)

    s, c = np.sin(beta), np.cos(beta)
    force = slope(Loads.columns(problem), beta[:, 0])[:, None, :]
    alpha, minus_swirl, height = (by(change.integrals[..., k]) for k in range(3))
    mu = problem.mu[:, None, None]
    twist = (d_mu * ratio + mu * d_ratio) * t[:, None, :] + mu * ratio * later
    return {
        "beta": by(change.beta) + v * later,
        "dbeta": (by(change.rate) - force * later - v / rho * d_rho) / rho,
        "alpha": alpha0 + alpha + s * later,
        "z": rho * (height + c * later) + z * d_rho,
        "gamma": gamma0 + twist + minus_swirl - s * c * later,
    }
