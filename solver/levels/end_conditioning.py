"""The condition number of an equilibrium between given ends: how beta responds to a change of beta(L)."""

from typing import Any

import numpy as np

from ..core import orbits as core
from ..numerics.arrays import Array
from ..problem.reduced import Reduced
from .morse_index import diagonal_of


def end_response(orbit: Any) -> Array:
    """The largest |d beta(t)/d beta(L)| = |eta(t)/eta(L)| along B orbits whose beta(0) is held.

    eta as in `morse_index.jacobi_end`, at the nodes of all panels that the rod passes, in its first period and in its
    last: between them eta grows evenly.

    Returns
    -------
    array (B,)
        At least 1; unbounded at a fold.
    """
    return core.response(orbit)


def response(problem: Reduced, h: Array, beta: Array) -> Array:
    """The largest |d beta(t)/d beta(L)| of equilibria known on a mesh alone, (B,).

    The solution of the tridiagonal system whose far end is moved by one; arguments as in `morse_index.morse_index`.
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
