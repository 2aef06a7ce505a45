"""The verdict on each dimensionless problem: whether it is solved, and a sentence, its outcome."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..numerics.arrays import SHAPELESS, Array

SOLVED = "solved"
FEWER = "fewer digits"  # the remark on a case whose error is above the tolerance, for a reason that follows BECAUSE
BECAUSE = ", as "
NOT_FINITE = "failed: the computation left the finite numbers"


class Verdicts(NamedTuple):
    """Whether each of B problems is solved, and its outcome."""

    solved: NDArray[np.bool_]
    outcome: NDArray[np.object_]

    def with_failures(self, why: Any) -> "Verdicts":
        """The verdicts with the failures `why`, (B,) sentences, empty for a problem that did not fail."""
        fails = np.asarray(why, dtype=object) != ""
        return Verdicts(self.solved & ~fails, np.where(fails, why, self.outcome))


def all_solved(size: int) -> Verdicts:
    """The verdicts on so many problems that are all solved."""
    return Verdicts(np.ones(size, dtype=bool), np.full(size, SOLVED, dtype=object))


def verdicts(beta: Array, error: Array, condition: Array, tol: float, rounding: Any = 0.0) -> Verdicts:
    """The verdict on each problem: it is solved if its error leaves a shape, and is small enough.

    At most it may be tol * max(1, condition), or `rounding`, (B,) or one: what is left where all numbers of the case
    are known to the digits of floats.
    """
    outcome = np.full(error.shape, SOLVED, dtype=object)
    finite = np.isfinite(beta).all(axis=-1) & np.isfinite(error)
    grown = error <= tol * np.maximum(1, condition)
    kept = grown | (error <= rounding)
    for i in np.flatnonzero(~finite):
        outcome[i] = NOT_FINITE
        if np.isfinite(beta[i]).all() and np.isinf(condition[i]):
            said = "however small a change of what is given, it may change by any amount"
            outcome[i] = f"failed: the shape is not determined: {said}"
    for i in np.flatnonzero(finite & ~kept):
        outcome[i] = f"failed: error {error[i]:.1e} above the tolerance {tol:.1e} at condition {condition[i]:.1e}"
    for i in np.flatnonzero(finite & kept & (error > tol)):
        if error[i] > SHAPELESS and grown[i]:
            outcome[i] = f"failed: condition above {decade(condition[i])} leaves no digit"
        elif error[i] > SHAPELESS:
            outcome[i] = f"failed: rounding may change the far angle by {error[i]:.1e} rad after so many bends or turns"
        else:
            why = "rounding may change the far angle by so much after so many bends or turns"
            why = f"a small change of the case grows {condition[i]:.1e} times along the rod" if grown[i] else why
            outcome[i] = fewer_digits(tol, f"{error[i]:.1e}", why)
    return Verdicts(finite & kept & (error <= max(tol, SHAPELESS)), outcome)


def fewer_digits(tol: float, error: str, why: str) -> str:
    """The outcome of a case that is solved to an error above the tolerance, and why."""
    return f"{SOLVED}; {FEWER} than the tolerance {tol:.1e} asks for: error {error}{BECAUSE}{why}"


def decade(number: float) -> str:
    """The power of ten below a positive number, as of a condition number of which rounding leaves no digit: 1e+15."""
    return f"{10.0 ** np.floor(np.log10(number)):.0e}"
