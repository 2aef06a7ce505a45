"""The search for every orbit that joins two end angles over a given length: for each path one equation in the level.

The sign of the length less the rod's, along the grid of levels, shows every bracket but those of two roots between two
points of the grid; these are searched for wherever the length comes near the rod's without passing it (a dip). A census
counts the equilibria without their shapes.
"""

from collections import Counter
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..core.tuning import LOWEST
from ..numerics.arrays import ALIKE, EPS, Array, Booleans, Columns, Integers
from ..numerics.roots import EXACT
from ..problem.dimensionless import EndsProblem
from ..problem.limits import LARGEST
from .boundary import (
    Boundary,
    Levels,
    Paths,
    TransitTimes,
    Ways,
    boundary_of,
    helix_path,
    length_roots,
    transit_times,
)
from .level_grid import LevelGrid, level_grid_of
from .path_orbits import energies, solve_orbits
from .periodic_orbit import Orbit, helix_half_waves, helix_index, jacobi_zeros

MOST_PERIODS = 200  # of an orbit along a rod, unless asked for more. x10: longer lists, and their time
BUDGET = 3e7  # evaluations of G: ten to twenty seconds. x10: minutes, before a search says that it is incomplete
# levels computed for each equilibrium, by which the work is foretold. x10: searches are cut that could be done
_EACH = 15
_PATHS = 1000  # paths searched together: arrays of some MB. x10: only memory
_COARSE = 0.5  # step in log gap of levels that are only looked at. x10: pairs that nearly meet lie between two levels
# points of the finer grid at a dip, and how often it is refined: by 16 each time, to 6e-8 of a step. x10: only time
_ZOOM, _ROUNDS = 17, 6
# of the rise to the next of even steps: the bottom of a parabola lies less below the lowest point. x10: grids are
# refined in vain
_SHALLOW = 0.5


@dataclass(frozen=True, eq=False)
class FoundPaths:
    """K equilibria of one ends problem and their orbits.

    dbeta0: (K,), beta_t(0). orbit: of all, with their paths. index: (K,), Morse index. energy: (K,), in
    units of A/rho. lowest, highest: (K,), smallest and largest beta along the rod [rad]. total: how many equilibria
    were found, also those that were not solved. remark: why the list is incomplete; empty where it is complete.
    evaluations: of G.
    """

    problem: EndsProblem
    dbeta0: Array
    orbit: Orbit
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
        beta0, betaL = self.problem.beta0, self.problem.betaL
        over = np.maximum(self.highest - np.maximum(beta0, betaL), np.minimum(beta0, betaL) - self.lowest)
        return np.maximum(over, 0.0)


@dataclass(frozen=True, eq=False)
class _Roots:
    """K levels at which the length of a path is that of the rod; lengthens: (K,), whether it grows with the level.

    total: their number, with those on ways of more turning points than were asked for. signed: the same, each counted
    with (-1)^index. lost: brackets in which no root was found. calls: evaluations of G.
    """

    levels: Levels
    ways: Ways
    lengthens: Booleans
    total: int
    signed: int
    lost: int
    calls: int


@dataclass(frozen=True, eq=False)
class _Brackets(Columns):
    """K pairs of levels between which the length of a path passes that of the rod, (K,) each.

    pin, sign: of both levels. first, second: their y, equal where the root is known already. way: number of the way.
    rises: whether the length grows with the level.
    """

    pin: Integers
    sign: Array
    first: Array
    second: Array
    way: Integers
    rises: Booleans


def search_levels(
    problem: EndsProblem, most_periods: int = MOST_PERIODS, most_turns: int | None = None
) -> FoundPaths | None:
    """Every equilibrium of one ends problem.

    Parameters
    ----------
    problem : EndsProblem
        One ends problem.
    most_periods : int
        Search paths of at most this many whole periods of beta.
    most_turns : int, optional
        Solve only those of at most this many turning points; the others are counted. A stable equilibrium has one
        turning point at most, so 1 is enough for all stable ones, of which there is always at least one.

    Returns
    -------
    FoundPaths or None
        None where no equilibrium was found.
    """
    equilibria = None
    if not _fits(problem):
        return None
    for step in (0.25, 0.0625):
        equilibria = _search(problem, most_periods, most_turns, step)
        if equilibria is not None and not equilibria.remark.startswith(_COUNT):
            break
    return equilibria


_COUNT = "incomplete"


