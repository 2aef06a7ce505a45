"""The algebra of the potential G: what it is, and (below) where it turns.

Dimensionless throughout (lengths in rho): beta_t^2 + G(beta) = eta, beta_tt = -H(beta), H = G'/2; eqs. (32), (35).
"""

from typing import Any

import numpy as np

from .reduced import Reduced


def potential(problem: Reduced, beta: Any) -> Any:
    """G(beta), eq. (32) corrected; beta broadcasts against the problems' (B,)."""
    s, c = np.sin(beta), np.cos(beta)
    return (2 * (problem.lam - problem.mu * c) - s**3) * s + 2 * problem.phi * c


def slope(problem: Reduced, beta: Any) -> Any:
    """H(beta) = G'/2, eq. (35) corrected."""
    s, c = np.sin(beta), np.cos(beta)
    return problem.lam * c - problem.mu * (c - s) * (c + s) - (problem.phi + 2 * c * s * s) * s


def slope_rate(problem: Reduced, beta: Any) -> Any:
    """H'(beta): positive about a centre, negative about a saddle."""
    s, c = np.sin(beta), np.cos(beta)
    return -problem.lam * s + 4 * problem.mu * s * c - problem.phi * c - 2 * s * s * (3 * c * c - s * s)
