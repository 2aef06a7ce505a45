"""The search for every orbit that joins two angles over a given length: one equation a path, the level unknown."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.optimize import elementwise

from .landscape import extrema, slope
from .levels import DOWN, UP, Ladder, Ways, ladders, many, ways
from .methods.orbit import Orbit, solve_orbit
from .reduced import Array, Reduced

_PATHS = ((UP, UP), (UP, DOWN), (DOWN, UP), (DOWN, DOWN))
_LOOSE, _MIDDLE, _TIGHT = 1e-5, 1e-10, 1e-13
_ZOOM = 33


@dataclass(frozen=True)
class Bracket:
    """Between which rungs of log|gap| an orbit's length passes the rod's: along which path, how many whole swings."""

    pin: float
    sign: float
    low: float
    high: float
    leaving: int
    arriving: int
    swings: int


def search(problem: Reduced, most_swings: int = 200) -> tuple[Array, Orbit | None]:
    """beta_t(0) of every solution of one ends problem, (K,), and their orbits; None where there is none."""
    found = [b for ladder in ladders(problem, extrema(problem)) for b in _brackets(problem, ladder, most_swings)]
    pin, gap, leaving = _closed_in(problem, found) if found else (np.empty(0),) * 3
    pin, gap, leaving = _with_helix(problem, pin, gap, leaving)
    kept = _distinct(pin, gap, leaving)
    if not kept:
        return np.empty(0), None
    pin, gap, leaving = pin[kept], gap[kept], leaving[kept]
    start = many(problem, leaving.size).started(leaving)
    orbit = solve_orbit(start, _TIGHT, (pin, gap))
    assert problem.betaL is not None
    arrived = np.abs(orbit.at(start.span[:, None])[0][:, 0] - problem.betaL[0]) < 1e-6
    if not arrived.any():
        return np.empty(0), None
    if not arrived.all():
        orbit = solve_orbit(start.take(arrived), _TIGHT, (pin[arrived], gap[arrived]))
    return leaving[arrived], orbit


def _brackets(problem: Reduced, ladder: Ladder, most_swings: int) -> Iterator[Bracket]:
    """Where on a ladder the length of some path passes the rod's."""
    assert problem.betaL is not None
    seen, _ = ways(problem, np.full(ladder.y.size, ladder.pin), ladder.sign * np.exp(ladder.y), _LOOSE)
    span, turning = problem.span[0], ~np.isnan(seen.direct)
    periods = seen.period[~np.isnan(seen.period)]
    most = min(most_swings, int(span / periods.min()) + 1) if periods.size else 0
    sense = UP if problem.betaL[0] > problem.beta0[0] else DOWN
    for leaving, arriving in _PATHS:
        for swings in range(most + 1):
            length = seen.length(leaving, arriving, swings)
            # an orbit that turns all the way has one path; a path of no length is none
            plain = swings == 0 and leaving == arriving == sense
            length = np.where((length <= 0) | (turning & (not plain)), np.nan, length)
            for low, high in _crossings(problem, ladder, length - span, (leaving, arriving, swings)):
                yield Bracket(ladder.pin, ladder.sign, low, high, leaving, arriving, swings)


def _crossings(problem: Reduced, ladder: Ladder, off: Array, path: tuple[int, int, int]) -> list[tuple[float, float]]:
    """Pairs of y between which `off` changes sign, the two of a fold between two rungs among them."""
    y, size = ladder.y, np.abs(off)
    with np.errstate(invalid="ignore"):
        pairs = [(float(y[k + 1]), float(y[k])) for k in np.flatnonzero(off[:-1] * off[1:] < 0)]
        same = (off[1:-1] * off[:-2] > 0) & (off[1:-1] * off[2:] > 0)
        dips = np.flatnonzero(same & (size[1:-1] < size[:-2]) & (size[1:-1] <= size[2:])) + 1
        # the bottom of a dip lies below its lowest rung by a fraction of the rise to the next ones
        bottom = size[dips] - 0.25 * np.maximum(size[dips - 1] - size[dips], size[dips + 1] - size[dips])
    for k in dips[bottom < 0]:
        low, high = float(y[k + 1]), float(y[k - 1])
        tip = _dip(problem, ladder, path, low, high, float(np.sign(off[k])))
        if tip is not None:
            pairs += [(low, tip), (tip, high)]
    return pairs


def _dip(
    problem: Reduced, ladder: Ladder, path: tuple[int, int, int], low: float, high: float, sign: float
) -> float | None:
    """Where between two rungs the length passes the rod's and comes back, if it does."""
    for _ in range(3):
        y = np.linspace(low, high, _ZOOM)
        seen, _ = ways(problem, np.full(_ZOOM, ladder.pin), ladder.sign * np.exp(y), _MIDDLE)
        off = sign * (seen.length(*path) - problem.span[0])
        if np.isnan(off).all():
            return None
        k = int(np.nanargmin(off))
        if off[k] < 0:
            return float(y[k])
        if not 0 < k < _ZOOM - 1:
            return None
        low, high = y[k - 1], y[k + 1]
    return None


def _closed_in(problem: Reduced, found: list[Bracket]) -> tuple[Array, Array, Array]:
    """Pin, gap and beta_t(0) of the solution in each bracket, (K,) each; NaN where there turned out to be none."""
    pin, sign = np.array([b.pin for b in found]), np.array([b.sign for b in found])
    path = np.array([(b.leaving, b.arriving, b.swings) for b in found])

    def seen_at(y: Array, i: Array) -> tuple[Ways, Array]:
        return ways(problem, pin[i], sign[i] * np.exp(y), _TIGHT)

    def off(y: Array, which: Array) -> Array:
        i = which.astype(int)
        return seen_at(y, i)[0].length(*path[i].T) - problem.span[0]

    between = np.array([b.low for b in found]), np.array([b.high for b in found])
    which = np.arange(pin.size, dtype=float)
    tolerances = {"xatol": 1e-14, "xrtol": 1e-15}
    y = elementwise.find_root(off, between, args=(which,), tolerances=tolerances, maxiter=60).x
    _, v2 = seen_at(y, np.arange(pin.size))
    return pin, sign * np.exp(y), path[:, 0] * np.sqrt(np.where(v2 > 0, v2, np.nan))


def _with_helix(problem: Reduced, pin: Array, gap: Array, leaving: Array) -> tuple[Array, Array, Array]:
    """The rod that lies as a helix from end to end, which has no level to close in on, where there is one."""
    assert problem.betaL is not None
    beta = problem.beta0
    scale = 1 + np.abs(problem.lam) + np.abs(problem.mu) + np.abs(problem.phi)
    if problem.betaL[0] == beta[0] and np.abs(slope(problem, beta))[0] <= 4e-16 * scale[0]:
        angle = beta[0] - 2 * np.pi * np.round(beta[0] / (2 * np.pi))
        return np.append(pin, angle), np.append(gap, 0.0), np.append(leaving, 0.0)
    return pin, gap, leaving


def _distinct(pin: Array, gap: Array, leaving: Array) -> list[int]:
    """Indices of the solutions, each once: two are one where start slopes agree and so do gaps from the same pin."""
    keep: list[int] = []
    for i in np.argsort(leaving, kind="stable"):
        if np.isnan(leaving[i]):
            continue
        close = [j for j in keep if abs(leaving[j] - leaving[i]) <= 1e-9 * (1 + abs(leaving[i]))]
        if not any(pin[i] != pin[j] or abs(gap[i] - gap[j]) <= 1e-6 * abs(gap[i]) for j in close):
            keep.append(int(i))
    return keep