def _fits(problem: EndsProblem) -> bool:
    """Whether a float can hold the squares of the numbers of one ends problem, and of the beta_t that it needs."""
    numbers = problem.lam, problem.mu, problem.phi, problem.span, problem.beta0, problem.betaL
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        reach = np.abs(problem.betaL - problem.beta0) / problem.span
        return bool((np.abs(np.stack([*numbers, reach, 1 / problem.span])) < LARGEST.most).all())


def _search(problem: EndsProblem, most_periods: int, most_turns: int | None, step: float) -> FoundPaths | None:
    """One search, on a level grid of steps of `step` in log gap."""
    boundary, grid = level_grid_of(boundary_of(problem), step)
    roots, reason = level_roots(boundary, grid, most_periods, most_turns)
    paths, lengthens = paths_of(boundary, roots, boundary.helix_angle)
    if not lengthens.size:
        return None
    orbit, level = solve_orbits(problem, boundary, paths, lengthens)
    good = np.abs(orbit.far_angle - problem.betaL[0]) < np.maximum(ALIKE, np.minimum(_end_rounding(orbit), 0.1))
    lost = roots.lost + int(np.count_nonzero(~good))
    if not good.any():
        return None
    if not good.all():
        paths, lengthens = paths.take(good), lengthens[good]
        orbit, level = solve_orbits(problem, boundary, paths, lengthens)
    index, energy = jacobi_zeros(orbit), energies(orbit, level)
    lowest, highest = _range(orbit, problem)
    helices = index[paths.helix]
    signed = roots.signed + int(np.where(helices % 2 == 0, 1, -1).sum())
    remark = reason or _remark(index, energy, signed, lost)
    total, calls = roots.total + helices.size, roots.calls + int(orbit.panels.calls.sum())
    return FoundPaths(problem, orbit.problem.dbeta0, orbit, index, energy, lowest, highest, total, remark, calls)


def _remark(index: Array, energy: Array, signed: int, lost: int) -> str:
    """Why the list is incomplete, or nothing.

    By degree the equilibria, each counted with (-1)^index, add up to one, and the one of lowest energy has index 0.
    """
    if lost:
        return f"{_COUNT}: {lost} equilibria were bracketed and could not be solved"
    if signed != 1:
        return f"{_COUNT}: the equilibria found, each counted with (-1)^index, add up to {signed}, not to 1"
    lowest = energy <= energy.min() + 1e-9 * (1 + np.abs(energy.min()))
    if not (index[lowest] == 0).any():
        return f"{_COUNT}: the equilibrium of lowest energy found is unstable, so a lower one is missing"
    return ""


def level_roots(boundary: Boundary, grid: LevelGrid, most_periods: int, most_turns: int | None) -> tuple[_Roots, str]:
    """Every level at which a path has the length of the rod, and what `most_periods` or `BUDGET` leaves out."""
    size, seen = grid.levels.y.size, transit_times(boundary, grid.levels)
    needed = _most_needed(boundary, grid, seen)
    reason = f"only equilibria of at most {most_periods} whole periods of beta were searched for"
    reason = reason if needed - 1 > most_periods else ""
    ways = boundary.ways(2 * min(needed, most_periods) + 1)
    parts = [
        brackets_on_grid(boundary, grid, seen, ways.take(slice(k, k + _PATHS)), k)
        for k in range(0, ways.turns.size if size else 1, _PATHS)
    ]
    brackets, calls = _Brackets.join([p for p, _ in parts]), seen.calls + sum(more for _, more in parts)
    turns = ways.turns[brackets.way]
    kept = np.ones(turns.size, dtype=bool) if most_turns is None else turns <= most_turns
    afford = int(BUDGET / (_EACH * max(1.0, seen.calls / max(size, 1))))
    if np.count_nonzero(kept) > afford:
        most = int(np.sort(turns[kept])[afford]) - 1
        kept = kept & (turns <= most)
        reason = (
            f"only equilibria of at most {most} bends were solved: all {turns.size} would take too many evaluations"
        )
    odd = (turns - brackets.rises) % 2 == 1
    signed = int(np.where(odd, -1, 1).sum())
    return _roots_in(boundary, brackets.take(kept), ways, turns.size, signed, calls), reason


