"""Forces, moments and contact along the rod, from beta and beta'. Arrays broadcast.

A: bending stiffness, l = MZ/A, m = M3/A, p = FZ/A, rho: distance from the axis. Index 1 is the inward normal,
2 lies in the surface across the rod, 3 is the tangent.
"""

from typing import Any

import numpy as np

from ..numerics.arrays import Array


def slope(l: Any, m: Any, p: Any, rho: Any, beta: Array) -> Array:
    """H(beta) [1/length^2]; eq. (35), corrected."""
    s, c = np.sin(beta), np.cos(beta)
    return (l * c - m * np.cos(2 * beta)) / rho - (p + 2 * c * s * s / rho**2) * s


def circumferential_force(A: Any, l: Any, m: Any, rho: Any, beta: Array) -> Array:
    """FY [force]; eq. (30)."""
    return A / rho * (l - m * np.cos(beta) - np.sin(beta) ** 3 / rho)


def normal_force(A: Any, m: Any, rho: Any, beta: Array, dbeta: Array) -> Array:
    """F1 [force], along the inward normal; eq. (33) with the sign of beta' and rho for R."""
    return A * dbeta * (m - 1.5 * np.sin(2 * beta) / rho)


def surface_forces(FY: Array, FZ: Any, beta: Array) -> tuple[Array, Array]:
    """F2, F3 [force]: across the rod in the surface, and along it; eq. (31)."""
    s, c = np.sin(beta), np.cos(beta)
    return FZ * s - FY * c, FZ * c + FY * s


def contact(A: Any, m: Any, rho: Any, FY: Array, H: Array, beta: Array, dbeta: Array) -> Array:
    """The cylinder's push per length [force/length], positive outward; eq. (34) without its factor [h - G]^(-1/2)."""
    bent = H * (1.5 * np.sin(2 * beta) / rho - m) - 3 / rho * dbeta**2 * np.cos(2 * beta)
    return np.sin(beta) * FY / rho + A * bent


def curvature(rho: Any, beta: Array, dbeta: Array) -> Array:
    """kappa [1/length]: geodesic part beta', normal part sin(beta)^2/rho."""
    return np.hypot(dbeta, np.sin(beta) ** 2 / rho)


def energy_density(A: Any, h: Any, dbeta: Array) -> Array:
    """Energy per length less the work of the dead loads, the twist eliminated (Routh) [force].

    A/2 (beta'^2 + sin^4/rho^2) + M3 sin cos/rho - FZ cos - MZ sin/rho, which is A (beta'^2 - h/2) by eq. (32).
    """
    return A * (dbeta**2 - h / 2)
