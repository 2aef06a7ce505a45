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
BUDGET = 3e7  # evaluations of G, some ten to twenty seconds
_EACH = 15  # levels looked at for each solution
_PATHS = 1000  # paths looked at together
_LARGEST = 1e100
_MISSED = 1e-6  # rad: an orbit that ends farther than this from beta(L) is none


@dataclass(frozen=True, eq=False)
class Found:
    """K solutions of one ends problem and their orbits.

    slope: beta_t(0), (K,). path: pin (angle in [-pi, pi)), sign and y = log gap of the level, direction at both ends
    and whole periods, (K,) each; see `transit`. helix: (K,), a rod that is a helix from end to end and has no path.
    index: Morse index, (K,). energy: in units of A/rho, (K,). lowest, highest: smallest and largest beta along the
    rod [rad], (K,). total: how many solutions there are, those that were not solved among them. remark: why the list
    is a part of all only; empty where it is complete. evaluations: of G.
    """

    slope: Array
    orbit: Orbit
    path: "Way"
    index: Array
    energy: Array
    lowest: Array
    highest: Array
    total: int
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
    """K levels at which the length of a path is the rod's; lengthens: (K,), whether it grows with the level.

    total, signed: how many there are, those on paths of more turning points than were asked for among them, and their
    count with (-1)^index. lost: brackets in which no root was met. calls: evaluations of G.
    """

    levels: Levels
    paths: Paths
    lengthens: NDArray[np.bool_]
    total: int
    signed: int
    lost: int
    calls: int


def search(problem: Reduced, most_swings: int = 200, most_turns: int | None = None) -> Found | None:
    """Every solution of one ends problem with at most so many whole periods, or None where none is found.

    most_turns: leave out those of more turning points, which are counted and not solved. A solution of index 0 has one
    turning point at most, so 1 is enough for all stable ones, of which there is always at least one.
    """
    found = None
    if not _fits(problem):
        return None
    for step in (0.25, 0.0625):
        found = _searched(problem, most_swings, most_turns, step)
        if found is not None and not found.remark.startswith(_COUNT):
            break
    return found


_COUNT = "incomplete"


def _fits(problem: Reduced) -> bool:
    """Whether a float holds the squares of the numbers of one ends problem, and of the slope it needs."""
    assert problem.betaL is not None
    numbers = problem.lam, problem.mu, problem.phi, problem.span, problem.beta0, problem.betaL
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        reach = np.abs(problem.betaL - problem.beta0) / problem.span
        return bool((np.abs(np.stack([*numbers, reach, 1 / problem.span])) < _LARGEST).all())


def _searched(problem: Reduced, most_swings: int, most_turns: int | None, step: float) -> Found | None:
    """One search, with rungs of `step` in log gap."""
    assert problem.betaL is not None
    boundary, chain = chained(bounded(problem), step)
    roots, said = _roots(boundary, chain, most_swings, most_turns)
    helix = helix_of(problem, boundary.found)
    way, lengthens = ways_of(boundary, roots, helix)
    if not lengthens.size:
        return None
    orbit, level = solved(problem, boundary, way, lengthens)
    far = orbit.at(orbit.problem.span[:, None])[0][:, 0]
    good = np.abs(far - problem.betaL[0]) < np.maximum(_MISSED, np.minimum(_blur(orbit), 0.1))
    lost = roots.lost + int(np.count_nonzero(~good))
    if not good.any():
        return None
    if not good.all():
        way, lengthens = way.take(good), lengthens[good]
        orbit, level = solved(problem, boundary, way, lengthens)
    index, energy = jacobi_zeros(orbit), energies(orbit, level)
    lowest, highest = _range(orbit)
    assert orbit.problem.dbeta0 is not None
    helices = index[way.helix]
    signed = roots.signed + int(np.where(helices % 2 == 0, 1, -1).sum())
    remark = said or _remark(index, energy, signed, lost)
    total, calls = roots.total + helices.size, roots.calls + int(orbit.panels.calls.sum())
    return Found(orbit.problem.dbeta0, orbit, way, index, energy, lowest, highest, total, remark, calls)


