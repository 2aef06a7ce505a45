"""Pieces of rods on which beta and beta_t are Chebyshev series in time, for the integration of observables."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..numerics.arrays import Array, Integers
from ..problem.reduced import Reduced

COLUMNS = ("case", "row", "low", "high", "time", "count", "begin")  # fields of each piece


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


def join_pieces(parts: Sequence[Pieces], problem: Reduced) -> Pieces:
    """Pieces one after the other, as those of `problem`."""
    if len(parts) == 1:
        return replace(parts[0], problem=problem)
    N = max(p.series.shape[2] for p in parts)
    padded = [np.pad(p.series, ((0, 0), (0, 0), (0, N - p.series.shape[2]))) for p in parts]
    before = np.cumsum([0, *(p.series.shape[0] for p in parts)])
    row = np.concatenate([p.row + k for p, k in zip(parts, before, strict=False)])
    rest = {name: np.concatenate([getattr(p, name) for p in parts]) for name in COLUMNS if name != "row"}
    return Pieces(problem, np.concatenate(padded), row=row, monotone=all(p.monotone for p in parts), **rest)
