"""Half a period of the orbit by Taylor's method, compiled; the rest by symmetry."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..numerics.arrays import Array
from ..problem.reduced import Reduced
from .conditioning import slope_weight
from .periodic_orbit import Orbit, solve_orbit
from .phase import Phase, located
from .pieces import HELIX, LIBRATION, ROTATION

_STEPS = 28  # of an orbit, to begin with

_Store = tuple[Array, Array, Array]


@dataclass(frozen=True, eq=False)
class MarchedOrbit:
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

    def locate(self, t: Array) -> Phase:
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
        read_orbit(self.lost, self.kind == LIBRATION, self.told, self._steps, t, out)
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

    def take(self, i: int) -> "MarchedOrbit | Orbit":
        """The orbit of problem i alone."""
        if self.lost[i] and self.rest is not None:
            return self.rest.take(int(np.count_nonzero(self.lost[:i])))
        return self.pick(np.array([i]))

    def pick(self, rows: NDArray[np.int64]) -> "MarchedOrbit":
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
        read_orbit(lost, swings, self.told[case], (first[case], count[case], *steps), t[:, None], out)
        if self.rest is not None and lost.any():
            out[2:, lost, 0] = self.rest.along((np.cumsum(self.lost) - 1)[case[lost]], t[lost])
        return out[2, :, 0], out[3, :, 0]

    @cached_property
    def _steps(self) -> tuple[Array, ...]:
        """The series of all steps, marched again: reading the stations once does not need them kept."""
        return march_orbit(self.problem, self.tol)[1]


def march_orbit(problem: Reduced, tol: float, store: _Store | None = None) -> tuple[MarchedOrbit, tuple[Array, ...]]:
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
    return MarchedOrbit(problem, tol, kind, lost, told, error, condition, calls), (first, count, since, width, series)


def room_for(orbits: int) -> _Store:
    """Room for the steps of so many orbits, as far as one knows before."""
    from ..core.kernels import MOST, ORDER

    room = _STEPS * orbits + 2 * MOST
    return np.empty(room), np.empty(room), np.empty((room, 4, ORDER + 1))


def read_orbit(lost: Any, swings: Any, told: Array, steps: tuple[Array, ...], t: Array, out: Array) -> None:
    """beta, beta_t, alpha, z at t (B, n) into out (4, B, n), each of the four in one piece of memory."""
    from ..core.kernels import read

    read(np.ascontiguousarray(t), lost, swings, told, *steps, *out)


def joined(parts: list[MarchedOrbit], problem: Reduced, some: Any) -> MarchedOrbit:
    """Some of each of the parts, one after the other, as the orbits of `problem`."""
    names = ("kind", "lost", "told", "error", "condition", "evaluations")
    columns: dict[str, Any] = {name: np.concatenate([getattr(one, name)[some] for one in parts]) for name in names}
    return MarchedOrbit(problem, parts[0].tol, **columns)
