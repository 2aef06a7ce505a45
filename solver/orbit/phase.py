"""Places along a periodic orbit: each time folded into the orbit's first period."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..numerics.arrays import Array
from .pieces import LIBRATION


@dataclass(frozen=True, eq=False)
class Phase:
    """Times folded into courses, all (B, n): which part, how far along it, after how many rounds.

    mirrored: on the way back; second: on the backward course; folded: (B, 1), whether there is a way back at all.
    """

    t: Array
    arc: NDArray[np.int64]
    local: Array
    mirrored: NDArray[np.bool_]
    second: NDArray[np.bool_]
    rounds: Array
    folded: NDArray[np.bool_]

    @property
    def turns(self) -> Array:
        """Turning points passed, (B, n); 0 where beta does not swing."""
        return np.where(self.folded, 2 * self.rounds + self.second + self.mirrored, 0.0)


def located(t: Array, kind: Any, ahead: Array, back: Array, period: Array) -> Phase:
    """Fold t (B, n) into courses of lengths ahead and back (B,) in time."""
    ahead, back, period = ahead[:, None], back[:, None], period[:, None]
    with np.errstate(invalid="ignore"):
        rest = np.where(np.isfinite(period), np.fmod(t, period), t)
        rounds = np.where(np.isfinite(period), np.round((t - rest) / period), 0.0)
    folded = (kind == LIBRATION)[:, None]
    second = folded & (rest > 2 * ahead)
    local = np.where(second, rest - 2 * ahead, rest)
    limit = np.where(second, back, ahead)
    mirrored = folded & (local > limit)
    local = np.where(mirrored, np.maximum(2 * limit - local, 0), local)
    part = 2 * np.arange(t.shape[0])[:, None] + second
    return Phase(t, part, local, mirrored, second, rounds, folded)
