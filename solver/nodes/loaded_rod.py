"""Rods whose loads vary along them, in units of A and rho: numbers, scales, and what their ends are given."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..core.weight_friction import SIZE
from ..numerics.arrays import Array, integral
from ..problem.case import IN_PLACE, Case
from ..problem.case_fields import with_fields_unchecked
from ..problem.dimensionless import StartProblem, dimensionless_problem, end_fields, end_values, flat, problem_at_ends

BETA, SPEED, ALPHA, Q, PHI, MU, SHORT, ROUND = range(SIZE)
HELD = {"beta0": "beta0", "betaL": "betaL", "azimuth": "alpha", "height": "z", "rotation": "turn"}  # what ends can hold
VARYING = "numbers", "near", "far"  # the numbers of a rod that vary over fields of its case, beside its span


@dataclass(frozen=True, eq=False)
class LoadedRod:
    """A rod between its ends.

    numbers: (7,), as of `core.weight_friction.march`. span: L/rho. held: those of `HELD` that are given;
    for any other one its partner is: beta_t, lam, phi or mu. near: (2,), beta0
    or beta_t(0), and alpha(0). far: (4,), beta or beta_t, lam or azimuth, phi or z/rho, mu or rotation, at the far end.
    """

    numbers: Array
    span: float
    held: frozenset[str]
    near: Array
    far: Array

    @property
    def along(self) -> float:
        """omega cos(theta): phi grows by it along the rod."""
        return float(self.numbers[1])

    @property
    def across(self) -> float:
        """omega sin(theta)."""
        return float(self.numbers[2])

    @property
    def has_friction(self) -> bool:
        """Whether friction acts: then there is no energy and no index."""
        return bool(self.numbers[3] != 0)

    @property
    def turns_freely(self) -> bool:
        """Whether no end angle is given, so that a shape whose beta is whole turns larger is the same one."""
        return not {"beta0", "betaL"} & self.held

    @cached_property
    def tension_known(self) -> float:
        """phi at the far end; 0 where the height is held."""
        return 0.0 if "height" in self.held else float(self.far[2])

    @property
    def twist_known(self) -> float:
        """mu at the far end of a straight rod."""
        return float(self.far[3] / (self.numbers[0] * self.span) if "rotation" in self.held else self.far[3])

    def rate(self, t: Array, rubbed: Array | float = 0.0) -> Array:
        """1 over the length on which the shape changes at t. rubbed: what friction adds to phi."""
        phi = self.tension_known - self.along * (self.span - t) + rubbed
        mu = 0.0 if "rotation" in self.held else float(self.far[3])
        lam = 0.0 if "azimuth" in self.held else float(self.far[1]) - mu
        turned = self.far[1] / self.span if "azimuth" in self.held else 0.0
        return rate_of_change(phi, self.along, self.across, mu, lam, self.span, turned)

    @cached_property
    def time(self) -> float:
        """The shortest length on which the shape changes."""
        return float(1 / self.rate(np.array([0.0, self.span])).max())

    @cached_property
    def scale(self) -> Array:
        """The sizes of the eight numbers of the state."""
        return np.array(scales(1 / self.time, min(1.0, 1 / self.time)))

    def in_scales(self, scale: Array) -> "LoadedRod":
        """A copy of the rod with given sizes of the numbers of the state."""
        other = replace(self)
        vars(other)["scale"] = scale
        return other

    def conditions(self) -> tuple[Array, Array, Array, Array]:
        """Rows (4, 8) and values (4,) of the conditions at the start and at the far end, each of order 1."""
        start, far = np.zeros((4, SIZE)), np.zeros((4, SIZE))
        values = np.array([self.near[0], self.near[1], 0.0, 0.0]), self.far.copy()
        start[0, BETA if "beta0" in self.held else SPEED] = 1
        start[1, ALPHA] = start[2, SHORT] = start[3, ROUND] = 1
        far[0, BETA if "betaL" in self.held else SPEED] = 1
        if "azimuth" in self.held:
            far[1, ALPHA] = 1
            values[1][1] += self.near[1]
        else:
            far[1, Q] = far[1, MU] = 1
        if "height" in self.held:
            far[2, SHORT] = 1
            values[1][2] = self.span - self.far[2]
        else:
            far[2, PHI] = 1
        if "rotation" in self.held:
            far[3, ROUND], far[3, ALPHA] = 1, -1
            values[1][3] -= self.near[1]
        else:
            far[3, MU] = 1
        sizes = [1 / (rows * self.scale).max(axis=1) for rows in (start, far)]
        return start * sizes[0][:, None], values[0] * sizes[0], far * sizes[1][:, None], values[1] * sizes[1]

    def times(self, factor: float, numbers: Sequence[int], far: Sequence[int] = ()) -> "LoadedRod":
        """The rod with some of its numbers, and of those of its far end, by their places, multiplied by a factor."""
        new = self.numbers.copy(), self.far.copy()
        for values, places in zip(new, (numbers, far), strict=True):
            for place in places:
                values[place] *= factor
        return replace(self, numbers=new[0], far=new[1])

    def share(self, part: float) -> "LoadedRod":
        """The rod under a share of its loads and held numbers; the weight across stays whole."""
        numbers, far = self.numbers.copy(), self.far * part
        numbers[1] *= part
        if "height" in self.held:
            far[2] = self.span + (self.far[2] - self.span) * part
        return replace(self, numbers=numbers, near=self.near * part, far=far)

    def _with_far(self, place: int, value: float, held: frozenset[str]) -> "LoadedRod":
        """The rod with another number of its far end, and what its ends then hold."""
        far = self.far.copy()
        far[place] = value
        return replace(self, held=held, far=far)

    def with_tension(self, phi: float) -> "LoadedRod":
        """The rod with another given phi at the far end, also in place of a held height."""
        return self._with_far(2, phi, self.held - {"height"})

    def with_azimuth(self, gained: float) -> "LoadedRod":
        """The rod with another azimuth held at the far end, over that of the start."""
        return self._with_far(1, gained, self.held | {"azimuth"})

    def with_torque_through(self) -> "LoadedRod":
        """The rod under the moment about the axis with which a straight rod is an equilibrium, its azimuth free."""
        return self._with_far(1, self.twist_known, self.held - {"azimuth"})

    def with_friction(self, part: float) -> "LoadedRod":
        """The rod with a share of its friction."""
        return self.times(part, [3])

    def with_torque(self, part: float) -> "LoadedRod":
        """The rod with a share of its twisting moment, of what is given and of what friction adds as it turns."""
        return self.times(part, [5], [3])

    def with_weight(self, part: float) -> "LoadedRod":
        """The rod with a share of its weight."""
        return self.times(part, [1, 2])

    @property
    def straight(self) -> bool:
        """Whether the straight rod along the axis is an equilibrium."""
        turned = self.far[1] if "azimuth" in self.held else self.far[1] - self.twist_known
        if "height" in self.held and self.far[2] != self.span:
            return False
        level = self.across * np.sin(self.near[1])
        leans = self.rotates and self.across != 0  # without weight across no push turns the straight rod aside
        return not any((self.near[0], self.far[0], turned)) and abs(level) <= 1e-15 * abs(self.across) and not leans

    @property
    def rotates(self) -> bool:
        """Whether the rod turns in place against friction."""
        return bool(self.numbers[4] == IN_PLACE and self.has_friction)

    def nodes(self, rubbed: Array | float = 0.0) -> Array:
        """Nodes from 0 to the span, about one on each length on which the shape changes.

        rubbed: what friction adds to phi, at places of equal distances.
        """
        t, passed = self.changes(rubbed)
        count = max(4, int(np.ceil(passed[-1])))
        return np.interp(np.linspace(0, passed[-1], count + 1), passed, t)

    def changes(self, rubbed: Array | float = 0.0) -> tuple[Array, Array]:
        """Places from 0 to the span, and how many lengths on which the shape changes lie before each."""
        t = np.linspace(0, self.span, max(513, np.size(rubbed)))
        rate = self.rate(t, np.interp(t, np.linspace(0, self.span, np.size(rubbed)), np.ravel(rubbed)))
        return t, integral(rate, t)

    def straight_states(self, nodes: Array) -> Array:
        """The state of the straight rod at the nodes, (N, 8); friction on it included."""
        y = np.zeros((nodes.size, SIZE))
        y[:, ALPHA] = self.near[1]
        outward, k = self.numbers[6], self.numbers[3]
        push = -outward * self.across * np.cos(self.near[1])
        rate = self.along + (0.0 if self.rotates else k * push)
        y[:, PHI] = self.tension_known - rate * (self.span - nodes)
        y[:, MU] = self.twist_known
        y[:, ROUND] = self.numbers[0] * y[:, MU] * nodes
        return y


def densest_nodes(rods: Iterable[LoadedRod]) -> Array:
    """Nodes as shares of the span, dense enough for each rod."""
    return max((rod.nodes() / rod.span for rod in rods), key=len)


def rate_of_change(phi: Any, along: Any, across: Any, mu: Any, q: Any, span: Any, turned: Any = 0.0) -> Array:
    """1 over the length on which the shape of a rod changes under such loads; turned: the azimuth gained in a unit."""
    weight = np.sqrt(np.abs(across)) + np.cbrt(along**2)
    return np.sqrt(np.abs(phi) + weight + mu**2 + np.cbrt(q**2) + turned**2 + 1 / span**2)


def scales(rate: Any, size: Any) -> list[Any]:
    """The sizes of the eight numbers of a state that changes at a rate, and whose beta has a size."""
    unit = np.ones_like(rate)
    return [size, size * rate, unit, size * rate**2, rate**2, rate, size**2 / rate, unit]


def numbers_of(case: Case) -> Array:
    """The numbers of each rod as `core.weight_friction.march` takes them, (B, 7)."""
    return np.stack([flat(column, case.shape) for column in _number_columns(case)], axis=1)


def _number_columns(case: Case) -> tuple[Any, ...]:
    """The seven numbers of `core.weight_friction.march`, in the shapes of the fields that they come from."""
    A, rho, wall = np.asarray(case.rod.bending_stiffness), np.asarray(case.rho), case.cylinder
    theta = 0.0 if wall.inclination is None else wall.inclination
    sign, way = wall.sense
    with np.errstate(all="ignore"):  # overflow is reported in the outcome
        omega = (0.0 if case.rod.weight is None else case.rod.weight) * rho**3 / A
        # sines of small angles, so that a rod that lies feels no weight along it, and one that hangs none across it
        along, across = omega * np.sin(np.pi / 2 - theta), omega * np.sin(np.minimum(theta, np.pi - theta))
        rubbed = sign * (0.0 if wall.friction is None else wall.friction)
        return case.rod.stiffness_ratio, along, across, rubbed, float(way), case.rod.a / rho, case.outward


def starts_of(case: Case) -> tuple[StartProblem, Array, Array, Array]:
    """The start problems of a case, its numbers (B, 7), the states at the start and their scales, (B, 8) each."""
    problem, numbers = dimensionless_problem(case), numbers_of(case)
    assert isinstance(problem, StartProblem)
    y = np.zeros((problem.size, SIZE))
    y[:, BETA], y[:, SPEED], y[:, ALPHA] = problem.beta0, problem.dbeta0, flat(case.given.alpha, case.shape)
    y[:, Q], y[:, PHI], y[:, MU] = problem.lam - problem.mu, problem.phi, problem.mu
    rate = rate_of_change(problem.phi, numbers[:, 1], numbers[:, 2], problem.mu, y[:, Q], problem.span)
    scale = np.stack(scales(rate, np.minimum(1, np.maximum(rate, np.abs(problem.beta0)))), axis=1)
    scale[:, SPEED] = np.maximum(scale[:, SPEED], np.abs(problem.dbeta0))
    return problem, numbers, y, scale


def rods_of(case: Case) -> list[LoadedRod]:
    """The ends problems of a case, one by one."""
    problem, numbers = problem_at_ends(case), numbers_of(case)
    alpha0 = flat(case.given.alpha, case.shape)
    return [
        _rod_of(problem.given, numbers[i], problem.values[i].tolist(), float(problem.span[i]), float(alpha0[i]))
        for i in range(problem.size)
    ]


def rod_over(case: Case, *names: str) -> Callable[..., LoadedRod]:
    """The ends problem of one case over some fields: that of `rods_of`, for valid values, many times as fast."""
    fields = end_fields(case)

    def rod_at(*values: float) -> LoadedRod:
        other = with_fields_unchecked(case, dict(zip(names, values, strict=True)))
        with np.errstate(all="ignore"):
            *five, span, _ = end_values(other, fields)
            return _rod_of(fields, np.array(_number_columns(other)), five, float(span), float(other.given.alpha))

    return rod_at


def _rod_of(fields: Sequence[str], numbers: Array, values: Sequence[float], span: float, alpha0: float) -> LoadedRod:
    """The ends problem of one rod. values: of the five given fields, one of each of `problem.case.PAIRS`."""
    beta0, betaL, axial, turned, twist = values
    held = frozenset(fields).intersection(HELD)
    return LoadedRod(numbers, span, held, np.array([beta0, alpha0]), np.array([betaL, turned, axial, twist]))
