"""The densities whose integrals and extremes are the observables, in units of A and rho, at the nodes of rod pieces,
and their partial derivatives."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..mechanics.potential import Loads, slope_rate_of, slope_terms, steepest
from ..numerics.arrays import Array
from .rod_pieces import Angles, Pieces


@dataclass(frozen=True, eq=False)
class Density:
    """A density at m nodes of Q pieces, (Q, m) each.

    values. size: sum of the sizes of the terms of a value, whose rounding is that many eps. spread: the largest change
    of a value for a unit change of beta and the change of beta_t that comes with it.
    """

    values: Array
    size: Array
    spread: Array


def angle(pieces: Pieces) -> Density:
    """beta itself."""
    beta = pieces.angles.beta
    return Density(beta, np.abs(beta), np.ones_like(beta))


def across(pieces: Pieces) -> Density:
    """sin(beta), the rate of the azimuth alpha in t."""
    s, c = pieces.angles.sin, pieces.angles.cos
    return Density(s, np.abs(s), np.abs(c))


def along(pieces: Pieces) -> Density:
    """cos(beta), the rate of the height z/rho in t."""
    s, c = pieces.angles.sin, pieces.angles.cos
    return Density(c, np.abs(c), np.abs(s))


def curvature(pieces: Pieces) -> Density:
    """kappa rho = hypot(beta_t, sin^2)."""
    s, c, v = pieces.angles.sin, pieces.angles.cos, np.abs(pieces.angles.speed)
    kappa = np.hypot(v, s * s)
    share = np.divide(v, kappa, out=np.ones_like(kappa), where=kappa > 0)
    return Density(kappa, v + s * s, share * rate(pieces) + 2 * np.abs(s * c))


def bending(pieces: Pieces) -> Density:
    """kappa^2 rho^2/2: bending energy per length in A/rho^2."""
    speed, s, c = pieces.angles.speed, pieces.angles.sin, pieces.angles.cos
    s2 = s * s
    found = (speed * speed + s2 * s2) / 2
    return Density(found, found, np.abs(speed) * rate(pieces) + 2 * s2 * np.abs(s * c))


def potential(pieces: Pieces) -> Density:
    """Energy per length less the work of the dead loads in A/rho^2, without the constant -M3^2/(2C).

    With weight the work of FZ at the far end less that of the weight along the axis is that of the local FZ.
    """
    loads, speed, s, c = _loads(pieces), pieces.angles.speed, pieces.angles.sin, pieces.angles.cos
    weight: Any = 0.0
    if pieces.varying is not None:
        far = Loads.columns(pieces.problem, pieces.case)
        loads, weight = Loads(far.lam, far.mu, loads.phi), pieces.varying[3]
    s2 = s * s
    bent, twisted, pulled, turned = (speed * speed + s2 * s2) / 2, loads.mu * s * c, loads.phi * c, loads.lam * s
    size = bent + np.abs(twisted) + np.abs(pulled) + np.abs(turned) + np.abs(weight)
    moved = 2 * s2 * s * c + loads.mu * (c - s) * (c + s) + loads.phi * s - loads.lam * c
    return Density(bent + twisted - pulled - turned - weight, size, np.abs(speed) * rate(pieces) + np.abs(moved))


def outward(pieces: Pieces) -> Density:
    """f rho^3/A, the contact per length, positive outward; eq. (34), corrected."""
    loads, speed, s, c = _loads(pieces), pieces.angles.speed, pieces.angles.sin, pieces.angles.cos
    v2, s3, cos2 = speed * speed, s * s * s, (c - s) * (c + s)
    across, lever = loads.lam - loads.mu * c - s3, 3 * s * c - loads.mu
    even, twist, rest = slope_terms(loads, s, c)
    H = even + twist - rest
    size = np.abs(s) * (np.abs(loads.lam) + np.abs(loads.mu * c) + np.abs(s3)) + 3 * v2 * np.abs(cos2)
    size = size + (np.abs(even) + np.abs(twist) + np.abs(rest)) * (3 * np.abs(s * c) + np.abs(loads.mu))
    moved = c * across + s * (loads.mu * s - 3 * s * s * c) + slope_rate_of(loads, s, c) * lever + 3 * H * cos2
    spread = np.abs(moved + 12 * v2 * s * c) + 6 * np.abs(speed * cos2) * rate(pieces)
    found = s * across + H * lever - 3 * v2 * cos2
    if pieces.varying is not None:
        weight, divisor = pieces.varying[3:]
        found, size = (found - weight) / divisor, size + np.abs(weight)
    return Density(found, size, spread)


def tension(pieces: Pieces) -> Density:
    """F3 rho^2/A, the internal force along the tangent: phi cos + (lam - mu cos - sin^3) sin."""
    loads, s, c = _loads(pieces), pieces.angles.sin, pieces.angles.cos
    s3 = s * s * s
    across = loads.lam - loads.mu * c - s3
    size = np.abs(loads.phi * c) + np.abs(s) * (np.abs(loads.lam) + np.abs(loads.mu * c) + np.abs(s3))
    moved = -loads.phi * s + c * across + s * (loads.mu * s - 3 * s * s * c)
    return Density(loads.phi * c + across * s, size, np.abs(moved))


def push(pieces: Pieces, sign: Array) -> Density:
    """The contact force counted positive where the cylinder pushes; sign: (B,), of `Case.outward`."""
    found = outward(pieces)
    return replace(found, values=found.values * sign[pieces.case, None])


def rate(pieces: Pieces) -> Array:
    """An upper bound of the change of beta_t for a unit change of beta, (Q, 1)."""
    loads = _loads(pieces)
    return np.sqrt(steepest(loads))


def _loads(pieces: Pieces) -> Loads:
    """The loads of each piece as columns, (Q, 1); where they vary, at the nodes, (Q, m)."""
    if pieces.varying is not None:
        return Loads(*pieces.varying[:3])
    return Loads.columns(pieces.problem, pieces.case)


@dataclass(frozen=True, eq=False)
class Rates:
    """The derivatives of a density with respect to beta, |beta_t|, lam, mu and phi, (Q, m) each or a number."""

    beta: Array
    speed: Array
    lam: Array | float = 0.0
    mu: Array | float = 0.0
    phi: Array | float = 0.0


def _angle(at: Angles, loads: Loads) -> Rates:
    return Rates(np.ones_like(at.beta), np.zeros_like(at.beta))


def _curvature(at: Angles, loads: Loads) -> Rates:
    s, c, v = at.sin, at.cos, at.speed
    kappa = np.hypot(v, s * s)
    with np.errstate(invalid="ignore"):  # no derivative where the rod is straight
        return Rates(2 * s * c * (s * s / kappa), v / kappa)


def _bending(at: Angles, loads: Loads) -> Rates:
    s, c = at.sin, at.cos
    return Rates(2 * s * s * s * c, at.speed)


def _potential(at: Angles, loads: Loads) -> Rates:
    s, c = at.sin, at.cos
    moved = 2 * s * s * s * c + loads.mu * (c - s) * (c + s) + loads.phi * s - loads.lam * c
    return Rates(moved, at.speed, -s, s * c, -c)


def _outward(at: Angles, loads: Loads) -> Rates:
    s, c, v = at.sin, at.cos, at.speed
    cos2, lever = (c - s) * (c + s), 3 * s * c - loads.mu
    even, twist, rest = slope_terms(loads, s, c)
    H = even + twist - rest
    moved = c * (loads.lam - loads.mu * c - s**3) + s * (loads.mu * s - 3 * s * s * c) + 12 * v * v * s * c
    moved = moved + slope_rate_of(loads, s, c) * lever + 3 * H * cos2
    return Rates(moved, -6 * v * cos2, s + c * lever, -s * c - cos2 * lever - H, -s * lever)


def _tension(at: Angles, loads: Loads) -> Rates:
    s, c = at.sin, at.cos
    moved = -loads.phi * s + c * (loads.lam - loads.mu * c - s**3) + s * (loads.mu * s - 3 * s * s * c)
    return Rates(moved, np.zeros_like(s), s, -s * c, c)


RATES: dict[Callable[..., Density], Callable[[Angles, Loads], Rates]] = {
    angle: _angle,
    curvature: _curvature,
    bending: _bending,
    potential: _potential,
    outward: _outward,
    tension: _tension,
}