def _remark(index: Array, energy: Array, signed: int, lost: int) -> str:
    """What is missing, in words: by degree the equilibria, each counted with (-1)^index, add up to one, and the one of
    lowest energy has index 0."""
    if lost:
        return f"{_COUNT}: {lost} equilibria were bracketed and could not be solved"
    if signed != 1:
        return f"{_COUNT}: the equilibria found, each counted with (-1)^index, add up to {signed}, not to 1"
    lowest = energy <= energy.min() + 1e-9 * (1 + np.abs(energy.min()))
    if not (index[lowest] == 0).any():
        return f"{_COUNT}: the equilibrium of lowest energy found is unstable, so a lower one is missing"
    return ""


def _roots(boundary: Boundary, chain: Chain, most_swings: int, most_turns: int | None) -> tuple[Roots, str]:
    """Every level on the chain at which a path has the rod's length, and what `most_swings` or `BUDGET` leaves out."""
    span, size = float(boundary.problem.span[0]), chain.levels.y.size
    seen = transit(boundary, chain.levels)
    period = 2 * seen.time.sum(axis=0)[~seen.rotates & ~chain.place]
    shortest = float(np.nanmin(period, initial=np.inf))
    needed = int(min(span / shortest, 1e9)) + 1 if np.isfinite(shortest) else 0
    said = f"only equilibria of at most {most_swings} whole periods of beta were searched for"
    said = said if needed - 1 > most_swings else ""
    every = paths(boundary, 2 * min(needed, most_swings) + 1)
    parts = [
        _on_chain(boundary, chain, seen, every.take(slice(k, k + _PATHS)), k)
        for k in range(0, every.swings.size if size else 1, _PATHS)
    ]
    brackets, calls = _joined([p for p, _ in parts]), seen.calls + sum(more for _, more in parts)
    turns = every.turns[brackets.path]
    kept = np.ones(turns.size, dtype=bool) if most_turns is None else turns <= most_turns
    afford = int(BUDGET / (_EACH * max(1.0, seen.calls / max(size, 1))))
    if np.count_nonzero(kept) > afford:
        most = int(np.sort(turns[kept])[afford]) - 1
        kept = kept & (turns <= most)
        said = f"only equilibria of at most {most} bends were solved: all {turns.size} would take too many evaluations"
    odd = (turns - brackets.rises) % 2 == 1
    some = brackets.take(kept)
    y, more = _closed_in(boundary, some, every.counts(boundary.rising)[some.path])
    found = ~np.isnan(y)
    levels = Levels(some.pin[found], some.sign[found], y[found])
    total, signed, lost = turns.size, int(np.where(odd, -1, 1).sum()), int(np.count_nonzero(~found))
    return Roots(levels, every.take(some.path[found]), some.rises[found], total, signed, lost, calls + more), said


def roots_on(boundary: Boundary, chain: Chain, some: Paths) -> Roots:
    """Every level on the chain at which one of these paths has the rod's length."""
    brackets, calls = _on_chain(boundary, chain, transit(boundary, chain.levels), some, 0)
    y, more = _closed_in(boundary, brackets, some.counts(boundary.rising)[brackets.path])
    found = ~np.isnan(y)
    levels = Levels(brackets.pin[found], brackets.sign[found], y[found])
    path, rises = brackets.path[found], brackets.rises[found]
    return Roots(levels, some.take(path), rises, path.size, 0, int(np.count_nonzero(~found)), calls + more)


@dataclass(frozen=True, eq=False)
class Brackets:
    """K pairs of levels between which the length of a path passes the rod's, (K,) each: pin, sign, y of both; the same
    y twice where it is known already. path: its number. rises: whether the length grows with the level."""

    pin: NDArray[np.int64]
    sign: Array
    first: Array
    second: Array
    path: NDArray[np.int64]
    rises: NDArray[np.bool_]

    def take(self, index: Any) -> "Brackets":
        return Brackets(**{name: v[index] for name, v in vars(self).items()})


def _joined(parts: list[Brackets]) -> Brackets:
    names = ("pin", "sign", "first", "second", "path", "rises")
    columns: dict[str, Any] = {name: np.concatenate([getattr(p, name) for p in parts]) for name in names}
    return Brackets(**columns)


