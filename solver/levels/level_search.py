"""The search for every orbit that joins two end angles over a given length: for each path one equation in the level."""

from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..numerics.arrays import EPS, Array, Booleans
from ..orbit.periodic_orbit import Orbit
from ..problem.limits import LARGEST
from ..problem.reduced import EndsProblem
from .level_brackets import Brackets, brackets_on_grid, join_brackets, roots_in
from .level_grid import LevelGrid, boundary_of, helix_of, level_grid_of
from .morse_index import jacobi_zeros
from .path_orbits import energies, solve_orbits
from .transit_times import Boundary, LevelPaths, Levels, Paths, TransitTimes, transit_times

MOST_PERIODS = 200  # of an orbit along a rod, unless asked for more
BUDGET = 3e7  # evaluations of G: ten to twenty seconds
_EACH = 15  # levels computed for each equilibrium
_PATHS = 1000  # paths searched together
_COARSE = 0.5  # step in log gap of levels that are only looked at
_MISSED = 1e-6  # rad: an orbit that ends farther than this from beta(L) is rejected


@dataclass(frozen=True, eq=False)
class Found:
    """K equilibria of one ends problem and their orbits.

    slope: (K,), beta_t(0). orbit: of all. path: their levels and paths. index: (K,), Morse index. energy: (K,), in
    units of A/rho. lowest, highest: (K,), smallest and largest beta along the rod [rad]. total: how many equilibria
    were found, also those that were not solved. remark: why the list is incomplete; empty where it is complete.
    evaluations: of G.
    """

    problem: EndsProblem
    slope: Array
    orbit: Orbit
    path: LevelPaths
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
        first, last = self.problem.beta0, self.problem.betaL
        over = np.maximum(self.highest - np.maximum(first, last), np.minimum(first, last) - self.lowest)
        return np.maximum(over, 0.0)


@dataclass(frozen=True, eq=False)
class Roots:
    """K levels at which the length of a path is that of the rod; lengthens: (K,), whether it grows with the level.

    total: their number, with those on paths of more turning points than were asked for. signed: the same, each counted
    with (-1)^index. lost: brackets in which no root was found. calls: evaluations of G.
    """

    levels: Levels
    paths: Paths
    lengthens: Booleans
    total: int
    signed: int
    lost: int
    calls: int


