"""The derivatives of integrals and extremes along rods whose orbits move, in units of A and rho."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from types import SimpleNamespace
from typing import Any

import numpy as np

from ..mechanics.potential import Loads
from ..numerics.arrays import Array, Integers
from ..numerics.chebyshev import basis, derivative, polynomials
from ..numerics.roots import bracketed
from ..observe.density_rates import RATES
from ..observe.rod_pieces import Angles
from ..orbit.pieces import LIBRATION
from ..orbit.variations import Place, Variations
from ..problem.reduced import Reduced
from .motions import Motion

_SAME = 1e-12  # relative: extremes that differ by less are equal
_APART = 1e-4  # relative: derivatives that differ by more are different
_NEAR = 0.1  # rad: how near a critical point the difference of a density from that there is integrated
_EDGE = 1e-9  # of the largest pace of a density: at the end of a panel the density is stationary
_ROUNDING = 64 * 2.0**-52  # of a difference of two values of a density
_FAINT = 1e-9  # of the sum of the sizes of its terms: a derivative below this is rounding
_GOAL, _ROUNDS = 1e-11, 3

Density = Callable[..., Any]


@dataclass(frozen=True, eq=False)
class Values:
    """A density at points (...): its values; `pace`, their change along the orbit in a unit of time; `moved`: (..., 4),
    their change by a unit of each element of e where nothing moves along the orbit."""

    values: Array
    pace: Array
    moved: Array


def density_at(density: Density, sign: Array, problem: Reduced, case: Array, beta: Array, place: Place) -> Values:
    """A density times sign (B,) of the problems `case` (Q,), at beta and places (Q, m)."""
    angles, loads = Angles(beta, np.abs(place.v), np.sin(beta), np.cos(beta)), Loads.columns(problem, case)
    values = density(SimpleNamespace(angles=angles, problem=problem, case=case)).values
    rates = RATES[density](angles, loads)
    by_rate = rates.speed * np.where(place.v < 0, -1.0, 1.0)
    across = rates.beta * (place.c * place.H / place.D) + by_rate * (place.v / place.D)
    moved = place.gamma * across[..., None] + place.shift * rates.beta[..., None]
    for q, rate in ((1, rates.lam), (2, rates.mu), (3, rates.phi)):
        moved[..., q] += rate
    turn = sign[case, None]
    return Values(turn * values, turn * (rates.beta * place.v - by_rate * place.H), turn[..., None] * moved)


@dataclass(frozen=True, eq=False)
class Measure:
    """The derivatives of integrals and extremes of one density times sign (B,), for directions of a motion.

    a0: (b, F), e: (b, F, 4), later: (b, F), the change of the length in t.
    """

    motion: Motion
    varied: Variations
    density: Density
    sign: Array
    a0: Array
    e: Array
    later: Array

    @cached_property
    def case(self) -> Integers:
        return self.varied.orbit.panels.arc // 2

    @cached_property
    def nodes(self) -> Values:
        """At the nodes of the panels, (P, n)."""
        nodes = basis(self.varied.nodes.v.shape[1]).nodes
        panels = np.arange(self.case.size)
        beta, place = self.varied.on_panels(panels, np.broadcast_to(nodes, (panels.size, nodes.size)))
        return self._at(self.case, beta, place)

    @cached_property
    def ends(self) -> tuple[Values, Values]:
        """At the two ends, (b,)."""
        motion, problem = self.motion, self.motion.problem
        assert motion.start is not None and motion.end is not None
        rows, found = np.arange(problem.size), []
        for t, place in ((0 * problem.span, motion.start), (problem.span, motion.end)):
            beta = sum(self.varied.angles(t[:, None]))
            found.append(_first(self._at(rows, beta, place.take((slice(None), None)))))
        return found[0], found[1]

    def _at(self, case: Array, beta: Array, place: Place) -> Values:
        return density_at(self.density, self.sign, self.motion.problem, case, beta, place)

    @cached_property
    def a(self) -> Array:
        """a at the far end, (b, F)."""
        assert self.motion.start is not None and self.motion.end is not None
        M = (self.motion.end.M - self.motion.start.M)[:, 0]
        return np.asarray(self.a0 + np.einsum("bk,bfk->bf", M, self.e))

    def integral(self) -> Array:
        """Of the integral over the rod, (b, F)."""
        return self._refined()._sum(lambda v: v, np.ones_like)

    def parts(self) -> tuple[Array, Array, Array]:
        """Of the integrals of the positive and of minus the negative values, and of the length of the positive ones."""
        cut = self._cut_at_zeros()
        positive = (cut.nodes.values.mean(axis=1) > 0).astype(float)[:, None]
        up = cut._sum(lambda v: np.maximum(v, 0), lambda v: (v > 0) * 1.0)
        down = cut._sum(lambda v: np.maximum(-v, 0), lambda v: (v <= 0) * -1.0)
        return up, down, cut._share(positive)

    def _sum(self, kept: Callable[[Array], Array], rate: Callable[[Array], Array]) -> Array:
        """Of the integral of kept(values), (b, F); rate: the derivative of `kept`, constant on each panel."""
        factor = rate(self.nodes.values.mean(axis=1))[:, None]
        moved = np.moveaxis(self.nodes.moved, 2, 1) * factor[..., None]
        closest, still = self._closest
        level, size = kept(still), _ROUNDING * (1 + np.abs(still))
        above = kept(self.nodes.values) - level[self.case, None]
        turned = factor * self._differences
        near = self._near & (np.abs(above - turned).max(axis=1) <= size[self.case])
        above[near] = turned[near]
        ends = []
        for t, place, values in zip(self._times, self._places, self.ends, strict=True):
            base, x = (v[:, 0] for v in self.varied.angles(t[:, None]))
            rows = np.arange(t.size)
            exact = self._difference(rows, base[:, None], x[:, None], np.abs(place.v)[:, None])[:, 0]
            exact, plain = rate(values.values) * exact, kept(values.values) - level
            same = np.abs(np.sin((base - self.varied.base[closest]) / 2)) < _SAME
            ends.append(np.where(same & (np.abs(plain - exact) <= size), exact, plain))
        whole = self._by_parts(above, moved, np.zeros((self.case.size, 4)), ends[0], ends[1])
        return whole + kept(self.ends[1].values)[:, None] * self.later

    def _share(self, positive: Array) -> Array:
        """Of the length where the values are positive, (b, F): what it gains at every zero that it passes."""
        arc, panel = self.varied.orbit.panels.arc, np.arange(self.case.size)
        before = np.where(panel == self.varied.orbit.first[arc], panel, panel - 1)
        crossed = positive[before, 0] != positive[:, 0]
        gained = self.nodes.moved[:, 0] / np.abs(self.nodes.pace[:, :1])
        jump = np.where(crossed[:, None], gained, 0.0)
        level = (self._closest[1] > 0) * 1.0
        above = np.broadcast_to(positive - level[self.case, None], self.nodes.values.shape)
        begin, end = ((one.values > 0) * 1.0 for one in self.ends)
        moved = np.zeros((self.case.size, 4, above.shape[1]))
        return self._by_parts(above, moved, jump, begin - level, end - level) + end[:, None] * self.later

    def _by_parts(self, above: Array, moved: Array, jump: Array, first: Array, last: Array) -> Array:
        """The integral of the change of a density: a times its pace is integrated by parts, so that a need not be.

        above (P, n), first and last (b,): the density at the nodes and at the two ends less that at the closest saddle.
        """
        varied, B = self.varied, self.motion.problem.size
        rates = moved - above[:, None] * varied.nodes.M[:, :4]
        jumps = jump - above[:, :1] * varied.jump[:, :4]
        closing = -first[np.arange(2 * B) // 2, None] * varied.closing[:, :4]
        sums = varied.sums(rates, jumps, closing)
        ends = self.a * last[:, None] - self.a0 * first[:, None]
        return np.asarray(np.einsum("bk,bfk->bf", sums, self.e) + ends)

    @property
    def _times(self) -> tuple[Array, Array]:
        span = self.motion.problem.span
        return 0 * span, span

    @property
    def _places(self) -> tuple[Place, Place]:
        assert self.motion.start is not None and self.motion.end is not None
        return self.motion.start, self.motion.end

    @cached_property
    def _closest(self) -> tuple[Integers, Array]:
        """The panel closest to a critical point, and the density at rest at that point, (b,) each."""
        nodes, base = self.varied.nodes, self.varied.base
        D = (nodes.v**2 + nodes.c[:, None] * nodes.H**2).min(axis=1)
        order = np.lexsort((D, self.case))
        panel = order[np.searchsorted(self.case[order], np.arange(self.motion.problem.size))]
        rest, beta = np.zeros((panel.size, 1)), base[panel, None]
        return panel, self._values(np.arange(panel.size), beta, rest)[:, 0]

    @cached_property
    def _near(self) -> Array:
        """Which panels are near that point, (P,)."""
        x, base = self.varied.orbit.panels.series[:, 0], self.varied.base
        same = np.abs(np.sin((base - base[self._closest[0]][self.case]) / 2)) < _SAME
        return same & (np.abs(x).sum(axis=1) < _NEAR)

    @cached_property
    def _differences(self) -> Array:
        """The density less that at rest at the critical point of the panel, (P, n), where the two are near."""
        points, near = basis(self.varied.nodes.v.shape[1]), self._near
        out, x = np.zeros(self.nodes.values.shape), self.varied.orbit.panels.series[:, 0] @ points.values
        base = self.varied.base[near, None]
        out[near] = self._difference(self.case[near], base, x[near], self.varied.nodes.v[near])
        return out

    def _difference(self, case: Array, base: Array, x: Array, speed: Array) -> Array:
        """The density at base + x (Q, m) less that at rest at base, to relative accuracy in x: Gauss' rule."""
        total, loads = np.zeros_like(x), Loads.columns(self.motion.problem, case)
        for node, weight in zip(*np.polynomial.legendre.leggauss(5), strict=True):
            share = (1 + node) / 2
            beta = base + share * x
            rates = RATES[self.density](Angles(beta, share * speed, np.sin(beta), np.cos(beta)), loads)
            total += weight / 2 * (rates.beta * x + rates.speed * speed)
        return self.sign[case, None] * total

    def _values(self, case: Array, beta: Array, speed: Array) -> Array:
        angles = Angles(beta, speed, np.sin(beta), np.cos(beta))
        some: Any = SimpleNamespace(angles=angles, problem=self.motion.problem, case=case)
        return np.asarray(self.sign[case, None] * self.density(some).values)

    def _refined(self) -> "Measure":
        """The same on panels that are halved until the series of the values and their changes end."""
        found = self
        for _ in range(_ROUNDS):
            nodes, points = found.nodes, basis(found.varied.nodes.v.shape[1])
            both = np.concatenate([nodes.values[:, None], np.moveaxis(nodes.moved, 2, 1)], axis=1) @ points.analyse
            tail = np.abs(both[:, :, -2:]).max(axis=2)
            top = np.zeros((found.motion.problem.size, 5))
            np.maximum.at(top, found.case, np.abs(both).max(axis=2))
            bad = np.flatnonzero((tail > _GOAL * top[found.case]).any(axis=1))
            if not bad.size:
                break
            found = replace(found, varied=found.varied.cut(bad, np.zeros(bad.size)))
        return found

    def _cut_at_zeros(self) -> "Measure":
        """The same on panels on which the values have one sign."""
        found = self._refined()
        values, nodes = found.nodes.values, basis(found.varied.nodes.v.shape[1]).nodes
        up = values > 0
        q, cell = np.nonzero(up[:, 1:] != up[:, :-1])
        if not q.size:
            return found
        rises = up[q, cell + 1]
        low, high = np.where(rises, nodes[cell], nodes[cell + 1]), np.where(rises, nodes[cell + 1], nodes[cell])
        x = _root(values[q] @ basis(nodes.size).analyse, low, high)
        inside = np.abs(x) < 1 - 1e-12
        return replace(found, varied=found.varied.cut(q[inside], x[inside]))

    def extreme(self, largest: bool) -> Array:
        """Of the largest or the smallest value along the rod, (b, F); NaN where several places reach it unequally."""
        turn = 1.0 if largest else -1.0
        case, values, slopes, sizes = self._candidates()
        best = np.full(self.motion.problem.size, -np.inf)
        np.fmax.at(best, case, turn * values)
        top = turn * values >= (best - _SAME * np.maximum(np.abs(best), 1e-300))[case]
        chosen = np.zeros((best.size, slopes.shape[1]))
        chosen[case[top][::-1]] = slopes[top][::-1]  # the first of each case
        off = np.abs(slopes - chosen[case]) > _APART * (np.abs(slopes) + np.abs(chosen[case])) + _FAINT * sizes
        unequal = np.zeros_like(chosen, dtype=bool)
        np.logical_or.at(unequal, case[top], off[top])
        return np.where(unequal, np.nan, chosen)

    def _candidates(self) -> tuple[Array, Array, Array, Array]:
        """Cases (N,), values (N,), their derivatives and the sizes of these, (N, F): at the ends of the rods, where the
        values are stationary, and where panels meet, as roots there are missed."""
        found = self._refined()
        panels, nodes = found.varied.orbit.panels, basis(found.varied.nodes.v.shape[1]).nodes
        pace = found.nodes.pace
        up = pace > 0
        q, cell = np.nonzero(up[:, 1:] != up[:, :-1])
        rises = up[q, cell + 1]
        low, high = np.where(rises, nodes[cell], nodes[cell + 1]), np.where(rises, nodes[cell + 1], nodes[cell])
        x = _root(pace[q] @ basis(nodes.size).analyse, low, high)
        most = np.zeros(self.motion.problem.size)
        np.maximum.at(most, found.case, np.abs(pace).max(axis=1))
        edges = np.abs(pace[:, [0, -1]]) <= _EDGE * most[found.case, None]
        edge, side = np.nonzero(edges)
        q, x = np.concatenate([q, edge]), np.concatenate([x, 2.0 * side - 1])
        passed = _passed(found.varied, q, x)
        q, x = q[passed], x[passed]
        beta, place = found.varied.on_panels(q, x[:, None])
        at = _first(found._at(found.case[q], beta, place))
        case = found.case[q]
        values, slopes, sizes = [at.values], [_along(at, self.e[case])], [_along(at, self.e[case], np.abs)]
        first, end = self.ends
        for one, along in ((first, self.a0), (end, self.a + self.later)):
            shifted = along * one.pace[:, None]
            values.append(one.values)
            slopes.append(_along(one, self.e) + shifted)
            sizes.append(_along(one, self.e, np.abs) + np.abs(shifted))
        rows = np.arange(self.motion.problem.size)
        joined = (np.concatenate(v) for v in (values, slopes, sizes))
        return np.concatenate([case, rows, rows]), *joined


