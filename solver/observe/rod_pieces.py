"""Pieces of rods on which beta and beta_t are Chebyshev series in time, for the integration of observables."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..core.measures import NODES
from ..numerics.arrays import Array, Integers
from ..numerics.chebyshev import basis, polynomials
from ..problem.reduced import Reduced

COLUMNS = ("case", "row", "low", "high", "time", "count", "begin")  # fields of each piece


@dataclass(frozen=True, eq=False)
class Angles:
    """beta, |beta_t|, and sin and cos of beta at the nodes of Q pieces, (Q, NODES) each."""

    beta: Array
    speed: Array
    sin: Array
    cos: Array


@dataclass(frozen=True, eq=False)
class Pieces:
    """Q pieces of the rods of B problems.

    series: (P, 2, N), Chebyshev coefficients of beta and |beta_t| on panels; where loads vary along the rods (P, 7, N),
    also of lam, mu, phi, the weight across times cos(alpha), and what friction divides the contact by.
    case: (Q,), of which problem. row: (Q,),
    on which panel. low, high: (Q,), from where to where on it, in [-1, 1]. time: (Q,), length in t. count: (Q,), how
    often the rod passes the piece. begin: (Q,), the t at which it first enters the piece. monotone: whether beta does
    not turn back on any piece, as on those of an orbit.
    """

    problem: Reduced
    series: Array
    case: Integers
    row: Integers
    low: Array
    high: Array
    time: Array
    count: Array
    begin: Array
    monotone: bool = False

    def take(self, index: Any) -> "Pieces":
        """The pieces that an index picks."""
        return replace(self, **{name: getattr(self, name)[index] for name in COLUMNS})

    def halves(self) -> "Pieces":
        """Each piece as two, one after the other."""
        twice = self.take(np.repeat(np.arange(self.case.size), 2))
        second = np.arange(twice.case.size) % 2 == 1
        middle = (twice.low + twice.high) / 2
        low, high = np.where(second, middle, twice.low), np.where(second, twice.high, middle)
        time = twice.time / 2
        begin = twice.begin + np.where(second, time, 0)
        return replace(twice, low=low, high=high, time=time, begin=begin)

    @cached_property
    def angles(self) -> Angles:
        """The angles at the nodes, from which every density is computed."""
        beta, speed = self.at(basis(NODES).nodes)
        return Angles(beta, speed, np.sin(beta), np.cos(beta))

    def at(self, nodes: Array) -> tuple[Array, Array]:
        """beta and |beta_t| at nodes (m,) of [-1, 1] on each piece, (Q, m) each."""
        return self._values(self.series[:, :2], nodes)

    @cached_property
    def varying(self) -> Array | None:
        """The other five at the nodes, (5, Q, NODES); None where loads do not vary."""
        return self._values(self.series[:, 2:], basis(NODES).nodes) if self.series.shape[1] > 2 else None

    def _values(self, series: Array, nodes: Array) -> Any:
        """The values of series (P, K, N) at nodes (m,) of [-1, 1] on each piece, (K, Q, m)."""
        n = series.shape[2]
        out = np.empty((self.case.size, series.shape[1], nodes.size))
        whole = (self.low == -1) & (self.high == 1)
        if whole.any():
            out[whole] = series[self.row[whole]] @ polynomials(nodes, n)
        cut = np.flatnonzero(~whole)
        if cut.size:
            low, high = self.low[cut, None], self.high[cut, None]
            x = np.clip(low + (high - low) * (1 + nodes) / 2, -1, 1)
            out[cut] = np.einsum("qcn,nqm->qcm", series[self.row[cut]], polynomials(x, n), optimize=True)
        return out.transpose(1, 0, 2)


def join_pieces(parts: Sequence[Pieces], problem: Reduced) -> Pieces:
    """Pieces one after the other, as those of `problem`."""
    N = max(p.series.shape[2] for p in parts)
    padded = [np.pad(p.series, ((0, 0), (0, 0), (0, N - p.series.shape[2]))) for p in parts]
    before = np.cumsum([0, *(p.series.shape[0] for p in parts)])
    row = np.concatenate([p.row + k for p, k in zip(parts, before, strict=False)])
    rest = {name: np.concatenate([getattr(p, name) for p in parts]) for name in COLUMNS if name != "row"}
    return Pieces(problem, np.concatenate(padded), row=row, monotone=all(p.monotone for p in parts), **rest)
