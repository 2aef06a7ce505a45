"""The answer to dimensionless problems, and the outcome of each: solved, or why not."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..numerics.arrays import Array
from .reduced import Reduced

SOLVED = "solved"
PLAIN = (0.0, 0.0, 0.0, 1.0, 0.5, 0.0)  # lam, mu, phi, span, beta(0), beta_t(0)
_SHAPELESS = 0.1  # rad: an error with which the shape is another, whatever the condition number excuses


@dataclass(frozen=True, eq=False)
class Trajectory:
    """The answer to B problems at n stations, in units of rho.

    beta, dbeta (d/dt), alpha (from 0), z (from 0): (B, n). swirl: returns the integral of sin(beta) cos(beta), (B, n),
    when it is asked for. outcome: (B,) sentences, "solved" or why not. error, condition, evaluations: (B,).
    orbit: the periodic structure behind the answer where the method knows it (see `methods.orbit`), else None.
    selection: (B,) how each was taken from its equilibria (`selection.Selection`), None where by a seed; or None.
    """

    beta: Array
    dbeta: Array
    alpha: Array
    z: Array
    swirl: Callable[[], Array]
    outcome: NDArray[np.object_]
    error: Array
    condition: Array
    evaluations: NDArray[np.int64]
    orbit: Any = None
    selection: NDArray[np.object_] | None = None


@dataclass(frozen=True, eq=False)
class Seed:
    """Near which of many solutions to look: slope, beta_t(0), (B,); beta at shares u of the rod, (B, n).

    problem: the ends problems that the seeds solve, where each seed is a solution; orbit: theirs, row (B,) of it for
    each seed, where their method knows it.
    """

    slope: Array
    u: Array
    beta: Array
    problem: Reduced | None = None
    orbit: Any = None
    row: Any = None

    def take(self, i: int) -> "Seed":
        one = slice(i, i + 1)
        known = self.slope[one], self.u[one], self.beta[one]
        return Seed(*known) if self.problem is None else Seed(*known, self.problem.take(one), self.orbit, self.row[one])

    def on(self, problem: Reduced, nodes: int) -> Array:
        """The one shape on equal steps, (nodes,), bent to meet the ends asked for."""
        assert problem.betaL is not None
        u = np.linspace(0, 1, nodes)
        beta = np.interp(u, self.u[0], self.beta[0])
        first, last = problem.beta0[0] - beta[0], problem.betaL[0] - beta[-1]
        return beta + first + (last - first) * u


def verdicts(beta: Array, error: Array, condition: Array, tol: float) -> NDArray[np.object_]:
    """The outcome of each problem, (B,): whether its error meets tol * max(1, condition), and leaves a shape at all."""
    outcome = np.full(error.shape, SOLVED, dtype=object)
    finite = np.isfinite(beta).all(axis=-1) & np.isfinite(error)
    kept = error <= tol * np.maximum(1, condition)
    for i in np.flatnonzero(~finite):
        outcome[i] = "failed: the computation left the finite numbers"
    for i in np.flatnonzero(finite & ~kept):
        outcome[i] = f"failed: error {error[i]:.1e} above the tolerance {tol:.1e} at condition {condition[i]:.1e}"
    for i in np.flatnonzero(finite & kept & (error > tol)):
        if error[i] > _SHAPELESS:
            outcome[i] = f"failed: condition {condition[i]:.1e} leaves no digit: error {error[i]:.1e}"
        else:
            outcome[i] = f"solved; condition {condition[i]:.1e} costs digits: error {error[i]:.1e}"
    return outcome


def stood_in(problem: Reduced, fit: NDArray[np.bool_]) -> Reduced:
    """The problems, a plain rod in place of each that is not `fit` (B,), so that its neighbours are solved as ever."""
    if fit.all():
        return problem
    plain = (*PLAIN, PLAIN[4])  # and beta(L)
    pairs = zip(vars(problem).items(), plain, strict=True)
    return Reduced(**{name: np.where(fit, v, x) for (name, v), x in pairs if v is not None})


def blanked(told: Trajectory, fit: NDArray[np.bool_], why: str) -> Trajectory:
    """The answer without what was told of the rods that stood in place of others; `why` is their outcome."""
    if fit.all():
        return told
    shown = fit[:, None]
    beta, dbeta, alpha, z = (np.where(shown, v, np.nan) for v in (told.beta, told.dbeta, told.alpha, told.z))
    return replace(
        told,
        **{"beta": beta, "dbeta": dbeta, "alpha": alpha, "z": z},
        swirl=lambda: np.where(shown, told.swirl(), np.nan),
        outcome=np.where(fit, told.outcome, why),
        error=np.where(fit, told.error, np.inf),
        condition=np.where(fit, told.condition, np.inf),
        evaluations=np.where(fit, told.evaluations, 0),
    )