def _roots_in(boundary: Boundary, brackets: _Brackets, ways: Ways, total: int, signed: int, calls: int) -> _Roots:
    """The roots in brackets of ways, and the numbers that are known of all."""
    y, apart = brackets.second.copy(), brackets.first != brackets.second
    if apart.any():
        cells, counts = brackets.take(apart), ways.counts(boundary.rising)[brackets.way[apart]]
        y[apart], more = length_roots(boundary, Levels(cells.pin, cells.sign, cells.first), counts, cells.second)
        calls += more
    known = ~np.isnan(y)
    brackets, lost = brackets.take(known), int(np.count_nonzero(~known))
    levels = Levels(brackets.pin, brackets.sign, y[known])
    return _Roots(levels, ways.take(brackets.way), brackets.rises, total, signed, lost, calls)


def _most_needed(boundary: Boundary, grid: LevelGrid, seen: TransitTimes) -> int:
    """The most whole periods of beta that a rod of this length may have."""
    period = 2 * seen.time.sum(axis=0)[~seen.rotates & ~grid.at_saddle]
    shortest = float(np.nanmin(period, initial=np.inf))
    return int(min(float(boundary.problem.span[0]) / shortest, 1e9)) + 1 if np.isfinite(shortest) else 0


def near_misses(problem: EndsProblem, most_periods: int) -> tuple[int, Counter[tuple[int, int, bool]]]:
    """The number of equilibria that are no helix, as seen on a coarse grid of levels; and how often the length of each
    way (leaving, turns) has a least value above that of the rod (True), or a largest below it (False):
    there two equilibria appear if the two meet."""
    boundary, grid = level_grid_of(boundary_of(problem), _COARSE)
    seen = transit_times(boundary, grid.levels)
    ways = boundary.ways(2 * min(_most_needed(boundary, grid, seen), most_periods) + 1)
    if grid.levels.y.size < 3 or not ways.turns.size:
        return 0, Counter()
    count = brackets_on_grid(boundary, grid, seen, ways, 0)[0].way.size
    off = seen.lengths(ways.counts(boundary.rising)) - problem.span[0]
    off[:, grid.at_saddle] = np.nan
    before, middle, after = off[:, :-2], off[:, 1:-1], off[:, 2:]
    with np.errstate(invalid="ignore"):
        least = (middle > 0) & (middle < before) & (middle <= after)
        largest = (middle < 0) & (middle > before) & (middle >= after)
    pairs = list(zip(ways.leaving.tolist(), ways.turns.tolist(), strict=True))
    sides = ((True, least), (False, largest))
    return count, Counter((*pairs[n], above) for above, side in sides for n in np.nonzero(side)[0])


def roots_on(boundary: Boundary, grid: LevelGrid, ways: Ways) -> _Roots:
    """Every level at which one of these ways has the length of the rod."""
    brackets, calls = brackets_on_grid(boundary, grid, transit_times(boundary, grid.levels), ways, 0)
    return _roots_in(boundary, brackets, ways, brackets.way.size, 0, calls)


def paths_of(boundary: Boundary, roots: _Roots, helix: float | None) -> tuple[Paths, Array]:
    """The path of each root, and whether its length grows with the level; last, with NaN, that helix."""
    levels, ways = roots.levels, roots.ways
    bent = np.zeros(levels.y.size, dtype=bool)
    paths = Paths(boundary.pins[levels.pin], levels.sign, levels.y, ways.leaving, ways.turns, bent)
    lengthens = roots.lengthens.astype(float)
    if helix is None:
        return paths, lengthens
    return Paths.join([paths, helix_path(helix).alone]), np.append(lengthens, np.nan)


def _end_rounding(orbit: Orbit) -> Array:
    """How far the rounding of the rod's length may move beta at the far end, (K,)."""
    return np.asarray(64 * EPS * orbit.problem.span * orbit.fastest)


def _range(orbit: Orbit, problem: EndsProblem) -> tuple[Array, Array]:
    """Smallest and largest beta along each rod, (K,): at its ends or at turning points."""
    lowest, highest = np.minimum(problem.beta0, problem.betaL), np.maximum(problem.beta0, problem.betaL)
    tip = np.repeat(orbit.problem.beta0, 2)
    ends = orbit.panels.base + orbit.panels.series[:, 0].sum(axis=1)
    tip[orbit.panels.arc] = ends  # the last panel of each arc is written last
    tip = np.reshape(tip, (-1, 2))
    for passed, end in zip((orbit.turns > 0, orbit.turns > 1), tip.T, strict=True):
        lowest = np.where(passed, np.minimum(lowest, end), lowest)
        highest = np.where(passed, np.maximum(highest, end), highest)
    return lowest, highest


