"""Continuation of one equilibrium while its ends, its loads, its length or the cylinder change.

An equilibrium is one orbit: the direction in which it leaves, the number of turning points that it passes, and its
level. For a fixed path the level follows from one scalar equation, length(level) = span. The unknown is one of

* log|gap| above or below a saddle that the rod passes or turns before: a rod that stays near a saddle is as easy to
  follow as any other;
* log beta_t^2 at one of the two ends;
* beta_t at an end, with its sign, where it is small: there the orbit that leaves upward and the one that leaves
  downward meet, and the path changes by one turning point.

Steps lead from the given problem to the wanted one, by predictor and corrector. d length/d unknown must keep its sign
from step to step: it changes at a fold, and between two neighbouring equilibria of one path. So the steps stop at a
fold and before a neighbour; small steps make a jump over both unlikely, but do not exclude it. Where steps become small
and the branch does not end (an end of the rod crosses a saddle, in a range as narrow as exp(-r L)), a leap is made: all
equilibria of the neighbouring paths are computed a little farther on, and the branch continues with the only one of the
same Morse index whose shape is close to the last.
"""

from dataclasses import dataclass, replace

import numpy as np

from ..numerics.arrays import Array
from ..orbit.periodic_orbit import Orbit, solve_orbit
from ..orbit.pieces import HELIX
from ..problem.reduced import Reduced
from .branch_coordinates import Chart, LinePoint, Path, charts, coordinate, excess, path_at, path_of
from .level_grid import level_grid_of
from .paths import DOWN, UP, Paths
from .search import level_paths_of, roots_on, solved_orbits
from .stability import jacobi_zeros

FOLD, LEFT = "a fold", "no orbit of its path joins the two ends there"
_NUDGE = 1e-5  # of the unknown's scale, for differences
_SHORTEST = 1e-6  # share of the line below which a step is abandoned
_LEAPS = (1e-3, 1e-4, 1e-5)  # shares of the line over which a leap is tried
_NEAR, _CLEAR = (
    0.05,
    4.0,
)  # rad between two shapes of one branch after a leap; factor by which the next shape must be farther
_EASY = 1e-3  # length of a step above which only the best coordinate is tried
_MOST_STEPS = 4000
_CORRECTIONS = 12
_REACH = 0.25  # largest change of the unknown in a step, in its scales
_FIELDS = ("lam", "mu", "phi", "span", "beta0", "betaL")


@dataclass(frozen=True)
class Ended:
    """Why a branch could not be followed, and the share of the line to the wanted problem that was covered."""

    share: float
    reason: str


@dataclass(frozen=True)
class _Line:
    """The line of problems from the first (share 0) to the last (share 1)."""

    first: Reduced
    last: Reduced

    @property
    def is_point(self) -> bool:
        """Whether the two are one problem."""
        return all(np.array_equal(getattr(self.first, n), getattr(self.last, n)) for n in _FIELDS)

    def at(self, share: float) -> LinePoint:
        if share >= 1:
            return LinePoint(self.last)
        mixed = {n: (1 - share) * getattr(self.first, n) + share * getattr(self.last, n) for n in _FIELDS}
        return LinePoint(Reduced(**mixed))


def continued(first: Reduced, path: Path, last: Reduced) -> Path | Ended:
    """The equilibrium of the problem `last` on the branch of an equilibrium of `first`.

    All numbers of the two problems change together, in proportion.

    Parameters
    ----------
    first, last : Reduced
        One ends problem each.
    path : Path
        The equilibrium of `first`.

    Returns
    -------
    Path or Ended
        `Ended` where the branch ends between the two; no other equilibrium is returned in its place.
    """
    line = _Line(first, last)
    place, target = line.at(0.0), line.at(1.0)
    if path.helix and target.helix is not None and first.beta0[0] == last.beta0[0]:
        return target.helix  # H is linear in the loads, so it is zero on the whole line
    if target.helix is None:
        return _followed(line, place, path)
    before = _Line(first, line.at(1 - _LEAPS[0]).problem)
    near = _followed(before, place, path)
    if isinstance(near, Ended):
        return near
    orbits = orbit_of(before.last, near), orbit_of(last, target.helix)
    shapes, index = [_shape(orbit) for orbit in orbits], [jacobi_zeros(orbit)[0] for orbit in orbits]
    if np.abs(shapes[0] - shapes[1]).max() < _NEAR and index[0] == index[1]:
        return target.helix
    return _followed(_Line(before.last, last), LinePoint(before.last), near)


