"""The centrelines of rods with weight or friction, from their angles and their push, and of rods that may leave the
cylinder, from their places."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
from scipy.interpolate import CubicSpline

from solver.numerics.arrays import whole_turns
from solver.orbits import frames

from .centreline import EASED, Array, Centreline, cut, spline

FREE_ORDER = 3  # of the errors of a spline through places, in their distance: the shear jumps at edges of contact


@dataclass(frozen=True, eq=False)
class VaryingLine(Centreline):
    """A centreline along which FZ and MZ vary: l and p are NaN, and beta'' and the contact are those of splines.

    stored_contact: at the stations, (n,). rate: the largest one at which beta can swing or die away [rad/length].
    """

    stored_contact: Array = field(default_factory=lambda: np.empty(0))
    rate: float = 0.0

    @property
    def _arrays(self) -> tuple[str, ...]:
        return (*super()._arrays, "stored_contact")

    def cut(self, parts: int) -> Self:
        """This curve through so many times as many stations."""
        line = super().cut(parts)
        return replace(line, stored_contact=self.contact(line.s))

    @cached_property
    def _spline(self) -> Any:
        return spline(self.s, self.beta)

    @property
    def bend(self) -> Array:
        """beta'' at the stations, (n,) [1/length^2]."""
        return np.asarray(self._spline(self.s, 2))

    @cached_property
    def phase_step(self) -> float:
        """The radians of a swing of beta between stations, at most: the step times the largest rate."""
        return float(np.diff(self.s).max() * self.rate)

    def contact(self, s: Array) -> Array:
        """The cylinder's push per length at s, (k,) [force/length], positive outward."""
        return np.asarray(spline(self.s, self.stored_contact)(s))


@dataclass(frozen=True, eq=False)
class FreeLine(Centreline):
    """The centreline of a rod that may leave the cylinder: a cubic spline through its places in space.

    radius: its distance from the axis at the stations, (n,) [length]. stored_contact: as of `VaryingLine`. edges: where
    the push jumps, in order, (k,) [length], as far as that is known.
    """

    stored_contact: Array = field(default_factory=lambda: np.empty(0))
    radius: Array = field(default_factory=lambda: np.empty(0))
    edges: Array = field(default_factory=lambda: np.empty(0))

    @property
    def _arrays(self) -> tuple[str, ...]:
        return (*super()._arrays, "stored_contact", "radius")

    @property
    def reach(self) -> float:
        """The largest distance of the centreline from the axis [length]."""
        return float(self.radius.max())

    @property
    def place(self) -> Array:
        """The centreline at the stations, (n, 3) [length]."""
        return frames.position(self.radius, self.alpha, self.z)

    @cached_property
    def _path(self) -> Any:
        return CubicSpline(self.s, self.place)

    @property
    def tangent(self) -> Array:
        """The unit tangent at the stations, (n, 3)."""
        return _unit(self._path(self.s, 1))

    @cached_property
    def phase_step(self) -> float:
        """The radians by which the tangent turns between stations, at most."""
        return float((np.diff(self.s) * np.linalg.norm(self._path(self.s[:-1], 2), axis=1)).max())

    @property
    def smooth(self) -> bool:
        """False: the angles rise evenly between stations, as the azimuth of a rod that passes the axis turns fast."""
        return False

    @cached_property
    def error(self) -> float:
        """The estimated error of the curve between stations [length]."""
        return float(np.linalg.norm(self.every_other()._path(self.s[1::2]) - self.place[1::2], axis=1).max()) / EASED

    def value_error(self, value: Callable[[Centreline, Array], Array]) -> float:
        """The estimated error between stations of a quantity, but next to edges of contact, where the push jumps."""
        touches = np.pad(self.stored_contact != 0, 1, mode="edge")
        even = (touches[:-2] == touches[1:-1]) & (touches[2:] == touches[1:-1])
        left_out = self.s[1::2][even[1::2]]
        missed = value(self.every_other(), left_out) - value(self, left_out)
        return float(np.abs(missed).max(initial=0.0)) / EASED

    def stations_for(self, tolerance: float, cubic: bool = False) -> int:
        """About how many stations are needed for an `error`, or a `cubic_error`, within the tolerance [length]."""
        error = self.cubic_error if cubic else self.error
        return int(np.ceil(1.1 * self.s.size * max(error / tolerance, 1.0) ** (1 / FREE_ORDER))) + 1

    def frame(self, s: Array) -> tuple[Array, Array, Array, Array]:
        """Position, tangent, the normal nearest to the outward one, and the normal across both at s, (k, 3) each."""
        x, y, _ = self._path(s).T
        around = np.arctan2(y, x) if self.radius.min() > np.diff(self.s).max() else self.at(s)[0]  # it passes the axis
        tangent, out = _unit(self._path(s, 1)), frames.outward(around)
        out = _unit(out - np.sum(out * tangent, axis=-1, keepdims=True) * tangent)
        return self._path(s), tangent, out, np.cross(out, tangent)

    def kappa(self, s: Array) -> Array:
        """Curvature at s, (k,) [1/length]."""
        return np.asarray(np.linalg.norm(self._path(s, 2), axis=-1))

    def contact(self, s: Array) -> Array:
        """The cylinder's push per length at s, (k,) [force/length], positive outward; point forces are not in it.

        It is even between stations; from one off the wall to one on it, it jumps at a known edge.
        """
        behind = np.clip(np.searchsorted(self.s, self.edges), 1, self.s.size - 1)
        pair = self.stored_contact[np.stack([behind - 1, behind], axis=1)]
        jumps = (pair == 0).sum(axis=1) == 1
        pair = np.where(pair == 0, 0.0, pair.sum(axis=1, keepdims=True))[jumps].ravel()
        at = np.repeat(behind[jumps], 2)
        places = np.insert(self.s, at, np.repeat(self.edges[jumps], 2))
        return np.interp(s, places, np.insert(self.stored_contact, at, pair))

    def cut(self, parts: int) -> Self:
        """This curve through so many times as many stations."""
        s = cut(self.s, parts)
        x, y, z = self._path(s).T
        alpha, beta, _ = self.at(s)
        turned = np.arctan2(y, x)
        turned += whole_turns(alpha - turned)
        return replace(
            self,
            s=s,
            alpha=turned,
            beta=beta,
            dbeta=self._even(self.dbeta, s),
            z=z,
            radius=np.hypot(x, y),
            stored_contact=self.contact(s),
        )


def _unit(vectors: Array) -> Array:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))


def contact_edges(s: Array, push: Array) -> Array:
    """Where contacts with a cylinder that only pushes begin or end, (k,) [length], of stations s and push (n,).

    Each is in the middle between two stations. None of a rod that is pulled, so held on.
    """
    last = np.flatnonzero(np.diff(push > 0))
    return (s[last] + s[last + 1]) / 2 if not (push < 0).any() else s[:0]
