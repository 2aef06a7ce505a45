"""The problems of a branch: five given numbers, the length and A/C over one parameter p."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from ..core import branches as core
from ..equilibrium.orbit_rates import HOW, NUMBERS
from ..equilibrium.system import FREE, Given, is_hinged
from ..levels.line_point import LinePoint
from ..levels.transit_times import CUTTING, NODES
from ..orbit.critical_points import grid
from ..orbit.variations import POINTS
from ..problem.reduced import EndsProblem

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
            return core.Steps(self.numbers, self.scale, grid(), NODES, (CUTTING, CUTTING))
        held = tuple((*NUMBERS, "turn").index(name) for name in self.names)
        return core.Steps(self.numbers, self.scale, grid(), POINTS, HOW, held)

    def place(self, p: float) -> LinePoint | None:
        """The problem under dead loads at p with its critical points."""
        if p not in self._known:
            given = self.given(p)
            while len(self._known) >= _KEPT:
                del self._known[next(iter(self._known))]
            self._known[p] = None if given is None else LinePoint(problem_of(given, {}))
        return self._known[p]


def problem_of(given: Given, numbers: dict[str, float]) -> EndsProblem:
    """The problem under dead loads of the given numbers, which count exactly, and of the others."""
    numbers = numbers | {name: float(v) for name, v in zip(given.names, given.values, strict=True) if name in FREE}
    return EndsProblem(**{name: np.array([v]) for name, v in numbers.items()}, span=np.array([given.span]))


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
