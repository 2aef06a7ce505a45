"""The critical points of G by the compiled core: `critical_points.c`."""

from dataclasses import dataclass

import numpy as np

from ..mechanics.potential import HasLoads
from ..numerics.arrays import Array, Booleans, Integers
from .library import fine, on_grid, run

_MOST = 16  # critical points of a problem


@dataclass(frozen=True, eq=False)
class CriticalPoints:
    """The critical points of G in [-pi, pi) of B problems, rising; padded to (B, K) with NaN.

    beta: (B, K). centre: (B, K), whether each is a minimum of G; they alternate. count: (B,), even, at least 2.
    A saddle and a centre may share an angle, where H only touches zero: under twist alone, at beta = 0 or pi.
    """

    beta: Array
    centre: Booleans
    count: Integers


def critical_points(problem: HasLoads) -> CriticalPoints:
    """All critical points of G, which are the helices of the loads: the roots of H, found as sign changes on a grid and
    refined inside their brackets. None, a count of 0, where a load is not finite."""
    loads = np.stack([problem.lam, problem.mu, problem.phi], axis=1)
    every = _critical_points(loads)
    if every is None:  # all are refused for the sake of those that are not finite
        fit = np.array([_critical_points(load[None]) is not None for load in loads])
        every = _critical_points(np.where(fit[:, None], loads, 0.0))
        assert every is not None
        every.beta[~fit], every.centre[~fit], every.count[~fit] = np.nan, False, 0
    return every


def _critical_points(loads: Array) -> CriticalPoints | None:
    """Those of loads (B, 3); None where one is not finite, or critical points could not be told apart."""
    B = loads.shape[0]
    beta, centre = np.full((B, _MOST), np.nan), np.zeros((B, _MOST), np.bool_)
    count = np.empty(B, np.int64)
    if not fine(run("rod_critical_points", B, loads, on_grid(), beta, centre, count)):
        return None
    most = int(count.max(initial=0))
    return CriticalPoints(beta[:, :most], centre[:, :most], count)
