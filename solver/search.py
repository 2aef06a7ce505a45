"""The search for every orbit that joins two angles over a given length: one equation a path, the level unknown."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from .landscape import TAU, extrema, potential, slope
from .levels import DOWN, UP, Ladder, Ways, ladders, many, ways
from .methods.orbit import Orbit, solve_orbit
from .reduced import Array, Reduced
from .resting import resting

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
    lengthens: bool


@dataclass(frozen=True, eq=False)
class Found:
    """K solutions of one ends problem: beta_t(0), (K,), and their orbits."""

    slope: Array
    orbit: Orbit


def search(problem: Reduced, most_swings: int = 200) -> Found | None:
    """Every solution of one ends problem, or None where there is none."""
    assert problem.betaL is not None
    brackets = [b for ladder in ladders(problem, extrema(problem)) for b in _brackets(problem, ladder, most_swings)]
    pin, gap, leaving = _closed_in(problem, brackets) if brackets else (np.empty(0),) * 3
    lengthens = np.array([b.lengthens for b in brackets], dtype=float)
    for rest in resting(problem):
        if not _known(problem, rest, pin, gap, leaving):
            pin, gap, leaving = np.append(pin, rest[0]), np.append(gap, rest[1]), np.append(leaving, rest[2])
            lengthens = np.append(lengthens, np.nan)
    kept = _distinct(problem, pin, gap, leaving)
    pin, gap, leaving, lengthens = pin[kept], gap[kept], leaving[kept], lengthens[kept]
    beta0 = np.full(leaving.size, problem.beta0[0])
    helix = _helix(problem)
    if helix is not None:
        pin, beta0 = np.append(pin, helix[0]), np.append(beta0, helix[1])
        gap, leaving, lengthens = np.append(gap, 0.0), np.append(leaving, 0.0), np.append(lengthens, np.nan)
    if not leaving.size:
        return None
    start = many(problem, leaving.size, beta0=beta0).started(leaving)
    orbit = solve_orbit(start, _TIGHT, (pin, gap))
    beta = orbit.at(start.span[:, None] * np.linspace(0, 1, 65))[0]
    good = np.abs(beta[:, -1] - problem.betaL[0]) < 1e-6
    if helix is not None:  # what stays within rounding of the helix is the helix
        good[:-1] &= np.ptp(beta[:-1], axis=1) > 1e-12
    if not good.any():
        return None
    if not good.all():
        orbit = solve_orbit(start.take(good), _TIGHT, (pin[good], gap[good]))
    return Found(leaving[good], replace(orbit, lengthens=lengthens[good]))


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
            for low, high, rises in _crossings(problem, ladder, length - span, (leaving, arriving, swings)):
                lengthens = rises == (ladder.sign > 0)
                yield Bracket(ladder.pin, ladder.sign, low, high, leaving, arriving, swings, lengthens)


def _crossings(
    problem: Reduced, ladder: Ladder, off: Array, path: tuple[int, int, int]
) -> list[tuple[float, float, bool]]:
    """Pairs of y between which `off` changes sign, the two of a fold between two rungs among them, and whether it rises
    with y."""
    y, size = ladder.y, np.abs(off)
    with np.errstate(invalid="ignore"):
        pairs = [(float(y[k + 1]), float(y[k]), bool(off[k] > 0)) for k in np.flatnonzero(off[:-1] * off[1:] < 0)]
        same = (off[1:-1] * off[:-2] > 0) & (off[1:-1] * off[2:] > 0)
        dips = np.flatnonzero(same & (size[1:-1] < size[:-2]) & (size[1:-1] <= size[2:])) + 1
        # the bottom of a dip lies below its lowest rung by a fraction of the rise to the next ones
        bottom = size[dips] - 0.25 * np.maximum(size[dips - 1] - size[dips], size[dips + 1] - size[dips])
    for k in dips[bottom < 0]:
        low, high = float(y[k + 1]), float(y[k - 1])
        tip = _dip(problem, ladder, path, low, high, float(np.sign(off[k])))
        if tip is not None:
            pairs += [(low, tip, bool(off[k] < 0)), (tip, high, bool(off[k] > 0))]
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

    from scipy.optimize import elementwise  # SciPy does not fetch this part by itself, and it need not come sooner

    between = np.array([b.low for b in found]), np.array([b.high for b in found])
    which = np.arange(pin.size, dtype=float)
    tolerances = {"xatol": 1e-14, "xrtol": 1e-15}
    y = elementwise.find_root(off, between, args=(which,), tolerances=tolerances, maxiter=60).x
    _, v2 = seen_at(y, np.arange(pin.size))
    return pin, sign * np.exp(y), path[:, 0] * np.sqrt(np.where(v2 > 0, v2, np.nan))


def _helix(problem: Reduced) -> tuple[float, float] | None:
    """The rod that lies as a helix from end to end, which has no level to close in on: its angle in [-pi, pi), and
    counted on to beta(0); None where the ends are no helix's, to rounding."""
    assert problem.betaL is not None
    beta = problem.beta0
    scale = 1 + np.abs(problem.lam) + np.abs(problem.mu) + np.abs(problem.phi)
    if problem.betaL[0] != beta[0] or np.abs(slope(problem, beta))[0] > 4e-16 * scale[0]:
        return None
    found = extrema(problem)
    angles = found.beta[0, : found.count[0]]
    turns = np.round((beta[0] - angles) / TAU)
    k = int(np.argmin(np.abs(angles + TAU * turns - beta[0])))
    return float(angles[k]), float(angles[k] + TAU * turns[k])


def _known(problem: Reduced, rest: tuple[float, float, float], pin: Array, gap: Array, leaving: Array) -> bool:
    """Whether the scan has met the rod that rests at one end already."""
    level = potential(many(problem, pin.size), pin) + gap
    own = float(potential(problem, np.array([rest[0]]))[0]) + rest[1]
    return bool(((np.abs(leaving - rest[2]) < 1e-5) & (np.abs(level - own) < 1e-9)).any())


def _distinct(problem: Reduced, pin: Array, gap: Array, leaving: Array) -> list[int]:
    """Indices of the solutions, each once: two are one where start slopes agree and so do their levels.

    Levels are compared by their gaps where both have the same pin; where not, they are one only well away from both.
    """
    keep: list[int] = []
    level = potential(many(problem, pin.size), pin) + gap

    def one(i: int, j: int) -> bool:
        if abs(leaving[j] - leaving[i]) > 1e-9 * (1 + abs(leaving[i])):
            return False
        if pin[i] == pin[j]:
            return bool(abs(gap[i] - gap[j]) <= 1e-6 * abs(gap[i]))
        return bool(min(abs(gap[i]), abs(gap[j])) > 1e-5 and abs(level[i] - level[j]) <= 1e-9 * (1 + abs(level[i])))

    for i in np.argsort(leaving, kind="stable"):
        if not np.isnan(leaving[i]) and not any(one(i, j) for j in keep):
            keep.append(int(i))
    return keep
