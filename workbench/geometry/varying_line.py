"""The centreline of a stored rod with weight or friction, from its stored angles and its stored contact force."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from scipy.interpolate import make_interp_spline

from .centreline import Array, Centreline

DEGREE = 5  # of the splines through the stations


@dataclass(frozen=True, eq=False)
class VaryingLine(Centreline):
    """A centreline along which FZ and MZ vary: l and p are NaN, and beta'' and the contact are those of splines.

    stored_contact: at the stations, (n,).
    """

    stored_contact: Array = field(default_factory=lambda: np.empty(0))

    @cached_property
    def _spline(self) -> Any:
        return make_interp_spline(self.s, self.beta, k=min(DEGREE, self.s.size - 1))

    @property
    def bend(self) -> Array:
        """beta'' at the stations, (n,) [1/length^2]."""
        return np.asarray(self._spline(self.s, 2))

    @cached_property
    def swing(self) -> float:
        """The radians of a swing of beta between stations, at most: from the rates of its three derivatives."""
        beta, rate, bend = (self._spline(self.s, k) for k in range(3))
        sizes = [float(np.ptp(beta)), float(np.abs(rate).max()), float(np.abs(bend).max())]
        if not all(sizes):
            return 0.0
        return float(np.diff(self.s).max() * max(2 * sizes[1] / sizes[0], sizes[2] / sizes[1]))

    def contact(self, s: Array) -> Array:
        """The cylinder's push per length at s, (k,) [force/length], positive outward."""
        return np.asarray(make_interp_spline(self.s, self.stored_contact, k=min(DEGREE, self.s.size - 1))(s))
