"""Curvature and the internal forces along the rod, from beta and beta'. Arrays broadcast.

A: bending stiffness [force length^2]; l = MZ/A, m = M3/A [1/length]; rho: distance of the centreline from the axis
[length]; beta [rad], dbeta [rad/length]. Index 1 is the inward normal, 2 lies in the surface across the rod, 3 is the
tangent. Internal forces are positive in tension. The contact force is in `contact`.
"""

from typing import Any

import numpy as np

from ..numerics.arrays import Array


def curvature(rho: Any, beta: Array, dbeta: Array) -> Array:
    """kappa [1/length], from its geodesic part beta' and its normal part sin(beta)^2/rho."""
    return np.hypot(dbeta, np.sin(beta) ** 2 / rho)


def circumferential_force(A: Any, l: Any, m: Any, rho: Any, beta: Array) -> Array:
    """FY [force]; eq. (30)."""
    return A / rho * (l - m * np.cos(beta) - np.sin(beta) ** 3 / rho)


def normal_force(A: Any, m: Any, rho: Any, beta: Array, dbeta: Array) -> Array:
    """F1 [force], along the inward normal; eq. (33) with the sign of beta', and rho in place of R."""
    return A * dbeta * (m - 1.5 * np.sin(2 * beta) / rho)


def surface_forces(FY: Array, FZ: Any, beta: Array) -> tuple[Array, Array]:
    """F2 and F3 [force]: in the surface across the rod, and along the tangent; eq. (31)."""
    s, c = np.sin(beta), np.cos(beta)
    return FZ * s - FY * c, FZ * c + FY * s
