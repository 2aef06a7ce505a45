"""Small systems of equations: linear ones, scaled, and the root of others by Newton's rule."""

from collections.abc import Callable

import numpy as np

from .arrays import Array

CLOSE = 1e-7  # a step of Newton's rule this short is the last: the next would be of the size of its square


def solve(matrix: Array, forced: Array) -> Array:
    """The solutions (B, n, k) of square systems (B, n, n), rows and columns scaled; NaN for a singular one."""
    with np.errstate(all="ignore"):
        column = 1 / np.abs(matrix).max(axis=1)
        scaled = matrix * column[:, None, :]
        row = 1 / np.abs(scaled).max(axis=2)
        scaled, wanted = scaled * row[..., None], forced * row[..., None]
    out = np.full(forced.shape, np.nan)
    for b in np.flatnonzero(np.isfinite(scaled).all(axis=(1, 2)) & np.isfinite(wanted).all(axis=(1, 2))):
        try:
            found = np.linalg.solve(scaled[b], wanted[b])
            found += np.linalg.solve(scaled[b], wanted[b] - scaled[b] @ found)
        except np.linalg.LinAlgError:
            continue
        out[b] = found * column[b][:, None]
    return out


def null_vector(matrix: Array) -> Array:
    """The unit vector t with F' t = 0, of n equations F' (n, n + 1), whose rows are scaled."""
    with np.errstate(all="ignore"):
        size = np.abs(matrix).max(axis=1, keepdims=True)
    return np.asarray(np.linalg.svd(matrix / np.where(size > 0, size, 1.0))[2][-1])


def root(
    equations: Callable[[Array], tuple[Array, Array] | None], x: Array, longest: float, rounds: int = 8
) -> Array | None:
    """The root near x (n,), by Newton's rule; None where it does not converge.

    Parameters
    ----------
    equations : callable
        Of x: the values (n,) and the derivatives (n, n); None where there are none.
    longest : float
        The largest change of an unknown in a step.
    """
    shortest = np.inf
    for _ in range(rounds):
        found = equations(x)
        if found is None:
            return None
        step = solve(found[1][None], -found[0][None, :, None])[0, :, 0]
        length = float(np.abs(step).max())
        if not length <= min(2 * shortest, longest):  # also NaN
            return None
        shortest, x = min(shortest, length), x + step
        if length < CLOSE:
            return x
    return None