def _on_chain(boundary: Boundary, chain: Chain, seen: Transit, some: Paths, before: int) -> tuple[Brackets, int]:
    """The brackets of N paths, the first of which is number `before` of all; and evaluations."""
    levels, counts = chain.levels, some.counts(boundary.rising)
    if not levels.y.size:  # no level joins the ends but a helix's own
        none = np.empty(0)
        return Brackets(none.astype(int), none, none, none, none.astype(int), none.astype(bool)), 0
    off = seen.lengths(counts) - boundary.problem.span[0]
    rate = seen.rates(counts)
    for own in np.flatnonzero(chain.place):  # at a saddle's own height the length is infinite, or continuous
        sides = [rate[:, j] for j in (own - 1, own + 1) if 0 <= j < levels.y.size]
        steep = np.fmax.reduce(sides) > 0
        off[:, own] = np.where(steep, np.inf, off[:, own] if own else np.nan)
    known, above = _above(off, boundary.problem.span[0])
    n, k = np.nonzero(known[:, :-1] & known[:, 1:] & (above[:, :-1] != above[:, 1:]))
    beside = chain.place[k] | chain.place[k + 1]
    rung = np.where(chain.place[k], k + 1, k)  # the real one, beside a saddle's own height
    place = levels.take(np.where(beside, rung, k + 1))
    with np.errstate(divide="ignore", invalid="ignore"):
        deep = place.y + np.where(rate[n, rung] > 0, off[n, rung] / rate[n, rung], 0.0)
        # next to the level at which the rod begins or ends at rest the length is linear in beta_t there
        share = -off[n, k] / (off[n, k + 1] - off[n, k])
        rests = chain.at_end & (k == 1) & (rate[n, k] == 0)
        at_rest = np.maximum(levels.y[min(2, levels.y.size - 1)] + 2 * np.log(share), boundary.deepest)
    y = np.where(beside, deep, np.where(rests, at_rest, np.nan))
    first = np.where(np.isnan(y), levels.y[k], y)
    second = np.where(np.isnan(y), place.y, y)
    direct = Brackets(place.pin, place.sign, first, second, n + before, above[n, k + 1])
    dips, calls = _dips(boundary, chain, some, off)
    return _joined([direct, replace(dips, path=dips.path + before)]), calls


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


def _closed_in(boundary: Boundary, some: Brackets, counts: Array) -> tuple[Array, int]:
    """y of the root in each bracket, (K,), NaN where there turned out to be none; and evaluations."""
    y = some.second.copy()
    open_ = np.flatnonzero(some.first != some.second)
    if not open_.size:
        return y, 0
    some, counts = some.take(open_), counts[open_]
    from scipy.optimize import elementwise  # SciPy does not fetch this part by itself, and it need not come sooner

    calls = 0

    def off(y: Array, which: Array) -> Array:
        nonlocal calls
        i = which.astype(int)
        seen = transit(boundary, Levels(some.pin[i], some.sign[i], y))
        calls += seen.calls
        return seen.lengths_along(counts[i]) - boundary.problem.span[0]

    low, high = np.minimum(some.first, some.second), np.maximum(some.first, some.second)
    which = np.arange(low.size, dtype=float)
    tolerances = {"xatol": 1e-14, "xrtol": 1e-15}
    told = elementwise.find_root(off, (low, high), args=(which,), tolerances=tolerances, maxiter=60)
    root = np.where(told.success, told.x, np.nan)
    for i in np.flatnonzero(~told.success):  # within rounding of one end of its bracket
        ends = np.array([low[i], high[i]])
        size = np.abs(off(ends, np.full(2, float(i))))
        if np.nanmin(size) < 1e-9 * boundary.problem.span[0]:
            root[i] = ends[int(np.nanargmin(size))]
    y[open_] = root
    return y, calls


