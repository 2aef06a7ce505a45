"""The compiled march of periodic orbits: the calls of `rod.c` on NumPy arrays."""

from dataclasses import dataclass

import numpy as np

from ..numerics.arrays import Array, Integers
from .library import fine, run, share_out, widest

LOST, TURNS, GOES_ROUND = 0, 1, 2  # how a leg ends
ORDER = 20  # of the series

_LEG = ("time", "alpha", "z", "swirl", "error", "late", "fastest", "steps", "amplitude", "e11", "e12", "e21", "e22")
# What the core knows of an orbit: `orbit` in rod.c. A leg goes from the start to the turning point ahead, or behind, or
# once round; status: how it ends. count: its steps. sound: whether the error is within the tolerance and far below a
# radian, and the condition number finite.
_FLAGS = ("sound", "i8"), ("evaluations", "i8")
_LEGS = ("legs", [(name, "f8") for name in _LEG], 2)
ORBIT = np.dtype([("error", "f8"), ("condition", "f8"), _LEGS, ("status", "i8", 2), ("count", "i8", 2), *_FLAGS])


@dataclass(frozen=True, eq=False)
class Steps:
    """The Taylor series of the steps of B orbits, those of the second leg of an orbit behind those of its first.

    first: (B,), the number of the first step of each orbit. since, width: (P,), begin and length of each step in the
    time of its leg. series: (P, 4, ORDER + 1), powers of beta, alpha, z and the swirl.
    """

    first: Integers
    since: Array
    width: Array
    series: Array


def room_for(orbits: Array) -> Steps:
    """Arrays, not filled, for the steps of orbits (B,) whose counts are known."""
    count = orbits["count"].sum(axis=1)
    total = int(count.sum())
    return Steps(np.cumsum(count) - count, np.empty(total), np.empty(total), np.empty((total, 4, ORDER + 1)))


def march(
    problems: Array,
    tol: float,
    t: Array,
    out: Array | None = None,
    swirl: Array | None = None,
    steps: Steps | None = None,
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
    steps : Steps, optional
        Filled with the series of an earlier march of the same problems.
    lanes : int
        Problems marched together: 1, 2, 4 or 8; 0: as many as the processor allows.

    Returns
    -------
    array, (B,) of ORBIT
        Of an orbit whose first status is LOST nothing is filled.
    """
    size, n = t.shape
    orbits = np.zeros(size, ORBIT)
    kept = (steps.first, steps.since, steps.width, steps.series) if steps else (None, None, None, None)
    task = size, problems, tol, orbits, n, t, out, swirl, *kept, lanes, widest()
    share_out(lambda a, b: fine(run("rod_march", a, b, *task)), size)
    return orbits
