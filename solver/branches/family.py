"""The problems of a branch: five given numbers, the length and A/C over one parameter p, as over a field of a case."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from ..core import branches as core
from ..core.branches import Numbers
from ..equilibrium.given_numbers import FREE, Given, is_hinged, problem_of
from ..equilibrium.orbit_rates import HOW, NUMBERS, orbit_rates
from ..levels.line_point import LinePoint, Path
from ..levels.transit_times import CUTTING, NODES
from ..orbit.variations import POINTS
from ..problem.case import PAIRS, Case
from ..problem.case_fields import unchecked_with_field, value_of, with_field
from ..problem.errors import InputError
from ..problem.reduced import (
    NUMBER_OF,
    EndsProblem,
    given_numbers,
    held_of,
    numbers_over,
    reduce,
    reduce_held,
    value_of_number,
)
from .branch_events import Bounds

_KEPT = 6  # problems kept, as one is needed several times in a step


@dataclass(frozen=True, eq=False)
class Family:
    """The given numbers over one parameter p.

    given: of p, None where there is no such problem. begun: one equilibrium, as a problem under dead loads, to begin
    from. scale: the change of p over which the problem changes. names: of the given numbers. numbers: values, span and
    A/C at p, or under dead loads lam, mu, phi, span, beta(0) and beta(L); the compiled core needs them.
    """

    given: Callable[[float], Given | None]
    begun: EndsProblem
    scale: float
    names: tuple[str, ...]
    numbers: core.Numbers | None = None
    _known: dict[float, LinePoint | None] = field(default_factory=dict, repr=False)  # the last few

    @property
    def is_dead(self) -> bool:
        """Whether the two angles and the three loads are given, so that nothing but the path is unknown."""
        return self.names == FREE

    @property
    def hinged(self) -> bool:
        """Whether an end moment is given."""
        return is_hinged(self.names)

    @cached_property
    def steps(self) -> core.Steps | None:
        """The core's functions on these problems; None without `numbers`, and for hinged rods:
        the core knows no corners."""
        if self.numbers is None or self.hinged:
            return None
        if self.is_dead:
            return core.Steps(self.numbers, self.scale, NODES, (CUTTING, CUTTING))
        held = tuple((*NUMBERS, "turn").index(name) for name in self.names)
        return core.Steps(self.numbers, self.scale, POINTS, HOW, held)

    def place(self, p: float) -> LinePoint | None:
        """The problem under dead loads at p with its critical points."""
        if p not in self._known:
            given = self.given(p)
            while len(self._known) >= _KEPT:
                del self._known[next(iter(self._known))]
            self._known[p] = None if given is None else LinePoint(problem_of(given, {}))
        return self._known[p]


def scale_of(given: Callable[[float], Given | None], p: float, reach: float) -> float:
    """The change of p over which a given number or the length changes by about itself or by one; at most `reach`."""
    nudge = 1e-6 * min(reach, max(abs(p), 1e-3 * reach))
    sides = [one for one in (given(p + nudge), given(p - nudge)) if one is not None]
    here = given(p)
    assert here is not None
    if not sides:
        return reach
    moved = np.abs(np.append(sides[0].values - here.values, sides[0].span - here.span)) / nudge
    size = np.append(np.where(np.isin(here.names, ("z", "alpha", "turn")), 1.0, 1 + np.abs(here.values)), 1 + here.span)
    rate = float((moved / size).max())
    return reach if rate * reach < 1 else 1 / rate


def family_of(case: Case, name: str, begun: EndsProblem, bounds: Bounds) -> Family:
    """The problems over one field; also a little beyond the range, as differences need them.

    begun: one equilibrium, as a problem under dead loads.
    """
    own, reach = value_of(case, name), bounds.high - bounds.low

    def given(value: float) -> Given | None:
        found = _case(case, name, bounds, value) if abs(value - own) <= 2 * reach else None
        return None if found is None else given_of(found)

    inside = numbers_over(case, name) if held_of(case) else partial(dead_numbers, numbers_over(case, name))
    here = given(own)
    assert here is not None
    numbers = partial(_numbers, inside, partial(numbers_at, given), bounds)
    return Family(given, begun, scale_of(given, own, reach), here.names, numbers)


def given_of(case: Case) -> Given | None:
    """The given numbers of one case with Ends; None for a start problem."""
    if held_of(case):
        return Given.of(reduce_held(case))
    problem = reduce(case)
    return Given.dead(problem) if isinstance(problem, EndsProblem) else None


def given_over(case: Case, *names: str) -> Callable[..., Given]:
    """The same over some fields, for valid values, many times as fast."""
    numbers, order = numbers_over(case, *names), given_numbers(case)
    names_of = order if held_of(case) else FREE
    picked = [order.index(name) for name in names_of]

    def given(*values: float) -> Given:
        *fixed, span, ratio = numbers(*values)
        return Given(names_of, np.array([float(fixed[k]) for k in picked]), float(span), float(ratio))

    return given


def dead_numbers(numbers: Callable[..., tuple[float, ...]], *values: float) -> tuple[float, ...]:
    """lam, mu, phi, span, beta(0) and beta(L) at values of some fields; numbers: `numbers_over` of these."""
    beta0, betaL, phi, lam, mu, span, _ = numbers(*values)
    return lam, mu, phi, span, beta0, betaL


def numbers_at(given: Callable[[float], Given | None], value: float) -> Sequence[float] | None:
    """What `Family.numbers` gives at a value, of the given numbers there."""
    found = given(value)
    if found is None or found.names != FREE:
        return None if found is None else [*found.values.tolist(), found.span, found.ratio]
    return [float(number[0]) for number in vars(problem_of(found, {})).values()]


def _case(case: Case, name: str, bounds: Bounds, value: float) -> Case | None:
    """The case at a value of the field; None where there is none."""
    if bounds.low <= value <= bounds.high:  # where the fields are known to be valid
        return unchecked_with_field(case, name, value)
    try:
        return with_field(case, name, value)
    except InputError:
        return None


def _numbers(inside: Numbers, beyond: Numbers, bounds: Bounds, value: float) -> Sequence[float] | None:
    """The numbers of the problem at a value; inside, beyond: those in the range of the field, and out of it."""
    if not bounds.low <= value <= bounds.high:
        return beyond(value)
    try:
        return inside(value)
    except (ZeroDivisionError, OverflowError):  # a stiffness out of the range of floats
        return None


PARTNER = {name: other for pair in PAIRS for name, other in (pair, pair[::-1])}


def exchange(case: Case, problem: EndsProblem, path: Path, name: str) -> Case:
    """The case with one more field of `Ends` given, at its value in an equilibrium, and its partner left open.

    problem, path: the equilibrium under its dead loads.
    """
    rho, A = float(case.rho), float(case.rod.bending_stiffness)
    rates = orbit_rates(problem, [path])
    number = dict(zip(NUMBERS, rates.values[0].tolist(), strict=True))
    number |= {name: float(getattr(problem, name)[0]) for name in FREE}
    number["turn"] = float(case.rod.stiffness_ratio) * number["mu"] * float(rates.length[0]) - number["swirl"]
    value = value_of_number(name, number[NUMBER_OF[name]], A, rho)
    reach = {"height": float(case.rod.L), "azimuth": float(case.rod.L) / rho}.get(name, np.inf)
    value = float(np.clip(value, -reach, reach))  # a taut rod reaches no farther but for rounding
    given: dict[str, Any] = {PARTNER[name]: None, name: value}
    return replace(case, given=replace(case.given, **given))
