"""The Morse index of an equilibrium between given ends: the number of negative directions of the second variation; and
its condition number on a mesh.

Both beta(0) and beta(L) are held, FZ, MZ and M3 are dead loads and the positions of the ends are free: an equilibrium
with no negative direction is stable in that sense. Held positions as well would exclude some directions, so they could
only make more equilibria stable.

The index is computed in two independent ways: negative pivots of the tridiagonal matrix of -eta'' - H'(beta) eta on a
mesh, and zeros of the Jacobi field, known from the orbit itself. The pivots fail for a rod that stays near a saddle
for long: what the rod does after that depends on digits that no mesh keeps.
"""

from typing import Any

import numpy as np

from ..mechanics.potential import Loads, slope_rate
from ..numerics.arrays import Array
from ..orbit import periodic_orbit
from ..orbit.periodic_orbit import HELIX, LIBRATION
from ..problem.reduced import Reduced

_MOST = 40_000  # steps of a mesh


def morse_index(problem: Reduced, h: Array, beta: Array) -> Array:
    """The number of negative eigenvalues of the second variation.

    Parameters
    ----------
    problem : Reduced
        B problems.
    h : array (B,)
        Step of the mesh.
    beta : array (B, n)
        The equilibria on equal steps.

    Returns
    -------
    array (B,)
        The Morse index.
    """
    import scipy

    diagonal = diagonal_of(problem, h, beta)
    beside = np.full(diagonal.shape[1] - 1, -1.0)
    negative = {"select": "v", "select_range": (-np.inf, 0.0)}
    return np.array(
        [scipy.linalg.eigvalsh_tridiagonal(row, beside, **negative).size for row in diagonal], dtype=np.int64
    )


def diagonal_of(problem: Reduced, h: Array, beta: Array) -> Array:
    """The diagonal of h times the second variation at the inner nodes of beta (B, n); beside it stands -1."""
    return 2 - h[:, None] ** 2 * slope_rate(Loads.columns(problem), beta[:, 1:-1])


def response(problem: Reduced, h: Array, beta: Array) -> Array:
    """The largest |d beta(t)/d beta(L)| of equilibria known on a mesh alone, (B,).

    The solution of the tridiagonal system whose far end is moved by one; arguments as in `morse_index`.
    """
    import scipy

    diagonal = diagonal_of(problem, h, beta)
    largest = np.ones(beta.shape[0])
    beside, moved = np.full(diagonal.shape[1] - 1, -1.0), np.zeros(diagonal.shape[1])
    moved[-1] = 1
    for i in range(beta.shape[0]):
        eta, info = scipy.linalg.lapack.dgtsv(beside, diagonal[i], beside, moved)[3:]
        largest[i] = np.maximum(1, np.abs(eta).max()) if info == 0 else np.inf
    return np.where(np.isfinite(largest), largest, np.inf)


def index_at_stations(problem: Reduced, t: Array, beta: Array, rate: Array) -> Array:
    """The negative pivots of shapes known at stations t alone, beta and beta_t (B, n), as floats (B,).

    NaN where the stations are too few: fewer than twelve to the shortest wave that H' allows, or every other one of
    them gives another number.
    """
    import scipy

    index = np.full(problem.size, np.nan)
    with np.errstate(invalid="ignore", over="ignore"):
        quickest = np.sqrt(np.abs(slope_rate(Loads.columns(problem), beta)).max(axis=1))
        dense = np.diff(t, axis=1).max(axis=1) * quickest <= 0.5
        dense &= (t[:, 0] == 0) & (t[:, -1] >= problem.span * (1 - 1e-12))
        steps = 2 * np.maximum(12 * problem.span * quickest, 400)
    for i in np.flatnonzero(dense & (steps <= _MOST) & (t.shape[1] >= 5)):
        counts = []
        for stations in (slice(None), np.unique([*range(0, t.shape[1], 2), t.shape[1] - 1])):
            n = int(steps[i])
            even = np.linspace(0, problem.span[i], n + 1)
            shape = scipy.interpolate.CubicHermiteSpline(t[i, stations], beta[i, stations], rate[i, stations])(even)
            rod = problem.take(slice(i, i + 1))
            counts.append(int(morse_index(rod, problem.span[i : i + 1] / n, shape[None])[0]))
        index[i] = counts[0] if counts[0] == counts[1] else np.nan
    return index


def helix_half_waves(problem: Any) -> Array:
    """r L/pi of helices of the angle beta(0), (B,), with r^2 = H'; 0 about a saddle."""
    return np.asarray(np.sqrt(np.maximum(slope_rate(problem, problem.beta0), 0)) * problem.span / np.pi)


def helix_index(half_waves: Array) -> Array:
    """The Morse index of helices between their end angles: how many whole numbers are below r L/pi, (B,)."""
    return np.maximum(np.ceil(half_waves * (1 - 1e-12)) - 1, 0)


def jacobi_zeros(orbit: Any) -> Array:
    """The Morse index of B orbits as the number of zeros of the Jacobi field inside (0, L).

    The Jacobi field solves eta'' + H'(beta) eta = 0, eta(0) = 0, eta'(0) = 1. beta_t solves the same equation, so by
    Sturm eta has one zero between each two zeros of beta_t, the turning points. Whether another follows the last of
    them is given by the sign of eta(L) = d beta(L)/d beta_t(0), which is that of -2 beta_t(0) beta_t(L) dT/d(level), T
    being the length of the orbit between the two angles. So the index is exact however long the rod and however
    closely it passes a saddle. The search for equilibria knows the sign of dT/d(level) (`Orbit.lengthens`); for other
    orbits the core gives that of eta(L).

    Returns
    -------
    array (B,)
        The Morse index as floats; NaN where a float cannot hold what decides it.
    """
    problem, turns = orbit.problem, orbit.turns
    librates = orbit.kind == LIBRATION
    shorter = np.full(problem.size, np.nan) if orbit.lengthens is None else 1 - orbit.lengthens
    if np.isnan(shorter[librates]).any():
        end = np.where(turns % 2 == 0, 1, -1) * periodic_orbit.response(orbit)[1]
        shorter = np.where(np.isnan(shorter), np.where(np.isnan(end), np.nan, end > 0), shorter)
    with np.errstate(invalid="ignore"):
        of_helix = helix_index(helix_half_waves(problem))
    at_rest = orbit.back == 0  # eta is beta_t itself
    index = np.maximum(turns - 1 + np.where(at_rest, 1, shorter), 0)
    return np.where(orbit.kind == HELIX, of_helix, np.where(librates, index, 0))
