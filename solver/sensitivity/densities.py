"""The densities whose integrals and extremes are the observables, in units of A and rho, and their derivatives.

The core computes the observables from the same formulas: core/densities.h.
"""

from dataclasses import dataclass

import numpy as np

from ..mechanics.potential import Loads, slope_rate_of, slope_terms
from ..numerics.arrays import Array


@dataclass(frozen=True, eq=False)
class Angles:
    """beta, |beta_t|, and sin and cos of beta, (Q, m) each."""

    beta: Array
    speed: Array
    sin: Array
    cos: Array


@dataclass(frozen=True, eq=False)
class Density:
    """A density at (Q, m) points, and its derivatives with respect to beta, |beta_t|, lam, mu and phi.

    size: the sum of the sizes of the terms of a value, whose rounding is that many eps.
    """

    values: Array
    size: Array
    beta: Array
    speed: Array
    lam: Array | float = 0.0
    mu: Array | float = 0.0
    phi: Array | float = 0.0


def angle(at: Angles, loads: Loads) -> Density:
    """beta itself."""
    return Density(at.beta, np.abs(at.beta), np.ones_like(at.beta), np.zeros_like(at.beta))


def curvature(at: Angles, loads: Loads) -> Density:
    """kappa rho = hypot(beta_t, sin^2)."""
    s, c, v = at.sin, at.cos, at.speed
    kappa = np.hypot(v, s * s)
    with np.errstate(invalid="ignore"):  # no derivative where the rod is straight
        return Density(kappa, v + s * s, 2 * s * c * (s * s / kappa), v / kappa)


def bending(at: Angles, loads: Loads) -> Density:
    """kappa^2 rho^2/2: bending energy per length in A/rho^2."""
    s, c, v = at.sin, at.cos, at.speed
    bent = (v * v + s**4) / 2
    return Density(bent, bent, 2 * s * s * s * c, v)


def potential(at: Angles, loads: Loads) -> Density:
    """Energy per length less the work of the dead loads in A/rho^2, without the constant -M3^2/(2C)."""
    s, c, v = at.sin, at.cos, at.speed
    bent, twisted, pulled, turned = (v * v + s**4) / 2, loads.mu * s * c, loads.phi * c, loads.lam * s
    size = bent + np.abs(twisted) + np.abs(pulled) + np.abs(turned)
    moved = 2 * s * s * s * c + loads.mu * (c - s) * (c + s) + loads.phi * s - loads.lam * c
    return Density(bent + twisted - pulled - turned, size, moved, v, -s, s * c, -c)


def outward(at: Angles, loads: Loads) -> Density:
    """f rho^3/A, the contact per length, positive outward; eq. (34), corrected."""
    s, c, v = at.sin, at.cos, at.speed
    v2, s3, cos2 = v * v, s * s * s, (c - s) * (c + s)
    across, lever = loads.lam - loads.mu * c - s3, 3 * s * c - loads.mu
    even, twist, rest = slope_terms(loads, s, c)
    H = even + twist - rest
    size = np.abs(s) * (np.abs(loads.lam) + np.abs(loads.mu * c) + np.abs(s3)) + 3 * v2 * np.abs(cos2)
    size = size + (np.abs(even) + np.abs(twist) + np.abs(rest)) * (3 * np.abs(s * c) + np.abs(loads.mu))
    moved = c * across + s * (loads.mu * s - 3 * s * s * c) + slope_rate_of(loads, s, c) * lever + 3 * H * cos2
    by_loads = s + c * lever, -s * c - cos2 * lever - H, -s * lever
    return Density(s * across + H * lever - 3 * v2 * cos2, size, moved + 12 * v2 * s * c, -6 * v * cos2, *by_loads)


def tension(at: Angles, loads: Loads) -> Density:
    """F3 rho^2/A, the internal force along the tangent: phi cos + (lam - mu cos - sin^3) sin."""
    s, c = at.sin, at.cos
    s3 = s * s * s
    across = loads.lam - loads.mu * c - s3
    size = np.abs(loads.phi * c) + np.abs(s) * (np.abs(loads.lam) + np.abs(loads.mu * c) + np.abs(s3))
    moved = -loads.phi * s + c * across + s * (loads.mu * s - 3 * s * s * c)
    return Density(loads.phi * c + across * s, size, moved, np.zeros_like(s), s, -s * c, c)
