"""What the marches of equal steps share: the search for the step by doubling, and the error found on the way."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..numerics.arrays import Array
from ..orbit.growth import growth, refined
from ..problem.reduced import Reduced
from ..problem.trajectory import Trajectory, verdicts

March = Callable[[Reduced, Array, int], Array]  # so many steps between stations -> (5, B, n), the rows of a Trajectory


@dataclass(frozen=True)
class Scheme:
    """A march of equal steps: its order, its calls of the equation a step, and how many steps in all it may take."""

    march: March
    order: int
    calls: int
    most: int


def marched(
    scheme: Scheme, problem: Reduced, t: Array, tol: float, steps: int | None, extrapolate: bool = False
) -> Trajectory:
    """All problems at once, with `steps` equal steps between neighbouring stations.

    Without `steps` the number is doubled, for those problems whose last two answers do not yet agree to `tol`, until
    the scheme's budget is spent. With it the answer is of that many steps, and what is marched beyond it measures its
    error. extrapolate: take Richardson's combination of each two neighbours, eq. (47), which is two orders better
    where the error has even powers only.
    """
    base = t if not t[:, 0].any() else np.concatenate([np.zeros((problem.size, 1)), t], axis=1)
    intervals, power = base.shape[1] - 1, 2.0 ** (scheme.order + 2 * extrapolate)
    answer, off = np.empty((2, 5, *base.shape))  # of all problems, each as it was when it was done
    condition, work, left = np.ones(problem.size), np.zeros(problem.size, dtype=np.int64), np.arange(problem.size)
    n, marches, answers = steps or 1, list[Array](), list[Array]()
    while left.size:
        some = problem.take(left)
        grid, k = refined(some, base[left], n)
        dense = scheme.march(some, grid, n // k)
        marches.append(dense[:, :, ::k])
        work[left] += scheme.calls * intervals * n
        if not extrapolate:
            answers.append(marches[-1])
        elif len(marches) > 1:
            answers.append(_extrapolated(scheme.order, *marches[-2:]))
        if len(answers) > 1:
            off[:, left] = np.abs(answers[-1] - answers[-2]) * power / (power - 1)
            answer[:, left] = answers[-1 if steps is None else 0]
            pending = _error(base, off)[left] > tol
            if steps is not None or 2 * n * intervals > scheme.most:
                pending[:] = False
            condition[left[~pending]] = growth(some.take(~pending), grid[~pending], *dense[:2, ~pending])
            marches, answers, left = [marches[-1][:, pending]], [answers[-1][:, pending]], left[pending]
        n *= 2
    skipped = base.shape[1] - t.shape[1]
    return _trajectory(tol, answer[:, :, skipped:], _error(base, off), condition, work)


def _extrapolated(order: int, coarse: Array, fine: Array) -> Array:
    """Eq. (47)."""
    power = 2.0**order
    return (power * fine - coarse) / (power - 1)


def _error(t: Array, off: Array) -> Array:
    """Error measure of a difference of two answers, (B,): beta, and alpha and z over max(1, t)."""
    reach = np.maximum(1, t[:, -1:])
    return np.nan_to_num(np.max(np.maximum(off[0], np.maximum(off[2], off[3]) / reach), axis=1), nan=np.inf)


def _trajectory(tol: float, answer: Array, error: Array, condition: Array, work: Array) -> Trajectory:
    beta, dbeta, alpha, z, swirl = answer
    error = error + 2e-16 * np.sqrt(work) * condition
    outcome = verdicts(beta, error, condition, tol)
    return Trajectory(beta, dbeta, alpha, z, lambda: swirl, outcome, error, condition, work)
