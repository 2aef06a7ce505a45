"""Integrals along an orbit that grow by the same amount each period, and the energy, made of one of them."""

from typing import Any

import numpy as np

from ..core import orbits as core
from ..numerics.arrays import Array
from .panels import running
from .phase import unfold
from .pieces import HELIX, LIBRATION


def accumulate(orbit: Any, series: Array, t: Array) -> Array:
    """The value at t (B, n) of an integral from the start; 0 on a helix.

    series: (P, n + 1), the integral on each panel from the panel's near end.
    """
    ends = series.sum(axis=1)
    gain = np.bincount(orbit.panels.arc, weights=ends, minlength=2 * orbit.problem.size).reshape(-1, 2)
    series = series.copy()
    series[:, 0] += running(ends[:, None], orbit.first, orbit.count)[:, 0]
    phase = orbit.locate(t)
    value = unfold(orbit.read(series[:, None], phase)[..., 0], phase, gain, (orbit.kind == LIBRATION)[:, None])
    return np.where((orbit.kind == HELIX)[:, None], 0.0, value)


def action(orbit: Any) -> Array:
    """The integral of beta_t^2 over the rod, (B,): exact on each panel, and a sum of positive terms."""
    return core.action(orbit)


def energies(orbit: Any, level: Array) -> Array:
    """Bending energy minus the work of the dead loads, the twist eliminated, in units of A/rho, (B,).

    beta_t^2/2 - G/2 integrated over the rod is the action less level span/2, level = eta (B,). Both terms are exact to
    a few roundings, so the error of the energy is a few roundings of the larger one.
    """
    return action(orbit) - level * orbit.problem.span / 2
