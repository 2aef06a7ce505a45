"""`swing`: half a swing by Taylor's method, compiled; the rest by symmetry. Optional (the extra `fast`: numba).

What `orbit` does by quadrature and for every extreme, this does by marching, for orbits that do not rest next to a
saddle: there a march loses the digits that say where the orbit goes, and `swing` hands the rod to `orbit`. Its error
is measured, not hoped: the covariance of what its steps leave out and round off is carried along with them.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..orbit.conditioning import slope_weight
from ..orbit.pieces import HELIX, LIBRATION, ROTATION
from ..problem.limits import TOO_LARGE, dimensionless
from ..problem.reduced import Array, Reduced
from . import orbit
from .base import SOLVED, Method, Trajectory, blanked, stood_in, verdicts
from .orbit import Orbit, Where, located, solve_orbit

INSTALLED = find_spec("numba") is not None
MISSING = "method 'swing' needs the package numba, which is not installed: pip install 'rod-workbench[fast]'"
_STEPS = 28  # of an orbit, to begin with
_DIGITS = 100  # times the tolerance: an error beyond it is handed over, also where the condition number excuses it
_BLOCK = 128  # orbits marched and read while their series are in the cache


_Store = tuple[Array, Array, Array]


@dataclass(frozen=True, eq=False)
class Swing:
    """The orbits of B problems, ready to be read anywhere along the rod; those that a march loses are `rest`.

    kind: (B,), HELIX, LIBRATION or ROTATION. lost: (B,), which of them are in `rest`, in order. told: (B, 2, FACTS),
    what is known of the legs forward and backward. error, condition: (B,). evaluations: (B,), how many derivatives of
    the equation were taken.
    """

    problem: Reduced
    tol: float
    kind: NDArray[np.int64]
    lost: NDArray[np.bool_]
    told: Array
    error: Array
    condition: Array
    evaluations: NDArray[np.int64]
    rest: Orbit | None = None

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
        """Of beta_t, (B,); inf where nothing moves."""
        swings = np.where(self.kind == LIBRATION, 2.0, 1.0)
        return np.where(self.kind == HELIX, np.inf, swings * (self.ahead + self.back))

    def locate(self, t: Array) -> Where:
        """Where t (B, n) are on the legs."""
        return located(t, self.kind, self.ahead, self.back, self.period)

    @cached_property
    def turns(self) -> Array:
        """Turning points passed by the far end, (B,); 0 where beta does not swing."""
        return self.locate(self.problem.span[:, None]).turns[:, 0]

    @cached_property
    def exact(self) -> Orbit:
        """The same by quadrature, which the index needs: its sign hangs on digits that a march may lose."""
        return solve_orbit(self.problem, self.tol)

    def at(self, t: Array) -> tuple[Array, Array, Array, Array]:
        """beta, beta_t, alpha, z at t (B, n), each (B, n)."""
        out = np.empty((4, *t.shape))
        _read(self.lost, self.kind == LIBRATION, self.told, self._steps, t, out)
        if self.rest is not None:
            out[:, self.lost] = self.rest.at(t[self.lost])
        return out[0], out[1], out[2], out[3]

    def swirl(self, t: Array) -> Array:
        """The integral of sin(beta) cos(beta) from the start, (B, n)."""
        from ..core.kernels import swirl

        out = np.empty(t.shape)
        swirl(np.ascontiguousarray(t), self.lost, self.kind == LIBRATION, self.told, *self._steps, out)
        if self.rest is not None:
            out[self.lost] = self.rest.swirl(t[self.lost])
        return out

    def take(self, i: int) -> "Swing | Orbit":
        """The orbit of problem i alone."""
        if self.lost[i] and self.rest is not None:
            return self.rest.take(int(np.count_nonzero(self.lost[:i])))
        return self.pick(np.array([i]))

    def pick(self, rows: NDArray[np.int64]) -> "Swing":
        """The orbits of the problems `rows`, (b,) rising; marched again when they are read."""
        some = joined([self], self.problem.take(rows), rows)
        if self.rest is None or not some.lost.any():
            return some
        return replace(some, rest=self.rest.pick((np.cumsum(self.lost) - 1)[rows[some.lost]]))

    def along(self, case: NDArray[np.int64], t: Array) -> tuple[Array, Array]:
        """alpha and z at single points of the rods: at t (N,) of the problems `case` (N,), (N,) each."""
        out = np.empty((4, case.size, 1))
        first, count, *steps = self._steps
        swings, lost = (self.kind == LIBRATION)[case], self.lost[case]
        _read(lost, swings, self.told[case], (first[case], count[case], *steps), t[:, None], out)
        if self.rest is not None and lost.any():
            out[2:, lost, 0] = self.rest.along((np.cumsum(self.lost) - 1)[case[lost]], t[lost])
        return out[2, :, 0], out[3, :, 0]

    @cached_property
    def _steps(self) -> tuple[Array, ...]:
        """The series of all steps, marched again: reading the stations once does not need them kept."""
        return _march(self.problem, self.tol)[1]


def _march(problem: Reduced, tol: float, store: _Store | None = None) -> tuple[Swing, tuple[Array, ...]]:
    """The orbits, and their steps: first and count (B, 2) of each leg, since, width (P,) and series (P, 4, n).

    store: room for steps that an earlier call made and that nobody reads any more.
    """
    from ..core.kernels import FACTS, LOST, ORDER, TURNS, march

    assert problem.dbeta0 is not None
    B, v0 = problem.size, problem.dbeta0
    numbers = np.stack([problem.lam, problem.mu, problem.phi, problem.span, problem.beta0, v0], axis=1)
    with np.errstate(over="ignore", invalid="ignore"):
        # what is late once is late again each period
        quickest = np.sqrt(np.abs(problem.lam) + 2 * np.abs(problem.mu) + np.abs(problem.phi) + 2)
        goals = np.maximum(0.002 * tol / np.maximum(1, problem.span * quickest / 6), 1e-17)
    weights = slope_weight(problem)
    count, status = np.zeros((B, 2), dtype=np.int64), np.zeros((B, 2), dtype=np.int64)
    told, judged = np.zeros((B, 2, FACTS)), np.full((B, 2), np.inf)
    stored: list[_Store] = []
    done = 0
    while done < B:
        since, width, series = store if store is not None and not stored else room_for(B - done)
        done, used = march(numbers, goals, weights, done, since, width, series, count, status, told, judged)
        stored.append((since[:used], width[:used], series[:used]))
    since, width, series = (np.concatenate(v) if len(stored) > 1 else v[0] for v in zip(*stored, strict=True))
    first = np.cumsum(count.reshape(-1)).reshape(B, 2) - count
    kind, lost = np.where(status[:, 0] == TURNS, LIBRATION, ROTATION), status[:, 0] == LOST
    calls = count.sum(axis=1) * ORDER
    error, condition = judged.T
    return Swing(problem, tol, kind, lost, told, error, condition, calls), (first, count, since, width, series)


def room_for(orbits: int) -> _Store:
    """Room for the steps of so many orbits, as far as one knows before."""
    from ..core.kernels import MOST, ORDER

    room = _STEPS * orbits + 2 * MOST
    return np.empty(room), np.empty(room), np.empty((room, 4, ORDER + 1))


def _read(lost: Any, swings: Any, told: Array, steps: tuple[Array, ...], t: Array, out: Array) -> None:
    """beta, beta_t, alpha, z at t (B, n) into out (4, B, n), each of the four in one piece of memory."""
    from ..core.kernels import read

    read(np.ascontiguousarray(t), lost, swings, told, *steps, *out)


def joined(parts: list[Swing], problem: Reduced, some: Any) -> Swing:
    """Some of each of the parts, one after the other, as the orbits of `problem`."""
    names = ("kind", "lost", "told", "error", "condition", "evaluations")
    columns: dict[str, Any] = {name: np.concatenate([getattr(one, name)[some] for one in parts]) for name in names}
    return Swing(problem, parts[0].tol, **columns)


def run(problem: Reduced, t: Array, tol: float, **_: Any) -> Trajectory:
    """All problems, a block at a time; what a march would lose, or cannot do to the tolerance, `orbit` does."""
    fit = dimensionless(problem)
    problem = stood_in(problem, fit)
    t = np.where(fit[:, None], t, 0)
    whole, done, store = np.empty((4, *t.shape)), [], room_for(min(_BLOCK, problem.size))
    for block in (slice(k, k + _BLOCK) for k in range(0, problem.size, _BLOCK)):
        swing, steps = _march(problem.take(block), tol, store)
        _read(swing.lost, swing.kind == LIBRATION, swing.told, steps, t[block], whole[:, block])
        done.append(swing)
    swing = joined(done, problem, slice(None))
    outcome = verdicts(whole[0], swing.error, swing.condition, tol)
    # promised or not, digits that only a march loses are worth a quadrature
    swing.lost[:] |= np.array([not text.startswith(SOLVED) for text in outcome]) | (swing.error > _DIGITS * tol)
    swing.lost[:] |= ~np.isfinite(swing.condition)
    if swing.lost.any():
        lost = swing.lost
        told = orbit.run(problem.take(lost), t[lost], tol)
        whole[:, lost] = told.beta, told.dbeta, told.alpha, told.z
        outcome[lost] = told.outcome
        swing.error[lost], swing.condition[lost], swing.evaluations[lost] = told.error, told.condition, told.evaluations
        swing.kind[lost] = told.orbit.kind
        swing.told[lost, 0, 0], swing.told[lost, 1, 0] = told.orbit.ahead, told.orbit.back
        swing = replace(swing, rest=told.orbit)
    found = swing
    beta, dbeta, alpha, z = whole
    told = Trajectory(
        beta, dbeta, alpha, z, lambda: found.swirl(t), outcome, found.error, found.condition, found.evaluations, found
    )
    return blanked(told, fit, TOO_LARGE)


SWING = Method(
    "swing", run, ("start",), float("inf"), "Taylor series over half a period, compiled; the rest by symmetry"
)
