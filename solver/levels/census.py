"""The numbers of all equilibria of one ends problem without their shapes: beta_t(0), Morse index, turning points."""

from collections import Counter
from dataclasses import dataclass

import numpy as np

from ..numerics.arrays import Array, Integers
from ..problem.reduced import EndsProblem
from .level_grid import boundary_of, helix_of, level_grid_of
from .level_search import MOST_PERIODS, level_roots
from .morse_index import helix_half_waves, helix_index
from .transit_times import Boundary, Levels, transit_times


@dataclass(frozen=True, eq=False)
class Census:
    """The K equilibria of one ends problem, (K,) each: beta_t(0), Morse index, turning points passed.

    complete: whether, counted with (-1)^index, they add up to 1, as they must by degree.
    """

    slope: Array
    index: Integers
    turns: Integers
    complete: bool

    @property
    def count(self) -> int:
        return self.slope.size

    @property
    def stable(self) -> int:
        return int(np.count_nonzero(self.index == 0))

    @property
    def indices(self) -> Counter[int]:
        """How many equilibria have each index; only folds and pitchforks change it."""
        return Counter(int(i) for i in self.index)


def census(problem: EndsProblem) -> Census:
    """The equilibria of one ends problem (of size 1)."""
    found = _count(problem, 0.25)
    return found if found.complete else _count(problem, 0.0625)


def _count(problem: EndsProblem, step: float) -> Census:
    boundary, grid = level_grid_of(boundary_of(problem), step)
    roots, reason = level_roots(boundary, grid, MOST_PERIODS, None)
    turns, levels = roots.paths.turns, roots.levels
    speed2 = boundary.start_speed2(levels.pin, levels.sign * np.exp(np.maximum(levels.y, boundary.deepest)))
    slope = roots.paths.leaving * np.sqrt(np.maximum(speed2, 0.0))
    index = np.where(_rotates(boundary, levels), 0, np.maximum(turns - roots.lengthens, 0))
    helix = helix_of(problem, boundary.found)
    if helix is not None:
        index = np.append(index, helix_index(helix_half_waves(problem)))
        slope, turns = np.append(slope, 0.0), np.append(turns, 0)
    index = index.astype(np.int64)
    signed = int(np.where(index % 2 == 0, 1, -1).sum())
    return Census(slope, index, turns, signed == 1 and not roots.lost and not reason)


def _rotates(boundary: Boundary, levels: Levels) -> Array:
    if not levels.y.size:
        return np.zeros(0, dtype=bool)
    return np.asarray(transit_times(boundary, levels).rotates)
