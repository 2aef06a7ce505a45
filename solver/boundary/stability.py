"""The second variation of an equilibrium between given ends, as the tridiagonal matrix of -eta'' - H'(beta) eta.

Both beta(0) and beta(L) are held, FZ, MZ and M3 are dead loads and the positions of the ends are free: an equilibrium
with no negative direction here is stable in that sense. Clamping the positions as well would forbid some directions,
so it could only make more shapes stable.

The index is counted in two ways that share nothing: negative pivots of that matrix on a mesh, and zeros of the Jacobi
field, known from the orbit itself. The pivots lose the rod that stays near a saddle for long: what it does after
that hangs on digits that no mesh keeps.
"""

from typing import Any

import numpy as np
import scipy

from ..mechanics.potential import Loads, slope, slope_rate
from ..numerics.arrays import Array
from ..numerics.chebyshev import basis
from ..orbit.conditioning import _flow as flow
from ..orbit.conditioning import shear
from ..orbit.orbit_energy import accumulated
from ..orbit.panels import running
from ..orbit.pieces import HELIX, LIBRATION
from ..problem.reduced import Reduced

_MOST = 40_000  # steps of a mesh


def morse_index(problem: Reduced, h: Array, beta: Array) -> Array:
    """Negative pivots of the Hessian at beta (B, n) on equal steps h (B,): the number of unstable directions, (B,)."""
    diagonal = _diagonal(problem, h, beta)
    index = np.zeros(beta.shape[0], dtype=np.int64)
    pivot = np.full(beta.shape[0], np.inf)
    for k in range(diagonal.shape[1]):
        pivot = diagonal[:, k] - 1 / pivot
        pivot = np.where(pivot == 0, 1e-300, pivot)
        index += pivot < 0
    return index


def index_at_stations(problem: Reduced, t: Array, beta: Array, rate: Array) -> Array:
    """Negative pivots of shapes known at stations t alone, beta and beta_t (B, n), as floats (B,).

    NaN where the stations are too few to tell: fewer than twelve to the quickest wave that H' allows, or every other
    one of them gives another number.
    """
    column = Loads.columns(problem)
    index = np.full(problem.size, np.nan)
    with np.errstate(invalid="ignore", over="ignore"):
        quickest = np.sqrt(np.abs(slope_rate(column, beta)).max(axis=1))
        told = np.diff(t, axis=1).max(axis=1) * quickest <= 0.5
        told &= (t[:, 0] == 0) & (t[:, -1] >= problem.span * (1 - 1e-12))
        steps = 2 * np.maximum(12 * problem.span * quickest, 400)
    for i in np.flatnonzero(told & (steps <= _MOST) & (t.shape[1] >= 5)):
        counts = []
        for some in (slice(None), np.unique([*range(0, t.shape[1], 2), t.shape[1] - 1])):
            n = int(steps[i])
            even = np.linspace(0, problem.span[i], n + 1)
            shape = scipy.interpolate.CubicHermiteSpline(t[i, some], beta[i, some], rate[i, some])(even)
            one = problem.take(slice(i, i + 1))
            counts.append(int(morse_index(one, problem.span[i : i + 1] / n, shape[None])[0]))
        index[i] = counts[0] if counts[0] == counts[1] else np.nan
    return index


