"""Phases of a periodic orbit: each time folded into the orbit's two arcs."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..numerics.arrays import Array, Booleans, Integers
from .pieces import LIBRATION


@dataclass(frozen=True, eq=False)
class Phase:
    """Times t folded into the arcs of B orbits, (B, n) each.

    arc: 2 b or 2 b + 1, as in `Panels`. local: time along that arc, from the start of the orbit. mirrored: whether the
    orbit is on its way back along the arc. second: whether the arc is the backward one. periods: whole periods passed.
    folded: (B, 1), whether the orbit comes back at all, which a libration does.
    """

    t: Array
    arc: Integers
    local: Array
    mirrored: Booleans
    second: Booleans
    periods: Array
    folded: Booleans

    @property
    def turns(self) -> Array:
        """Turning points passed, (B, n); 0 where beta does not librate."""
        return np.where(self.folded, 2 * self.periods + self.second + self.mirrored, 0.0)


def phase_at(t: Array, kind: Any, ahead: Array, back: Array, period: Array) -> Phase:
    """The phases of t (B, n) on orbits whose arcs last ahead and back, (B,)."""
    ahead, back, period = ahead[:, None], back[:, None], period[:, None]
    with np.errstate(invalid="ignore"):
        rest = np.where(np.isfinite(period), np.fmod(t, period), t)
        periods = np.where(np.isfinite(period), np.round((t - rest) / period), 0.0)
    folded = (kind == LIBRATION)[:, None]
    second = folded & (rest > 2 * ahead)
    local = np.where(second, rest - 2 * ahead, rest)
    limit = np.where(second, back, ahead)
    mirrored = folded & (local > limit)
    local = np.where(mirrored, np.maximum(2 * limit - local, 0), local)
    arc = 2 * np.arange(t.shape[0])[:, None] + second
    return Phase(t, arc, local, mirrored, second, periods, folded)


def unfold(value: Array, phase: Phase, gain: Array, librates: Array) -> Array:
    """What an integral along the orbit has grown to, from its value within an arc.

    value: (B, n) or (B, n, k), from the start along the arc. gain: (B, 2) or (B, 2, k), over the forward and the
    backward arc. librates: (B, 1).
    """
    there, after = gain[:, :1], gain[:, 1:]
    every = (phase.second, phase.mirrored, phase.periods, librates)
    second, mirrored, periods, folded = every if value.ndim == 2 else (v[..., None] for v in every)
    limit = np.where(second, after, there)
    value = np.where(mirrored, 2 * limit - value, value) + np.where(second, 2 * there, 0.0)
    return value + periods * np.where(folded, 2 * (there + after), there)