def brackets_on_grid(
    boundary: Boundary, grid: LevelGrid, seen: TransitTimes, ways: Ways, before: int
) -> tuple[_Brackets, int]:
    """The brackets of N ways, of which the first has the number `before`; and the evaluations of G."""
    levels, counts = grid.levels, ways.counts(boundary.rising)
    if not levels.y.size:  # no level joins the ends but a helix's own
        none = np.empty(0)
        return _Brackets(none.astype(int), none, none, none, none.astype(int), none.astype(bool)), 0
    off = seen.lengths(counts) - boundary.problem.span[0]
    rate = seen.rates(counts)
    for saddle in np.flatnonzero(grid.at_saddle):  # at a saddle's own height the length is infinite, or continuous
        sides = [rate[:, j] for j in (saddle - 1, saddle + 1) if 0 <= j < levels.y.size]
        steep = np.fmax.reduce(sides) > 0
        off[:, saddle] = np.where(steep, np.inf, off[:, saddle] if saddle else np.nan)
    known, above = _above(off, boundary.problem.span[0])
    n, k = np.nonzero(known[:, :-1] & known[:, 1:] & (above[:, :-1] != above[:, 1:]))
    beside = grid.at_saddle[k] | grid.at_saddle[k + 1]
    real = np.where(grid.at_saddle[k], k + 1, k)  # the real one, beside a saddle's own height
    at = levels.take(np.where(beside, real, k + 1))
    with np.errstate(divide="ignore", invalid="ignore"):
        deep = at.y + np.where(rate[n, real] > 0, off[n, real] / rate[n, real], 0.0)
        # next to the level at which the rod begins or ends at rest the length is linear in beta_t there
        share = -off[n, k] / (off[n, k + 1] - off[n, k])
        rests = grid.at_end & (k == 1) & (rate[n, k] == 0)
        at_rest = np.maximum(levels.y[min(2, levels.y.size - 1)] + 2 * np.log(share), boundary.deepest)
    y = np.where(beside, deep, np.where(rests, at_rest, np.nan))
    first = np.where(np.isnan(y), levels.y[k], y)
    second = np.where(np.isnan(y), at.y, y)
    direct = _Brackets(at.pin, at.sign, first, second, n + before, above[n, k + 1])
    dips, calls = _dips(boundary, grid, ways, off)
    return _Brackets.join([direct, replace(dips, way=dips.way + before)]), calls


def _above(off: Array, span: float) -> tuple[Booleans, Booleans]:
    """Where lengths are known, and where they are not below the rod's, (N, M).

    A length that differs from the rod's by rounding alone takes the side of the level before it, so that rounding makes
    no bracket.
    """
    known = ~np.isnan(off)
    with np.errstate(invalid="ignore"):
        above, sure = off >= 0, ~(np.abs(off) <= EXACT * span)
    sure[:, 1:] |= ~known[:, :-1]
    sure[:, 0] = True
    last = np.maximum.accumulate(np.where(sure, np.arange(off.shape[1]), 0), axis=1)
    return known, np.take_along_axis(above, last, axis=1)


def _dips(boundary: Boundary, grid: LevelGrid, ways: Ways, off: Array) -> tuple[_Brackets, int]:
    """Brackets of the two roots between grid points where the length comes near the rod's, passes it and returns."""
    counts, size = ways.counts(boundary.rising), np.abs(off)
    with np.errstate(invalid="ignore"):
        same = (off[:, 1:-1] * off[:, :-2] > 0) & (off[:, 1:-1] * off[:, 2:] > 0)
        least = same & (size[:, 1:-1] < size[:, :-2]) & (size[:, 1:-1] <= size[:, 2:])
        # the bottom of a dip lies below its lowest point by a fraction of the rise to the next ones: of a parabola by
        # 1/8 at even steps, and by 4/5 where one step is four times the other
        rise = np.fmax(size[:, :-2] - size[:, 1:-1], size[:, 2:] - size[:, 1:-1])
        near = least & (size[:, 1:-1] < rise) & np.isfinite(rise)
    way, least_at = np.nonzero(near)
    out: list[tuple[int, float, float, float, int, bool]] = []
    calls = 0
    for n, k in zip(way, least_at + 1, strict=True):
        cells = grid.cell(int(k) - 1), grid.cell(int(k))
        if None in cells:
            continue
        dip, more = _dip(boundary, cells, counts[n], bool(off[n, k] > 0))
        out += [(*cell, int(n), rises) for cell, rises in dip]
        calls += more
    columns = zip(*out, strict=True) if out else iter([()] * 6)
    kinds = (int, float, float, float, int, bool)
    return _Brackets(*(np.array(c, dtype=kind) for c, kind in zip(columns, kinds, strict=True))), calls