def jacobi_zeros(orbit: Any) -> Array:
    """Zeros inside (0, L) of eta'' + H'(beta) eta = 0, eta(0) = 0, eta'(0) = 1, on B orbits: the Morse index, (B,);
    NaN where a float cannot hold what decides it.

    No march: beta_t solves the same equation, so by Sturm eta has one zero between each two of its zeros, the turning
    points. Whether another follows the last of them is told by the sign of eta(L) = d beta(L)/d beta_t(0), which is
    that of -2 beta_t(0) beta_t(L) dT/d(level), T being the length of the orbit between the two angles. Exact however
    long the rod and however closely it hugs a saddle. The search for equilibria knows the sign of dT/d(level); for
    other orbits `jacobi_end` tells that of eta(L).
    """
    problem, turns = orbit.problem, orbit.turns
    swings = orbit.kind == LIBRATION
    shorter = np.full(problem.size, np.nan) if orbit.lengthens is None else 1 - orbit.lengthens
    if np.isnan(shorter[swings]).any():
        end = np.where(turns % 2 == 0, 1, -1) * jacobi_end(orbit)
        shorter = np.where(np.isnan(shorter), np.where(np.isnan(end), np.nan, end > 0), shorter)
    with np.errstate(invalid="ignore"):
        rate = slope_rate(problem, problem.beta0)
        waves = np.ceil(np.sqrt(np.maximum(rate, 0)) * problem.span / np.pi * (1 - 1e-12)) - 1
    at_rest = orbit.back == 0  # eta is beta_t itself
    index = np.maximum(turns - 1 + np.where(at_rest, 1, shorter), 0)
    return np.where(orbit.kind == HELIX, np.maximum(waves, 0), np.where(swings, index, 0))


def jacobi_end(orbit: Any) -> Array:
    """eta(L) of B orbits that swing, (B,), in some unit of time; NaN for others and where a float cannot hold it.

    eta = (c + beta_t(0) a) beta_t + beta_t(0) H / (beta_t^2 + H^2), with c = -H(0) / (beta_t(0)^2 + H(0)^2) and the
    shear a(t) of `sensitivity`, which grows by the same amount each period.
    """
    problem, panels, swings = orbit.problem, orbit.panels, orbit.kind == LIBRATION
    eta = np.full(problem.size, np.nan)
    if not swings.any():
        return eta
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        unit = np.where(swings, np.pi / (orbit.ahead + orbit.back), 1.0)  # in which a small swing has no shear
        series = shear(problem, panels, unit)
        ends = series.sum(axis=1)
        total = np.bincount(panels.arc, weights=ends, minlength=2 * problem.size).reshape(-1, 2)
        series[:, 0] += running(ends[:, None], orbit.first, orbit.count)[:, 0]
        where = orbit.locate(problem.span[:, None])
        a = orbit.read(series[:, None], where)[:, 0, 0]
        second, mirrored = where.second[:, 0], where.mirrored[:, 0]
        limit = np.where(second, total[:, 1], total[:, 0])
        a = np.where(mirrored, 2 * limit - a, a) + np.where(second, 2 * total[:, 0], 0)
        a = a + where.rounds[:, 0] * 2 * total.sum(axis=1)
        beta, v, _, _ = (value[:, 0] for value in orbit.at(problem.span[:, None]))
        v0, H0 = problem.dbeta0 / unit, slope(problem, problem.beta0) / unit**2
        v, H = v / unit, slope(problem, beta) / unit**2
        found = (v0 * a - H0 / (v0 * v0 + H0 * H0)) * v + v0 * (H / (v * v + H * H))
    eta[swings] = found[swings]
    return eta


