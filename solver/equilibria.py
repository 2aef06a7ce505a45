"""Every equilibrium of one ends problem, with its stability."""

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from .boundary.paths import LevelPaths
from .boundary.selection import NEAREST, Choose, select
from .numerics.arrays import Array
from .problem.case import Case, Ends
from .problem.errors import InputError, choices
from .problem.held_ends import held_of
from .problem.reduced import EndsProblem, reduce
from .problem.shown import table_of
from .problem.tolerance import DEFAULT_TOLERANCE
from .problem.trajectory import Trajectory
from .solution import Solution

if TYPE_CHECKING:
    from .orbit.periodic_orbit import Orbit

NONE_FOUND = "incomplete: no equilibrium was found, and by degree there is always one"


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """One equilibrium of an ends problem; `equilibria` makes it.

    Attributes
    ----------
    solution : Solution
        Its shape.
    index : int
        Morse index, the end angles held and the loads dead; 0: stable.
    energy : float
        Bending and twist energy minus the work of the loads [force length].
    dbeta0 : float
        beta'(0) [rad/length].
    turns : int
        Number of bends.
    attached : float
        Share of the length where the cylinder pushes.
    stray : float
        The most that beta leaves the interval between its end angles [rad].
    path : LevelPaths
        Its level and its path, which identify it among the equilibria of the case.

    Examples
    --------
    >>> from solver import Case, Cylinder, Ends, Rod, equilibria
    >>> rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=5.0)
    >>> found = equilibria(Case(rod, Cylinder(R=0.75), Ends(beta0=0.5, betaL=0.8, FZ=-8.66)))
    >>> lowest = found[0]
    >>> print(f"index {lowest.index}, {lowest.turns} bends, energy {lowest.energy:.4f}")
    index 0, 1 bends, energy 44.1262
    """

    solution: Solution = field(repr=False)
    index: int
    energy: float
    dbeta0: float
    turns: int
    attached: float
    stray: float
    path: LevelPaths = field(repr=False)


class Equilibria(list[Equilibrium]):
    """The equilibria of one case, lowest energy first.

    complete: whether they pass the test of completeness: counted with (-1)^index they add up to 1, as they must by
    degree, and the lowest is stable. The test detects an odd number of missing equilibria, but not a missing pair of
    opposite signs, as a fold creates it. remark: why the list is incomplete; empty if it is complete.
    """

    def __init__(self, found: list[Equilibrium], remark: str = "") -> None:
        super().__init__(found)
        self.remark = remark

    @property
    def complete(self) -> bool:
        return not self.remark

    def __repr__(self) -> str:
        count = f"{len(self)} {'equilibrium' if len(self) == 1 else 'equilibria'}"
        lines = [f"{count}, {'complete' if self.complete else self.remark}"]
        for i, one in enumerate(self, 1):
            bends = f"{one.turns} {'bend' if one.turns == 1 else 'bends'}"
            numbers = f"energy {one.energy:.6g}, {bends}, beta'(0) = {one.dbeta0:.6g}"
            lines.append(f"{i}: {f'index {one.index}' if one.index else 'stable'}, {numbers}")
        return "\n".join(lines)

    def _repr_html_(self) -> str | None:
        """A table for a notebook; None, which shows the `repr`, where the workbench cannot be imported."""
        return table_of("equilibria", self)


