"""Curvature, the internal forces along the rod and the contact force, from beta and beta'. Arrays broadcast.

A: bending stiffness [force length^2]; l = MZ/A, m = M3/A [1/length]; rho: distance of the centreline from the axis
[length]; beta [rad], dbeta [rad/length]. Index 1 is the inward normal, 2 lies in the surface across the rod, 3 is the
tangent. Internal forces are positive in tension.
"""

from typing import Any

import numpy as np

from ..numerics.arrays import Array
from ..problem.case import IN_PLACE, SIDES, Case


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


def contact_force(A: Any, m: Any, rho: Any, FY: Array, H: Array, beta: Array, dbeta: Array) -> Array:
    """The contact force f per length, eq. (34) without its factor [h - G]^(-1/2).

    Parameters
    ----------
    A : array
        Bending stiffness [force length^2].
    m : array
        M3/A [1/length].
    rho : array
        Distance of the centreline from the axis [length].
    FY : array
        Circumferential force [force], see `forces.circumferential_force`.
    H : array
        G'/2 [1/length^2], see `potential.dimensional_slope`.
    beta, dbeta : array
        The angle [rad] and its rate [rad/length].

    Returns
    -------
    array
        f [force/length], positive outward: away from the axis.
    """
    bent = H * (1.5 * np.sin(2 * beta) / rho - m) - 3 / rho * dbeta**2 * np.cos(2 * beta)
    return np.sin(beta) * FY / rho + A * bent


def with_weight(case: Case, contact: Array, alpha: Array, dbeta: Array) -> Array:
    """The contact force per length of rods with weight or friction, (*cases, n), from that without them.

    The weight across the axis pulls the rod to alpha = 0; the twisting moment of a rod that turns in place grows by the
    friction, and its rate makes a force where the rod bends.
    """

    def column(value: Any) -> Array:
        return np.expand_dims(np.broadcast_to(value, case.shape), -1)

    wall = case.cylinder
    if case.rod.weight is not None and wall.inclination is not None:
        contact = contact - column(case.rod.weight * np.sin(wall.inclination)) * np.cos(alpha)
    sign, way = wall.sense
    if way == IN_PLACE and wall.friction is not None:
        contact = contact / (1 - case.outward * sign * column(wall.friction * case.rod.a) * dbeta)
    return contact


def push_from(contact: Any, side: str) -> Any:
    """The contact force counted positive where the cylinder pushes the rod, on either side.

    Parameters
    ----------
    contact : array
        Contact force per length, positive outward, see `contact_force`.
    side : str
        Where the rod lies: "outside" or "inside".
    """
    return SIDES[side] * contact