def end_response(orbit: Any) -> Array:
    """Largest |d beta(t)/d beta(L)| = |eta(t)/eta(L)| along B orbits whose beta(0) is held, (B,), at least 1.

    eta as in `jacobi_end`, at the nodes of all panels that the rod meets, in the first round and in the last: between
    them it grows evenly. Unbounded at a fold.
    """
    problem, panels = orbit.problem, orbit.panels
    worst = np.where(orbit.kind == HELIX, _helix_response(problem), 1.0)
    if not panels.arc.size:
        return worst
    points, b, second = basis(panels.series.shape[2] - 1), panels.arc // 2, panels.arc % 2 == 1
    folded = orbit.kind == LIBRATION
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        unit = np.sqrt(np.abs(problem.lam) + np.abs(problem.mu) + np.abs(problem.phi) + 1)
        v, H, _ = flow(problem, panels, unit)
        series = shear(problem, panels, unit)
        ends = series.sum(axis=1)
        total = np.bincount(panels.arc, weights=ends, minlength=2 * problem.size).reshape(-1, 2)
        grown = series @ points.values + running(ends[:, None], orbit.first, orbit.count)
        v0, H0 = problem.dbeta0 / unit, slope(problem, problem.beta0) / unit**2
        fixed = -H0 / (v0 * v0 + H0 * H0)
        clock = orbit.since[:, None] + (panels.duration / 2)[:, None] * (1 + points.nodes)
        ahead, whole = orbit.ahead[b, None], (orbit.ahead + orbit.back)[b, None]
        late, there = second[:, None], total[b, :1]
        limit = np.where(late, total[b, 1:], there)
        rounds = np.floor(problem.span / orbit.period)[b, None]
        a_round = np.where(folded, 2 * total.sum(axis=1), total[:, 0])[b, None]
        sign = (orbit.arcs.direction[b] * np.where(second, -1, 1))[:, None]
        largest = np.zeros(b.size)
        for time, a, way in (
            (np.where(late, 2 * ahead, 0) + clock, np.where(late, 2 * there, 0) + grown, sign),
            (np.where(late, 2 * whole, 2 * ahead) - clock, np.where(late, 2 * there, 0) + 2 * limit - grown, -sign),
        ):
            met = (time <= problem.span[b, None]) | (rounds > 0)
            if way is not sign:
                met = met & folded[b, None]
            last = np.maximum(rounds - (time + rounds * orbit.period[b, None] > problem.span[b, None]), 0)
            for many in (0 * last, last):
                along = (fixed[b, None] + v0[b, None] * (a + a_round * many)) * way
                eta = along * v + v0[b, None] * (H / (v * v + H * H))
                largest = np.maximum(largest, np.where(met, np.abs(eta), 0).max(axis=1))
        far = problem.span[:, None]
        a = accumulated(orbit, series, far)[:, 0]
        beta, v, _, _ = (value[:, 0] for value in orbit.at(far))
        v, H = v / unit, slope(problem, beta) / unit**2
        eta = (fixed + v0 * a) * v + v0 * (H / (v * v + H * H))
        ratio = np.zeros(problem.size)
        np.maximum.at(ratio, b, largest / np.abs(eta)[b])
    moves = orbit.kind != HELIX
    worst[moves] = np.where(np.isfinite(ratio), np.maximum(ratio, 1), np.inf)[moves]
    return worst


def _helix_response(problem: Reduced) -> Array:
    """The same about a constant angle: waves about a centre, 1 about a saddle, (B,)."""
    rate = slope_rate(problem, problem.beta0)
    waves = np.sqrt(np.maximum(rate, 0)) * problem.span
    with np.errstate(divide="ignore"):
        return np.where(waves > np.pi / 2, 1 / np.abs(np.sin(waves)), 1.0)


def response(problem: Reduced, h: Array, beta: Array) -> Array:
    """Largest |d beta(t)/d beta(L)| of equilibria known on a mesh alone, (B,); unbounded at a fold, else 1 or so.

    The solution of the tridiagonal system whose far end is moved by one.
    """
    diagonal = _diagonal(problem, h, beta)
    largest = np.ones(beta.shape[0])
    beside, moved = np.full(diagonal.shape[1] - 1, -1.0), np.zeros(diagonal.shape[1])
    moved[-1] = 1
    for i in range(beta.shape[0]):
        eta, info = scipy.linalg.lapack.dgtsv(beside, diagonal[i], beside, moved)[3:]
        largest[i] = np.maximum(1, np.abs(eta).max()) if info == 0 else np.inf
    return np.where(np.isfinite(largest), largest, np.inf)


def _diagonal(problem: Reduced, h: Array, beta: Array) -> Array:
    column = Loads.columns(problem)
    return 2 - h[:, None] ** 2 * slope_rate(column, beta[:, 1:-1])
