"""The contact force: what the cylinder exerts on the rod, per length. Arrays broadcast."""

from typing import Any

import numpy as np

from ..numerics.arrays import Array
from ..problem.case import IN_PLACE, SIDES, Case


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
        Circumferential force [force], see `statics.circumferential_force`.
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
