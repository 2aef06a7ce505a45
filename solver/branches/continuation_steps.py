"""One step of continuation: predictor and corrector in a coordinate, or a leap to the neighbouring paths."""

from dataclasses import dataclass

import numpy as np

from ..equilibrium.charts import Chart, charts, coordinate, excess, path_at
from ..levels.level_grid import level_grid_of
from ..levels.level_search import level_paths_of, roots_on
from ..levels.line_point import LinePoint, Path, path_of
from ..levels.morse_index import jacobi_zeros
from ..levels.path_orbits import orbit_of, solve_orbits
from ..levels.paths import DOWN, UP, Paths
from ..numerics.arrays import Array
from ..orbit.periodic_orbit import Orbit
from ..problem.reduced import EndsProblem

FOLD, LEFT = "a fold", "no orbit of its path joins the two ends there"
_NUDGE = 1e-5  # of the unknown's scale, for differences
SHORTEST = 1e-6  # share of the line below which a step is abandoned
LEAPS = (1e-3, 1e-4, 1e-5)  # shares of the line over which a leap is tried
NEAR, _CLEAR = 0.05, 4.0  # rad between two shapes of a branch after a leap; factor by which others must be farther
_EASY = 1e-3  # length of a step above which only the best coordinate is tried
_CORRECTIONS = 12
_REACH = 0.25  # largest change of the unknown in a step, in its scales
FIELDS = ("lam", "mu", "phi", "span", "beta0", "betaL")


@dataclass(frozen=True)
class Line:
    """The line of problems from the first (share 0) to the last (share 1)."""

    first: EndsProblem
    last: EndsProblem

    @property
    def is_point(self) -> bool:
        """Whether the two are one problem."""
        return all(np.array_equal(getattr(self.first, n), getattr(self.last, n)) for n in FIELDS)

    def at(self, share: float) -> LinePoint:
        if share >= 1:
            return LinePoint(self.last)
        mixed = {n: (1 - share) * getattr(self.first, n) + share * getattr(self.last, n) for n in FIELDS}
        return LinePoint(EndsProblem(**mixed))


def advanced(
    line: Line, place: LinePoint, path: Path, share: float, step: float
) -> tuple[LinePoint, Path, float] | str:
    """The equilibrium after at most one step, and the step taken; else why the step failed in the best coordinate."""
    first = ""
    for chart in charts(place, path):
        advance = _advance(line, place, chart, share, step)
        if not isinstance(advance, str):
            return advance
        first = first or advance
        if step > _EASY:
            break
    return first


def _advance(
    line: Line, place: LinePoint, chart: Chart, share: float, step: float
) -> tuple[LinePoint, Path, float] | str:
    x, nudge = coordinate(chart), _NUDGE * chart.scale
    off = excess(place, chart, np.array([x - nudge, x, x + nudge]))
    rate = float(off[2] - off[0]) / (2 * nudge)
    ahead = min(1e-6, step)
    drift = float(excess(line.at(share + ahead), chart, np.array([x]))[0] - off[1]) / ahead
    if not np.isfinite(rate) or not np.isfinite(drift) or rate == 0:
        return LEFT
    speed = -drift / rate
    if abs(speed) * step > _REACH * chart.scale:
        step = _REACH * chart.scale / abs(speed)
        if step < SHORTEST:
            return FOLD
    there = line.at(share + step)
    found = _correct(there, chart, x + speed * step, rate)
    return found if isinstance(found, str) else (there, found, step)


def _correct(place: LinePoint, chart: Chart, guess: float, rate: float) -> Path | str:
    """The root of length - span next to a guess; rate: the derivative one step before."""
    nudge, x, best = _NUDGE * chart.scale, guess, np.inf
    for round_ in range(_CORRECTIONS):
        off = excess(place, chart, np.array([x - nudge, x, x + nudge]))
        if not np.isfinite(off).all():
            return LEFT
        here = float(off[2] - off[0]) / (2 * nudge)
        if not 0.25 < here / rate < 4:
            return FOLD
        step = -float(off[1]) / here
        if round_ > 2 and abs(step) >= best:
            break
        best = abs(step)
        x += step
        if abs(x - guess) > _REACH * chart.scale:
            return FOLD
        if abs(step) <= 4e-16 * max(abs(x), chart.scale):
            break
    path = path_at(place, chart, x)
    if path is not None and not place.joined_at(path):
        return LEFT
    if path is None or best > 1e-9 * max(abs(x), chart.scale):
        return "the correction did not converge"
    return path


def settle(place: LinePoint, path: Path) -> Path | str:
    """The path with its level corrected on its own problem."""
    reason = ""
    for chart in charts(place, path):
        x, nudge = coordinate(chart), _NUDGE * chart.scale
        off = excess(place, chart, np.array([x - nudge, x + nudge]))
        rate = float(off[1] - off[0]) / (2 * nudge)
        if np.isfinite(rate) and rate != 0:
            found = _correct(place, chart, x, rate)
            if not isinstance(found, str):
                return found
            reason = reason or found
    return reason or LEFT


def leapt(line: Line, place: LinePoint, path: Path, share: float) -> tuple[LinePoint, Path, float] | None:
    """The equilibrium a little farther on with a close shape and the same Morse index.

    None where there is none, or more than one.
    """
    before = orbit_of(place.problem, path)
    index, shape = jacobi_zeros(before)[0], shape_of(before)
    turns = int(index) if path.helix else path.turns
    for leap in LEAPS:
        if share + leap > 1:
            continue
        there = line.at(share + leap)
        every, orbit = _neighbours(there, turns)
        if orbit is None:
            continue
        same = np.flatnonzero(jacobi_zeros(orbit) == index)
        apart = np.abs(shape_of(orbit)[same] - shape).max(axis=1)
        order = np.argsort(apart)
        if not order.size or apart[order[0]] > NEAR:
            continue
        if order.size > 1 and apart[order[1]] < _CLEAR * apart[order[0]]:
            continue
        settled = settle(there, every[int(same[order[0]])])
        if not isinstance(settled, str):
            return there, settled, leap
    return None


def _neighbours(place: LinePoint, turns: int) -> tuple[list[Path], Orbit | None]:
    """Every equilibrium whose path passes up to two turning points more or fewer."""
    problem = place.problem
    boundary, grid = level_grid_of(place.blank)
    near = np.arange(max(turns - 2, 0), turns + 3)
    leaving = np.repeat([UP, DOWN], near.size)
    near = np.tile(near, 2)
    plain = (leaving == (UP if boundary.rising else DOWN)) & (problem.beta0[0] != problem.betaL[0])
    kept = (near > 0) | plain
    leaving, near = leaving[kept], near[kept]
    some = Paths(leaving, np.where(near % 2 == 0, leaving, -leaving), near // 2)
    if not grid.place.size:
        return [], None
    roots = roots_on(boundary, grid, some)
    if not roots.lengthens.size:
        return [], None
    found, lengthens = level_paths_of(boundary, roots, None)
    orbit, _ = solve_orbits(problem, boundary, found, lengthens)
    return [path_of(found, i) for i in range(found.y.size)], orbit


def shape_of(orbit: Orbit) -> Array:
    """beta at equal shares of the rod, (K, 257)."""
    return orbit.at(orbit.problem.span[:, None] * np.linspace(0, 1, 257))[0]
