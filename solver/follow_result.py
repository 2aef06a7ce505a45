"""A branch of equilibria over one field of a case; `follow` makes it."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from .numerics.arrays import Array, Integers
from .problem.case import Case
from .problem.dimensionless import EndsProblem, reduce
from .problem.errors import InputError, show
from .problem.shown import make
from .solution import Solution

HELIX = "helix ceases"  # a kind of special point
BORDER = "border of the range"  # a kind of end


@dataclass(frozen=True, eq=False)
class BranchPoint:
    """One equilibrium of a branch.

    Attributes
    ----------
    value : float
        The value of the field.
    index : int
        Morse index under the ends of the case; 0: stable; -1: not known. At a special point the smaller of the two.
    path : Path or Shape
        Its level and its path, which identify it among the equilibria of the case; with weight or friction its shape on
        nodes.
    """

    value: float
    index: int
    path: Any = field(repr=False)
    _under_dead_loads: EndsProblem | None = field(repr=False)  # None: that of its case
    _case: Callable[[float], Case] = field(repr=False)  # these two make what is read
    _solve: Callable[["BranchPoint"], Solution] = field(repr=False)

    @cached_property
    def case(self) -> Case:
        """Its case, made when it is first read, as `problem` and `solution` are."""
        return self._case(self.value)

    @cached_property
    def problem(self) -> EndsProblem:
        """The dimensionless problem that it solves, with the loads that held ends need."""
        if self._under_dead_loads is not None:
            return self._under_dead_loads
        problem = self.solution.problem if self.case.on_nodes else reduce(self.case)
        assert isinstance(problem, EndsProblem)
        return problem

    @cached_property
    def solution(self) -> Solution:
        """Its shape."""
        return self._solve(self)

    def with_path(self, path: Any, problem: EndsProblem) -> "BranchPoint":
        """The point with the path that another solve found for it, which belongs to that problem under dead loads."""
        return replace(self, path=path, _under_dead_loads=problem)


@dataclass(frozen=True)
class SpecialPoint:
    """Where a branch turns back, or meets another, or changes its index.

    Attributes
    ----------
    kind : str
        "fold": two equilibria meet and cease to exist. "pitchfork": a branch of two mirror images meets this one.
        "branch point": another branch crosses this one. "helix ceases": the branch ends here, next to the place where
        the helix ceases to exist that the rod lies along.
    value : float
        The value of the field.
    before, after : int
        The Morse index on either side, in the order of the points; -1 where the branch ends.
    position : int
        Its place among the points of the branch.
    """

    kind: str
    value: float
    before: int
    after: int
    position: int


@dataclass(frozen=True)
class BranchEnd:
    """Where and why a branch stops.

    Attributes
    ----------
    value : float
        The value of the field.
    reason : str
        In words: "the end of the range", "the branch is closed", "the limit of ... points", which helix ceases to
        exist, or why it could not be followed.
    kind : str
        "border of the range", "closed", "helix ceases", or "stopped".
    """

    value: float
    reason: str
    kind: str = "stopped"


@dataclass(frozen=True, eq=False)
class Branch:
    """Equilibria in the order of a branch, over one field.

    Attributes
    ----------
    field : str
        The name of the field.
    points : tuple of BranchPoint
        The equilibria. Those at the values asked for and the special points are among them.
    special : tuple of SpecialPoint
        Folds and other special points, in the order of the points.
    begin, end : BranchEnd
        Why there are no points before the first, and none after the last.
    start : int
        The place of the equilibrium that was followed.

    Examples
    --------
    >>> from solver import Case, Cylinder, Ends, Rod, follow, solve
    >>> rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=5.0)
    >>> branch = follow(solve(Case(rod, Cylinder(R=0.75), Ends(beta0=0.5, betaL=0.8, FZ=-8.66))), FZ=[-20.0, -5.0])
    >>> branch.end.reason, int(branch.index[-1])
    ('the end of the range', 0)
    """

    field: str
    points: tuple[BranchPoint, ...]
    special: tuple[SpecialPoint, ...]
    begin: BranchEnd
    end: BranchEnd
    start: int

    def __len__(self) -> int:
        return len(self.points)

    @cached_property
    def values(self) -> Array:
        """The value of the field at each point, (N,)."""
        return np.array([point.value for point in self.points])

    @cached_property
    def index(self) -> Integers:
        """The Morse index of each point, (N,)."""
        return np.array([point.index for point in self.points], dtype=np.int64)

    def at(self, value: float) -> list[BranchPoint]:
        """The points at a value of the field that was asked for, in the order of the branch.

        Raises
        ------
        InputError
            For a value at which the branch has no point.
        """
        points = [point for point in self.points if np.array_equal(point.value, value)]
        if not points:
            number: object = value
            given = f"{number:.10g}" if isinstance(number, float) else show(number)
            raise InputError(
                f"the branch has no point at {self.field} = {given}; it goes from {self.values.min():.10g} to "
                f"{self.values.max():.10g}; give follow the values at which points are wanted"
            )
        return points

    def to_dataset(self, stations: int = 201, **units: str) -> Any:
        """The branch as a dataset over `point`.

        Parameters
        ----------
        stations : int
            Number of stations of the shapes.
        **units : str
            ``length`` and ``force``, the units of the case, for labels; default: these words.

        Returns
        -------
        xarray.Dataset
            The field, energy, height, azimuth, turns around, Morse index, bends and beta'(0) over `point`; beta,
            alpha and z over (point, u), u = s/L; `special`, the kind of each special point, else empty. Needs xarray.
        """
        return make("workbench.branches.followed_branch", "as_dataset", self, stations, units)

    def __repr__(self) -> str:
        kinds = [f"{point.kind} at {point.value:.6g}" for point in self.special]
        span = f"{self.field} from {self.values[0]:.6g} to {self.values[-1]:.6g}"
        return f"<Branch of {len(self)} equilibria, {span}; {', '.join(kinds) or 'no special point'}>"
