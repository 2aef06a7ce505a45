"""The partial derivatives of the densities, by which the derivatives of observables are computed."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..mechanics.potential import Loads, slope_rate_of, slope_terms
from ..numerics.arrays import Array
from . import densities
from .densities import Density
from .rod_pieces import Angles


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
    densities.angle: _angle,
    densities.curvature: _curvature,
    densities.bending: _bending,
    densities.potential: _potential,
    densities.outward: _outward,
    densities.tension: _tension,
}
