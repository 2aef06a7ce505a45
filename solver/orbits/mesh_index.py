"""The Morse index of an equilibrium between given ends on a mesh, the number of negative directions of the second
variation; and its condition number there.

Both beta(0) and beta(L) are held, FZ, MZ and M3 are dead loads and the positions of the ends are free: an equilibrium
with no negative direction is stable in that sense. Held positions as well would exclude some directions, so they could
only make more equilibria stable.

The index is the number of negative pivots of the tridiagonal matrix of -eta'' - H'(beta) eta. The pivots fail for a rod
that stays near a saddle for long: what the rod does after that depends on digits that no mesh keeps. Where the orbit is
known, `periodic_orbit.jacobi_zeros` counts.
"""

import numpy as np

from ..numerics.arrays import Array
from ..problem.dimensionless import Reduced
from .potential import Loads, slope_rate

_MOST = 40_000  # steps of a mesh; a rod that needs more has no index. x10: ten times the time for such rods


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