def _dips(boundary: Boundary, chain: Chain, some: Paths, off: Array) -> tuple[Brackets, int]:
    """Brackets of the two roots between rungs where the length comes near the rod's, passes it and returns."""
    counts, size = some.counts(boundary.rising), np.abs(off)
    with np.errstate(invalid="ignore"):
        same = (off[:, 1:-1] * off[:, :-2] > 0) & (off[:, 1:-1] * off[:, 2:] > 0)
        least = same & (size[:, 1:-1] < size[:, :-2]) & (size[:, 1:-1] <= size[:, 2:])
        # the bottom of a dip lies below its lowest rung by a fraction of the rise to the next ones
        rise = np.fmax(size[:, :-2] - size[:, 1:-1], size[:, 2:] - size[:, 1:-1])
        near = least & (size[:, 1:-1] < 0.25 * rise) & np.isfinite(rise)
    path, rung = np.nonzero(near)
    out: list[tuple[int, float, float, float, int, bool]] = []
    calls = 0
    for n, k in zip(path, rung + 1, strict=True):
        cells = chain.cell(int(k) - 1), chain.cell(int(k))
        if None in cells:
            continue
        found, more = _dip(boundary, cells, counts[n], bool(off[n, k] > 0))
        out += [(*cell, int(n), rises) for cell, rises in found]
        calls += more
    columns = zip(*out, strict=True) if out else iter([()] * 6)
    kinds = (int, float, float, float, int, bool)
    return Brackets(*(np.array(c, dtype=kind) for c, kind in zip(columns, kinds, strict=True))), calls


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
            passes = np.argwhere(over[:, :-1] != over[:, 1:])
            return [((*cells[a][:2], y[a, b], y[a, b + 1]), bool(over[a, b + 1])) for a, b in passes], calls
        if np.isnan(off).any():
            return [], calls
        least = int(np.argmin(np.abs(off)))
        c, j = divmod(least, _ZOOM)
        before = (c, j - 1) if j else (0, _ZOOM - 2)
        after = (c, j) if j < _ZOOM - 1 else (1, 0)
        cells = [(*cells[a][:2], y[a, b], y[a, b + 1]) for a, b in (before, after)]
    return [], calls


def ways_of(boundary: Boundary, roots: Roots, helix: Any) -> tuple[Way, Array]:
    """Level and path of each root, the helix last; and whether the length grows with the level, NaN for the helix."""
    levels, some = roots.levels, roots.paths
    columns: list[Any] = [boundary.pins[levels.pin], levels.sign, levels.y]
    columns += [some.leaving, some.arriving, some.swings, np.zeros(levels.y.size, dtype=bool)]
    lengthens = roots.lengthens.astype(float)
    if helix is not None:
        mark = (helix[0], 1.0, -np.inf, 0, 0, 0, True)
        columns = [np.append(c, np.asarray(v, dtype=c.dtype)) for c, v in zip(columns, mark, strict=True)]
        lengthens = np.append(lengthens, np.nan)
    return Way(*columns), lengthens


def solved(problem: Reduced, boundary: Boundary, way: Way, lengthens: Array) -> tuple[Orbit, Array]:
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
    falls = np.ones((K, 2))  # of the ends from the pin
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
    return replace(orbit, problem=start, lengthens=lengthens, response=growth, passed=passed, path=way), level


def _blur(orbit: Orbit) -> Array:
    """How far the rounding of the rod's length may move beta at its far end, (K,)."""
    fastest = np.zeros(orbit.problem.size)
    np.maximum.at(fastest, orbit.panels.part // 2, orbit.panels.fastest)
    return np.asarray(64 * np.finfo(float).eps * orbit.problem.span * fastest)


def _range(orbit: Orbit) -> tuple[Array, Array]:
    """Smallest and largest beta along each rod, (K,): at its ends or at turning points."""
    problem = orbit.problem
    assert problem.betaL is not None
    lowest, highest = np.minimum(problem.beta0, problem.betaL), np.maximum(problem.beta0, problem.betaL)
    tip = np.repeat(problem.beta0, 2)
    tip[orbit.panels.part] = orbit.panels.series[:, 0].sum(axis=1)  # the last panel of each part is written last
    tip = np.reshape(tip, (-1, 2))
    for passed, end in zip((orbit.turns > 0, orbit.turns > 1), tip.T, strict=True):
        lowest = np.where(passed, np.minimum(lowest, end), lowest)
        highest = np.where(passed, np.maximum(highest, end), highest)
    return lowest, highest