def search_levels(
    problem: EndsProblem, most_periods: int = MOST_PERIODS, most_turns: int | None = None
) -> Found | None:
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
    Found or None
        None where no equilibrium was found.
    """
    found = None
    if not _fits(problem):
        return None
    for step in (0.25, 0.0625):
        found = _search(problem, most_periods, most_turns, step)
        if found is not None and not found.remark.startswith(_COUNT):
            break
    return found


_COUNT = "incomplete"


def _fits(problem: EndsProblem) -> bool:
    """Whether a float can hold the squares of the numbers of one ends problem, and of the beta_t that it needs."""
    numbers = problem.lam, problem.mu, problem.phi, problem.span, problem.beta0, problem.betaL
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        reach = np.abs(problem.betaL - problem.beta0) / problem.span
        return bool((np.abs(np.stack([*numbers, reach, 1 / problem.span])) < LARGEST).all())


def _search(problem: EndsProblem, most_periods: int, most_turns: int | None, step: float) -> Found | None:
    """One search, on a level grid of steps of `step` in log gap."""
    boundary, grid = level_grid_of(boundary_of(problem), step)
    roots, reason = level_roots(boundary, grid, most_periods, most_turns)
    helix = helix_of(problem, boundary.found)
    path, lengthens = level_paths_of(boundary, roots, helix)
    if not lengthens.size:
        return None
    orbit, level = solve_orbits(problem, boundary, path, lengthens)
    far = orbit.at(orbit.problem.span[:, None])[0][:, 0]
    good = np.abs(far - problem.betaL[0]) < np.maximum(_MISSED, np.minimum(_end_rounding(orbit), 0.1))
    lost = roots.lost + int(np.count_nonzero(~good))
    if not good.any():
        return None
    if not good.all():
        path, lengthens = path.take(good), lengthens[good]
        orbit, level = solve_orbits(problem, boundary, path, lengthens)
    index, energy = jacobi_zeros(orbit), energies(orbit, level)
    lowest, highest = _range(orbit, problem)
    helices = index[path.helix]
    signed = roots.signed + int(np.where(helices % 2 == 0, 1, -1).sum())
    remark = reason or _remark(index, energy, signed, lost)
    total, calls = roots.total + helices.size, roots.calls + int(orbit.panels.calls.sum())
    return Found(problem, orbit.problem.dbeta0, orbit, path, index, energy, lowest, highest, total, remark, calls)


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


def level_roots(boundary: Boundary, grid: LevelGrid, most_periods: int, most_turns: int | None) -> tuple[Roots, str]:
    """Every level at which a path has the length of the rod, and what `most_periods` or `BUDGET` leaves out."""
    size, seen = grid.levels.y.size, transit_times(boundary, grid.levels)
    needed = _most_needed(boundary, grid, seen)
    reason = f"only equilibria of at most {most_periods} whole periods of beta were searched for"
    reason = reason if needed - 1 > most_periods else ""
    every = boundary.paths(2 * min(needed, most_periods) + 1)
    parts = [
        brackets_on_grid(boundary, grid, seen, every.take(slice(k, k + _PATHS)), k)
        for k in range(0, every.turns.size if size else 1, _PATHS)
    ]
    brackets, calls = join_brackets([p for p, _ in parts]), seen.calls + sum(more for _, more in parts)
    turns = every.turns[brackets.path]
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
    return _roots_in(boundary, brackets.take(kept), every, turns.size, signed, calls), reason


def _roots_in(boundary: Boundary, some: Brackets, paths: Paths, total: int, signed: int, calls: int) -> Roots:
    """The roots in some brackets of paths, and the numbers that are known of all."""
    y, more = roots_in(boundary, some, paths.counts(boundary.rising)[some.path])
    known = ~np.isnan(y)
    some, lost = some.take(known), int(np.count_nonzero(~known))
    levels = Levels(some.pin, some.sign, y[known])
    return Roots(levels, paths.take(some.path), some.rises, total, signed, lost, calls + more)


def _most_needed(boundary: Boundary, grid: LevelGrid, seen: TransitTimes) -> int:
    """The most whole periods of beta that a rod of this length may have."""
    period = 2 * seen.time.sum(axis=0)[~seen.rotates & ~grid.place]
    shortest = float(np.nanmin(period, initial=np.inf))
    return int(min(float(boundary.problem.span[0]) / shortest, 1e9)) + 1 if np.isfinite(shortest) else 0


def near_misses(problem: EndsProblem, most_periods: int) -> tuple[int, Counter[tuple[int, int, bool]]]:
    """The number of equilibria that are no helix, as seen on a coarse grid of levels; and how often the length of each
    path (leaving, turns) has a least value above that of the rod (True), or a largest below it (False):
    there two equilibria appear if the two meet."""
    boundary, grid = level_grid_of(boundary_of(problem), _COARSE)
    seen = transit_times(boundary, grid.levels)
    every = boundary.paths(2 * min(_most_needed(boundary, grid, seen), most_periods) + 1)
    if grid.levels.y.size < 3 or not every.turns.size:
        return 0, Counter()
    count = brackets_on_grid(boundary, grid, seen, every, 0)[0].path.size
    off = seen.lengths(every.counts(boundary.rising)) - problem.span[0]
    off[:, grid.place] = np.nan
    before, here, after = off[:, :-2], off[:, 1:-1], off[:, 2:]
    with np.errstate(invalid="ignore"):
        least = (here > 0) & (here < before) & (here <= after)
        largest = (here < 0) & (here > before) & (here >= after)
    ways = list(zip(every.leaving.tolist(), every.turns.tolist(), strict=True))
    sides = ((True, least), (False, largest))
    return count, Counter((*ways[n], above) for above, some in sides for n in np.nonzero(some)[0])


def roots_on(boundary: Boundary, grid: LevelGrid, some: Paths) -> Roots:
    """Every level at which one of these paths has the length of the rod."""
    brackets, calls = brackets_on_grid(boundary, grid, transit_times(boundary, grid.levels), some, 0)
    return _roots_in(boundary, brackets, some, brackets.path.size, 0, calls)


def level_paths_of(boundary: Boundary, roots: Roots, helix: Any) -> tuple[LevelPaths, Array]:
    """Level and path of each root, the helix last; and whether its length grows with the level, NaN for the helix."""
    levels, some = roots.levels, roots.paths
    columns: list[Any] = [boundary.pins[levels.pin], levels.sign, levels.y]
    columns += [some.leaving, some.turns, np.zeros(levels.y.size, dtype=bool)]
    lengthens = roots.lengthens.astype(float)
    if helix is not None:
        mark = (helix[0], 1.0, -np.inf, 0, 0, True)
        columns = [np.append(c, np.asarray(v, dtype=c.dtype)) for c, v in zip(columns, mark, strict=True)]
        lengthens = np.append(lengthens, np.nan)
    return LevelPaths(*columns), lengthens


def _end_rounding(orbit: Orbit) -> Array:
    """How far the rounding of the rod's length may move beta at the far end, (K,)."""
    fastest = np.zeros(orbit.problem.size)
    np.maximum.at(fastest, orbit.panels.arc // 2, orbit.panels.fastest)
    return np.asarray(64 * EPS * orbit.problem.span * fastest)


def _range(orbit: Orbit, problem: EndsProblem) -> tuple[Array, Array]:
    """Smallest and largest beta along each rod, (K,): at its ends or at turning points."""
    lowest, highest = np.minimum(problem.beta0, problem.betaL), np.maximum(problem.beta0, problem.betaL)
    tip = np.repeat(orbit.problem.beta0, 2)
    tip[orbit.panels.arc] = orbit.panels.series[:, 0].sum(axis=1)  # the last panel of each arc is written last
    tip = np.reshape(tip, (-1, 2))
    for passed, end in zip((orbit.turns > 0, orbit.turns > 1), tip.T, strict=True):
        lowest = np.where(passed, np.minimum(lowest, end), lowest)
        highest = np.where(passed, np.maximum(highest, end), highest)
    return lowest, highest
