"""Every equilibrium of a rod whose end angles and dead loads are given, with its stability."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import elementwise

from .case import Case, Ends
from .errors import InputError
from .landscape import extrema, potential, slope
from .levels import DOWN, UP, Ladder, ladders, many, ways
from .methods.base import Seed, Trajectory, verdicts
from .methods.orbit import Orbit, solve_orbit
from .observables import observe
from .reduced import Array, Reduced, reduce
from .solution import Solution
from .stability import morse_index, response

_PATHS = ((UP, UP), (UP, DOWN), (DOWN, UP), (DOWN, DOWN))
_LOOSE, _TIGHT = 1e-5, 1e-13


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """One equilibrium. index: Morse index, 0 stable, both end angles held and the loads dead. energy [force length]:
    bending energy less the work of the loads. dbeta0: beta'(0) [rad/length]. turns: number of bends. attached: share of
    the length where the cylinder pushes."""

    solution: Solution
    index: int
    energy: float
    dbeta0: float
    turns: int
    attached: float


def equilibria(case: Case, tol: float = 1e-8, stations: int = 201, most_swings: int = 200) -> list[Equilibrium]:
    """All solutions of one ends problem with at most `most_swings` whole periods of beta, lowest energy first.

    beta(L) counts whole turns: to end at the same tangent after turning round, ask for beta(L) + 2 pi.
    Raises `InputError` for a start problem or a grid of cases.
    """
    if not isinstance(case.given, Ends):
        raise InputError(f"equilibria needs a Case given by Ends, got {type(case.given).__name__}")
    if case.shape:
        raise InputError(f"equilibria takes one case at a time, got a grid of shape {case.shape}")
    problem = reduce(case)
    slopes, orbit = search(problem, most_swings)
    if not slopes.size:
        return []
    t = problem.span[:, None] * np.linspace(0, 1, stations)
    found = []
    wide = many(problem, slopes.size)
    all_ = trajectory(wide, orbit, np.repeat(t, slopes.size, axis=0), tol)
    beta, h = _grid(wide, orbit)
    index = morse_index(wide, h, beta)
    for i in range(slopes.size):
        solution = Solution(case, problem, _pick(all_, orbit, i, t), t, "shooting", tol)
        seen = observe(solution, ("energy", "turns", "attached"))
        found.append(
            Equilibrium(
                solution, int(index[i]), float(seen["energy"]), float(slopes[i] / case.rho), int(seen["turns"]), float(seen["attached"])
            )
        )
    return sorted(found, key=lambda e: e.energy)


def search(problem: Reduced, most_swings: int = 200) -> tuple[Array, Orbit]:
    """beta_t(0) of every solution of one ends problem, (K,), and the orbits themselves."""
    found = extrema(problem)
    pins, signs, lows, highs, paths = [], [], [], [], []
    for ladder in ladders(problem, found):
        for low, high, path in _brackets(problem, ladder, most_swings):
            pins.append(ladder.pin), signs.append(ladder.sign), lows.append(low), highs.append(high), paths.append(path)
    pin, sign, path = np.array(pins), np.array(signs), np.array(paths).reshape(-1, 3)
    y = _roots(problem, pin, sign, path, np.array(lows), np.array(highs))
    gap = sign * np.exp(y)
    if pin.size:
        _, v2 = ways(problem, pin, gap, _TIGHT)
        leaving = np.where(np.isnan(v2), np.nan, path[:, 0]) * np.sqrt(np.where(v2 > 0, v2, 0))
    else:
        leaving = np.empty(0)
    pin, gap, leaving = _with_helices(problem, pin, gap, leaving)
    kept = _distinct(problem, leaving, pin, gap)
    pin, gap, leaving = pin[kept], gap[kept], leaving[kept]
    start = many(problem, leaving.size, betaL=None, dbeta0=leaving)  # type: ignore[arg-type]
    orbit = solve_orbit(start, _TIGHT, (pin, gap))
    assert problem.betaL is not None
    arrived = np.abs(orbit.at(start.span[:, None])[0][:, 0] - problem.betaL[0]) < 1e-6
    if not arrived.all():
        start, pin, gap = start.take(arrived), pin[arrived], gap[arrived]
        orbit = solve_orbit(start, _TIGHT, (pin, gap))
    assert start.dbeta0 is not None
    return start.dbeta0, orbit


def _brackets(problem: Reduced, ladder: Ladder, most_swings: int) -> list[tuple[float, float, tuple[int, int, int]]]:
    """Neighbouring rungs between which the length of some path passes the rod's; (low y, high y, path)."""
    M = ladder.y.size
    seen, _ = ways(problem, np.full(M, ladder.pin), ladder.sign * np.exp(ladder.y), _LOOSE)
    span = problem.span[0]
    out: list[tuple[float, float, tuple[int, int, int]]] = []
    turning = ~np.isnan(seen.direct)
    shortest = np.nanmin(seen.period) if (~np.isnan(seen.period)).any() else np.inf
    swings = np.arange(0, min(most_swings, int(span / shortest) + 1) + 1) if np.isfinite(shortest) else np.array([0])
    for leaving, arriving in _PATHS:
        for n in swings:
            off = seen.length(leaving, arriving, n) - span
            if turning.any() and (n > 0 or arriving != leaving or leaving != (UP if _way(problem) > 0 else DOWN)):
                off = np.where(turning, np.nan, off)
            # a path that has no length yet is no path: the plain way up or down from beta(0) away from beta(L)
            off = np.where(off + span <= 0, np.nan, off)
            out += [(*pair, (leaving, arriving, int(n))) for pair in _crossings(problem, ladder, off, (leaving, arriving, int(n)))]
    return out