def equilibria(case: Case, tol: float = DEFAULT_TOLERANCE, stations: int = 201, most_swings: int = 200) -> Equilibria:
    """All equilibria of one ends problem.

    Parameters
    ----------
    case : Case
        A single ends problem. beta(L) counts whole turns: for the same tangent after one turn, give beta(L) + 2 pi.
    tol : float
        Tolerance, as of `solve`.
    stations : int
        Number of stations of each solution.
    most_swings : int
        The largest number of whole periods of beta along the rod.

    Returns
    -------
    Equilibria
        A list of `Equilibrium`, lowest energy first. Its `complete` says whether the list passes the test of
        completeness; its `remark` says why not.

    Raises
    ------
    InputError
        For a start problem, a grid of cases, and held ends.

    Examples
    --------
    >>> from solver import Case, Cylinder, Ends, Rod, equilibria
    >>> rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=5.0)
    >>> found = equilibria(Case(rod, Cylinder(R=0.75), Ends(beta0=0.5, betaL=0.8, FZ=-8.66)))
    >>> found.complete, [one.index for one in found]
    (True, [0, 0, 1])
    """
    from .boundary.search import search  # only a call needs the modules behind these
    from .boundary.selected_equilibrium import equilibrium_trajectory
    from .boundary.transit_times import repeated
    from .observe.measurement import Reading
    from .observe.observables import OBSERVABLES

    if held := held_of(case):
        raise InputError(
            f"equilibria lists those under dead loads and between two angles, got {choices(held)}; "
            "solve finds one equilibrium of held ends, and a seed selects another one"
        )
    problem = reduce(case)
    if not isinstance(problem, EndsProblem):
        raise InputError(f"equilibria needs a Case with Ends, got {type(case.given).__name__}")
    if case.shape:
        raise InputError(f"equilibria takes one case at a time, got a grid of shape {case.shape}")
    all_of_them = search(problem, most_swings)
    if all_of_them is None:
        return Equilibria([], NONE_FOUND)
    slopes, orbit, K = all_of_them.slope, all_of_them.orbit, all_of_them.slope.size
    wide, index, stray = repeated(problem, K), all_of_them.index, all_of_them.stray
    t = wide.span[:, None] * np.linspace(0, 1, stations)
    together = equilibrium_trajectory(wide, orbit, t, tol)
    read = Reading(Solution(_repeated(case, K), wide, together, t, "shooting", tol))
    for name, angle in (("low", all_of_them.lowest), ("high", all_of_them.highest)):
        read.know(name, angle, read.error)
    turns, attached = OBSERVABLES["turns"].compute(read), OBSERVABLES["attached"].compute(read)[0]
    energy = read.A / read.rho * all_of_them.energy - OBSERVABLES["twist_energy"].compute(read)[0]
    found = []
    for i in range(K):
        solution = Solution(case, problem, _one(together, orbit.take(i), t, i), t[i : i + 1], "shooting", tol)
        numbers = float(energy[i]), float(slopes[i] / case.rho), int(turns[i])
        more = float(attached[i]), float(stray[i]), all_of_them.path.take(slice(i, i + 1))
        found.append(Equilibrium(solution, int(index[i]), *numbers, *more))
    return Equilibria(_in_order(found), all_of_them.remark)


def _repeated(case: Case, K: int) -> Case:
    """The same ends problem K times."""
    g = case.given
    assert isinstance(g, Ends)
    return Case(case.rod, case.cylinder, Ends(np.full(K, g.beta0), g.betaL, g.FZ, g.MZ, g.M3, g.alpha, g.gamma))


def _one(together: Trajectory, orbit: "Orbit", t: Array, i: int) -> Trajectory:
    """Row i of a trajectory, with its own orbit."""
    row = slice(i, i + 1)
    names = ("beta", "dbeta", "alpha", "z", "solved", "outcome", "error", "condition", "evaluations")
    picked = {name: getattr(together, name)[row] for name in names}
    return replace(together, **picked, swirl=lambda: orbit.swirl(t[row]), orbit=orbit)


def _in_order(found: list[Equilibrium]) -> list[Equilibrium]:
    """Lowest energy first; of mirror images, whose energies differ only by rounding, the lower beta'(0) first."""
    found = sorted(found, key=lambda e: e.energy)
    energy = np.array([e.energy for e in found])
    new = np.diff(energy, prepend=-np.inf) > 1e-9 * (1 + np.abs(energy))
    slope = np.array([e.dbeta0 for e in found])
    return [found[i] for i in np.lexsort((slope, np.cumsum(new)))]


def nearest(found: list[Equilibrium], dbeta0: float, energy: float) -> Equilibrium:
    """The equilibrium nearest to beta'(0) [rad/length] and energy [force length], each relative to its spread.

    Both are needed: mirror images have the same energy to the last bit, and equilibria that rest near one saddle the
    same slope. Raises `InputError` for an empty list.
    """
    if not found:
        raise InputError("no equilibrium was found for these end angles and loads")
    far = np.zeros(len(found))
    for values, wanted in (([e.dbeta0 for e in found], dbeta0), ([e.energy for e in found], energy)):
        far += np.abs(np.array(values) - wanted) / (np.ptp(values) or 1.0)
    return found[int(np.argmin(far))]


def meant(found: list[Equilibrium], choose: Choose = NEAREST) -> Equilibrium | None:
    """The equilibrium that `solve` takes by the rule `choose`; None if no equilibrium fits the rule."""
    columns = ([getattr(one, name) for one in found] for name in ("index", "energy", "stray", "dbeta0"))
    i = select(choose, *(np.array(column, dtype=float) for column in columns))
    return None if i is None else found[i]
