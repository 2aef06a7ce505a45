"""The state of varied orbits at the nodes of their panels, as the core computes it, and the heights of their levels.

Quantities are those of `variations`, which integrates the rates of M.
"""

from dataclasses import dataclass

import numpy as np

from ..numerics.arrays import Array, Integers
from .periodic_orbit import Orbit

PAIRS = np.triu_indices(4)  # the rows and columns of M that are kept


@dataclass(frozen=True, eq=False)
class Nodes:
    """The state at the nodes of P panels, (P, n); M: (P, 10, n), the rates of the elements of M."""

    v: Array
    H: Array
    c: Array
    shift: Array
    gamma: Array
    M: Array


def slopes_by_loads(beta: Array) -> Array:
    """The derivatives of H with respect to lam, mu and phi at beta (P, n), (P, 3, n)."""
    return np.stack([np.cos(beta), -np.cos(2 * beta), -np.sin(beta)], axis=1)


def nearest(orbit: Orbit, D: Array) -> Integers:
    """The panel of each orbit whose critical point the orbit comes closest to, (B,).

    D: (P,), the least beta_t^2 + c H^2 of each panel.
    """
    b = orbit.panels.arc // 2
    order = np.lexsort((D, b))
    first = np.searchsorted(b[order], np.arange(orbit.problem.size))
    return np.asarray(order[np.minimum(first, order.size - 1)])


def height_rates(angle: Array, other: Array) -> Array:
    """-(G_q(angle) - G_q(other))/2 for q = lam, mu, phi, (P, 3)."""
    # products, so that points that are mirror images have exactly the same height where the load cannot tell them apart
    half, mean = (angle - other) / 2, (angle + other) / 2
    sin_half = np.sin(half)
    by_lam, by_mu, by_phi = (
        2 * np.cos(mean) * sin_half,
        np.cos(2 * mean) * np.sin(2 * half),
        -2 * np.sin(mean) * sin_half,
    )
    return np.where((angle == other)[:, None], 0.0, np.stack([-by_lam, by_mu, -by_phi], axis=1))
