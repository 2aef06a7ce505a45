"""Folds next to a separatrix: an end of the rod lies at a turning point, on the level of a saddle that the rod nears.

Long rods lose their stable equilibria there. With g the gap between the level and the saddle's height, n/(2 r) what a
unit of log g adds to the length T, and x = beta_t at that end towards the turning point, T = T0(log g) + kappa x, where
kappa = 1/|H| for each of the two ends that lies there, and x^2 = g - D, D = G(end) - G(saddle). So

    dT/dx = 0:  x = -kappa g/(2 dT0/dlog g),     T0 + kappa x = L/rho,     D = g - x^2,

two equations in log g and the two fields, with errors of the order of g^3: g may be far below rounding, where the
start's beta_t tells nothing. kappa = 0 is the pitchfork of a rod with two equal end angles, whose ends reach the
turning point together and whose length does not depend on x.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..levels.line_point import LinePoint
from ..levels.transit_times import Levels, Paths, transit_times
from ..mechanics.potential import slope
from ..numerics.arclength import FOLD, PITCHFORK
from ..numerics.arrays import Array
from .fold_system import DEEP
from .parameter_plane import ParameterPlane

UNIT = 20.0  # of log gap in the metric of the curve
SHALLOW = np.log(4 * DEEP)  # of the gap: where a curve leaves this form
_NEAR = 0.03  # largest |beta_t| at an end that counts as at its turning point
_FOLLOWED = 0.3  # rad: how far the saddle may move before it is looked up anew
_NUDGE, _STEP = 1e-6, 1e-3  # of the derivatives by the shares, and by log gap


@dataclass(frozen=True)
class SeparatrixSystem:
    """One such curve: its saddle (an angle near it), the end at rest ("start" or "end"), the sign of the gap, and the
    path (leaving, turns) of the rod; weight: ends at the turning point that act on T, 0 to 2."""

    plane: ParameterPlane
    kind: str
    scale: float
    saddle: float
    end: str
    sign: float
    leaving: int
    turns: int
    weight: int

    @property
    def size(self) -> int:
        return 3

    def equations(self, x: Array) -> tuple[Array, Array, float, Array]:
        y, shares = float(x[0]) * UNIT, x[1:3]
        here = self._two(y, shares)
        if not np.isfinite(here).all():
            return here, np.full((2, 3), np.nan), np.nan, np.zeros(2)
        rates = [(self._two(y + _STEP, shares) - self._two(y - _STEP, shares)) * (UNIT / (2 * _STEP))]
        for k in range(2):
            nudge = _NUDGE * np.eye(2)[k]
            rates.append((self._two(y, shares + nudge) - self._two(y, shares - nudge)) / (2 * _NUDGE))
        matrix = np.array(rates).T
        return here, matrix, 1.0, -matrix[0, 1:]

    def _two(self, y: float, shares: Array) -> Array:
        """D - g + x^2 and T - L/rho."""
        return self._three(y, shares)[:2]

    def _three(self, y: float, shares: Array) -> Array:
        """The same and x."""
        place, saddle = self.saddle_at(shares)
        if np.isnan(saddle):
            return np.full(3, np.nan)
        angle = place.start if self.end == "start" else place.end
        gap = self.sign * np.exp(max(y, -600.0))
        time = self._time(place, saddle, angle, gap, y + _STEP * np.array([-1.0, 0.0, 1.0]))
        rate = (time[2] - time[0]) / (2 * _STEP)
        if not rate < 0:
            return np.full(3, np.nan)
        kappa = self.weight / abs(float(slope(place.problem, np.array([angle]))[0]))
        rest = -kappa * gap / (2 * rate)
        height = -place.fall(saddle, angle)
        return np.array([height - gap + rest**2, time[1] + kappa * rest - place.problem.span[0], rest])

    def _time(self, place: LinePoint, saddle: float, angle: float, gap: float, y: Array) -> Array:
        """T0 at several values of log gap, with the end exactly at its turning point."""
        base = place.boundary(saddle)
        out = np.empty(y.size)
        low = angle == place.blank.low
        both = place.blank.low == place.blank.high
        other = float(base.falls[0, 1 if low else 0])
        for k, one in enumerate(y):
            g = self.sign * np.exp(max(float(one), -600.0))
            tiny = abs(g) * 1e-12
            own = -g + tiny
            falls = np.array([[own, own if both else other] if low else [other, own]])
            boundary = replace(base, falls=falls, deepest=min(base.deepest, -600.0))
            levels = Levels(np.zeros(1, dtype=np.int64), np.array([self.sign]), np.array([max(float(one), -600.0)]))
            seen = transit_times(boundary, levels)
            time = seen.time.copy()
            time[2 if _rises(place, angle) else 1] = 0.0
            path = Paths(np.array([self.leaving]), np.array([self.turns]))
            out[k] = float(path.counts(boundary.rising)[0] @ time[:, 0])
        return out

    def has_index(self, x: Array, lower: int) -> bool:
        """Whether equilibria of index lower and lower + 1 meet there: such a rod passes lower + 1 turning points.

        At a fold it passes the one at its end where the gap is positive, as the length then falls with x^2 and must
        rise with x. At a pitchfork it passes that of one of the two ends.
        """
        place, _ = self.saddle_at(x[1:3])
        arriving = self.leaving if self.turns % 2 == 0 else -self.leaving
        passed = {
            "start": (self.leaving < 0) == _rises(place, place.start),
            "end": (arriving > 0) == _rises(place, place.end),
        }
        inner = self.turns - (passed[self.end] if self.weight == 1 else sum(passed.values()))
        return inner + (1 if self.weight == 0 else self.weight * (self.sign > 0)) == lower + 1

    def leaves(self, x: Array) -> bool:
        return bool(x[0] * UNIT > SHALLOW) or abs(_apart(self.saddle_at(x[1:3])[1], self.saddle)) > _FOLLOWED

    def saddle_at(self, shares: Array) -> tuple[LinePoint, float]:
        """The problem at some shares, and its saddle next to this one."""
        place = LinePoint(self.plane.problems(shares))
        far = np.abs(_apart(place.saddles, self.saddle))
        return place, float(place.saddles[int(np.argmin(far))]) if far.size and far.min() < 0.5 else np.nan

    def renew(self, x: Array) -> "SeparatrixSystem | None":
        """The same beside the saddle where it is now; None where log gap is not the better unknown."""
        saddle = self.saddle_at(x[1:3])[1]
        return None if x[0] * UNIT > SHALLOW or np.isnan(saddle) else replace(self, saddle=saddle)

    def start_rate(self, x: Array) -> float:
        y, shares = float(x[0]) * UNIT, x[1:3]
        place, saddle = self.saddle_at(shares)
        if self.end == "start" or self.weight != 1:
            passing = float(self._three(y, shares)[2])  # beta_t towards the turning point
            return -passing if _rises(place, place.start) else passing
        gap = self.sign * np.exp(max(y, -600.0))
        return self.leaving * float(np.sqrt(max(gap + place.fall(saddle, place.start), 0.0)))


def _rises(place: LinePoint, angle: float) -> bool:
    """Whether beta accelerates upward at an angle: a turning point there is the lower one of the orbit."""
    return float(slope(place.problem, np.array([angle]))[0]) < 0


def _apart(angle: Any, other: float) -> Any:
    """An angle less another, in [-pi, pi)."""
    return (angle - other + np.pi) % (2 * np.pi) - np.pi


def deep_system(
    plane: ParameterPlane, scale: float, shares: Array, slope_: float, turns: int, kind: str = FOLD
) -> tuple[SeparatrixSystem, Array] | None:
    """The system of a curve near a point, and a first x; None where no end is near a turning point on a separatrix."""
    place = LinePoint(plane.problems(shares))
    speed2 = slope_ * slope_
    own = {"start": speed2, "end": speed2 + place.fall(place.start, place.end)}
    end = min(own, key=lambda name: abs(own[name]))
    if not place.saddles.size or abs(own[end]) > _NEAR**2:
        return None
    gaps = np.array([speed2 - place.fall(float(s), place.start) for s in place.saddles])
    k = int(np.argmin(np.abs(gaps)))
    if abs(gaps[k]) > np.exp(SHALLOW):
        return None
    equal = place.blank.low == place.blank.high and not place.blank.whole_turns
    if kind == PITCHFORK and not equal:
        return None
    weight = (0 if kind == PITCHFORK else 2) if equal else 1
    leaving = 1 if slope_ > 0 else -1
    sign = 1.0 if gaps[k] > 0 else -1.0
    y = float(np.log(max(abs(gaps[k]), 1e-250)))
    saddle = float(place.saddles[k])
    system = SeparatrixSystem(plane, kind, scale, saddle, end, sign, leaving, turns, weight)
    return system, np.array([y / UNIT, *shares])
