"""Periodic orbits by Taylor's method, compiled: half a period is marched, the rest follows by symmetry."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..mechanics.potential import steepest
from ..numerics.arrays import Array, Booleans, Integers
from ..problem.reduced import Reduced
from .linearised_growth import slope_weight
from .periodic_orbit import Orbit, solve_orbit
from .phase import Phase, located
from .pieces import HELIX, LIBRATION, ROTATION

if TYPE_CHECKING:
    from ..problem.trajectory import Trajectory

_STEPS = 28  # of an orbit, as a first guess of the memory needed

Memory = tuple[Array, Array, Array]  # since, width and series of steps


class Steps(NamedTuple):
    """The Taylor series of all steps of B orbits.

    first, number: (B, 2), the steps of the forward and of the backward arc. since, width: (P,), begin and length of
    each step in the time of its arc. series: (P, 4, n), powers of beta, alpha, z and the swirl.
    """

    first: Integers
    number: Integers
    since: Array
    width: Array
    series: Array

    def of(self, case: Integers) -> "Steps":
        """The same for the orbits `case`."""
        return self._replace(first=self.first[case], number=self.number[case])


@dataclass(frozen=True, eq=False)
class MarchedOrbit:
    """The orbits of B problems, ready to be read anywhere along the rod.

    kind: (B,), HELIX, LIBRATION or ROTATION. lost: (B,), where the march fails; these orbits are in `rest`, in order.
    arcs: (B, 2), records (`core.arc_march.ARC`) of the forward and the backward arc. error, condition: (B,).
    evaluations: (B,), how many derivatives of the equation were computed. rest: the lost orbits by quadrature.
    """

    problem: Reduced
    tol: float
    kind: Integers
    lost: Booleans
    arcs: Array
    error: Array
    condition: Array
    evaluations: Integers
    rest: Orbit | None = None

    @property
    def ahead(self) -> Array:
        """Time from the start to the turning point ahead, or of a whole turn of a rotation, (B,)."""
        ahead: Array = self.arcs["time"][:, 0]
        return ahead

    @property
    def back(self) -> Array:
        """Time to the turning point behind; 0 in a rotation, (B,)."""
        back: Array = self.arcs["time"][:, 1]
        return back

    @cached_property
    def period(self) -> Array:
        """Period of beta_t, (B,); inf on a helix."""
        arcs = np.where(self.kind == LIBRATION, 2.0, 1.0)
        return np.where(self.kind == HELIX, np.inf, arcs * (self.ahead + self.back))

    def locate(self, t: Array) -> Phase:
        """The phases of the times t, (B, n)."""
        return located(t, self.kind, self.ahead, self.back, self.period)

    @cached_property
    def turns(self) -> Array:
        """Turning points passed by the far end, (B,); 0 where beta does not librate."""
        return self.locate(self.problem.span[:, None]).turns[:, 0]

    @cached_property
    def exact(self) -> Orbit:
        """The same orbits by quadrature, for the Morse index: its sign depends on digits that a march may lose."""
        return solve_orbit(self.problem, self.tol)

    def at(self, t: Array) -> tuple[Array, Array, Array, Array]:
        """beta, beta_t, alpha, z at t (B, n), each (B, n)."""
        out = np.empty((4, *t.shape))
        read_orbit(self.lost, self.kind == LIBRATION, self.arcs, self._steps, t, out)
        if self.rest is not None:
            out[:, self.lost] = self.rest.at(t[self.lost])
        return out[0], out[1], out[2], out[3]

    def swirl(self, t: Array) -> Array:
        """The integral of sin(beta) cos(beta) from the start, (B, n)."""
        from ..core.orbit_reading import read_swirl

        out = np.empty(t.shape)
        read_swirl(np.ascontiguousarray(t), self.lost, self.kind == LIBRATION, self.arcs, *self._steps, out)
        if self.rest is not None:
            out[self.lost] = self.rest.swirl(t[self.lost])
        return out

    def take(self, i: int) -> "MarchedOrbit | Orbit":
        """The orbit of problem i alone."""
        if self.lost[i] and self.rest is not None:
            return self.rest.take(int(np.count_nonzero(self.lost[:i])))
        return self.pick(np.array([i]))

    def pick(self, rows: Integers) -> "MarchedOrbit":
        """The orbits of the problems `rows`, (b,) rising; marched again when they are read."""
        some = joined([self], self.problem.take(rows), rows)
        if self.rest is None or not some.lost.any():
            return some
        return replace(some, rest=self.rest.pick((np.cumsum(self.lost) - 1)[rows[some.lost]]))

    def along(self, case: Integers, t: Array) -> tuple[Array, Array]:
        """alpha and z at single points of the rods: at t (N,) of the problems `case` (N,), (N,) each."""
        out = np.empty((4, case.size, 1))
        librates, lost = (self.kind == LIBRATION)[case], self.lost[case]
        read_orbit(lost, librates, self.arcs[case], self._steps.of(case), t[:, None], out)
        if self.rest is not None and lost.any():
            out[2:, lost, 0] = self.rest.along((np.cumsum(self.lost) - 1)[case[lost]], t[lost])
        return out[2, :, 0], out[3, :, 0]

    @cached_property
    def _steps(self) -> Steps:
        """The series of all steps, marched again: an answer that is only read at its stations does not store them."""
        return march_orbit(self.problem, self.tol)[1]

    def completed(self, lost: Booleans, answer: "Trajectory") -> "MarchedOrbit":
        """The same orbits, those that are `lost` (B,) taken from an answer to them by quadrature."""
        rest: Orbit = answer.orbit
        arcs = self.arcs.copy()
        arcs["time"][lost, 0], arcs["time"][lost, 1] = rest.ahead, rest.back
        return replace(
            self,
            kind=_with(self.kind, lost, rest.kind),
            lost=lost,
            arcs=arcs,
            error=_with(self.error, lost, answer.error),
            condition=_with(self.condition, lost, answer.condition),
            evaluations=_with(self.evaluations, lost, answer.evaluations),
            rest=rest,
        )


def _with(values: Array, rows: Booleans, new: Array) -> Array:
    """A copy of the values (B,) with new ones in some rows."""
    out = values.copy()
    out[rows] = new
    return out


def march_orbit(problem: Reduced, tol: float, memory: Memory | None = None) -> tuple[MarchedOrbit, Steps]:
    """March the orbits of B start problems.

    Parameters
    ----------
    problem : Reduced
        B start problems with finite numbers.
    tol : float
        Allowed error of beta [rad].
    memory : tuple of arrays, optional
        Arrays for the steps, from `memory_for`; they may hold the steps of an earlier call that are no longer read.

    Returns
    -------
    MarchedOrbit
        The orbits; `lost` where the march fails.
    Steps
        Their series.
    """
    from ..core.arc_march import ARC, LIBRATES, LOST
    from ..core.orbit_march import ESTIMATE, march
    from ..core.taylor_step import ORDER

    assert problem.dbeta0 is not None
    B, v0 = problem.size, problem.dbeta0
    numbers = np.stack([problem.lam, problem.mu, problem.phi, problem.span, problem.beta0, v0], axis=1)
    with np.errstate(over="ignore", invalid="ignore"):
        # an error of the time repeats each period
        quickest = np.sqrt(steepest(problem))
        goals = np.maximum(0.002 * tol / np.maximum(1, problem.span * quickest / 6), 1e-17)
    weights = slope_weight(problem)
    count, status = np.zeros((B, 2), dtype=np.int64), np.zeros((B, 2), dtype=np.int64)
    arcs, estimates = np.zeros((B, 2), dtype=ARC), np.full(B, np.inf, dtype=ESTIMATE)
    filled: list[Memory] = []
    done = 0
    while done < B:
        since, width, series = memory if memory is not None and not filled else memory_for(B - done)
        done, used = march(numbers, goals, weights, done, since, width, series, count, status, arcs, estimates)
        filled.append((since[:used], width[:used], series[:used]))
    since, width, series = (np.concatenate(v) if len(filled) > 1 else v[0] for v in zip(*filled, strict=True))
    first = np.cumsum(count.reshape(-1)).reshape(B, 2) - count
    kind, lost = np.where(status[:, 0] == LIBRATES, LIBRATION, ROTATION), status[:, 0] == LOST
    calls = count.sum(axis=1) * ORDER
    orbit = MarchedOrbit(problem, tol, kind, lost, arcs, estimates["error"], estimates["condition"], calls)
    return orbit, Steps(first, count, since, width, series)


def memory_for(orbits: int) -> Memory:
    """Arrays for the steps of so many orbits, estimated before the march."""
    from ..core.arc_march import MOST
    from ..core.taylor_step import ORDER

    steps = _STEPS * orbits + 2 * MOST
    return np.empty(steps), np.empty(steps), np.empty((steps, 4, ORDER + 1))


def read_orbit(lost: Booleans, librates: Booleans, arcs: Array, steps: Steps, t: Array, out: Array) -> None:
    """Read beta, beta_t, alpha, z at t (B, n) into out (4, B, n), each of the four contiguous."""
    from ..core.orbit_reading import read

    read(np.ascontiguousarray(t), lost, librates, arcs, *steps, *out)


def joined(orbits: Sequence[MarchedOrbit], problem: Reduced, rows: Any = slice(None)) -> MarchedOrbit:
    """The `rows` of each of the orbits, concatenated, as the orbits of `problem`."""
    names = ("kind", "lost", "arcs", "error", "condition", "evaluations")
    columns: dict[str, Any] = {name: np.concatenate([getattr(one, name)[rows] for one in orbits]) for name in names}
    return MarchedOrbit(problem, orbits[0].tol, **columns)
