"""The search for every orbit that joins two angles over a given length: one equation a path, the level unknown."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .action import energies
from .dwell import dwelling
from .landscape import potential
from .levels import Chain, bounded, chained, helix_of
from .methods.orbit import Orbit, solve_orbit
from .reduced import Array, Reduced
from .stability import end_response, jacobi_zeros
from .transit import STRETCH, Boundary, Levels, Paths, Transit, many, paths, transit

_TIGHT = 1e-13
_ZOOM, _ROUNDS = 17, 6  # rungs of a closer look at a dip, and how often it is made closer
_NOISE = 1e-14  # of the rod's length, what the rounding of a sum of times may come to
_PATHS = 1000  # paths looked at together
_MISSED = 1e-6  # rad: an orbit that ends farther than this from beta(L) is none


@dataclass(frozen=True, eq=False)
class Found:
    """K solutions of one ends problem and their orbits.

    slope: beta_t(0), (K,). path: pin (angle in [-pi, pi)), sign and y = log gap of the level, direction at both ends
    and whole periods, (K,) each; see `transit`. helix: (K,), a rod that is a helix from end to end and has no path.
    index: Morse index, (K,). energy: in units of A/rho, (K,). lowest, highest: smallest and largest beta along the
    rod [rad], (K,). remark: why the list is a part of all only; empty where it is complete.
    """

    slope: Array
    orbit: Orbit
    path: "Way"
    index: Array
    energy: Array
    lowest: Array
    highest: Array
    remark: str
    evaluations: int

    @property
    def stray(self) -> Array:
        """How far beta goes beyond the interval between its two end angles [rad], (K,)."""
        problem = self.orbit.problem
        assert problem.betaL is not None
        first, last = problem.beta0, problem.betaL
        over = np.maximum(self.highest - np.maximum(first, last), np.minimum(first, last) - self.lowest)
        return np.maximum(over, 0.0)


@dataclass(frozen=True, eq=False)
class Way:
    """The level and the path of K solutions, (K,) each: eta = G(pin) + sign exp(y); see `transit.Paths`."""

    pin: Array
    sign: Array
    y: Array
    leaving: NDArray[np.int64]
    arriving: NDArray[np.int64]
    swings: NDArray[np.int64]
    helix: NDArray[np.bool_]

    def take(self, index: Any) -> "Way":
        return Way(**{name: v[index] for name, v in vars(self).items()})


@dataclass(frozen=True, eq=False)
class Roots:
    """K levels at which the length of a path is the rod's; lengthens: (K,), whether it grows with the level."""

    levels: Levels
    paths: Paths
    lengthens: NDArray[np.bool_]
    lost: int
    calls: int


def search(problem: Reduced, most_swings: int = 200) -> Found | None:
    """Every solution of one ends problem with at most so many whole periods, or None where none is found."""
    found = None
    for step in (0.25, 0.0625):
        found = _searched(problem, most_swings, step)
        if found is not None and not found.remark.startswith(_COUNT):
            break
    return found


_COUNT = "incomplete"


def _searched(problem: Reduced, most_swings: int, step: float) -> Found | None:
    """One search, with rungs of `step` in log gap."""
    assert problem.betaL is not None
    boundary, chain = chained(bounded(problem), step)
    roots, capped = _roots(boundary, chain, most_swings)
    helix = helix_of(problem, boundary.found)
    way, lengthens = _ways(boundary, roots, helix)
    if not lengthens.size:
        return None
    orbit, level = _solved(problem, boundary, way, lengthens)
    far = orbit.at(orbit.problem.span[:, None])[0][:, 0]
    good = np.abs(far - problem.betaL[0]) < _MISSED
    lost = roots.lost + int(np.count_nonzero(~good))
    if not good.any():
        return None
    if not good.all():
        way, lengthens = way.take(good), lengthens[good]
        orbit, level = _solved(problem, boundary, way, lengthens)
    index, energy = jacobi_zeros(orbit), energies(orbit, level)
    lowest, highest = _range(orbit)
    assert orbit.problem.dbeta0 is not None
    remark = _remark(index, energy, lost, capped, most_swings)
    calls = roots.calls + int(orbit.panels.calls.sum())
    return Found(orbit.problem.dbeta0, orbit, way, index, energy, lowest, highest, remark, calls)


