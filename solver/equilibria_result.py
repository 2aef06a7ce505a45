"""Equilibria of one case with their stability, as a list that says how complete it is."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .observe.observables import observe
from .problem.case import Ends
from .problem.declared_fields import PAIRS
from .problem.quantities import former
from .problem.shown import table_of
from .solution import Solution


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """One equilibrium of an ends problem; `equilibria` makes it.

    Attributes
    ----------
    solution : Solution
        Its shape.
    index : int
        Morse index under the ends of the case; 0: stable; -1: not known.
    energy : float
        Bending and twist energy minus the work of the loads and end moments that the case gives [force length].
    dbeta0 : float
        beta'(0) [rad/length].
    bends : int
        Number of bends.
    attached : float
        Share of the length where the cylinder pushes.
    stray : float
        The most that beta goes beyond its end angles, above the larger or below the smaller one [rad].
    path : Paths or Shape
        Its level and its path, which identify it among the equilibria of the case; with weight, friction or a hinge its
        shape on nodes.
    dead_index : int
        Morse index under dead loads, between its own end angles; -1: not known.
    found_by : str
        What the search found it by: "levels" under dead loads; "continuation", "mirror image", "across a fold",
        "deflation", "helix" or "scan" under held ends; with weight in words, such as "scan of the start".

    Examples
    --------
    >>> from solver import Case, Cylinder, Ends, Rod, equilibria
    >>> rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=5.0)
    >>> found = equilibria(Case(rod, Cylinder(R=0.75), Ends(beta0=0.5, betaL=0.8, FZ=-8.66)))
    >>> lowest = found[0]
    >>> print(f"index {lowest.index}, {lowest.bends} bends, energy {lowest.energy:.4f}")
    index 0, 1 bends, energy 44.1262
    """

    solution: Solution = field(repr=False)
    index: int
    energy: float
    dbeta0: float
    bends: int
    attached: float
    stray: float
    path: Any = field(repr=False)
    dead_index: int = field(repr=False)
    found_by: str = field(default="levels", repr=False)
    turns = former("turns")


def equilibrium_of(solution: Solution, index: int, path: Any, dead_index: int, found_by: str) -> Equilibrium:
    """An equilibrium with what is observed of its shape."""
    seen = observe(solution, ["bends", "attached"])
    numbers = energy_as_held(solution), float(solution.dbeta[0]), int(seen["bends"]), float(seen["attached"])
    ends = solution.beta[[0, -1]]
    stray = max(float(solution.beta.max() - ends.max()), float(ends.min() - solution.beta.min()), 0.0)
    return Equilibrium(solution, index, *numbers, stray, path, dead_index, found_by)


def energy_as_held(solution: Solution) -> float:
    """The bending and twist energy of one rod minus the work of the loads and end moments that its case gives.

    The observable `energy` subtracts the work of FZ, MZ and M3, also where they are reactions. A reaction does no work
    when neighbouring shapes with the same held ends are compared, so their order is that of this number.
    """
    return float(observe(solution, ["energy"])["energy"]) + _work_of_reactions(solution)


def _work_of_reactions(solution: Solution) -> float:
    """The work of loads that are reactions, less that of the end moments that are given."""
    ends = solution.case.given
    assert isinstance(ends, Ends)
    along = zip(PAIRS[2:], (solution.z, solution.alpha, solution.gamma), strict=True)
    work = sum(
        float(getattr(solution, load) * (values[-1] - values[0]))
        for (load, held), values in along
        if held in solution.held
    )
    for name, sign, beta in (("M10", -1, solution.problem.beta0), ("M1L", 1, solution.problem.betaL)):  # type: ignore[union-attr]
        if name in solution.held:
            work -= sign * float(getattr(ends, name)) * float(beta[0])
    return work


def stability(index: int) -> str:
    """A Morse index in words."""
    return "stable" if index == 0 else f"index {index}" if index > 0 else "index not known"


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
        for i, equilibrium in enumerate(self, 1):
            bends = f"{equilibrium.bends} {'bend' if equilibrium.bends == 1 else 'bends'}"
            name = "held energy" if equilibrium.solution.held else "energy"
            numbers = f"{name} {equilibrium.energy:.6g}, {bends}, beta'(0) = {equilibrium.dbeta0:.6g}"
            lines.append(f"{i}: {stability(equilibrium.index)}, {numbers}{self._more(equilibrium)}")
        return "\n".join(lines)

    def _more(self, equilibrium: Equilibrium) -> str:
        """What a line of the `repr` adds."""
        return ""

    def _repr_html_(self) -> str | None:
        """A table for a notebook; None, which shows the `repr`, where the workbench cannot be imported."""
        return table_of("equilibria", self)


@dataclass(frozen=True)
class HeldSearch:
    """How equilibria with held ends were searched for.

    Attributes
    ----------
    within : dict
        The lowest and the highest value of each reaction, by its name, over which the search went [units of the case].
    most_swings : int
        The largest number of whole periods of beta along the rods from which it began.
    problems : int
        Dead-load problems that were solved, with all their equilibria; 0 where all loads and the bending moment at an
        end are given, and what the start leaves open was scanned.
    starts, failed : int
        Continuations from these equilibria to the held ends, and those of them that reached none.
    deflations : int
        Searches from them led away from the equilibria that were known.
    outside : int
        Equilibria that were found outside the ranges, and are not listed.
    note : str
        A sentence on equilibria that are not listed, or "".
    beyond : dict
        The lowest and the highest value of each reaction of the equilibria outside the ranges, by its name.
    narrower : dict
        Where the equilibria lie in a small part of a default range, a range around them, by the name of the reaction.
    """

    within: dict[str, tuple[float, float]]
    most_swings: int
    problems: int
    starts: int
    failed: int
    deflations: int
    outside: int
    note: str = ""
    beyond: dict[str, tuple[float, float]] = field(default_factory=dict)
    narrower: dict[str, tuple[float, float]] = field(default_factory=dict)

    @property
    def ranges(self) -> str:
        """The ranges in words."""
        return ranges_in_words(self.within)

    def _counts(self) -> list[str]:
        return [
            f"it began from the equilibria of {self.problems} problems under dead loads "
            f"that have at most {self.most_swings} whole periods of beta (most_swings in Python)",
            f"{self.starts} continuations, {self.failed} of which failed",
            f"{self.deflations} deflations",
        ]

    def __str__(self) -> str:
        if not self.within:
            return self.note
        said = [
            f"not proved complete: searched over {self.ranges}",
            *(self._counts() if self.problems else ["beta(0), or beta'(0) where beta(0) is given, was scanned"]),
        ]
        if self.outside:
            are = "equilibrium was" if self.outside == 1 else "equilibria were"
            said.append(
                f"{self.outside} more {are} found outside these ranges and not listed ({ranges_in_words(self.beyond)})"
            )
        if self.narrower:
            ranges = " ".join(f"--within {name}={low:g}:{high:g}" for name, (low, high) in self.narrower.items())
            finer = f"{ranges} (in Python within) searches it more finely"
            said.append(f"all listed equilibria lie in a small part of the range: {finer}")
        return "; ".join([*said, *([self.note] if self.note else [])])


def ranges_in_words(ranges: Mapping[str, tuple[float, float]]) -> str:
    """``FZ from -3 to 4, MZ = 1``, for the lowest and the highest value of each number."""
    said = []
    for name, (low, high) in ranges.items():
        first, last = f"{low:.6g}", f"{high:.6g}"
        said.append(f"{name} = {first}" if first == last else f"{name} from {first} to {last}")
    return ", ".join(said)


class HeldEquilibria(Equilibria):
    """Equilibria of one case with held ends, lowest energy first; never proved complete.

    search: the ranges and the counts of the search, which the remark states.
    """

    def __init__(self, found: list[Equilibrium], search: HeldSearch) -> None:
        super().__init__(found, str(search))
        self.search = search

    def _more(self, equilibrium: Equilibrium) -> str:
        loads = ", ".join(f"{name} = {float(value):.6g}" for name, value in equilibrium.solution.reactions.items())
        return f", {loads}; {stability(equilibrium.dead_index)} under dead loads"


def in_order(equilibria: list[Equilibrium]) -> list[Equilibrium]:
    """Lowest energy first; of mirror images, whose energies differ only by rounding, the lower beta'(0) first."""
    equilibria = sorted(equilibria, key=lambda e: e.energy)
    energy = np.array([e.energy for e in equilibria])
    new = np.diff(energy, prepend=-np.inf) > 1e-9 * (1 + np.abs(energy))
    dbeta0 = np.array([e.dbeta0 for e in equilibria])
    return [equilibria[i] for i in np.lexsort((dbeta0, np.cumsum(new)))]
