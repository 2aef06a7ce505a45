"""A leap along a line of problems under dead loads, where steps become too small and the branch goes on.

All equilibria of the neighbouring paths are computed a little farther on; the branch continues with the only one of the
same Morse index whose shape is close.
"""

import numpy as np

from ..equilibrium.given_numbers import Given, OrbitState, problem_of
from ..equilibrium.system import settle
from ..levels.level_grid import level_grid_of
from ..levels.level_search import level_paths_of, roots_on
from ..levels.line_point import LinePoint, Path, path_of
from ..levels.morse_index import jacobi_zeros
from ..levels.path_orbits import orbit_of, solve_orbits
from ..levels.transit_times import DOWN, UP, Paths
from ..numerics.arrays import Array
from ..orbit.periodic_orbit import Orbit
from ..problem.reduced import EndsProblem

LEAPS = (1e-3, 1e-4, 1e-5)  # shares of the line over which a leap is tried
NEAR, _CLEAR = 0.05, 4.0  # rad between two shapes of a branch after a leap; factor by which others must be farther


def leap(first: Given, last: Given, share: float, problem: EndsProblem, path: Path) -> tuple[OrbitState, float] | None:
    """The equilibrium a little farther on with a close shape and the same Morse index, and the share that is leapt.

    first, last: the ends of the line. problem, path: the equilibrium at a share of it. None where there is none beyond,
    or more than one.
    """
    before = orbit_of(problem, path)
    index, shape = jacobi_zeros(before)[0], shape_of(before)
    turns = int(index) if path.helix else path.turns
    for length in LEAPS:
        if share + length > 1:
            continue
        problem_there = problem_of(first.towards(last, share + length), {})
        every, orbit = _neighbours(LinePoint(problem_there), turns)
        if orbit is None:
            continue
        same = np.flatnonzero(jacobi_zeros(orbit) == index)
        apart = np.abs(shape_of(orbit)[same] - shape).max(axis=1)
        order = np.argsort(apart)
        if not order.size or apart[order[0]] > NEAR:
            continue
        if order.size > 1 and apart[order[1]] < _CLEAR * apart[order[0]]:
            continue
        settled = settle(problem_there, every[int(same[order[0]])])
        if not isinstance(settled, str):
            return settled, length
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
    ways = Paths(leaving, near)
    if not grid.place.size:
        return [], None
    roots = roots_on(boundary, grid, ways)
    if not roots.lengthens.size:
        return [], None
    paths, lengthens = level_paths_of(boundary, roots, None)
    orbit, _ = solve_orbits(problem, boundary, paths, lengthens)
    return [path_of(paths, i) for i in range(paths.y.size)], orbit


def shape_of(orbit: Orbit) -> Array:
    """beta at equal shares of the rod, (K, 257)."""
    return orbit.at(orbit.problem.span[:, None] * np.linspace(0, 1, 257))[0]
