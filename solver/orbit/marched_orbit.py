"""Periodic orbits by Taylor's method, compiled: half a period is marched, the rest follows by symmetry."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ..core import march as core
from ..core.library import numbers_of
from ..numerics.arrays import Array, Booleans, Integers
from ..problem.reduced import StartProblem
from .periodic_orbit import Orbit, solve_orbit
from .pieces import LIBRATION, ROTATION, Periodic

if TYPE_CHECKING:
    from ..problem.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class MarchedOrbit(Periodic):
    """The orbits of B problems, ready to be read anywhere along the rod.

    found: (B,), records of the compiled core (`core.march.ORBIT`); those of `lost` orbits have what `rest` knows.
    lost: (B,), where the march fails or is too inaccurate; these orbits are in `rest`, in order, by quadrature.
    """

    problem: StartProblem
    tol: float
    found: Array
    lost: Booleans
    rest: Orbit | None = None

    @cached_property
    def kind(self) -> Integers:
        kind = np.where(self.found["status"][:, 0] == core.TURNS, LIBRATION, ROTATION)
        if self.rest is not None:
            kind[self.lost] = self.rest.kind
        return kind

    @cached_property
    def ahead(self) -> Array:
        return np.ascontiguousarray(self.found["legs"]["time"][:, 0])

    @cached_property
    def back(self) -> Array:
        return np.ascontiguousarray(self.found["legs"]["time"][:, 1])

    @cached_property
    def late(self) -> Array:
        """Standard deviation of ahead + back by what the steps leave out and round off, (B,).

        The error of beta along the rod does not contain it where the rod ends before the next turning point.
        """
        return np.where(self.lost, 0.0, self.found["legs"]["late"].sum(axis=1))

    @cached_property
    def exact(self) -> Orbit:
        """The same orbits by quadrature, for the Morse index: its sign depends on digits that a march may lose."""
        return solve_orbit(self.problem, self.tol)

    def at(self, t: Array) -> tuple[Array, Array, Array, Array]:
        """beta, beta_t, alpha, z at t (B, n), each (B, n)."""
        out = np.full((4, *t.shape), np.nan)
        core.march(numbers_of(self.problem), self.tol, np.ascontiguousarray(t), out)
        if self.rest is not None:
            out[:, self.lost] = self.rest.at(t[self.lost])
        return out[0], out[1], out[2], out[3]

    def swirl(self, t: Array) -> Array:
        """The integral of sin(beta) cos(beta) from the start, (B, n)."""
        out = np.full(t.shape, np.nan)
        core.march(numbers_of(self.problem), self.tol, np.ascontiguousarray(t), swirl=out)
        if self.rest is not None:
            out[self.lost] = self.rest.swirl(t[self.lost])
        return out

    def take(self, rows: Integers) -> "MarchedOrbit":
        """The orbits of the problems `rows`, (b,) rising; all of them are these themselves, with their steps."""
        if rows.size == self.problem.size:
            return self
        lost, rest = self.lost[rows], None
        if self.rest is not None and lost.any():
            rest = self.rest.take((np.cumsum(self.lost) - 1)[rows[lost]])
        return MarchedOrbit(self.problem.take(rows), self.tol, self.found[rows], lost, rest)

    @cached_property
    def steps(self) -> core.Steps:
        """The series of all steps, marched again: an answer that is only read at its stations does not store them."""
        steps, mine = core.room_for(self.found), np.flatnonzero(~self.lost)
        # a lost orbit has no room: the march of one that was too inaccurate would write beyond the arrays
        selected = replace(steps, first=steps.first[mine])
        core.march(numbers_of(self.problem.take(mine)), self.tol, np.empty((mine.size, 0)), steps=selected)
        return steps

    def complete(self, lost: Booleans, answer: "Trajectory") -> "MarchedOrbit":
        """The same orbits, those that are `lost` (B,) taken from an answer to them by quadrature."""
        rest: Orbit = answer.orbit
        rows = np.array(self.found)
        for name in ("error", "condition", "evaluations"):
            rows[name][lost] = getattr(answer, name)
        rows["legs"]["time"][lost] = np.stack([rest.ahead, rest.back], axis=1)
        rows["status"][lost], rows["count"][lost] = core.LOST, 0
        return replace(self, found=rows, lost=lost, rest=rest)


def march_orbit(problem: StartProblem, tol: float, t: Array, out: Array) -> MarchedOrbit:
    """March the orbits of B start problems and read them.

    Parameters
    ----------
    problem : StartProblem
        B start problems.
    tol : float
        Allowed error of beta [rad].
    t : array, (B, n)
        Stations in units of rho.
    out : array, (4, B, n)
        Filled with beta, beta_t, alpha and z but for the orbits that are `lost`.

    Returns
    -------
    MarchedOrbit
        `lost` where the march fails.
    """
    rows = core.march(numbers_of(problem), tol, np.ascontiguousarray(t), out)
    return MarchedOrbit(problem, tol, rows, rows["status"][:, 0] == core.LOST)
