"""The problems of a branch: five given numbers, the length and A/C over one parameter p, as over a field of a case."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..core import branch_calls as core
from ..orbits.boundary import CUTTING, NODES, Boundary, Path, boundary_of
from ..orbits.variations import POINTS
from ..problem.case import Case
from ..problem.case_fields import value_of, with_field
from ..problem.declared_fields import PAIRS
from ..problem.dimensionless import (
    NUMBER_OF,
    EndsProblem,
    end_number_names,
    fields_held,
    numbers_over,
    value_of_number,
)
from ..problem.errors import InputError
from .branch_events import Bounds
from .given_numbers import FREE, Given, problem_of
from .orbit_rates import HOW, NUMBERS, orbit_rates

_KEPT = 6  # problems kept, as one is needed several times in a step. x10: only memory


@dataclass(frozen=True, eq=False)
class Family:
    """The given numbers over one parameter p.

    numbers: of p: the five given numbers, the span and A/C; None where there is no such problem. begun: one
    equilibrium, as a problem under dead loads, to begin from. scale: the change of p over which the problem changes.
    names: of the given numbers. natural: whether p must rise from 0 to 1, and all that is wanted is the equilibrium
    there: points on the way are rough and have no index, and a branch ends at a fold.
    """

    numbers: core.Numbers
    begun: EndsProblem
    scale: float
    names: tuple[str, ...]
    natural: bool = False
    _known: dict[float, Boundary | None] = field(default_factory=dict, repr=False)  # the last few

    @property
    def is_dead(self) -> bool:
        """Whether the two angles and the three loads are given, so that nothing but the path is unknown."""
        return self.names == FREE

    @cached_property
    def steps(self) -> core.BranchSteps:
        """The core's functions on these problems."""
        if self.is_dead:
            return core.BranchSteps(self._dead_numbers, self.scale, NODES, (CUTTING, CUTTING))
        held = tuple((*NUMBERS, "turn").index(name) for name in self.names)
        return core.BranchSteps(self.numbers, self.scale, POINTS, HOW, held)

    def _dead_numbers(self, p: float) -> Sequence[float] | None:
        """lam, mu, phi, span, beta(0) and beta(L) at p."""
        numbers = self.numbers(p)
        if numbers is None:
            return None
        beta0, betaL, lam, mu, phi, span, _ = numbers
        return lam, mu, phi, span, beta0, betaL

    def given(self, p: float) -> Given | None:
        """The given numbers at p."""
        numbers = self.numbers(p)
        return None if numbers is None else as_given(self.names, numbers)

    def boundary(self, p: float) -> Boundary | None:
        """The problem under dead loads at p with its critical points."""
        if p not in self._known:
            given = self.given(p)
            while len(self._known) >= _KEPT:
                del self._known[next(iter(self._known))]
            self._known[p] = None if given is None else boundary_of(problem_of(given, {}))
        return self._known[p]


def scale_of(numbers: core.Numbers, names: tuple[str, ...], p: float, reach: float) -> float:
    """The change of p over which a given number or the length changes by about itself or by one; at most `reach`."""
    nudge = 1e-6 * min(reach, max(abs(p), 1e-3 * reach))
    beside = numbers(p + nudge) or numbers(p - nudge)
    if beside is None:
        return reach
    values = np.array(numbers(p))[:6]
    size = 1 + np.abs(values)
    size[:5][[name in ("z", "alpha", "turn") for name in names]] = 1.0
    rate = float((np.abs(np.array(beside)[:6] - values) / nudge / size).max())
    return reach if rate * reach < 1 else 1 / rate


def family_of(case: Case, name: str, begun: EndsProblem, bounds: Bounds) -> Family:
    """The problems over one field; also a little beyond the range, as differences need them.

    begun: one equilibrium, as a problem under dead loads.
    """
    at_case, reach, (names, inside) = value_of(case, name), bounds.high - bounds.low, numbers_with_names(case, name)

    def numbers(value: float) -> Sequence[float] | None:
        if bounds.low <= value <= bounds.high:  # where the fields are known to be valid
            try:
                return inside(value)
            except (ZeroDivisionError, OverflowError):  # a stiffness out of the range of floats
                return None
        if abs(value - at_case) > 2 * reach:
            return None
        try:
            return numbers_with_names(with_field(case, name, value))[1]()
        except InputError:
            return None

    return Family(numbers, begun, scale_of(numbers, names, at_case, reach), names)


def numbers_with_names(case: Case, *fields: str) -> tuple[tuple[str, ...], Callable[..., Sequence[float]]]:
    """The names of the five given numbers, and over some fields these, L/rho and A/C, for valid values."""
    numbers = numbers_over(case, *fields)
    if fields_held(case):
        return end_number_names(case), numbers

    def dead(*values: float) -> Sequence[float]:
        beta0, betaL, phi, lam, mu, span, ratio = numbers(*values)
        return beta0, betaL, lam, mu, phi, span, ratio

    return FREE, dead


def as_given(names: tuple[str, ...], numbers: Sequence[float]) -> Given:
    """Given numbers by their names, from those of `numbers_with_names`."""
    return Given(names, np.array(numbers[:5], dtype=float), float(numbers[5]), float(numbers[6]))


PARTNER = {name: other for pair in PAIRS for name, other in (pair, pair[::-1])}


def end_numbers(problem: EndsProblem, path: Path, ratio: float) -> dict[str, float]:
    """The numbers of an equilibrium under its dead loads that ends can give, by name. ratio: A/C."""
    rates = orbit_rates(problem, [path])
    numbers = dict(zip(NUMBERS, rates.values[0].tolist(), strict=True))
    numbers |= {name: float(getattr(problem, name)[0]) for name in FREE}
    return numbers | {"turn": ratio * numbers["mu"] * float(rates.length[0]) - numbers["swirl"]}


def exchange(case: Case, numbers: Mapping[str, float], name: str) -> Case:
    """The case with one more field of `Ends` given, at its value in an equilibrium, and its partner left open.

    numbers: of the equilibrium, as of `end_numbers`.
    """
    value = value_of_number(name, numbers[NUMBER_OF[name]], float(case.rod.bending_stiffness), float(case.rho))
    reach = {"height": float(case.rod.L), "azimuth": float(case.rod.L / case.rho)}.get(name, np.inf)
    value = float(np.clip(value, -reach, reach))  # a taut rod reaches no farther but for rounding
    given: dict[str, Any] = {PARTNER[name]: None, name: value}
    return replace(case, given=replace(case.given, **given))
