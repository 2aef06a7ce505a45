"""Levels and paths of the orbits that join two end angles.

A level is given by a pin p (a saddle of G, or one of the ends), a sign and y: eta = G(p) + sign exp(y). A path is the
direction in which the orbit leaves the start and reaches the far end, and how many whole periods lie between.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..numerics.arrays import Array, Booleans, Integers

UP, DOWN = 1, -1


@dataclass(frozen=True, eq=False)
class Levels:
    """M levels: pin (M,), index into the boundary's pins; sign (M,), +1 or -1; y (M,), log of the gap's size."""

    pin: Integers
    sign: Array
    y: Array

    def take(self, index: Any) -> "Levels":
        return Levels(self.pin[index], self.sign[index], self.y[index])


@dataclass(frozen=True, eq=False)
class Paths:
    """N paths from one end to the other, (N,) each: direction at beta(0) and at beta(L), UP or DOWN; whole periods."""

    leaving: Integers
    arriving: Integers
    periods: Integers

    @property
    def turns(self) -> Integers:
        """Turning points passed, (N,)."""
        return 2 * self.periods + (self.leaving != self.arriving)

    def counts(self, rising: bool) -> Integers:
        """How many times crossing, above and below (`transit_times`) each path contains, (N, 3)."""
        turns, half = self.turns, (self.turns + 1) // 2
        up = self.leaving == UP
        inward = up == rising
        crossing = 2 * ((turns - ~inward) // 2) + 1
        return np.stack([crossing, 2 * np.where(up, half, turns // 2), 2 * np.where(up, turns // 2, half)], axis=1)

    def take(self, index: Any) -> "Paths":
        return Paths(self.leaving[index], self.arriving[index], self.periods[index])


@dataclass(frozen=True, eq=False)
class LevelPaths:
    """The level and the path of K solutions, (K,) each: eta = G(pin) + sign exp(y); see `Paths`."""

    pin: Array
    sign: Array
    y: Array
    leaving: Integers
    arriving: Integers
    periods: Integers
    helix: Booleans

    def take(self, index: Any) -> "LevelPaths":
        return LevelPaths(**{name: v[index] for name, v in vars(self).items()})
