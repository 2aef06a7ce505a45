"""A density along varied orbits, and how it answers the directions of a motion, in units of A and rho."""

from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np

from ..core.measures import densities
from ..mechanics.potential import steepest
from ..numerics.arrays import Array, Integers
from ..numerics.chebyshev import basis
from ..orbit.variations import Place, Variations
from ..problem.reduced import StartProblem

_GOAL, _ROUNDS = 1e-11, 3  # of the series of a density, relative; how often a panel may be halved

_GAUSS = np.polynomial.legendre.leggauss(5)


@dataclass(frozen=True, eq=False)
class Values:
    """A density at points (...).

    size: the sum of the sizes of the terms of a value. pace: the change of the values along the orbit in a unit of
    time. moved: (..., 4), their change by a unit of each
    element of e where nothing moves along the orbit.
    """

    values: Array
    size: Array
    pace: Array
    moved: Array


@dataclass(frozen=True, eq=False)
class DensityChange:
    """One density of the core along the rods of b problems, and its change in F directions.

    varied: the variations of their orbits. span: (b,), the length in t. places: of the two ends, (b,) each. a0: (b, F),
    e: (b, F, 4), as in `orbit.variations`. later: (b, F), the change of the length in t. sign: (b,), of the push.
    """

    problem: StartProblem
    varied: Variations
    span: Array
    places: tuple[Place, Place]
    density: str
    sign: Array
    a0: Array
    e: Array
    later: Array

    @property
    def case(self) -> Integers:
        """The problem of each panel, (P,)."""
        return self.varied.orbit.panels.arc // 2

    @property
    def times(self) -> tuple[Array, Array]:
        """t at the two ends, (b,) each."""
        return 0 * self.span, self.span

    def until(self, share: float) -> "DensityChange":
        """The same along the first share of the rods."""
        span = share * self.span
        end = self.varied.at(span[:, None]).take((slice(None), 0))
        return replace(self, span=span, places=(self.places[0], end), later=share * self.later)

    @cached_property
    def nodes(self) -> Values:
        """At the nodes of the panels, (P, n)."""
        nodes = basis(self.varied.nodes.v.shape[1]).nodes
        panels = np.arange(self.case.size)
        beta, place = self.varied.on_panels(panels, np.broadcast_to(nodes, (panels.size, nodes.size)))
        return self.at(self.case, beta, place)

    @cached_property
    def ends(self) -> list[Values]:
        """At the two ends, (b,) each."""
        return [first_of(self.read(t[:, None])[0]) for t in self.times]

    @cached_property
    def most_pace(self) -> Array:
        """The largest size of the pace, (b,)."""
        return self._most(np.abs(self.nodes.pace))

    def _most(self, values: Array) -> Array:
        most = np.zeros(self.problem.size)
        np.maximum.at(most, self.case, values.max(axis=1))
        return most

    @cached_property
    def shortest(self) -> Array:
        """A time in which the density changes at least, (b,)."""
        return np.asarray(1 / np.sqrt(steepest(self.problem) + self._most(self.varied.nodes.v) ** 2))

    def read(self, t: Array) -> tuple[Values, Array]:
        """At t (b, n), and how far the changes move it along the orbit, a of `orbit.variations`, (b, n, F)."""
        place = self.varied.at(t)
        gained = place.M[:, :, 0] - self.places[0].M[:, None, 0]
        a = self.a0[:, None] + np.einsum("bnk,bfk->bnf", gained, self.e)
        return self.at(np.arange(self.problem.size), self.varied.beta(t), place), np.asarray(a)

    @cached_property
    def loads(self) -> Array:
        """lam, mu, phi and the sign of the push, (b, 4)."""
        return np.stack([self.problem.lam, self.problem.mu, self.problem.phi, self.sign], axis=1)

    def at(self, case: Array, beta: Array, place: Place) -> Values:
        """At beta and places (Q, m) of the problems `case` (Q,)."""
        rates = densities(self.density, self.loads[case], beta, place.v)
        by_rate = rates.speed * np.where(place.v < 0, -1.0, 1.0)
        across = rates.beta * (place.c * place.H / place.D) + by_rate * (place.v / place.D)
        moved = place.gamma * across[..., None] + place.shift * rates.beta[..., None]
        for q, rate in ((1, rates.lam), (2, rates.mu), (3, rates.phi)):
            moved[..., q] += rate
        return Values(rates.values, rates.size, rates.beta * place.v - by_rate * place.H, moved)

    @cached_property
    def a(self) -> Array:
        """a at the far end, (b, F)."""
        start, end = self.places
        return np.asarray(self.a0 + np.einsum("bk,bfk->bf", (end.M - start.M)[:, 0], self.e))

    def difference(self, case: Array, base: Array, x: Array, speed: Array) -> Array:
        """The density at base + x (Q, m) less that at rest at base, to relative accuracy in x: Gauss' rule."""
        total = np.zeros_like(x)
        for node, weight in zip(*_GAUSS, strict=True):
            share = (1 + node) / 2
            rates = densities(self.density, self.loads[case], base + share * x, share * speed)
            total += weight / 2 * (rates.beta * x + rates.speed * speed)
        return total

    def at_angles(self, case: Array, beta: Array, speed: Array) -> Array:
        """The values at beta and |beta_t| (Q, m) of the problems `case` (Q,)."""
        return densities(self.density, self.loads[case], beta, speed).values

    def refine(self) -> "DensityChange":
        """The same on panels that are halved until the series of the values and their changes end."""
        found = self
        for _ in range(_ROUNDS):
            nodes, points = found.nodes, basis(found.varied.nodes.v.shape[1])
            both = np.concatenate([nodes.values[:, None], np.moveaxis(nodes.moved, 2, 1)], axis=1) @ points.analyse
            tail = np.abs(both[:, :, -2:]).max(axis=2)
            top = np.zeros((found.problem.size, 5))
            np.maximum.at(top, found.case, np.abs(both).max(axis=2))
            bad = np.flatnonzero((tail > _GOAL * top[found.case]).any(axis=1))
            if not bad.size:
                break
            found = replace(found, varied=found.varied.cut(bad, np.zeros(bad.size)))
        return found


def first_of(values: Values) -> Values:
    return Values(*(getattr(values, field.name)[:, 0] for field in fields(Values)))
