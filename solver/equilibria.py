"""Every equilibrium of a rod whose end angles and dead loads are given, with its stability."""

from dataclasses import dataclass, replace

import numpy as np

from .boundary.paths import LevelPaths
from .boundary.search import search
from .boundary.selected_equilibrium import equilibrium_trajectory
from .boundary.selection import NEAREST, Choose, select
from .boundary.transit_times import repeated
from .numerics.arrays import Array
from .observe.observables import observe
from .orbit.periodic_orbit import Orbit
from .problem.case import Case, Ends
from .problem.errors import InputError
from .problem.reduced import reduce
from .problem.trajectory import Trajectory
from .solution import Solution

NONE = "incomplete: no equilibrium was found, and by degree there is always one"


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """One equilibrium.

    index: Morse index, 0 for a stable one, both end angles held and the loads dead. energy: bending energy less the
    work of the loads [force length]. dbeta0: beta'(0) [rad/length]. turns: number of bends. attached: share of the
    length where the cylinder pushes. stray: how far beta goes beyond the interval between its end angles [rad].
    path: its level and its path (`paths.LevelPaths` of one), which tell it from every other equilibrium of the case.
    """

    solution: Solution
    index: int
    energy: float
    dbeta0: float
    turns: int
    attached: float
    stray: float
    path: LevelPaths


class Equilibria(list[Equilibrium]):
    """The equilibria of one case, lowest energy first, and whether they are all that there are.

    complete: the equilibria, each counted with (-1)^index, add up to 1, as they must by degree, and the lowest is
    stable. So an odd number of missing ones is seen; a pair of opposite signs, as is born at a fold, is not.
    remark: one sentence that says why the list is a part only; empty where it is complete.
    """

    def __init__(self, found: list[Equilibrium], remark: str = "") -> None:
        super().__init__(found)
        self.remark = remark

    @property
    def complete(self) -> bool:
        return not self.remark


def equilibria(case: Case, tol: float = 1e-8, stations: int = 201, most_swings: int = 200) -> Equilibria:
    """All solutions of one ends problem with at most `most_swings` whole periods of beta, lowest energy first.

    The list says whether it is `complete`, and why not.

    beta(L) counts whole turns: to end at the same tangent after turning round, ask for beta(L) + 2 pi.
    Raises `InputError` for a start problem or a grid of cases.
    """
    if not isinstance(case.given, Ends):
        raise InputError(f"equilibria needs a Case given by Ends, got {type(case.given).__name__}")
    if case.shape:
        raise InputError(f"equilibria takes one case at a time, got a grid of shape {case.shape}")
    problem = reduce(case)
    all_of_them = search(problem, most_swings)
    if all_of_them is None:
        return Equilibria([], NONE)
    slopes, orbit, K = all_of_them.slope, all_of_them.orbit, all_of_them.slope.size
    wide, index, stray = repeated(problem, K), all_of_them.index, all_of_them.stray
    t = wide.span[:, None] * np.linspace(0, 1, stations)
    together = equilibrium_trajectory(wide, orbit, t, tol)
    seen = observe(Solution(_repeated(case, K), wide, together, t, "shooting", tol), ("energy", "turns", "attached"))
    found = []
    for i in range(K):
        solution = Solution(case, problem, _one(together, orbit.take(i), t, i), t[i : i + 1], "shooting", tol)
        numbers = float(seen["energy"][i]), float(slopes[i] / case.rho), int(seen["turns"][i])
        more = float(seen["attached"][i]), float(stray[i]), all_of_them.path.take(slice(i, i + 1))
        found.append(Equilibrium(solution, int(index[i]), *numbers, *more))
    return Equilibria(_in_order(found), all_of_them.remark)


def _repeated(case: Case, K: int) -> Case:
    """The same ends problem K times over."""
    g = case.given
    assert isinstance(g, Ends)
    return Case(case.rod, case.cylinder, Ends(np.full(K, g.beta0), g.betaL, g.FZ, g.MZ, g.M3, g.alpha, g.gamma))


def _one(together: Trajectory, orbit: Orbit, t: Array, i: int) -> Trajectory:
    """Row i of a trajectory, with its own orbit."""
    row = slice(i, i + 1)
    names = ("beta", "dbeta", "alpha", "z", "outcome", "error", "condition", "evaluations")
    picked = {name: getattr(together, name)[row] for name in names}
    return replace(together, **picked, swirl=lambda: orbit.swirl(t[row]), orbit=orbit)


def _in_order(found: list[Equilibrium]) -> list[Equilibrium]:
    """Lowest energy first; of mirror images, whose energies differ by rounding alone, the lower beta'(0) first."""
    found = sorted(found, key=lambda e: e.energy)
    energy = np.array([e.energy for e in found])
    new = np.diff(energy, prepend=-np.inf) > 1e-9 * (1 + np.abs(energy))
    slope = np.array([e.dbeta0 for e in found])
    return [found[i] for i in np.lexsort((slope, np.cumsum(new)))]


def nearest(found: list[Equilibrium], dbeta0: float, energy: float) -> Equilibrium:
    """Of all equilibria of a case the one next to beta'(0) [rad/length] and energy [force length], each measured by
    its spread. Both are needed: mirror images share the energy, and what hugs one saddle the slope, to the last bit.

    Raises `InputError` where there is none.
    """
    if not found:
        raise InputError("no equilibrium joins these end angles under these loads")
    far = np.zeros(len(found))
    for values, wanted in (([e.dbeta0 for e in found], dbeta0), ([e.energy for e in found], energy)):
        far += np.abs(np.array(values) - wanted) / (np.ptp(values) or 1.0)
    return found[int(np.argmin(far))]


def meant(found: list[Equilibrium], choose: Choose = NEAREST) -> Equilibrium | None:
    """Of all equilibria of a case the one that `solve` takes by the rule `choose`; None where no equilibrium has the
    index asked for, or where there is none."""
    columns = ([getattr(one, name) for one in found] for name in ("index", "energy", "stray", "dbeta0"))
    i = select(choose, *(np.array(column, dtype=float) for column in columns))
    return None if i is None else found[i]
