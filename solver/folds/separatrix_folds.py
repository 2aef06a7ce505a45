"""Folds next to a separatrix: an end of the rod lies at a turning point, on the level of a saddle that the rod nears.

Long rods lose their stable equilibria there. With g the gap between the level and the saddle's height, n/(2 r) what a
unit of log g adds to the length T, and x = beta_t at that end towards the turning point, T = T0(log g) + kappa x, where
kappa = 1/|H| for each of the two ends that lies there, and x^2 = g - D, D = G(end) - G(saddle). So

    dT/dx = 0:  x = -kappa g/(2 dT0/dlog g),     T0 + kappa x = L/rho,     D = g - x^2,

two equations in log g and the two fields, with errors of the order of g^3: g may be far below rounding, where the
start's beta_t tells nothing. kappa = 0 is the pitchfork of a rod with two equal end angles, whose ends reach the
turning point together and whose length does not depend on x.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..equilibrium.given_numbers import FREE, problem_of
from ..levels.boundary import Boundary, Levels, Paths, boundary_of, transit_times
from ..mechanics.potential import slope
from ..numerics.arclength import FOLD, PITCHFORK, Node, node_at
from ..numerics.arrays import Array
from .orbit_folds import GivenAt, OrbitFold, OrbitPitchfork, meets_pitchforks, mirror_image, point_near
from .special_line import Ahead, SpecialPoint, point_on_line

UNIT = 20.0  # of log gap in the metric of the curve
DEEP = 1e-6  # of the gap: where beta_t at the start tells little
SHALLOW = np.log(4 * DEEP)  # where a curve leaves this form
_NEAR = 0.03  # largest |beta_t| at an end that counts as at its turning point
_AT_REST = 1e-2  # the same, where a curve takes this form
_FOLLOWED = 0.3  # rad: how far the saddle may move before it is looked up anew
_NUDGE, _STEP = 1e-6, 1e-3  # of the derivatives by z, and by log gap
_SAME = 0.02  # largest distance between a point and itself in another form


@dataclass(frozen=True, eq=False, kw_only=True)
class SeparatrixPoint(SpecialPoint):
    """Such a fold or pitchfork. w: log gap over `UNIT`, and z.

    scale: of beta_t(0). saddle: an angle near it. end: at rest, "start" or "end". sign: of the gap. leaving, turns: the
    path of the rod. weight: ends at the turning point that act on T, 0 to 2.
    """

    given_at: GivenAt
    scale: float
    saddle: float
    end: str
    sign: float
    leaving: int
    turns: int
    weight: int
    nudge = np.array([_STEP / UNIT, _NUDGE, _NUDGE])

    @property
    def mark(self) -> Array:
        """As of `SpecialPoint`; it is that of no orbit."""
        return np.array([self.w[0], 10.0 + self.leaving, self.turns, *np.zeros(7)])

    def value(self, w: Array) -> Array | None:
        """D - g + x^2 and T - L/rho, (2,)."""
        values = self._three(float(w[0]) * UNIT, w[1:])[:2]
        return values if np.isfinite(values).all() else None

    def side_of(self, node: Node) -> Array:
        """As of `SpecialPoint`."""
        return -node.jacobian[0, 1:]

    def _three(self, y: float, z: Array) -> Array:
        """D - g + x^2, T - L/rho and x."""
        place, saddle = self.saddle_at(z)
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

    def _time(self, place: Boundary, saddle: float, angle: float, gap: float, y: Array) -> Array:
        """T0 at several values of log gap, with the end exactly at its turning point."""
        base = place.with_pin(saddle)
        out = np.empty(y.size)
        low = angle == place.low
        is_helix_angle = place.low == place.high
        other = float(base.falls[0, 1 if low else 0])
        for k, log_gap in enumerate(y):
            g = self.sign * np.exp(max(float(log_gap), -600.0))
            tiny = abs(g) * 1e-12
            fall = -g + tiny
            falls = np.array([[fall, fall if is_helix_angle else other] if low else [other, fall]])
            boundary = replace(base, falls=falls, deepest=min(base.deepest, -600.0))
            levels = Levels(np.zeros(1, dtype=np.int64), np.array([self.sign]), np.array([max(float(log_gap), -600.0)]))
            seen = transit_times(boundary, levels)
            time = seen.time.copy()
            time[2 if _rises(place, angle) else 1] = 0.0
            path = Paths(np.array([self.leaving]), np.array([self.turns]))
            out[k] = float(path.counts(boundary.rising)[0] @ time[:, 0])
        return out

    @cached_property
    def lower(self) -> int:
        """The lower Morse index of the two equilibria that meet: one less than the turning points that the rod passes.

        At a fold it passes the one at its end where the gap is positive, as the length then falls with x^2 and must
        rise with x. At a pitchfork it passes that of one of the two ends.
        """
        place, _ = self.saddle_at(self.z)
        arriving = self.leaving if self.turns % 2 == 0 else -self.leaving
        passed = {
            "start": (self.leaving < 0) == _rises(place, place.start),
            "end": (arriving > 0) == _rises(place, place.end),
        }
        inner = self.turns - (passed[self.end] if self.weight == 1 else sum(passed.values()))
        return int(inner + (1 if self.weight == 0 else self.weight * (self.sign > 0)) - 1)

    @property
    def is_shallow(self) -> bool:
        """Whether log gap is not the better unknown."""
        return float(self.w[0]) * UNIT > SHALLOW

    def saddle_at(self, z: Array) -> tuple[Boundary, float]:
        """The problem at z, and the angle of its saddle next to this one; NaN where it no longer exists."""
        place = boundary_of(problem_of(self.given_at(z), {}))
        far = np.abs(_apart(place.saddles, self.saddle))
        return place, float(place.saddles[int(np.argmin(far))]) if far.size and far.min() < 0.5 else np.nan

    @cached_property
    def slope(self) -> float:
        """beta_t(0)."""
        y, (place, saddle) = float(self.w[0]) * UNIT, self.saddle_at(self.z)
        if self.end == "start" or self.weight != 1:
            passing = float(self._three(y, self.z)[2])  # beta_t towards the turning point
            return -passing if _rises(place, place.start) else passing
        gap = self.sign * np.exp(max(y, -600.0))
        return self.leaving * float(np.sqrt(max(gap + place.fall(saddle, place.start), 0.0)))


def _rises(place: Boundary, angle: float) -> bool:
    """Whether beta accelerates upward at an angle: a turning point there is the lower one of the orbit."""
    return float(slope(place.problem, np.array([angle]))[0]) < 0


def _apart(angle: Any, other: float) -> Any:
    """An angle less another, in [-pi, pi)."""
    return (angle - other + np.pi) % (2 * np.pi) - np.pi


def separatrix_guess(
    given_at: GivenAt, scale: float, z: Array, slope_: float, turns: int, kind: str = FOLD
) -> SeparatrixPoint | None:
    """A guess of such a point near z; None where no end is near a turning point on a separatrix.

    slope_, turns: beta_t(0) and the turning points of an equilibrium nearby.
    """
    place = boundary_of(problem_of(given_at(z), {}))
    speed2 = slope_ * slope_
    speeds = {"start": speed2, "end": speed2 + place.fall(place.start, place.end)}
    end = min(speeds, key=lambda name: abs(speeds[name]))
    if not place.saddles.size or abs(speeds[end]) > _NEAR**2:
        return None
    gaps = np.array([speed2 - place.fall(float(s), place.start) for s in place.saddles])
    k = int(np.argmin(np.abs(gaps)))
    if abs(gaps[k]) > np.exp(SHALLOW):
        return None
    equal = place.low == place.high and not place.whole_turns
    if kind == PITCHFORK and not equal:
        return None
    weight = (0 if kind == PITCHFORK else 2) if equal else 1
    leaving, sign = (1 if slope_ > 0 else -1), (1.0 if gaps[k] > 0 else -1.0)
    y = float(np.log(max(abs(gaps[k]), 1e-250)))
    return SeparatrixPoint(
        given_at=given_at, kind=kind, scale=scale, saddle=float(place.saddles[k]), end=end, sign=sign, leaving=leaving,
        turns=turns, weight=weight, w=np.array([y / UNIT, *z]),
    )  # fmt: skip


DeadPoint = OrbitFold | OrbitPitchfork | SeparatrixPoint


def in_other_form(point: DeadPoint, node: Node, stuck: bool) -> Iterator[Ahead[DeadPoint]]:
    """As of `special_line.Others`; there are several forms under dead loads alone."""
    way = node.tangent[-2:]
    if isinstance(point, SeparatrixPoint):
        yield from _from_separatrix(point, node, way, stuck)
    elif isinstance(point, OrbitFold) and meets_pitchforks(point, node):
        yield from _onward(mirror_image(point), point, -way)
    elif point.own[0].names == FREE and (stuck or _is_deep(point)):
        scale, turns = float(point.scales[0]), point.lower + 1
        guess = separatrix_guess(point.given_at, scale, point.z, point.slope, turns, point.kind)
        if guess is not None:
            yield from _onward(point_on_line(guess, int(np.argmin(np.abs(way)))), point, way)


def _from_separatrix(point: SeparatrixPoint, node: Node, way: Array, stuck: bool) -> Iterator[Ahead[DeadPoint]]:
    """The same beside the saddle where it is now, or in the numbers of the start."""
    saddle, axis = point.saddle_at(point.z)[1], int(np.argmin(np.abs(way)))
    if not point.is_shallow and abs(_apart(saddle, point.saddle)) > _FOLLOWED:
        yield replace(point, saddle=saddle), node
    elif point.is_shallow or stuck:
        plain = point_near(point.kind, point.given_at, point.scale, point.slope, point.z, axis)
        yield from _onward(plain, point, way)


def _onward(other: DeadPoint | None, point: DeadPoint, way: Array) -> Iterator[Ahead[DeadPoint]]:
    """A point that is another form of one, with its node, travelled along `way` of z; nothing where it is another."""
    if other is None or np.abs(other.z - point.z).max() > _SAME or other.lower != point.lower:
        return
    node = node_at(other, other.w, np.append(np.zeros(other.w.size - 2), way))
    if not isinstance(node, str):
        yield other, node


def _is_deep(point: OrbitFold | OrbitPitchfork) -> bool:
    """Whether an end lies at a turning point next to a separatrix, so that beta_t(0) tells little."""
    place, v = boundary_of(point.own[1].problem), point.slope
    near = min(v * v, abs(v * v + place.fall(place.start, place.end))) < _AT_REST**2
    return near and any(abs(v * v - place.fall(float(s), place.start)) < DEEP for s in place.saddles)
