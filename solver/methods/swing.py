"""`swing`: half a swing by Taylor's method, compiled; the rest by symmetry. Optional (the extra `fast`: numba).

What `orbit` does by quadrature and for every extreme, this does by marching, for orbits that do not rest next to a
saddle: there a march loses the digits that say where the orbit goes, and `swing` says so instead. Its error is
measured, not hoped: the covariance of what its steps leave out and round off is carried along with them.
"""

from dataclasses import dataclass
from functools import cached_property
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..course import LIBRATION, ROTATION
from ..landscape import slope, slope_rate
from ..reduced import Array, Reduced
from .base import Method, Trajectory, verdicts

INSTALLED = find_spec("numba") is not None
MISSING = "method 'swing' needs the package numba, which is not installed: pip install 'rod-workbench[fast]'"
_STEPS = 28  # of an orbit, to begin with
_BLOCK = 256  # orbits marched and read while their series are in the cache
_LOST = "failed: it rests too near a saddle, or too long, for a march to keep its digits; method 'orbit' does not march"


@dataclass(frozen=True, eq=False)
class Swing:
    """The orbits of B problems, ready to be read anywhere along the rod; those that were lost read as NaN.

    kind: (B,), LIBRATION or ROTATION; lost: (B,). told: (B, 2, FACTS), what is known of the legs forward and backward.
    error, condition: (B,). evaluations: (B,), how many derivatives of the equation were taken.
    """

    problem: Reduced
    tol: float
    kind: NDArray[np.int64]
    lost: NDArray[np.bool_]
    told: Array
    error: Array
    condition: Array
    evaluations: NDArray[np.int64]

    @property
    def ahead(self) -> Array:
        """Time from the start to the turning point ahead, or once round, (B,)."""
        return self.told[:, 0, 0]

    @property
    def back(self) -> Array:
        """Time to the turning point behind; 0 where the orbit goes round, (B,)."""
        return self.told[:, 1, 0]

    @cached_property
    def period(self) -> Array:
        """Of beta_t, (B,)."""
        return np.where(self.kind == LIBRATION, 2.0, 1.0) * (self.ahead + self.back)

    @cached_property
    def direction(self) -> Array:
        """Sign of beta_t just after the start, (B,)."""
        assert self.problem.dbeta0 is not None
        v = self.problem.dbeta0
        return np.sign(np.where(v == 0, -slope(self.problem, self.problem.beta0), v))

    def at(self, t: Array) -> tuple[Array, Array, Array, Array]:
        """beta, beta_t, alpha, z at t (B, n), each (B, n)."""
        return _read(self, self._steps, t)

    def swirl(self, t: Array) -> Array:
        """The integral of sin(beta) cos(beta) from the start, (B, n)."""
        from ..kernels import swirl

        out = np.empty(t.shape)
        swirl(np.ascontiguousarray(t), self.lost, self.kind == LIBRATION, self.told, *self._steps, out)
        return out

    @cached_property
    def _steps(self) -> tuple[Array, ...]:
        """The series of all steps, marched again: reading the stations once does not need them kept."""
        return _march(self.problem, self.tol)[1]


def _march(problem: Reduced, tol: float) -> tuple[Swing, tuple[Array, ...]]:
    """The orbits, and their steps: first and count (B, 2) of each leg, since, width (P,) and series (P, 4, n)."""
    from ..kernels import FACTS, LOST, ORDER, TURNS, march

    assert problem.dbeta0 is not None
    B, v0 = problem.size, problem.dbeta0
    numbers = np.stack([problem.lam, problem.mu, problem.phi, problem.span, problem.beta0, v0], axis=1)
    with np.errstate(over="ignore", invalid="ignore"):
        natural = np.sqrt(np.abs(slope_rate(problem, problem.beta0)))
        # what is late once is late again each period
        quickest = np.sqrt(np.abs(problem.lam) + 2 * np.abs(problem.mu) + np.abs(problem.phi) + 2)
        goals = np.maximum(0.002 * tol / np.maximum(1, problem.span * quickest / 6), 1e-17)
    weights = np.maximum(np.maximum(1, np.abs(v0)), natural)
    count, status = np.zeros((B, 2), dtype=np.int64), np.zeros((B, 2), dtype=np.int64)
    told, judged = np.zeros((B, 2, FACTS)), np.full((B, 2), np.inf)
    stored: list[tuple[Array, Array, Array]] = []
    done = 0
    while done < B:
        room = _STEPS * (B - done) + 120
        since, width, series = np.empty(room), np.empty(room), np.empty((room, 4, ORDER + 1))
        done, used = march(numbers, goals, weights, done, since, width, series, count, status, told, judged)
        stored.append((since[:used], width[:used], series[:used]))
    since, width, series = (np.concatenate(v) if len(stored) > 1 else v[0] for v in zip(*stored, strict=True))
    first = np.cumsum(count.reshape(-1)).reshape(B, 2) - count
    kind, lost = np.where(status[:, 0] == TURNS, LIBRATION, ROTATION), status[:, 0] == LOST
    calls = count.sum(axis=1) * ORDER
    return Swing(problem, tol, kind, lost, told, *judged.T, calls), (first, count, since, width, series)


def _read(swing: Swing, steps: tuple[Array, ...], t: Array) -> Array:
    """beta, beta_t, alpha, z at t (B, n), (4, B, n)."""
    from ..kernels import read

    out = np.empty((4, *t.shape))
    read(np.ascontiguousarray(t), swing.lost, swing.kind == LIBRATION, swing.direction, swing.told, *steps, out)
    return out


def run(problem: Reduced, t: Array, tol: float, **_: Any) -> Trajectory:
    """All problems, a block at a time; those that a march would lose are refused by their outcome."""
    blocks = [slice(k, k + _BLOCK) for k in range(0, problem.size, _BLOCK)]
    whole = np.empty((4, *t.shape))
    done = []
    for block in blocks:
        swing, steps = _march(problem.take(block), tol)
        whole[:, block] = _read(swing, steps, t[block])
        done.append(swing)
    names = ("kind", "lost", "told", "error", "condition", "evaluations")
    all_of_them = Swing(problem, tol, *(np.concatenate([getattr(one, name) for one in done]) for name in names))
    beta, dbeta, alpha, z = whole
    error, condition = all_of_them.error, all_of_them.condition
    outcome = verdicts(beta, error, condition, tol)
    outcome[all_of_them.lost] = _LOST
    calls = all_of_them.evaluations
    return Trajectory(
        beta, dbeta, alpha, z, lambda: all_of_them.swirl(t), outcome, error, condition, calls, all_of_them
    )


SWING = Method(
    "swing", run, ("start",), float("inf"), "Taylor series over half a period, compiled; the rest by symmetry"
)
