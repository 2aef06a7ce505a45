"""The critical points of G (the roots of H): every helix of the given loads, centres and saddles, none missed."""

from dataclasses import dataclass

import numpy as np

from ..core import orbits as core
from ..numerics.arrays import Array, Booleans, Integers
from ..problem.reduced import Reduced


@dataclass(frozen=True, eq=False)
class CriticalPoints:
    """The critical points of G in [-pi, pi) of B problems, rising; padded to (B, K) with NaN.

    beta: (B, K). centre: (B, K), whether each is a minimum of G; they alternate. count: (B,), even, at least 2.
    A saddle and a centre may share an angle, where H only touches zero: under twist alone, at beta = 0 or pi.
    """

    beta: Array
    centre: Booleans
    count: Integers


def critical_points(problem: Reduced) -> CriticalPoints:
    """All critical points of G: the roots of H, found as sign changes on a grid and refined inside their brackets.

    None, a count of 0, where a load is not finite.
    """
    loads = np.stack([problem.lam, problem.mu, problem.phi], axis=1)
    found = core.critical_points(loads)
    if found is None:
        fit = np.array([core.critical_points(load[None]) is not None for load in loads])[:, None]
        found = core.critical_points(np.where(fit, loads, 0.0))
        assert found is not None
        beta, centre, count = found
        found = np.where(fit, beta, np.nan), centre & fit, np.where(fit[:, 0], count, 0)
    return CriticalPoints(*found)
