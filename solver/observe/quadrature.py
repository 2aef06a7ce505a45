"""Integrals, extremes and signs of a density along the rod, from Chebyshev series on pieces of it.

A density is computed at the nodes of each piece; where its series has not converged, the piece is halved. The last
coefficients measure the error that is left.
"""

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..core.measures import NODES
from ..numerics.arrays import EPS, Array
from ..numerics.chebyshev import Basis, basis, derivative, means, polynomials, series_at, through, weights
from ..numerics.roots import bracket
from .densities import Density
from .rod_pieces import COLUMNS, Pieces

_ROUNDS, _PATIENCE = 48, 3  # halvings; those that may fail to shorten the series
_MOST = 1_000_000  # pieces of a round
_ROUNDING = 64 * EPS  # of the terms of a density, and of beta: a series cannot end below that


@dataclass(frozen=True, eq=False)
class Resolved:
    """A density on Q pieces.

    values, size, spread: (Q, m), as in `Density`. coefficients: (Q, m), of the Chebyshev series. tail: (Q,), what the
    series leave out.
    """

    pieces: Pieces
    values: Array
    size: Array
    spread: Array
    coefficients: Array
    tail: Array

    def over(self, values: Array) -> Array:
        """Sums over the pieces of each case, each times its length and count, (Q,) -> (B,)."""
        p = self.pieces
        return np.bincount(p.case, weights=values * p.time * p.count, minlength=p.problem.size)

    def most(self, values: Array) -> Array:
        """The largest of the pieces of each case, (Q,) -> (B,)."""
        return _most(self.pieces, values)

    @cached_property
    def integral(self) -> Array:
        """Integral in t, (B,)."""
        return self.over(self.coefficients @ means(NODES))

    @cached_property
    def left_out(self) -> Array:
        """The error of the integral by truncation and rounding, (B,)."""
        return self.over(2 * self.tail + EPS * self.size.max(axis=1))

    def integral_of(self, values: Array) -> Array:
        """Integral in t of values at the nodes (Q, m), (B,)."""
        return self.over(values @ weights(NODES))

    def largest(self) -> Array:
        """Largest value, (B,): at a node, the ends of the pieces among them, or where the derivative is zero."""
        return self._largest(1.0)

    def smallest(self) -> Array:
        """Smallest value, (B,)."""
        return -self._largest(-1.0)

    def _largest(self, sign: float) -> Array:
        values, rate = sign * self.values, sign * self.rates
        best = self.most(values.max(axis=1))
        width = np.diff(_basis().nodes)
        reach = np.maximum(values[:, :-1] + rate[:, :-1] * width, values[:, 1:] - rate[:, 1:] * width)
        turns = (rate[:, :-1] > 0) & (rate[:, 1:] < 0) & (reach > best[self.pieces.case, None])
        q, cell = np.nonzero(turns)
        if q.size:
            x = self.turning(q, cell, -sign)
            np.fmax.at(best, self.pieces.case[q], sign * series_at(self.coefficients[q], x))
        return best

    @cached_property
    def rates(self) -> Array:
        """Derivative with respect to the place in [-1, 1] at the nodes, (Q, m)."""
        return through(self.coefficients, _basis().differentiate)

    def turning(self, q: Array, cell: Array, sign: float) -> Array:
        """Where the derivative, times `sign` rising through zero in the cells (C,) of pieces q, is zero, (C,)."""
        nodes = _basis().nodes
        slopes = sign * self.coefficients[q] @ derivative(NODES)
        return _root(slopes, nodes[cell], nodes[cell + 1])

    def less(self, values: Array) -> "Resolved":
        """The density less other values at the nodes, (Q, m)."""
        left = self.values - values
        return replace(self, values=left, coefficients=through(left, _basis().analyse))

    def rate_at(self, q: Array, x: Array) -> Array:
        """Derivative of pieces q with respect to the place in [-1, 1], at places x, (C,)."""
        return series_at(self.coefficients[q] @ derivative(NODES), x)

    def crossings(self) -> tuple[Array, Array, Array]:
        """Pieces q, places x in [-1, 1] and directions (1 up, -1 down) where the density changes sign, (C,) each.

        Two changes between neighbouring nodes are found where the density turns between them.
        """
        nodes, up = _basis().nodes, self.values > 0
        q, cell = np.nonzero(up[:, 1:] != up[:, :-1])
        rises = up[q, cell + 1]
        low, high = np.where(rises, nodes[cell], nodes[cell + 1]), np.where(rises, nodes[cell + 1], nodes[cell])
        found = [(q, low, high, rises), self._touching(1.0), self._touching(-1.0)]
        q, low, high, rises = (np.concatenate(v) for v in zip(*found, strict=True))
        return q, _root(self.coefficients[q], low, high), np.where(rises, 1.0, -1.0)

    def first_below(self) -> Array:
        """The least t at which the density is negative, (B,); inf where it is nowhere.

        What a rod passes backward, it passed forward before, with the same values; so only the way forward counts.
        """
        p = self.pieces
        share = np.where(self.values[:, 0] < 0, 0.0, np.inf)  # of the time of the piece
        q, x, sign = self.crossings()
        falls = sign < 0
        np.fmin.at(share, q[falls], (1 + x[falls]) / 2)
        first = np.full(p.problem.size, np.inf)
        np.fmin.at(first, p.case, p.begin + share * p.time)
        return first

    def _touching(self, sign: float) -> tuple[Array, Array, Array, Array]:
        """Pairs of sign changes in one cell, where a positive density (sign 1) dips below zero or a negative one above.

        Returns pieces, places where it is negative, places where it is positive, and whether it rises, (2 C,) each.
        """
        v, rate, nodes = sign * self.values, sign * self.rates, _basis().nodes
        same = (self.values > 0) == (sign > 0)  # zero counts as negative
        width = np.diff(nodes)
        dips = same[:, 1:] & same[:, :-1] & (rate[:, :-1] < 0) & (rate[:, 1:] > 0)
        dips &= (v[:, :-1] + rate[:, :-1] * width < 0) | (v[:, 1:] - rate[:, 1:] * width < 0)
        q, cell = np.nonzero(dips)
        if not q.size:
            return q, np.empty(0), np.empty(0), np.empty(0, dtype=bool)
        x = self.turning(q, cell, sign)
        crosses = sign * series_at(self.coefficients[q], x) < 0
        q, cell, x = q[crosses], cell[crosses], x[crosses]
        a, b = nodes[cell], nodes[cell + 1]
        first, second = ((x, a), (x, b)) if sign > 0 else ((a, x), (b, x))
        low, high = (np.concatenate([one, other]) for one, other in zip(first, second, strict=True))
        rises = np.repeat([sign < 0, sign > 0], q.size)
        return np.concatenate([q, q]), low, high, rises