def _along(at: Values, e: Array, size: Callable[[Array], Array] = np.asarray) -> Array:
    """The change of values (N,) where nothing moves along the orbit, (N, F); size: applied to each factor."""
    return np.asarray(np.einsum("nk,nfk->nf", size(at.moved), size(e)))


def _first(values: Values) -> Values:
    return Values(values.values[:, 0], values.pace[:, 0], values.moved[:, 0])


def _passed(varied: Variations, q: Array, x: Array) -> Array:
    """Whether the rod passes the places x of panels q, (N,)."""
    orbit, panels = varied.orbit, varied.orbit.panels
    case, second = panels.arc[q] // 2, panels.arc[q] % 2 == 1
    span, ahead, back = orbit.problem.span[case], orbit.ahead[case], orbit.back[case]
    local = orbit.since[q] + panels.duration[q] * (1 + x) / 2
    there = local + np.where(second, 2 * ahead, 0.0)
    again = np.where(orbit.kind[case] == LIBRATION, 2 * ahead + np.where(second, 2 * back, 0.0) - local, np.inf)
    return np.asarray((np.minimum(there, again) <= span) | (orbit.period[case] <= span))


def _root(series: Array, low: Array, high: Array) -> Array:
    """Where series (C, n) are zero between places where they are negative and where they are not, (C,)."""
    both = np.stack([series, series @ derivative(series.shape[1])])

    def value_and_rate(x: Array) -> tuple[Array, Array]:
        found = np.einsum("kcn,nc->kc", both, polynomials(x, series.shape[1]))
        return found[0], found[1]

    return bracketed(value_and_rate, low, high, steps=60)
