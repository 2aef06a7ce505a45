"""The condition number of an equilibrium between given ends: how beta responds to a change of beta(L)."""

from typing import Any

import numpy as np

from ..core import orbits as core
from ..core.panels import available
from ..mechanics.potential import load_size, slope, slope_rate
from ..numerics.arrays import Array
from ..numerics.chebyshev import basis
from ..orbit.conditioning import flow_at_nodes, shear
from ..orbit.orbit_energy import accumulated
from ..orbit.panels import running
from ..orbit.pieces import HELIX, LIBRATION
from ..problem.reduced import Reduced
from .stability import diagonal_of


def end_response(orbit: Any) -> Array:
    """The largest |d beta(t)/d beta(L)| = |eta(t)/eta(L)| along B orbits whose beta(0) is held.

    eta as in `stability.jacobi_end`, at the nodes of all panels that the rod passes, in its first period and in its
    last: between them eta grows evenly.

    Returns
    -------
    array (B,)
        At least 1; unbounded at a fold.
    """
    return core.response(orbit) if available() else reference_response(orbit)


def reference_response(orbit: Any) -> Array:
    """The same without the core."""
    problem, panels = orbit.problem, orbit.panels
    worst = np.where(orbit.kind == HELIX, _helix_response(problem), 1.0)
    if not panels.arc.size:
        return worst
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        unit = np.sqrt(load_size(problem) + 1)
        series = shear(problem, panels, unit)
        v0, H0 = problem.dbeta0 / unit, slope(problem, problem.beta0) / unit**2
        fixed = -H0 / (v0 * v0 + H0 * H0)
        largest = _largest_on_panels(orbit, unit, series, v0, fixed)
        far = problem.span[:, None]
        a = accumulated(orbit, series, far)[:, 0]
        beta, v, _, _ = (value[:, 0] for value in orbit.at(far))
        v, H = v / unit, slope(problem, beta) / unit**2
        eta = (fixed + v0 * a) * v + v0 * (H / (v * v + H * H))
        ratio, b = np.zeros(problem.size), panels.arc // 2
        np.maximum.at(ratio, b, largest / np.abs(eta)[b])
    moves = orbit.kind != HELIX
    worst[moves] = np.where(np.isfinite(ratio), np.maximum(ratio, 1), np.inf)[moves]
    return worst


def _largest_on_panels(orbit: Any, unit: Array, series: Array, v0: Array, fixed: Array) -> Array:
    """The largest |eta| at the nodes of each panel, (P,), where the rod passes them.

    unit, v0, fixed: (B,), of time, beta_t(0) in it, and c of `jacobi_end`. series: (P, n + 1), the shear.
    """
    problem, panels = orbit.problem, orbit.panels
    points, b, second = basis(panels.series.shape[2] - 1), panels.arc // 2, panels.arc % 2 == 1
    folded = orbit.kind == LIBRATION
    v, H, _ = flow_at_nodes(problem, panels, unit)
    ends = series.sum(axis=1)
    total = np.bincount(panels.arc, weights=ends, minlength=2 * problem.size).reshape(-1, 2)
    grown = series @ points.values + running(ends[:, None], orbit.first, orbit.count)
    clock = orbit.since[:, None] + (panels.duration / 2)[:, None] * (1 + points.nodes)
    ahead, whole = orbit.ahead[b, None], (orbit.ahead + orbit.back)[b, None]
    late, there = second[:, None], total[b, :1]
    limit = np.where(late, total[b, 1:], there)
    periods = np.floor(problem.span / orbit.period)[b, None]
    a_period = np.where(folded, 2 * total.sum(axis=1), total[:, 0])[b, None]
    sign = (orbit.arcs.direction[b] * np.where(second, -1, 1))[:, None]
    largest = np.zeros(b.size)
    for returns, time, a in (
        (False, np.where(late, 2 * ahead, 0) + clock, np.where(late, 2 * there, 0) + grown),
        (True, np.where(late, 2 * whole, 2 * ahead) - clock, np.where(late, 2 * there, 0) + 2 * limit - grown),
    ):
        passed = ((time <= problem.span[b, None]) | (periods > 0)) & (folded[b, None] | (not returns))
        direction = -sign if returns else sign
        last = np.maximum(periods - (time + periods * orbit.period[b, None] > problem.span[b, None]), 0)
        for many in (0 * last, last):
            along = (fixed[b, None] + v0[b, None] * (a + a_period * many)) * direction
            eta = along * v + v0[b, None] * (H / (v * v + H * H))
            largest = np.maximum(largest, np.where(passed, np.abs(eta), 0).max(axis=1))
    return largest


def _helix_response(problem: Reduced) -> Array:
    """The same about a constant angle: waves about a centre, 1 about a saddle, (B,)."""
    rate = slope_rate(problem, problem.beta0)
    waves = np.sqrt(np.maximum(rate, 0)) * problem.span
    with np.errstate(divide="ignore"):
        return np.where(waves > np.pi / 2, 1 / np.abs(np.sin(waves)), 1.0)


def response(problem: Reduced, h: Array, beta: Array) -> Array:
    """The largest |d beta(t)/d beta(L)| of equilibria known on a mesh alone, (B,).

    The solution of the tridiagonal system whose far end is moved by one; arguments as in `stability.morse_index`.
    """
    import scipy

    diagonal = diagonal_of(problem, h, beta)
    largest = np.ones(beta.shape[0])
    beside, moved = np.full(diagonal.shape[1] - 1, -1.0), np.zeros(diagonal.shape[1])
    moved[-1] = 1
    for i in range(beta.shape[0]):
        eta, info = scipy.linalg.lapack.dgtsv(beside, diagonal[i], beside, moved)[3:]
        largest[i] = np.maximum(1, np.abs(eta).max()) if info == 0 else np.inf
    return np.where(np.isfinite(largest), largest, np.inf)
