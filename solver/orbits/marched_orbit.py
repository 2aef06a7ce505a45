"""Periodic orbits by Taylor's method, compiled (`rod.c`): half a period is marched, the rest follows by symmetry."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ..core.library import fine, numbers_of, run, share_out, structure, widest
from ..core.measures import step_series
from ..core.weight_friction import ORDER
from ..numerics.arrays import Array, Booleans, Integers
from ..problem.dimensionless import StartProblem
from .periodic_orbit import LIBRATION, ROTATION, Orbit, Periodic, solve_orbit

if TYPE_CHECKING:
    from ..problem.trajectory import Trajectory


LOST, TURNS, GOES_ROUND = 0, 1, 2  # how a leg ends
# orbits whose steps are kept for all who read some of them: 12 MB; others are marched again. x10: 120 MB
_KEPT = 1024
_STEPS = 32  # of an orbit, for which there is room at once; for more they are marched again. x10: only memory

# What the core knows of an orbit: `orbit` in rod.c. A leg goes from the start to the turning point ahead, or behind, or
# once round; status: how it ends. count: its steps. sound: whether the error is within the tolerance and far below a
# radian, and the condition number finite. first: the number of its first step, where they are kept.
_LEG = "time alpha z swirl error late fastest steps amplitude e11 e12 e21 e22"
ORBIT = np.dtype(
    [
        ("error", "f8"),
        ("condition", "f8"),
        ("legs", [(name, "f8") for name in _LEG.split()], 2),
        ("status", "i8", 2),
        ("count", "i8", 2),
        ("sound", "i8"),
        ("evaluations", "i8"),
        ("first", "i8"),
    ]
)
_StepRoom = structure("step_room", "rod.c")


@dataclass(frozen=True, eq=False)
class Steps:
    """The Taylor series of the steps of orbits, those of the second leg of an orbit behind those of its first.

    since, width: (P,), begin and length of each step in the time of its leg. series: (P, 4, ORDER + 1), powers of beta,
    alpha, z and the swirl.
    """

    since: Array
    width: Array
    series: Array

    @cached_property
    def angles(self) -> Array:
        """Chebyshev series of beta and |beta_t| on the steps, (P, 2, ORDER + 1)."""
        return step_series(self.width, self.series)

    def as_room(self) -> Any:
        """The steps as the core reads or fills them."""
        return _StepRoom(self.width.size, 0, self.since, self.width, self.series)


def march(
    problems: Array,
    tol: float,
    t: Array,
    out: Array | None = None,
    swirl: Array | None = None,
    room: Any = None,
    lanes: int = 0,
) -> Array:
    """March problems, read each at its stations, and keep its steps.

    Results are equal to the bit for every width of the lanes, number of threads and choice of other problems.

    Parameters
    ----------
    problems : array, (B, 6)
        lam, mu, phi, span, beta(0), beta_t(0).
    tol : float
        The allowed error of beta [rad].
    t : array, (B, n)
        Times, rising from 0 to at most the span.
    out : array, (4, B, n), optional
        Filled with beta, beta_t, alpha and z.
    swirl : array, (B, n), optional
        Filled with the integral of sin(beta) cos(beta).
    room : step_room, optional
        Filled with the steps; its `used` says how many there are, also where it has no room for all.
    lanes : int
        Problems marched together: 1, 2, 4 or 8; 0: as many as the processor allows.

    Returns
    -------
    array, (B,) of ORBIT
        Of an orbit whose first status is LOST nothing is filled.
    """
    size, n = t.shape
    orbits = np.zeros(size, ORBIT)
    task = size, problems, tol, orbits, n, t, out, swirl, room, lanes, widest()
    share_out(lambda a, b: fine(run("rod_march", a, b, *task)), size)
    return orbits


def march_with_steps(
    problems: Array, tol: float, t: Array, out: Array | None = None, lanes: int = 0
) -> tuple[Array, Steps]:
    """March problems as `march` does, and keep all their steps."""
    size = _STEPS * (len(problems) + 4)
    while True:
        steps = Steps(np.empty(size), np.empty(size), np.empty((size, 4, ORDER + 1)))
        room = steps.as_room()
        orbits = march(problems, tol, t, out, room=room, lanes=lanes)
        if room.used <= size:
            return orbits, Steps(*(array[: room.used] for array in vars(steps).values()))
        size = room.used


@dataclass(frozen=True, eq=False)
class MarchedOrbit(Periodic):
    """The orbits of B problems, ready to be read anywhere along the rod.

    found: (B,), records of the compiled core (`ORBIT`); those of `lost` orbits have what `rest` knows.
    lost: (B,), where the march fails or is too inaccurate; these orbits are in `rest`, in order, by quadrature.
    kept: their steps, and those of others.
    """

    problem: StartProblem
    tol: float
    found: Array
    lost: Booleans
    rest: Orbit | None = None
    kept: Steps | None = None

    @cached_property
    def in_rest(self) -> Integers:
        """The place of each lost orbit in `rest`, (B,)."""
        return np.asarray(np.cumsum(self.lost) - 1)

    @cached_property
    def kind(self) -> Integers:
        kind = np.where(self.found["status"][:, 0] == TURNS, LIBRATION, ROTATION)
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
        """These orbits by quadrature, for the Morse index: its sign depends on digits that a march may lose."""
        return solve_orbit(self.problem, self.tol)

    def at(self, t: Array) -> tuple[Array, Array, Array, Array]:
        """beta, beta_t, alpha, z at t (B, n), each (B, n)."""
        out = np.full((4, *t.shape), np.nan)
        march(numbers_of(self.problem), self.tol, np.ascontiguousarray(t), out)
        if self.rest is not None:
            out[:, self.lost] = self.rest.at(t[self.lost])
        return out[0], out[1], out[2], out[3]

    def swirl(self, t: Array) -> Array:
        """The integral of sin(beta) cos(beta) from the start, (B, n)."""
        out = np.full(t.shape, np.nan)
        march(numbers_of(self.problem), self.tol, np.ascontiguousarray(t), swirl=out)
        if self.rest is not None:
            out[self.lost] = self.rest.swirl(t[self.lost])
        return out

    def take(self, rows: Integers) -> "MarchedOrbit":
        """The orbits of the problems `rows`, (b,) rising; all of them are these themselves, with their steps."""
        if rows.size == self.problem.size:
            return self
        lost, rest = self.lost[rows], None
        if self.rest is not None and lost.any():
            rest = self.rest.take(self.in_rest[rows[lost]])
        return MarchedOrbit(self.problem.take(rows), self.tol, self.found[rows], lost, rest, self.kept)

    @cached_property
    def steps(self) -> Steps:
        """The series of all steps, and of those of others; of many orbits they are not kept, and marched again."""
        if self.kept is not None:
            return self.kept
        again, steps = march_with_steps(numbers_of(self.problem), self.tol, np.empty((self.problem.size, 0)))
        self.found["first"] = again["first"]
        return steps

    def complete(self, lost: Booleans, answer: "Trajectory") -> "MarchedOrbit":
        """These orbits, those that are `lost` (B,) taken from an answer by quadrature."""
        rest: Orbit = answer.orbit
        rows = np.array(self.found)
        for name in ("error", "condition", "evaluations"):
            rows[name][lost] = getattr(answer, name)
        rows["legs"]["time"][lost] = np.stack([rest.ahead, rest.back], axis=1)
        rows["status"][lost], rows["count"][lost] = LOST, 0
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
    question = numbers_of(problem), tol, np.ascontiguousarray(t), out
    rows, kept = march_with_steps(*question) if problem.size <= _KEPT else (march(*question), None)
    return MarchedOrbit(problem, tol, rows, rows["status"][:, 0] == LOST, kept=kept)
