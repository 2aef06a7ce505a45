"""Panels: short parts of an arc on which beta and the developed curve are Chebyshev series in time."""

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from ..numerics.arrays import Array, Integers

EPS = 2.0**-52
MOST = 10_000  # panels of one orbit beyond which none is halved any more


@dataclass(frozen=True, eq=False)
class Panels:
    """P panels, in order of arc and of time away from the start.

    arc: (P,), 2 b for the forward arc of problem b, 2 b + 1 for the backward one. rank: (P,), of the panel's piece.
    duration: (P,). series: (P, 5, n + 1), of beta, |beta_t|, alpha, z and the swirl (the integral of sin cos), the last
    three from the panel's near end. fastest: (P,), largest |beta_t|. error: (P,), what the truncated series leave out
    of beta. time_error: (P,), what they leave out of the duration, as a share of it. time_rounding: (P,), what the
    rounding of G changes of the duration, as a share. calls: (P,), evaluations of G.
    """

    arc: Integers
    rank: Integers
    duration: Array
    series: Array
    fastest: Array
    error: Array
    time_error: Array
    time_rounding: Array
    calls: Integers

    def take(self, index: Any) -> "Panels":
        return Panels(**{f.name: getattr(self, f.name)[index] for f in fields(self)})


def running(values: Array, first: Any, count: Any) -> Array:
    """Sums of the values (P, k) before each panel within its part: added part by part, so that none sees another's."""
    part = np.repeat(np.arange(count.size), count)
    rank = np.arange(part.size) - first[part]
    table = np.zeros((count.size, int(count.max(initial=0)) + 1, values.shape[1]))
    table[part, rank + 1] = values
    return np.cumsum(table, axis=1)[part, rank]


def join(parts: list[Panels]) -> Panels:
    """Panels one after the other."""
    columns: dict[str, Any] = {f.name: np.concatenate([getattr(p, f.name) for p in parts]) for f in fields(Panels)}
    return Panels(**columns)
