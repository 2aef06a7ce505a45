"""The growth of a change of the start where H' hardly changes along the rod: the specification of the core's."""

import numpy as np

from solver.mechanics.potential import slope, slope_higher_rates, slope_rate
from solver.numerics.arrays import Array, Booleans
from solver.problem.reduced import StartProblem


def beside_helix(problem: StartProblem) -> tuple[Booleans, Array]:
    """Whether H' hardly changes along each rod, (B,), and the condition number of all as if it did not, (B,).

    H' hardly changes where the rod stays near one helix or is short. The condition number is then bounded about a
    centre, linear in the length where H' = 0, and exponential about a saddle. How far beta strays follows from
    H'(beta(0)) as if that were constant; the change of H' over this range, times the time in which it has an effect
    (the whole length, or where the rod is long, one radian), has to be small.
    """
    beta, span = problem.beta0, problem.span
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        rate, (second, _) = slope_rate(problem, beta), slope_higher_rates(problem, beta)
        even, odd = _largest_solutions(rate, span)
        strays = np.abs(problem.dbeta0) * odd
        strays = strays + 2 * np.abs(slope(problem, beta)) * _largest_solutions(rate, span / 2)[1] ** 2
        third = np.abs(problem.lam) + 8 * np.abs(problem.mu) + np.abs(problem.phi) + 20  # a bound
        change = np.abs(second) * strays + third * strays**2 / 2
        steady = change * span * np.fmin(span, 1 / np.sqrt(np.abs(rate))) < 0.1
        return np.asarray(steady), np.maximum(1, np.maximum(even, odd * slope_weight(problem)))


def slope_weight(problem: StartProblem) -> Array:
    """w = max(1, |beta_t(0)|, sqrt|H'(beta(0))|), (B,): the factor of a change of beta_t(0).

    With it a change of beta_t counts as the change of angle that it becomes a quarter of a period later, so the
    condition number does not depend on where in its period an orbit starts.
    """
    natural = np.sqrt(np.abs(slope_rate(problem, problem.beta0)))
    return np.maximum(np.maximum(1, np.abs(problem.dbeta0)), natural)


def _largest_solutions(rate: Array, span: Array) -> tuple[Array, Array]:
    """The largest values on [0, span] of the two solutions of eta'' = -rate eta that begin as 1 and as t, (B,) each."""
    root = np.sqrt(np.abs(rate))
    angle = np.minimum(root * span, 700)
    bounded = np.where(angle < np.pi / 2, np.sin(angle), 1.0)
    odd = np.where(rate > 0, bounded, np.sinh(angle)) / root
    return np.where(rate >= 0, 1.0, np.cosh(angle)), np.where(root * span > 1e-150, odd, span)
