"""A leap along a family of problems under dead loads, where steps become too small and the branch goes on.

All equilibria of the neighbouring paths are computed a little farther on; the branch continues with the only one of the
same Morse index whose shape is close.
"""

from collections.abc import Callable, Iterator

import numpy as np

from ..numerics.arrays import Array
from ..orbits.boundary import Boundary, Path, boundary_of, path_of
from ..orbits.level_grid import level_grid_of
from ..orbits.level_search import paths_of, roots_on
from ..orbits.path_orbits import orbit_of, solve_orbits
from ..orbits.periodic_orbit import Orbit, jacobi_zeros
from ..problem.dimensionless import EndsProblem
from .given_numbers import Given, problem_of

Guess = tuple[EndsProblem, Path, float]  # of an equilibrium: its problem and path, and a share of a way
# shares of the way over which a leap is tried. x10: shapes change more than `NEAR`, and none is found
LEAPS = (1e-3, 1e-4, 1e-5)
SHARES = np.linspace(0, 1, 257)  # of the length, at which two shapes are compared. x10: only time
# rad between two shapes of a branch after a leap; factor by which others must be farther. x10: leaps to other branches;
# branches that have close neighbours end
NEAR, _CLEAR = 0.05, 4.0


def leap(
    given_at: Callable[[float], Given | None], problem: EndsProblem, path: Path, longest: float = LEAPS[0]
) -> Iterator[Guess]:
    """The equilibria a little farther on with a close shape and the same Morse index, and the shares that are leapt.

    given_at: the numbers at a share of the way. problem, path: the equilibrium at its begin. longest: the share that is
    tried first. None is given where there is none beyond, or more than one.
    """
    before = orbit_of(problem, path)
    index, angles = jacobi_zeros(before)[0], angles_on(before)
    for length in _shares(longest):
        given = given_at(length)
        if given is None:
            continue
        problem_there = problem_of(given, {})
        every, orbit = _neighbours(boundary_of(problem_there), int(index))
        if orbit is None:
            continue
        same = np.flatnonzero(jacobi_zeros(orbit) == index)
        apart = np.abs(angles_on(orbit)[same] - angles).max(axis=1)
        order = np.argsort(apart)
        if not order.size or apart[order[0]] > NEAR:
            continue
        if order.size > 1 and apart[order[1]] < _CLEAR * apart[order[0]]:
            continue
        yield problem_there, every[int(same[order[0]])], length


def _shares(longest: float) -> Iterator[float]:
    """The shares of a line that are tried, falling."""
    while longest > LEAPS[0]:
        yield longest
        longest /= 4
    yield from LEAPS


def _neighbours(boundary: Boundary, index: int) -> tuple[list[Path], Orbit | None]:
    """Every equilibrium that may have a Morse index: zeros of beta_t separate those of the change of beta that is 0 at
    the start, so the rod has as many turning points as its index, or one more."""
    boundary, grid = level_grid_of(boundary)
    ways = boundary.ways(index + 1)
    ways = ways.take(ways.turns >= index)
    if not grid.at_saddle.size:
        return [], None
    roots = roots_on(boundary, grid, ways)
    if not roots.lengthens.size:
        return [], None
    paths, lengthens = paths_of(boundary, roots, None)
    orbit, _ = solve_orbits(boundary.problem, boundary, paths, lengthens)
    return [path_of(paths, i) for i in range(paths.y.size)], orbit


def angles_on(orbit: Orbit, u: Array = SHARES) -> Array:
    """beta at shares u of the length, (K, n)."""
    return orbit.at(orbit.problem.span[:, None] * u)[0]