def _root(series: Array, low: Array, high: Array) -> Array:
    """Where series (C, n) are zero between places where they are negative and where they are not, (C,)."""
    both = np.stack([series, series @ derivative(series.shape[1])])

    def value_and_rate(x: Array) -> tuple[Array, Array]:
        found = np.einsum("kcn,nc->kc", both, polynomials(x, series.shape[1]))
        return found[0], found[1]

    return bracket(value_and_rate, low, high, steps=60)


def _most(pieces: Pieces, values: Array) -> Array:
    best = np.full(pieces.problem.size, -np.inf)
    np.fmax.at(best, pieces.case, values)
    return best


def resolve(
    pieces: Pieces,
    density: Callable[[Pieces], Density],
    goal: float,
    extremes: bool = True,
    signs: bool = False,
) -> Resolved:
    """The density on pieces that are halved until its series converge.

    Parameters
    ----------
    pieces : Pieces
        The pieces of B rods.
    density : callable
        Pieces to their `Density`.
    goal : float
        Allowed error of the integral, relative to the integral of the density's size.
    extremes, signs : bool
        Whether the largest value, and whether the value everywhere, is to be known to `goal` of the largest value.
    """
    done: list[Resolved] = []
    total = top = np.zeros(0)
    before, stuck = np.full(pieces.case.size, np.inf), np.zeros(pieces.case.size, dtype=np.int64)
    for round_ in range(_ROUNDS + 1):
        here = _expand(pieces, density)
        values, tail = np.abs(here.values), here.tail
        largest, length = values.max(axis=1), pieces.time * pieces.count
        if round_ == 0:
            total, top = here.integral_of(values), here.most(largest)
        bad = tail * length > goal * total[pieces.case] / 8
        if signs:
            bad |= tail > goal * largest
        elif extremes:
            bad |= (tail > goal * largest) & (largest + 16 * tail >= top[pieces.case])
        floor = here.size + here.spread * np.maximum(1, np.abs(pieces.problem.beta0))[pieces.case, None]
        bad &= tail > _ROUNDING * floor.max(axis=1)
        stuck = stuck + (tail > 0.7 * before)
        bad &= (stuck < _PATIENCE) & (round_ < _ROUNDS) & (pieces.high - pieces.low > 1e-13)
        if not bad.any() or 2 * np.count_nonzero(bad) > _MOST:
            done.append(here)
            break
        done.append(_take(here, ~bad))
        pieces = pieces.take(bad).halves()
        before, stuck = np.repeat(tail[bad], 2), np.repeat(stuck[bad], 2)
    return done[0] if len(done) == 1 else _join(done)


def _expand(pieces: Pieces, density: Callable[[Pieces], Density]) -> Resolved:
    found = density(pieces)
    coefficients = through(found.values, _basis().analyse)
    tail = np.abs(coefficients[:, -3:]).max(axis=1)
    return Resolved(pieces, found.values, found.size, found.spread, coefficients, tail)


_ARRAYS = tuple(f.name for f in fields(Resolved) if f.name != "pieces")


def _take(found: Resolved, index: Any) -> Resolved:
    return Resolved(found.pieces.take(index), **{name: getattr(found, name)[index] for name in _ARRAYS})


def _join(parts: list[Resolved]) -> Resolved:
    pieces = [part.pieces for part in parts]
    columns: dict[str, Any] = {name: np.concatenate([getattr(p, name) for p in pieces]) for name in COLUMNS}
    arrays = {name: np.concatenate([getattr(part, name) for part in parts]) for name in _ARRAYS}
    return Resolved(replace(pieces[0], **columns), **arrays)


def _basis() -> Basis:
    return basis(NODES)