def _way(problem: Reduced) -> float:
    assert problem.betaL is not None
    return float(problem.betaL[0] - problem.beta0[0])


def _crossings(problem: Reduced, ladder: Ladder, off: Array, path: tuple[int, int, int]) -> list[tuple[float, float]]:
    """Pairs of y between which `off` changes sign, those of a fold between two rungs among them."""
    y = ladder.y
    with np.errstate(invalid="ignore"):
        change = np.flatnonzero(off[:-1] * off[1:] < 0)
    pairs = [(float(y[k + 1]), float(y[k])) for k in change]
    size = np.abs(off)
    with np.errstate(invalid="ignore"):
        dips = np.flatnonzero((size[1:-1] < size[:-2]) & (size[1:-1] <= size[2:]) & (off[1:-1] * off[:-2] > 0) & (off[1:-1] * off[2:] > 0)) + 1
        bottom = size[dips] - 0.25 * np.maximum(size[dips - 1] - size[dips], size[dips + 1] - size[dips])
    for k in dips[bottom < 0]:
        tip = _dip(problem, ladder, path, float(y[k + 1]), float(y[k]), float(y[k - 1]), float(np.sign(off[k])))
        if tip is not None:
            pairs += [(float(y[k + 1]), tip), (tip, float(y[k - 1]))]
    return pairs


def _dip(problem: Reduced, ladder: Ladder, path: tuple[int, int, int], low: float, mid: float, high: float, sign: float) -> float | None:
    """Where between two rungs the length passes the rod's and comes back, if it does."""

    def off(y: Array) -> Array:
        seen, _ = ways(problem, np.full(y.shape, ladder.pin), ladder.sign * np.exp(y), 1e-10)
        return sign * (seen.length(*path) - problem.span[0])

    grid = np.linspace(low, high, 33)
    values = off(grid)
    k = int(np.nanargmin(values)) if not np.isnan(values).all() else 0
    if values[k] < 0:
        return float(grid[k])
    if not 0 < k < 32:
        return None
    grid = np.linspace(grid[k - 1], grid[k + 1], 33)
    values = off(grid)
    k = int(np.nanargmin(values))
    return float(grid[k]) if values[k] < 0 else None


def _roots(problem: Reduced, pin: Array, sign: Array, path: Array, low: Array, high: Array) -> Array:
    """log|gap| of every solution, (K,), all closed in on together."""
    if not pin.size:
        return np.empty(0)

    def off(y: Array, which: Array) -> Array:
        i = which.astype(int)
        seen, _ = ways(problem, pin[i], sign[i] * np.exp(y), _TIGHT)
        value = seen.length(path[i, 0], path[i, 1], path[i, 2]) - problem.span[0]
        return value

    which = np.arange(pin.size, dtype=float)
    answer = elementwise.find_root(off, (low, high), args=(which,), tolerances={"xatol": 1e-14, "xrtol": 1e-15}, maxiter=60)
    return answer.x


def _with_helices(problem: Reduced, pin: Array, gap: Array, leaving: Array) -> tuple[Array, Array, Array]:
    """The rods that lie as a helix from end to end, which have no level to close in on."""
    assert problem.betaL is not None
    b = problem.beta0
    scale = 1 + np.abs(problem.lam) + np.abs(problem.mu) + np.abs(problem.phi)
    if problem.betaL[0] == b[0] and np.abs(slope(problem, b))[0] <= 4e-16 * scale[0]:
        angle = b[0] - 2 * np.pi * np.round(b[0] / (2 * np.pi))
        return np.append(pin, angle), np.append(gap, 0.0), np.append(leaving, 0.0)
    return pin, gap, leaving


