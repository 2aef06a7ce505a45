"""The rule that selects one of the equilibria between two ends, and the equilibrium that a rule or a seed means.

Under dead loads the equilibrium of lowest energy of a long compressed rod points backwards: beta passes pi, which
lets the load do more work. A user mostly means the stable equilibrium that stays near its end angles. So the default
is: among the stable equilibria the one whose beta goes least beyond its two end angles; among equal
ones the one of lower energy, then the one with positive beta'(0). If none is stable, all equilibria are compared.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..numerics.arrays import FAINT, NEGLIGIBLE, Array, Integers
from ..orbits.boundary import Path, path_of
from ..orbits.level_search import FoundPaths, search_levels
from ..orbits.path_orbits import NO_EQUILIBRIUM, equilibrium_trajectory, path_from_start
from ..problem.dimensionless import EndsProblem
from ..problem.errors import InputError
from ..problem.trajectory import Seed, Trajectory

NEAREST, LOWEST = "nearest", "lowest"
RULES = (NEAREST, LOWEST)

Choose = str | int  # "nearest", "lowest", or a Morse index

INCOMPLETE = "selected from a list of equilibria that may be incomplete"  # the remark on a solved case


@dataclass(frozen=True)
class Selection:
    """How one equilibrium was taken from those found.

    count: equilibria found. stable: how many of them have Morse index 0. choose: the rule asked for. complete: whether
    no test says that one is missing (`equilibria.Equilibria`).
    """

    count: int
    stable: int
    choose: Choose
    complete: bool

    def __str__(self) -> str:
        words = f"{self.count} equilibri{'um' if self.count == 1 else 'a'}{'' if self.complete else ' found'}"
        known = f"{words}, {self.stable} stable" + ("" if self.complete else ", the list is incomplete")
        return f"{known}; {self.rule}"

    @property
    def rule(self) -> str:
        """Which equilibrium the rule takes, in words."""
        if self.choose == LOWEST:
            return "shown: the shape of lowest energy"
        if self.choose == NEAREST:
            return f"shown: the {'stable ' if self.stable else ''}shape that swings least"
        return f"shown: of those of index {self.choose} the shape that swings least"

    @property
    def remark(self) -> str:
        """What the outcome of a solved case says of the selection, or nothing."""
        return "" if self.complete else INCOMPLETE


@dataclass(frozen=True)
class HeldSelection(Selection):
    """How one equilibrium under held ends was taken from those found, of which no list is complete.

    index: Morse index of the one taken; NaN where it is not decided. turned: how many were set aside because a dead
    force that pushes turns them round.
    """

    index: float = 0.0
    turned: int = 0

    def __str__(self) -> str:
        first = "" if self.index == 0 else f"unstable under held ends, index {self.index:.0f}; "
        first = first if np.isfinite(self.index) else "not known to be stable under held ends; "
        many = "equilibrium" if self.count == 1 else "equilibria"
        return f"{first}{self.count} {many} compared, {self.stable} stable; {self.rule}"

    @property
    def rule(self) -> str:
        """Which equilibrium the rule takes, in words."""
        if isinstance(self.choose, int):
            return f"shown: of those of index {self.choose} that of least held energy"
        kind = "stable " if self.choose == NEAREST and self.stable else ""
        aside = f" (set aside: {self.turned} that the push turns round)" if self.turned else ""
        return f"shown: the {kind}one of least held energy{aside}"

    @property
    def remark(self) -> str:
        """Nothing: what was compared is said with the selection, and no list of held ends is complete."""
        return ""


def check(choose: Any) -> Choose:
    """The rule as given; raises `InputError` unless it is one of `RULES` or a Morse index."""
    if isinstance(choose, str) and choose in RULES:
        return choose
    if isinstance(choose, (int, np.integer)) and not isinstance(choose, bool) and choose >= 0:
        return int(choose)
    raise InputError(f"choose must be 'nearest', 'lowest' or a Morse index (0, 1, 2, ...), got {choose!r}")


def select(choose: Choose, index: Array, energy: Array, strays: Array, dbeta0: Array) -> int | None:
    """Which of K equilibria the rule takes; None where no equilibrium has the index asked for, or K is 0.

    index: Morse indices. energy: in any unit, of held ends held energy. strays: how far beta goes beyond its two end
    angles; of held ends whether the rod turns round. dbeta0: beta'(0), in any unit. (K,) each.
    """
    if choose == LOWEST:
        among: Integers = np.arange(index.size)
    elif choose == NEAREST:
        among = np.flatnonzero(index == 0) if (index == 0).any() else np.arange(index.size)
    else:
        among = np.flatnonzero(index == choose)
    if not among.size:
        return None
    if choose != LOWEST:
        least = strays[among].min()
        # strays and energies of mirror images differ by rounding; FAINT [rad] is for strays next to zero
        among = among[strays[among] <= least + NEGLIGIBLE * least + FAINT]
    lowest = energy[among].min()
    among = among[energy[among] <= lowest + NEGLIGIBLE * np.abs(energy[among]).max()]
    positive = among[dbeta0[among] > 0]
    among = positive if positive.size else among
    return int(among[np.argmax(dbeta0[among])])


def selection(choose: Choose, index: Array, total: int, complete: bool) -> Selection:
    """The record of a selection among `total` equilibria; index: (K,), Morse indices, at least of all stable ones."""
    return Selection(total, int(np.count_nonzero(index == 0)), choose, complete)


def selection_of(
    problem: EndsProblem, t: Array, tol: float, dbeta0: float | None, choose: Choose = NEAREST
) -> Trajectory | str:
    """The equilibrium of one ends problem with beta_t(0) nearest `dbeta0`, or without `dbeta0` the one of the rule.

    Returns the outcome, a sentence, where there is none.
    """
    equilibria = _search(problem, dbeta0, choose)
    if equilibria is None:
        return NO_EQUILIBRIUM
    if dbeta0 is not None:
        nearest = np.argmin(np.abs(equilibria.dbeta0 - dbeta0), keepdims=True)
        return equilibrium_trajectory(problem, equilibria.orbit.take(nearest), t, tol)
    i = select(choose, equilibria.index, equilibria.energy, equilibria.stray, equilibria.dbeta0)
    if i is None:
        return none_of_index(choose, equilibria.total, equilibria.index)
    if not isinstance(choose, int) and equilibria.index[i] != 0 and equilibria.remark:  # by degree one is stable
        return f"failed: {equilibria.remark}"
    how = np.array([selection(choose, equilibria.index, equilibria.total, not equilibria.remark)], dtype=object)
    return replace(equilibrium_trajectory(problem, equilibria.orbit.take(slice(i, i + 1)), t, tol), selection=how)


def none_of_index(choose: Choose, total: int, index: Array) -> str:
    """The outcome where none of the equilibria has the index asked for; index: of those that are known."""
    each = sorted({int(i) for i in index[np.isfinite(index)]})
    shown = ", ".join(map(str, each[:8])) + (f", ... up to {each[-1]}" if len(each) > 8 else "")
    return f"failed: none of the {total} equilibria found has index {choose}; their indices: {shown}"


def _search(problem: EndsProblem, dbeta0: float | None, choose: Choose) -> FoundPaths | None:
    """The equilibria that the rule needs.

    A stable one has one turning point at most, one of index K at most K + 1, and that of lowest energy is stable.
    """
    if dbeta0 is not None:
        return search_levels(problem)
    equilibria = search_levels(problem, most_turns=choose + 1 if isinstance(choose, int) else 1)
    needs_stable = equilibria is None or not (equilibria.index == 0).any()
    return search_levels(problem) if not isinstance(choose, int) and needs_stable else equilibria


def select_seed(problem: EndsProblem, choose: Choose) -> tuple[Seed, NDArray[np.object_], list[str]]:
    """The equilibrium of each of B ends problems that the rule takes, as a seed at 2001 stations.

    Returns the seed, NaN where there is no equilibrium; (B,) how each was selected; and the outcomes that say why there
    is none, empty where there is one.
    """
    u = np.linspace(0, 1, 2001)
    taken, why = np.full(problem.size, None, dtype=object), [""] * problem.size
    dbeta0, beta = np.full(problem.size, np.nan), np.full((problem.size, u.size), np.nan)
    for i in range(problem.size):
        single = problem.take(slice(i, i + 1))
        answer = selection_of(single, single.span[:, None] * u, 1e-8, None, choose)
        if isinstance(answer, str):
            why[i] = answer
            continue
        dbeta0[i], beta[i] = answer.dbeta[0, 0], answer.beta[0]
        taken[i] = None if answer.selection is None else answer.selection[0]
    return Seed(dbeta0, np.tile(u, (problem.size, 1)), beta), taken, why


def path_of_seed(seed: Seed) -> Path | None:
    """The path of the seed's equilibrium; None if the seed is not an equilibrium."""
    assert seed.problem is not None
    if not np.isfinite(seed.beta[0]).all():
        return None
    if seed.paths is not None:
        return path_of(seed.paths, 0)
    path = path_from_start(seed.problem, float(seed.dbeta0[0]))
    if path is not None:
        return path
    equilibria = search_levels(seed.problem)
    if equilibria is None:
        return None
    u = seed.problem.span[:, None] * seed.u[:1]
    apart = np.abs(equilibria.orbit.at(np.repeat(u, equilibria.dbeta0.size, axis=0))[0] - seed.beta[:1]).max(axis=1)
    best = int(np.argmin(apart))
    return path_of(equilibria.orbit.paths, best) if apart[best] < 0.01 else None