def _remark(index: Array, energy: Array, lost: int, capped: bool, most_swings: int) -> str:
    """What is missing, in words: by degree the equilibria, each counted with (-1)^index, add up to one, and the one of
    lowest energy has index 0."""
    if capped:
        return f"only equilibria of at most {most_swings} whole periods of beta were searched for"
    if lost:
        return f"{_COUNT}: {lost} equilibria were bracketed and could not be solved"
    count = int(np.sum(np.where(index % 2 == 0, 1, -1)))
    if count != 1:
        return f"{_COUNT}: the equilibria found, each counted with (-1)^index, add up to {count}, not to 1"
    lowest = energy <= energy.min() + 1e-9 * (1 + np.abs(energy.min()))
    if not (index[lowest] == 0).any():
        return f"{_COUNT}: the equilibrium of lowest energy found is unstable, so a lower one is missing"
    return ""


def _roots(boundary: Boundary, chain: Chain, most_swings: int) -> tuple[Roots, bool]:
    """Every level on the chain at which a path has the rod's length, and whether `most_swings` leaves out paths."""
    span = float(boundary.problem.span[0])
    seen = transit(boundary, chain.levels)
    period = 2 * seen.time.sum(axis=0)[~seen.rotates & ~chain.place]
    shortest = np.nanmin(period, initial=np.inf) if period.size else np.inf
    needed = int(min(span / shortest, 1e9)) + 1 if np.isfinite(shortest) else 0
    every = paths(boundary, 2 * min(needed, most_swings) + 1)
    parts = []
    for k in range(0, every.swings.size if chain.place.size else 1, _PATHS):
        some = every.take(slice(k, k + _PATHS))
        parts.append(_on_chain(boundary, chain, seen, some))
    return _joined(parts, seen.calls), needed - 1 > most_swings


def _joined(parts: list[Roots], calls: int) -> Roots:
    levels = Levels(*(np.concatenate([getattr(p.levels, name) for p in parts]) for name in ("pin", "sign", "y")))
    names = ("leaving", "arriving", "swings")
    every = Paths(*(np.concatenate([getattr(p.paths, name) for p in parts]) for name in names))
    lengthens = np.concatenate([p.lengthens for p in parts])
    return Roots(levels, every, lengthens, sum(p.lost for p in parts), calls + sum(p.calls for p in parts))


def _on_chain(boundary: Boundary, chain: Chain, seen: Transit, some: Paths) -> Roots:
    """The roots of N paths."""
    levels, counts = chain.levels, some.counts(boundary.rising)
    if not levels.y.size:  # no level joins the ends but a helix's own
        none = np.empty(0, dtype=int)
        return Roots(levels, some.take(none), none.astype(bool), 0, 0)
    off = seen.lengths(counts) - boundary.problem.span[0]
    rate = seen.rates(counts)
    for k in np.flatnonzero(chain.place):  # at a saddle's own height the length is infinite, or continuous
        sides = [rate[:, j] for j in (k - 1, k + 1) if 0 <= j < levels.y.size]
        steep = np.fmax.reduce(sides) > 0
        off[:, k] = np.where(steep, np.inf, off[:, k] if k else np.nan)
    known, above = _above(off, boundary.problem.span[0])
    n, k = np.nonzero(known[:, :-1] & known[:, 1:] & (above[:, :-1] != above[:, 1:]))
    lengthens = above[n, k + 1]
    beside = chain.place[k] | chain.place[k + 1]
    rung = np.where(chain.place[k], k + 1, k)  # the real one, beside a saddle's own height
    own = levels.take(np.where(beside, rung, k + 1))
    with np.errstate(divide="ignore", invalid="ignore"):
        deep = own.y + np.where(rate[n, rung] > 0, off[n, rung] / rate[n, rung], 0.0)
        # next to the level at which the rod begins or ends at rest the length is linear in beta_t there
        share = -off[n, k] / (off[n, k + 1] - off[n, k])
        rests = chain.at_end & (k == 1) & (rate[n, k] == 0)
        at_rest = np.maximum(levels.y[2] + 2 * np.log(share), boundary.deepest) if levels.y.size > 2 else own.y
    y = np.where(beside, deep, np.where(rests, at_rest, np.nan))
    open_ = np.flatnonzero(np.isnan(y))
    pairs = [(own.take(open_), levels.y[k[open_]], own.y[open_], n[open_], lengthens[open_])]
    dips, calls = _dips(boundary, chain, some, off)
    pairs.append(dips)
    pin, sign = (np.concatenate([getattr(p[0], name) for p in pairs]) for name in ("pin", "sign"))
    low, high, path, rises = (np.concatenate([p[j] for p in pairs]) for j in range(1, 5))
    root, more = _closed_in(boundary, pin, sign, low, high, counts[path])
    done = ~np.isnan(y)
    pin, sign = np.concatenate([own.pin[done], pin]), np.concatenate([own.sign[done], sign])
    y, path = np.concatenate([y[done], root]), np.concatenate([n[done], path])
    rises = np.concatenate([lengthens[done], rises])
    found = ~np.isnan(y)
    levels = Levels(pin[found], sign[found], y[found])
    return Roots(levels, some.take(path[found]), rises[found], int(np.count_nonzero(~found)), calls + more)