def _distinct(problem: Reduced, leaving: Array, pin: Array, gap: Array) -> Array:
    """Indices of the solutions met once: two are one where slope at the start and gap agree."""
    keep: list[int] = []
    level = potential(many(problem, pin.size), pin) + gap if pin.size else gap
    for i in np.argsort(leaving, kind="stable"):
        if np.isnan(leaving[i]):
            continue
        same = [
            j
            for j in keep
            if abs(leaving[j] - leaving[i]) <= 1e-9 * (1 + abs(leaving[i]))
            and abs(level[j] - level[i]) <= 1e-9 * (1 + abs(level[i]))
            and (pin[i] != pin[j] or abs(gap[i] - gap[j]) <= 1e-6 * abs(gap[i]))
        ]
        if not same:
            keep.append(int(i))
    return np.array(keep, dtype=int)


def _grid(problem: Reduced, orbit: Orbit) -> tuple[Array, Array]:
    """beta of K solutions on equal steps that resolve them, (K, n), and the steps, (K,)."""
    fastest = np.sqrt(4 * (np.abs(problem.lam) + np.abs(problem.mu) + np.abs(problem.phi) + 1))
    n = int(np.clip(12 * np.max(problem.span * fastest), 400, 20000))
    return orbit.at(problem.span[:, None] * np.linspace(0, 1, n + 1))[0], problem.span / n


def trajectory(problem: Reduced, orbit: Orbit, t: Array, tol: float) -> Trajectory:
    """The orbits of K ends problems at stations t (K, n), with how far they miss beta(L) as their error."""
    assert problem.betaL is not None
    beta, dbeta, alpha, z = orbit.at(t)
    grid, h = _grid(problem, orbit)
    condition = response(problem, h, grid)
    miss = np.abs(orbit.at(problem.span[:, None])[0][:, 0] - problem.betaL)
    error = (2 * miss + 1e-14) * condition
    calls = np.bincount(orbit.panels.part // 2, weights=orbit.panels.calls, minlength=t.shape[0]).astype(np.int64)
    return Trajectory(beta, dbeta, alpha, z, lambda: orbit.swirl(t), verdicts(beta, error, condition, tol), error, condition, calls, orbit)


def _pick(all_: Trajectory, orbit: Orbit, i: int, t: Array) -> Trajectory:
    one = slice(i, i + 1)
    alone = orbit.take(i)
    fields = (all_.beta, all_.dbeta, all_.alpha, all_.z)
    told = (all_.outcome, all_.error, all_.condition, all_.evaluations)
    return Trajectory(*(v[one] for v in fields), lambda: alone.swirl(t), *(v[one] for v in told), alone)


def chosen(problem: Reduced, t: Array, tol: float, slope: float | None) -> Trajectory | None:
    """The equilibrium of one ends problem with beta_t(0) nearest `slope`, or of lowest energy; None where there is none."""
    slopes, orbit = search(problem)
    if not slopes.size:
        return None
    i = int(np.argmin(_energies(problem, slopes, orbit) if slope is None else np.abs(slopes - slope)))
    alone = orbit.take(i)
    return trajectory(problem, alone, t, tol)


def _energies(problem: Reduced, slopes: Array, orbit: Orbit) -> Array:
    """Energy of each orbit in units of A/rho, (K,)."""
    wide = many(problem, slopes.size)
    t = wide.span[:, None] * np.linspace(0, 1, 4001)
    dbeta = orbit.at(t)[1]
    level = slopes**2 + potential(wide, wide.beta0)
    return np.trapezoid(dbeta**2, t, axis=1) - level * problem.span[0] / 2


def lowest(problem: Reduced, points: int = 2001) -> Seed:
    """The equilibrium of lowest energy of each problem, as a seed; NaN where there is none."""
    u = np.linspace(0, 1, points)
    slopes, shapes = np.full(problem.size, np.nan), np.full((problem.size, points), np.nan)
    for i in range(problem.size):
        one = problem.take(slice(i, i + 1))
        found = chosen(one, one.span[:, None] * u, 1e-8, None)
        if found is not None:
            slopes[i], shapes[i] = found.dbeta[0, 0], found.beta[0]
    return Seed(slopes, np.tile(u, (problem.size, 1)), shapes)
