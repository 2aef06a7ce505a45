"""The critical points of G (the roots of H): every helix of the given loads, centres and saddles, none missed."""

from dataclasses import dataclass
from functools import cache

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


@cache
def grid() -> tuple[Array, Array]:
    """Angles and H, H' there as linear functions of (lam - mu, lam + mu, mu, phi, 1): (M,), (5, 2 M).

    Even spacing leaves at most one pair of roots of H in a cell; small loads gather three roots about beta = 0 and
    beta = pi, which points in geometric progression separate.
    """
    near = 2.0 ** -np.arange(6, 42)
    even = np.linspace(-np.pi, np.pi, 193)[:-1] + 1e-3
    angles = np.sort(np.concatenate([even, near, -near, [0.0], near - np.pi, np.pi - near]))
    s, c = np.sin(angles), np.cos(angles)
    up, size = c > 0, np.abs(c)
    bent = s * s * (1 + 2 * size) / (1 + size)
    value = [c * up, c * ~up, bent, -s, -2 * c * s**3]
    rate = [-s * up, -s * ~up, np.where(up, -s, s) + 2 * np.sin(2 * angles), -c, -2 * s * s * (3 * c * c - s * s)]
    return angles, np.ascontiguousarray(np.hstack([value, rate]))


def critical_points(problem: Reduced) -> CriticalPoints:
    """All critical points of G: the roots of H, found as sign changes on a grid and refined inside their brackets.

    None, a count of 0, where a load is not finite.
    """
    loads = np.stack([problem.lam, problem.mu, problem.phi], axis=1)
    found = core.critical_points(loads, grid())
    if found is None:
        fit = np.array([core.critical_points(one[None], grid()) is not None for one in loads])[:, None]
        found = core.critical_points(np.where(fit, loads, 0.0), grid())
        assert found is not None
        beta, centre, count = found
        found = np.where(fit, beta, np.nan), centre & fit, np.where(fit[:, 0], count, 0)
    return CriticalPoints(*found)
