"""One equilibrium of an ends problem by its orbit, and one problem with the critical points of its potential."""

from dataclasses import dataclass, replace

import numpy as np

from ..numerics.arrays import Array
from ..problem.reduced import EndsProblem
from .level_grid import boundary_of, floor_of, helix_of
from .transit_times import Boundary, LevelPaths, Levels, Paths, fall, transit_times


@dataclass(frozen=True)
class Path:
    """One equilibrium of an ends problem, by its orbit.

    pin: the angle, in [-pi, pi), from whose height the level is measured: a saddle of G, or one of the two ends.
    sign, y: the gap eta - G(pin) = sign exp(y). leaving: UP or DOWN, the direction at the start. turns: how many
    turning points the rod passes.
    """

    pin: float
    sign: float
    y: float
    leaving: int
    turns: int
    helix: bool = False  # the rod is a helix from end to end: it has no level, and its angle is the pin

    @property
    def arriving(self) -> int:
        """UP or DOWN, the direction at the far end."""
        return self.leaving if self.turns % 2 == 0 else -self.leaving

    @property
    def level_path(self) -> LevelPaths:
        """The same as `transit_times.LevelPaths` of one."""
        return LevelPaths(*(np.array([number]) for number in vars(self).values()))


def path_of(paths: LevelPaths, i: int) -> Path:
    """Equilibrium i of a search."""
    return Path(*(column[i].item() for column in vars(paths).values()))


class LinePoint:
    """One ends problem on the line between the first and the last, with the critical points of its G."""

    def __init__(self, problem: EndsProblem) -> None:
        self.problem = problem
        self.blank = boundary_of(problem)
        critical = self.blank.found
        self.angles = critical.beta[0, : critical.count[0]]
        self.saddles = self.angles[~critical.centre[0, : critical.count[0]]]
        self.start, self.end = (self.blank.low, self.blank.high)[:: 1 if self.blank.rising else -1]

    @property
    def is_tied(self) -> bool:
        """Whether G is the same at both ends, so that beta_t passes through 0 at both together."""
        return self.start == self.end or self.fall(self.start, self.end) == 0

    @property
    def helix(self) -> Path | None:
        """The rod that is a helix from end to end, where there is one."""
        helix = helix_of(self.problem, self.blank.found)
        return None if helix is None else Path(helix[0], 1.0, -np.inf, 0, 0, True)

    def fall(self, pin: float, beta: float) -> float:
        """G(pin) - G(beta)."""
        return fall(self.problem, pin, beta, bool((self.angles == pin).any()))

    def boundary(self, pin: float) -> Boundary:
        """The problem with its levels measured from one angle."""
        falls = [[self.fall(pin, end) for end in (self.blank.low, self.blank.high)]]
        return replace(self.blank, pins=np.array([pin]), falls=np.array(falls))

    def joins_at(self, path: Path) -> bool:
        """Whether the level lies above every maximum of G between the two ends."""
        highest, _ = floor_of(self.blank, self.angles, self.saddles)
        gap = path.sign * float(np.exp(max(path.y, self.blank.deepest)))
        return (path.pin == highest and path.sign > 0) or gap + self.fall(path.pin, highest) >= 0

    def lengths(self, some: list[Path]) -> Array:
        """Lengths of paths whose levels have one pin, (M,)."""
        boundary = self.boundary(some[0].pin)
        y, sign = np.array([path.y for path in some]), np.full(len(some), some[0].sign)
        columns = np.array([(path.leaving, path.turns) for path in some])
        seen = transit_times(boundary, Levels(np.zeros(y.size, dtype=np.int64), sign, y))
        return seen.lengths_along(Paths(*columns.T).counts(boundary.rising))
