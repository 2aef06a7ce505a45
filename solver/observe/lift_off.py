"""Where along a rod the cylinder does not push: on which share of the length, and how far from the ends."""

import numpy as np

from ..mechanics.potential import Loads, slope
from ..mechanics.statics import contact_force
from ..numerics.arrays import Array, Booleans
from ..problem.reduced import Reduced, flat
from ..shape import Shape
from .measurement import Reading

QUARTER = 0.25  # of the length at each end: a rod without push only there lifts off at its ends
ALLOWED = 1e-9  # of the length: a shorter stretch without push is rounding
PLACES, FINER = 256, 64  # at which the push is computed in a quarter, and between two of these places


def only_at_ends(sol: Shape) -> Booleans:
    """Whether the cylinder pushes all along the middle half of each rod, (B,)."""
    read = Reading(sol)
    first, last = (read.over("share", until) for until in (QUARTER, 1 - QUARTER))
    pushed, doubt = (last[0] - first[0]) / read.length, (last[1] + first[1]) / read.length
    found: Booleans = 1 - 2 * QUARTER - pushed <= ALLOWED + doubt
    return found


def distance_from_ends(sol: Shape, cases: Array) -> Array:
    """The largest distance from the nearer end at which the cylinder does not push, as a share of the length.

    Parameters
    ----------
    sol : Shape
        The rods.
    cases : array of int, (k,)
        Which of them; the cylinder pushes all along their middle halves.

    Returns
    -------
    array (k,)
        At most `QUARTER`; 0 where no place without push is found.
    """
    share = np.zeros(cases.size)
    for far in (False, True):
        places = np.broadcast_to(np.geomspace(QUARTER * 1e-4, QUARTER, PLACES), (cases.size, PLACES))
        at = _last_without_push(sol, cases, places, far)
        spread = np.linspace(0, 1, FINER)
        low = np.take_along_axis(places, at[:, None], axis=1)
        high = np.take_along_axis(places, np.minimum(at + 1, PLACES - 1)[:, None], axis=1)
        finer = low + (high - low) * spread
        best = np.take_along_axis(finer, np.maximum(_last_without_push(sol, cases, finer, far), 0)[:, None], axis=1)
        share = np.maximum(share, np.where(at < 0, 0, best[:, 0]))
    return share


def _last_without_push(sol: Shape, cases: Array, places: Array, far: bool) -> Array:
    """The number of the last of places (k, m), shares of the length, without push, (k,); -1 where there is none.

    far: the places are counted from the far end.
    """
    span = sol.problem.span[cases, None]
    free = push_at(sol, cases, span * (1 - places if far else places)) <= 0
    m = places.shape[1]
    return np.where(free.any(axis=1), m - 1 - np.argmax(free[:, ::-1], axis=1), -1)


def push_at(sol: Shape, cases: Array, t: Array) -> Array:
    """The push at places t (k, m), in units of rho, of some cases (k,), in units of A/rho^3; between stations, where
    the method knows no orbit, linear in t."""
    if sol.trajectory.shapes is not None:
        return np.stack([sol.trajectory.shapes.of(int(i)).push_at(row) for i, row in zip(cases, t, strict=True)])
    problem: Reduced = sol.problem.take(cases)
    if sol.trajectory.orbit is None:
        shape = sol.trajectory
        rows = [[np.interp(t[i], sol.t[k], v[k]) for i, k in enumerate(cases)] for v in (shape.beta, shape.dbeta)]
        beta, rate = (np.array(row).reshape(t.shape) for row in rows)
    else:
        beta, rate = sol.trajectory.orbit.pick(cases).at(t)[:2]
    mu, lam = problem.mu[:, None], problem.lam[:, None]
    around = lam - mu * np.cos(beta) - np.sin(beta) ** 3
    outward = contact_force(1.0, mu, 1.0, around, slope(Loads.columns(problem), beta), beta, rate)
    sign: Array = flat(sol.case.outward, sol.case.shape)[cases, None]
    return sign * outward
