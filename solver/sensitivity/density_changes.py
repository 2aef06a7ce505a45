"""A density along varied orbits, and how it answers the directions of a motion, in units of A and rho."""

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..core.measures import densities, extremes
from ..equilibrium import orbit_rates
from ..mechanics.potential import steepest
from ..numerics.arrays import Array, Booleans, Integers
from ..numerics.chebyshev import basis
from ..orbit.variations import Place, Variations
from ..problem.reduced import StartProblem
from .motions import Motion

SAME = 1e-12  # relative: extremes that differ by less are equal
_SERIES = 1e-14  # of the series of which the places of extremes are found, relative
_STEP = 1e-4  # of the shortest time of a change: differences about a place
_NEAR = 0.1  # rad: how near a critical point the difference of a density from that there is integrated
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

    def take(self, k: int) -> "Values":
        """The k-th of the points (b, n) of each rod, (b,)."""
        return Values(*(getattr(self, field.name)[:, k] for field in fields(Values)))

    def tile(self, count: int) -> "Values":
        """The same, that often after each other, of points (b, n)."""
        parts = (getattr(self, field.name) for field in fields(Values))
        return Values(*(np.tile(part, (1, count, *[1] * (part.ndim - 2))) for part in parts))


class Candidates(NamedTuple):
    """Places along b rods, t (b, K), NaN where there is none, and what is read there: `DensityChange.read`."""

    t: Array
    at: Values
    a: Array


@dataclass(frozen=True, eq=False)
class DensityChange:
    """One density of the core along the rods of b problems, and its change in F directions.

    motion: of the rods. varied: the variations of their orbits. span: (b,), the length in t. places: of the two ends,
    (b,) each. a0: (b, F), e: (b, F, 4), as in `orbit.variations`. later: (b, F), the change of the length in t. sign:
    (b,), of the push.
    """

    motion: Motion
    varied: Variations
    span: Array
    places: tuple[Place, Place]
    density: str
    sign: Array
    a0: Array
    e: Array
    later: Array

    @property
    def problem(self) -> StartProblem:
        """The start problems of the orbits."""
        return self.motion.problem

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
        both = self.read(np.stack(self.times, axis=1))[0]
        return [both.take(end) for end in (0, 1)]

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

    @cached_property
    def candidates(self) -> Candidates:
        """Where an extreme along the whole rods may be: at the ends, and where the density is largest or smallest."""
        return self._candidates(self.span, np.stack(self.times, axis=1))

    def candidates_until(self, until: Array) -> Candidates:
        """The same of an extreme up to the times `until` (b,), without the ends."""
        return self._candidates(until, np.empty((until.size, 0)))

    def _candidates(self, until: Array, ends: Array) -> Candidates:
        reach = np.fmin(until, self.varied.orbit.period)  # later periods have the same values
        given = self.motion.pieces, self.sign, self.density
        t = np.concatenate([extremes(*given, turned, reach, SAME, _SERIES) for turned in (False, True)], axis=1)
        t = np.concatenate([ends, t[:, np.isfinite(t).any(axis=0)]], axis=1)
        at_end = (t <= 0) | (t >= self.span[:, None] * (1 - SAME))
        t = np.where(at_end, t, np.clip(self._stationary(t), 0.0, self.span[:, None]))
        return Candidates(t, *self.read(np.where(np.isnan(t), 0.0, t)))

    def _stationary(self, t: Array) -> Array:
        """Places (b, K) next to which the density is stationary, by a step of Newton's from each."""
        step = _STEP * self.shortest[:, None]
        pace = self.read(np.concatenate([t - step, t + step, t], axis=1))[0].pace
        low, high, middle = np.split(pace, 3, axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            off = 2 * step * middle / (high - low)
        return np.where(np.abs(off) < step, t - off, t)

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
        shares, flat = ((1 + _GAUSS[0]) / 2)[:, None], (x.shape[0], _GAUSS[0].size * x.shape[1])
        beta, rate = base[:, None] + shares * x[:, None], shares * speed[:, None]
        rates = densities(self.density, self.loads[case], beta.reshape(flat), rate.reshape(flat))
        slopes = np.stack([rates.beta, rates.speed]).reshape(2, *beta.shape)
        by_beta, by_speed = np.einsum("k,pqkm->pqm", _GAUSS[1] / 2, slopes)
        return np.asarray(by_beta * x + by_speed * speed)

    @cached_property
    def closest(self) -> tuple[Integers, Array]:
        """The panel closest to a critical point, and the density at rest at that point, (b,) each."""
        nodes, base = self.varied.nodes, self.varied.base
        D = (nodes.v**2 + nodes.c[:, None] * nodes.H**2).min(axis=1)
        order = np.lexsort((D, self.case))
        panel = order[np.searchsorted(self.case[order], np.arange(self.problem.size))]
        rest, beta = np.zeros((panel.size, 1)), base[panel, None]
        return panel, densities(self.density, self.loads, beta, rest).values[:, 0]

    @cached_property
    def near(self) -> Booleans:
        """Which panels are near that point, (P,)."""
        x, base = self.varied.orbit.panels.series[:, 0], self.varied.base
        same = np.abs(np.sin((base - base[self.closest[0]][self.case]) / 2)) < orbit_rates.SAME
        return same & (np.abs(x).sum(axis=1) < _NEAR)

    @cached_property
    def differences(self) -> Array:
        """The density less that at rest at the critical point of the panel, (P, n), where the two are near."""
        points, near = basis(self.varied.nodes.v.shape[1]), self.near
        out, x = np.zeros(self.nodes.values.shape), self.varied.orbit.panels.series[:, 0] @ points.values
        base = self.varied.base[near, None]
        out[near] = self.difference(self.case[near], base, x[near], self.varied.nodes.v[near])
        return out

    @cached_property
    def refined(self) -> "DensityChange":
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