def _followed(line: _Line, place: LinePoint, path: Path) -> Path | Ended:
    """The path followed along the line; not both ends of the line are helices."""
    share, step, here = 0.0, 1.0, path
    if path.helix:
        begun = _leapt(line, place, path, share)
        if begun is None:
            return Ended(share, "no equilibrium next to the helix")
        place, here, share = begun
    else:
        settled = _settled(place, path)
        if isinstance(settled, str):
            return Ended(share, settled)
        if line.is_point:
            return settled
        here = settled
    for _ in range(_MOST_STEPS):
        if share >= 1:
            return here
        advance = _advanced(line, place, here, share, min(step, 1 - share))
        if isinstance(advance, str):
            step = min(step, 1 - share) / 4
            if step >= _SHORTEST:
                continue
            leap = _leapt(line, place, here, share)
            if leap is None:
                return Ended(share, advance)
            advance = leap
        place, here, taken = advance
        share = 1.0 if taken >= 1 - share else share + taken
        step = 2 * taken
    return Ended(share, f"the limit of {_MOST_STEPS} steps")


def path_from_start(problem: Reduced, slope: float) -> Path | None:
    """The equilibrium of one ends problem that starts with beta_t(0) = slope.

    None where that orbit does not end at beta(L) within 1e-6 rad.
    """
    assert problem.betaL is not None
    orbit = solve_orbit(replace(problem, betaL=None, dbeta0=np.array([slope])), 1e-13)
    if abs(float(orbit.at(problem.span[:, None])[0][0, 0] - problem.betaL[0])) > 1e-6:
        return None
    place = LinePoint(problem)
    if orbit.kind[0] == HELIX:
        return place.helix
    y = 2 * float(np.log(max(abs(slope), 1e-150)))
    return Path(place.start, 1.0, y, UP if slope > 0 else DOWN, int(orbit.turns[0]))


def orbit_of(problem: Reduced, path: Path) -> Orbit:
    """The orbit of one equilibrium, with the fields that its Morse index and its condition number need."""
    place = LinePoint(problem)
    if path.helix:
        return solved_orbits(problem, place.boundary(path.pin), path.level_path, np.array([np.nan]))[0]
    length = place.lengths([replace(path, y=path.y - 1e-4), replace(path, y=path.y + 1e-4)])
    lengthens = np.array([float(path.sign * (length[1] - length[0]) > 0)])
    return solved_orbits(problem, place.boundary(path.pin), path.level_path, lengthens)[0]


# steps


def _advanced(
    line: _Line, place: LinePoint, path: Path, share: float, step: float
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
    line: _Line, place: LinePoint, chart: Chart, share: float, step: float
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
        if step < _SHORTEST:
            return FOLD
    there = line.at(share + step)
    found = _corrected(there, chart, x + speed * step, rate)
    return found if isinstance(found, str) else (there, found, step)


def _corrected(place: LinePoint, chart: Chart, guess: float, rate: float) -> Path | str:
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


def _settled(place: LinePoint, path: Path) -> Path | str:
    """The path with its level corrected on its own problem."""
    reason = ""
    for chart in charts(place, path):
        x, nudge = coordinate(chart), _NUDGE * chart.scale
        off = excess(place, chart, np.array([x - nudge, x + nudge]))
        rate = float(off[1] - off[0]) / (2 * nudge)
        if np.isfinite(rate) and rate != 0:
            found = _corrected(place, chart, x, rate)
            if not isinstance(found, str):
                return found
            reason = reason or found
    return reason or LEFT


def _leapt(line: _Line, place: LinePoint, path: Path, share: float) -> tuple[LinePoint, Path, float] | None:
    """The equilibrium a little farther on with a close shape and the same Morse index.

    None where there is none, or more than one.
    """
    before = orbit_of(place.problem, path)
    index, shape = jacobi_zeros(before)[0], _shape(before)
    turns = int(index) if path.helix else path.turns
    for leap in _LEAPS:
        if share + leap > 1:
            continue
        there = line.at(share + leap)
        every, orbit = _neighbours(there, turns)
        if orbit is None:
            continue
        same = np.flatnonzero(jacobi_zeros(orbit) == index)
        apart = np.abs(_shape(orbit)[same] - shape).max(axis=1)
        order = np.argsort(apart)
        if not order.size or apart[order[0]] > _NEAR:
            continue
        if order.size > 1 and apart[order[1]] < _CLEAR * apart[order[0]]:
            continue
        settled = _settled(there, every[int(same[order[0]])])
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
    plain = (leaving == (UP if boundary.rising else DOWN)) & (problem.beta0[0] != problem.betaL[0])  # type: ignore[index]
    kept = (near > 0) | plain
    leaving, near = leaving[kept], near[kept]
    some = Paths(leaving, np.where(near % 2 == 0, leaving, -leaving), near // 2)
    if not grid.place.size:
        return [], None
    roots = roots_on(boundary, grid, some)
    if not roots.lengthens.size:
        return [], None
    found, lengthens = level_paths_of(boundary, roots, None)
    orbit, _ = solved_orbits(problem, boundary, found, lengthens)
    return [path_of(found, i) for i in range(found.y.size)], orbit


def _shape(orbit: Orbit) -> Array:
    """beta at equal shares of the rod, (K, 257)."""
    return orbit.at(orbit.problem.span[:, None] * np.linspace(0, 1, 257))[0]
