"""The contact force: what the cylinder exerts on the rod, per length. Arrays broadcast."""

from typing import Any

import numpy as np

from ..numerics.arrays import Array
from ..problem.case import SIDES


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
