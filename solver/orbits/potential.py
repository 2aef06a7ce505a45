"""The potential G of the angle beta, H = G'/2, and the derivatives of H: eqs. (32) and (35), corrected.

Dimensionless throughout, lengths in units of rho: beta_t^2 + G(beta) = eta and beta_tt = -H(beta). A minimum of G is a
centre (an orbit next to it oscillates), a maximum is a saddle.

H stands here and nowhere else, but for four forms that serve one algorithm each: `methods.adaptive` (scalars,
and symbols), `methods.difference` (fewest operations) and `core` (power series). A test compares them.
"""

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from ..numerics.arrays import Array

TAU = 2 * np.pi


class HasLoads(Protocol):
    """Anything with the three dimensionless loads: `Loads`, or a problem, whose loads are (B,)."""

    @property
    def lam(self) -> Any: ...
    @property
    def mu(self) -> Any: ...
    @property
    def phi(self) -> Any: ...


@dataclass(frozen=True, eq=False)
class Loads:
    """The dimensionless loads lam = MZ rho/A, mu = M3 rho/A, phi = FZ rho^2/A, in the shape that a formula needs."""

    lam: Any
    mu: Any
    phi: Any

    @classmethod
    def columns(cls, problem: HasLoads, rows: Any = slice(None)) -> "Loads":
        """The loads of the problems `rows` as columns, (rows, 1), to broadcast against stations."""
        return cls(problem.lam[rows, None], problem.mu[rows, None], problem.phi[rows, None])


def potential(loads: HasLoads, beta: Any) -> Any:
    """G(beta), eq. (32), corrected.

    Parameters
    ----------
    loads : Loads or Reduced
        lam, mu, phi, which broadcast against `beta`.
    beta : array
        Angle from the axis to the tangent [rad].

    Returns
    -------
    array
        G in units of 1/rho^2.
    """
    s, c = np.sin(beta), np.cos(beta)
    return (2 * (loads.lam - loads.mu * c) - s**3) * s + 2 * loads.phi * c


def slope(loads: HasLoads, beta: Any) -> Any:
    """H(beta) = G'(beta)/2, eq. (35), corrected; parameters as in `potential`.

    Written so that lam and mu cancel exactly about beta = 0 and beta = pi.
    """
    even, twist, rest = slope_terms(loads, np.sin(beta), np.cos(beta))
    return even + twist - rest


def slope_terms(loads: HasLoads, s: Any, c: Any) -> tuple[Any, Any, Any]:
    """The three terms of H = first + second - third, from sin and cos of beta."""
    s2, size = s * s, np.abs(c)
    even = (loads.lam - np.where(c < 0, -loads.mu, loads.mu)) * c
    # the rest of lam cos(beta) - mu cos(2 beta): |cos(beta)| - cos(2 beta), without a difference
    return even, loads.mu * (s2 * (1 + 2 * size) / (1 + size)), (loads.phi + 2 * c * s2) * s


def slope_rate(loads: HasLoads, beta: Any) -> Any:
    """H'(beta); parameters as in `potential`. Positive at a centre, negative at a saddle."""
    return slope_rate_of(loads, np.sin(beta), np.cos(beta))


def slope_rate_of(loads: HasLoads, s: Any, c: Any) -> Any:
    """H'(beta) from sin and cos of beta."""
    return -loads.lam * s + 4 * loads.mu * s * c - loads.phi * c - 2 * s * s * (3 * c * c - s * s)


def slope_higher_rates(loads: HasLoads, beta: Any) -> tuple[Any, Any]:
    """The second and the third derivative of H."""
    s, c = np.sin(beta), np.cos(beta)
    s2, c2 = 2 * s * c, (c - s) * (c + s)
    s4, c4 = 2 * s2 * c2, (c2 - s2) * (c2 + s2)
    # 2 cos sin^3 = sin(2b)/2 - sin(4b)/4
    second = -loads.lam * c + 4 * loads.mu * c2 + loads.phi * s + 2 * s2 - 4 * s4
    third = loads.lam * s - 8 * loads.mu * s2 + loads.phi * c + 4 * c2 - 16 * c4
    return second, third


def slopes_by_loads(beta: Array) -> Array:
    """The derivatives of H with respect to lam, mu and phi at beta (P, n), (P, 3, n)."""
    return np.stack([np.cos(beta), -np.cos(2 * beta), -np.sin(beta)], axis=1)


def load_size(loads: HasLoads) -> Any:
    """|lam| + |mu| + |phi|; with 1 added a bound of |G|/2 and of |H| up to a factor."""
    return np.abs(loads.lam) + np.abs(loads.mu) + np.abs(loads.phi)


def steepest(loads: HasLoads) -> Any:
    """An upper bound of |H'| over all angles."""
    return np.abs(loads.lam) + 2 * np.abs(loads.mu) + np.abs(loads.phi) + 2


def dimensional_slope(l: Any, m: Any, p: Any, rho: Any, beta: Array) -> Array:
    """H [1/length^2] from l = MZ/A, m = M3/A [1/length], p = FZ/A [1/length^2] and rho [length]; eq. (35), corrected.

    The contact force that is stored was computed by this form; `slope(loads, beta) / rho**2` differs by rounding.
    """
    s, c = np.sin(beta), np.cos(beta)
    return (l * c - m * np.cos(2 * beta)) / rho - (p + 2 * c * s * s / rho**2) * s