def _above(off: Array, span: float) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Where lengths are known, and where they are not below the rod's, (N, M); what differs from the rod's by rounding
    alone goes with the rung before it, so that noise brackets nothing."""
    known = ~np.isnan(off)
    with np.errstate(invalid="ignore"):
        above, sure = off >= 0, ~(np.abs(off) <= _NOISE * span)
    sure[:, 1:] |= ~known[:, :-1]
    sure[:, 0] = True
    last = np.maximum.accumulate(np.where(sure, np.arange(off.shape[1]), 0), axis=1)
    return known, np.take_along_axis(above, last, axis=1)


def _closed_in(
    boundary: Boundary, pin: Any, sign: Array, first: Array, second: Array, counts: Array
) -> tuple[Array, int]:
    """y of the root in each bracket, (K,), NaN where there turned out to be none; and evaluations."""
    if not first.size:
        return np.empty(0), 0
    from scipy.optimize import elementwise  # SciPy does not fetch this part by itself, and it need not come sooner

    calls = 0

    def off(y: Array, which: Array) -> Array:
        nonlocal calls
        i = which.astype(int)
        seen = transit(boundary, Levels(pin[i], sign[i], y))
        calls += seen.calls
        return seen.lengths_along(counts[i]) - boundary.problem.span[0]

    low, high = np.minimum(first, second), np.maximum(first, second)
    which = np.arange(pin.size, dtype=float)
    tolerances = {"xatol": 1e-14, "xrtol": 1e-15}
    told = elementwise.find_root(off, (low, high), args=(which,), tolerances=tolerances, maxiter=60)
    y = np.where(told.success, told.x, np.nan)
    for i in np.flatnonzero(~told.success):  # within rounding of one end of its bracket
        ends = np.array([low[i], high[i]])
        size = np.abs(off(ends, np.full(2, float(i))))
        if np.nanmin(size) < 1e-9 * boundary.problem.span[0]:
            y[i] = ends[int(np.nanargmin(size))]
    return y, calls


def _dips(boundary: Boundary, chain: Chain, some: Paths, off: Array) -> tuple[Any, int]:
    """Brackets of the two roots between rungs where the length comes near the rod's, passes it and returns."""
    counts, size = some.counts(boundary.rising), np.abs(off)
    with np.errstate(invalid="ignore"):
        same = (off[:, 1:-1] * off[:, :-2] > 0) & (off[:, 1:-1] * off[:, 2:] > 0)
        least = same & (size[:, 1:-1] < size[:, :-2]) & (size[:, 1:-1] <= size[:, 2:])
        # the bottom of a dip lies below its lowest rung by a fraction of the rise to the next ones
        rise = np.fmax(size[:, :-2] - size[:, 1:-1], size[:, 2:] - size[:, 1:-1])
        near = least & (size[:, 1:-1] < 0.25 * rise) & np.isfinite(rise)
    n, k = np.nonzero(near)
    k = k + 1
    cells = [(chain.cell(int(i) - 1), chain.cell(int(i))) for i in k]
    kept = [i for i, pair in enumerate(cells) if None not in pair]
    out: list[tuple[int, float, float, float, int, bool]] = []
    calls = 0
    for i in kept:
        found, more = _dip(boundary, cells[i], counts[n[i]], bool(off[n[i], k[i]] > 0))
        out += [(*cell, int(n[i]), rises) for cell, rises in found]
        calls += more
    columns = list(zip(*out, strict=True)) if out else [()] * 6
    pin, sign, first, second = np.array(columns[0], dtype=int), *(np.array(c, dtype=float) for c in columns[1:4])
    rest = np.array(columns[4], dtype=int), np.array(columns[5], dtype=bool)
    return (Levels(pin, sign, first), first, second, *rest), calls