def _dip(boundary: Boundary, cells: Any, counts: Array, above: bool) -> tuple[list[Any], int]:
    """The cells in which the length of one path passes that of the rod, of two neighbouring cells refined.

    Each with whether the length grows with the level; and the evaluations of G.
    """
    calls = 0
    for _ in range(_ROUNDS):
        y = np.stack([np.linspace(a, b, _ZOOM) for _, _, a, b in cells])
        pin, sign = (np.repeat([cell[j] for cell in cells], _ZOOM) for j in (0, 1))
        seen = transit_times(boundary, Levels(pin, sign, y.reshape(-1)))
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
        beside = np.abs(off[c, max(j - 1, 0) : j + 2])  # at even steps
        if np.abs(off[c, j]) > _SHALLOW * (beside.max() - np.abs(off[c, j])):
            return [], calls
        before = (c, j - 1) if j else (0, _ZOOM - 2)
        after = (c, j) if j < _ZOOM - 1 else (1, 0)
        cells = [(*cells[a][:2], y[a, b], y[a, b + 1]) for a, b in (before, after)]
    return [], calls


@dataclass(frozen=True, eq=False)
class Census:
    """The K equilibria of one ends problem, (K,) each: beta_t(0), Morse index, and the level.

    saddle, sign, y: the level is sign exp(y) above the height of a saddle at that angle, the nearest one; NaN of a
    helix. complete: whether, counted with (-1)^index, they add up to 1, as they must by degree.
    """

    dbeta0: Array
    index: Integers
    saddle: Array
    sign: Array
    y: Array
    complete: bool

    @property
    def count(self) -> int:
        return self.dbeta0.size

    @property
    def stable(self) -> int:
        return int(np.count_nonzero(self.index == 0))

    @property
    def indices(self) -> Counter[int]:
        """How many equilibria have each index; only folds and pitchforks change it."""
        return Counter(int(i) for i in self.index)


def census(problem: EndsProblem) -> Census:
    """The equilibria of one ends problem (of size 1)."""
    count = _count(problem, 0.25)
    return count if count.complete else _count(problem, 0.0625)


def _count(problem: EndsProblem, step: float) -> Census:
    boundary, grid = level_grid_of(boundary_of(problem), step)
    roots, reason = level_roots(boundary, grid, MOST_PERIODS, None)
    turns, levels = roots.ways.turns, roots.levels
    speed2 = boundary.start_speed2(levels.pin, levels.sign * np.exp(np.maximum(levels.y, boundary.deepest)))
    dbeta0 = roots.ways.leaving * np.sqrt(np.maximum(speed2, 0.0))
    rotates = transit_times(boundary, levels).rotates if levels.y.size else False
    index = np.where(rotates, 0, np.maximum(turns - roots.lengthens, 0))
    saddle, sign, y = _above_saddles(boundary, levels, grid.at_end)
    if boundary.helix_angle is not None:
        index = np.append(index, helix_index(helix_half_waves(problem)))
        dbeta0 = np.append(dbeta0, 0.0)
        saddle, sign, y = (np.append(numbers, np.nan) for numbers in (saddle, sign, y))
    index = index.astype(np.int64)
    signed = int(np.where(index % 2 == 0, 1, -1).sum())
    return Census(dbeta0, index, saddle, sign, y, signed == 1 and not roots.lost and not reason)


def _above_saddles(boundary: Boundary, levels: Levels, at_end: bool) -> tuple[Array, Array, Array]:
    """The saddle next to each of K levels, and the sign and the log of the gap, (K,) each.

    at_end: whether the first pin is an end of the rod; the others are saddles.
    """
    saddle, sign, y = boundary.pins[levels.pin], levels.sign.copy(), levels.y.copy()
    by_end = at_end & (levels.pin == 0)
    if by_end.any():
        rises = [boundary.fall(float(s), float(boundary.pins[0])) for s in boundary.saddles]
        gaps = np.exp(np.maximum(y[by_end], boundary.deepest)) - np.array(rises)[:, None]
        nearest = np.abs(gaps).argmin(axis=0)
        gap = gaps[nearest, np.arange(nearest.size)]
        saddle[by_end], sign[by_end] = boundary.saddles[nearest], np.where(gap < 0, -1.0, 1.0)
        with np.errstate(divide="ignore"):
            y[by_end] = np.maximum(np.log(np.abs(gap)), LOWEST)
    return saddle, sign, y