def _dip(boundary: Boundary, cells: Any, counts: Array, above: bool) -> tuple[list[Any], int]:
    """The cells in which the length of one path passes the rod's, and whether it rises with the level, among two
    neighbouring cells in which it comes near; and evaluations."""
    calls = 0
    for _ in range(_ROUNDS):
        y = np.stack([np.linspace(a, b, _ZOOM) for _, _, a, b in cells])
        pin, sign = (np.repeat([cell[j] for cell in cells], _ZOOM) for j in (0, 1))
        seen = transit(boundary, Levels(pin, sign, y.reshape(-1)))
        calls += seen.calls
        length = seen.lengths_along(np.broadcast_to(counts, (pin.size, 3))).reshape(2, _ZOOM)
        off = length - boundary.problem.span[0]
        over = off >= 0
        if (over != above).any():
            c, j = np.nonzero(over[:, :-1] != over[:, 1:])
            return [
                ((*cells[a][:2], y[a, b], y[a, b + 1]), bool(over[a, b + 1])) for a, b in zip(c, j, strict=True)
            ], calls
        if np.isnan(off).any():
            return [], calls
        least = int(np.argmin(np.abs(off)))
        c, j = divmod(least, _ZOOM)
        before = (c, j - 1) if j else (0, _ZOOM - 2)
        after = (c, j) if j < _ZOOM - 1 else (1, 0)
        cells = [(*cells[a][:2], y[a, b], y[a, b + 1]) for a, b in (before, after)]
    return [], calls


def _ways(boundary: Boundary, roots: Roots, helix: Any) -> tuple[Way, Array]:
    """Level and path of each root, the helix last; and whether the length grows with the level, NaN for the helix."""
    levels, some = roots.levels, roots.paths
    columns = [boundary.pins[levels.pin] if levels.pin.size else np.empty(0), levels.sign, levels.y]
    columns += [some.leaving, some.arriving, some.swings, np.zeros(levels.y.size, dtype=bool)]
    lengthens = roots.lengthens.astype(float)
    if helix is not None:
        mark = (helix[0], 1.0, -np.inf, 0, 0, 0, True)
        columns = [np.append(c, np.asarray(v, dtype=c.dtype)) for c, v in zip(columns, mark, strict=True)]
        lengthens = np.append(lengthens, np.nan)
    return Way(*columns), lengthens


def _solved(problem: Reduced, boundary: Boundary, way: Way, lengthens: Array) -> tuple[Orbit, Array]:
    """The orbits and their levels eta, (K,)."""
    K = way.y.size
    moves = ~way.helix
    pin = np.array([int(np.argmin(np.abs(boundary.pins - p))) for p in way.pin[moves]], dtype=int)
    gap, slope, excess = np.zeros(K), np.zeros(K), np.zeros(K)
    gap[moves] = way.sign[moves] * np.exp(np.maximum(way.y[moves], boundary.deepest))
    slope[moves] = way.leaving[moves] * np.sqrt(np.maximum(boundary.start_speed2(pin, gap[moves]), 0))
    excess[moves] = np.maximum(boundary.deepest - way.y[moves], 0)
    first = boundary.low if boundary.rising else boundary.high
    start = many(problem, K, beta0=np.full(K, first), dbeta0=slope)
    level = potential(start, way.pin) + gap
    falls = np.ones((K, 2))
    falls[moves] = boundary.falls[pin]
    deep = excess > 0
    span = start.span.copy()
    if deep.any():
        some = Paths(way.leaving[moves], way.arriving[moves], way.swings[moves])
        seen = transit(boundary, Levels(pin, way.sign[moves], way.y[moves]), deep=False)
        span[moves] = np.where(deep[moves], seen.lengths_along(some.counts(boundary.rising)), span[moves])
    orbit = solve_orbit(replace(start, span=span), _TIGHT, (way.pin, gap), STRETCH)
    # between two ends on saddles of this height eta(L) stays as it is while eta between grows as the gap's root falls
    growth = end_response(orbit) * np.exp(np.minimum((falls == 0).all(axis=1) * excess / 2, 600))
    if deep.any():
        orbit = dwelling(orbit, start.span, gap, excess)
    turns = problem.beta0[0] - first
    orbit.panels.series[:, 0, 0] += turns
    start = replace(start, beta0=np.full(K, problem.beta0[0]))
    passed = np.where(way.helix, 0.0, Paths(way.leaving, way.arriving, way.swings).turns)
    return replace(orbit, problem=start, lengthens=lengthens, response=growth, passed=passed), level


def _range(orbit: Orbit) -> tuple[Array, Array]:
    """Smallest and largest beta along each rod, (K,): at its ends or at turning points."""
    problem = orbit.problem
    assert problem.betaL is not None
    lowest, highest = np.minimum(problem.beta0, problem.betaL), np.maximum(problem.beta0, problem.betaL)
    tip = np.repeat(problem.beta0, 2)
    tip[orbit.panels.part] = orbit.panels.series[:, 0].sum(axis=1)  # the last panel of each part is written last
    tip = tip.reshape(-1, 2)
    for k, passed in enumerate((orbit.turns > 0, orbit.turns > 1)):
        lowest = np.where(passed, np.minimum(lowest, tip[:, k]), lowest)
        highest = np.where(passed, np.maximum(highest, tip[:, k]), highest)
    return lowest, highest
