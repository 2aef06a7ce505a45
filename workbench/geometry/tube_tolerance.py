"""As many rings and sides as a picture or a file needs: the tube stays within a tolerance of the true one.

Flat triangles lose two things. A section of n sides misses its circle by a (1 - cos(pi/n)). And between two rings the
surface is straight while the rod bends, turns and twists: a chord of length h of a curve of curvature k is off by
k h^2/8. So the distance of the rings is proportional to 1/sqrt(k), and bends much smaller than the tolerance have less
than a ring each.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from solver.problem.errors import InputError

from .centreline import ALONG, APART, VALUE_ORDER, Array, Centreline, cut, spline, spline_error

Value = Callable[[Centreline, Array], Array]  # what a colour shows: of a curve, at s

LEAST_SIDES = 6
BETWEEN, LEAST_PLACES = 4, 3000  # places from station to station, and in all, at which it is read how the surface bends
COLOUR_STEPS = 48  # a colour may be off by one part in so many of its scale
MOST_TRIANGLES = 4_000_000  # some 400 MB while it is drawn
ROUNDING = 1e-9  # of the largest value: less is no range
MARGIN = 1.1  # for a number of stations that follows from an estimated error
FINEST = 16.0  # stations for each radian of the fastest swing: those of its fourth harmonic are off by 1/256
SHARE = 0.48  # of the tolerance for the sides, as much for the rings: on a diagonal both add up, elsewhere one counts


@dataclass(frozen=True, eq=False)
class Rings:
    """The rings of a tube: s (n,) [length], the number of sides of each, and the error of the surface [length]."""

    s: Array
    sides: int
    error: float


def rings(
    line: Centreline,
    span: tuple[float, float],
    tolerance: float,
    turned: Any = None,
    colour: Callable[[Array], Array] | None = None,
    colour_length: float = 0.0,
    sides_multiple: int = 2,
    most: int = MOST_TRIANGLES,
) -> Rings:
    """The rings and sides with which a tube is drawn to a tolerance.

    Parameters
    ----------
    span
        The arc lengths between which the tube is drawn [length].
    tolerance
        The error allowed [length], half a pixel for example.
    turned, colour, colour_length
        As of `place_rings`.
    sides_multiple
        The number of sides is a multiple of this; with 2, a corner of each ring touches the cylinder.
    most
        Triangles.

    Raises
    ------
    InputError
        The tube would take more than `most` triangles.
    """
    left = max(tolerance - line.error, tolerance / 2)
    sides = int(np.ceil(np.pi / np.arccos(max(1 - SHARE * left / line.a, 0.0))))
    sides = -(-max(sides, LEAST_SIDES) // sides_multiple) * sides_multiple

    def check(count: int) -> None:
        if 2 * count * sides > most:
            part = "" if most == MOST_TRIANGLES else " for a part of the picture"
            raise InputError(
                f"drawing this rod of length {line.L:.4g} with that pixel error takes some {2 * count * sides} "
                f"triangles{part}, and {most} are the limit: give a larger --pixel-error, or draw a part of the rod "
                "with --from and --to"
            )

    s = place_rings(line, span, SHARE * left, check, turned, colour, colour_length)
    return Rings(s, sides, line.error + left)


def place_rings(
    line: Centreline,
    span: tuple[float, float],
    tolerance: float,
    check: Callable[[int], None],
    turned: Any = None,
    colour: Callable[[Array], Array] | None = None,
    colour_length: float = 0.0,
    longest: float = np.inf,
) -> Array:
    """Where rings stand, (n,): so dense that straight lines between them are within the tolerance of the bent tube.

    Parameters
    ----------
    span, tolerance
        As of `rings`.
    check
        Called with the number of rings before they are placed; it raises where they are too many.
    turned
        The spline of the angle of the section [rad] over s, for a stripe that turns with it.
    colour
        What the colour shows at s, as a share of its scale; it is shown truly on intervals longer than `colour_length`.
    longest
        From ring to ring at most [length].
    """
    low, high = span
    count = max(int(np.ceil(BETWEEN * line.s.size * (high - low) / line.L)), LEAST_PLACES)
    s = np.linspace(low, high, count + 1)
    _, beta, _ = line.at(s)
    kappa, turning = line.kappa(s), np.sin(2 * beta) / (2 * line.rho) + (0.0 if turned is None else turned(s, 1))
    dense = np.sqrt((kappa * (1 + kappa * line.a) + line.a * turning**2) / (8 * tolerance))
    if colour is not None:
        bend = np.gradient(np.gradient(colour(s), s), s)
        dense = np.maximum(dense, np.minimum(np.sqrt(COLOUR_STEPS / 8 * np.abs(bend)), 1 / (colour_length or np.inf)))
    before = np.concatenate([[0.0], np.cumsum(np.diff(s) * (dense[1:] + dense[:-1]) / 2)]) + (s - low) / longest
    number = max(int(np.ceil(before[-1])), 2)
    check(number)
    if not before[-1]:
        return np.linspace(low, high, number + 1)
    places = np.interp(np.linspace(0, before[-1], number + 1), before, s)
    places[0] = low  # where the rod begins straight, `before` is 0 at several places
    return np.asarray(places)


def stations_for(line: Centreline, tolerance: float, value: Value | None = None, allowed: float = np.inf) -> int:
    """About how many stations it takes to draw a rod to a tolerance [length]; its own number where that is enough.

    value: what the colour shows, of a curve at s; allowed: by how much that may be off between stations. Where beta may
    swing between two stations, nothing of what is drawn there is known.
    """
    n = line.s.size
    more = n if line.error <= tolerance / 2 else max(line.stations_for(tolerance / 6), n + 1)
    if value is None:
        return more
    missed = line.value_error(value)
    if missed > allowed:
        more = max(more, int(np.ceil(MARGIN * n * (missed / allowed) ** (1 / VALUE_ORDER))), n + 1)
    if line.phase_step > APART:
        more = max(more, int(np.ceil(MARGIN * n * line.phase_step / APART)))
    return more


@dataclass(frozen=True, eq=False)
class DrawnCurve:
    """A quantity along a rod that is drawn by straight lines.

    values: at the stations s, (n,) each. allowed: by how much it may be off. line: the curve of the rod, which gives
    the quantities of `ALONG` between stations; None where nothing stored gives one. Others are splines there.
    """

    name: str
    s: Array
    values: Array
    allowed: float
    line: Centreline | None

    @property
    def error_between(self) -> float:
        """The estimated error between stations of the curve."""
        if self.line is None or self.name not in ALONG:
            return spline_error(self.s, self.values)
        return self.line.value_error(ALONG[self.name])

    def between(self, parts: int) -> Array:
        """The values at so many times as many stations."""
        s = cut(self.s, parts)
        if parts == 1 or self.line is None or self.name not in ALONG:
            return self.values if parts == 1 else np.asarray(spline(self.s, self.values)(s))
        return ALONG[self.name](self.line, s)

    @property
    def parts(self) -> int:
        """In how many parts the way from station to station is cut, for straight lines that follow the curve.

        They are never more than the fastest swing needs, as what is finer is rounding.
        """
        bent = float(np.abs(np.diff(self.values, 2)).max(initial=0.0)) / 8
        finest = np.inf if self.line is None else np.ceil(self.line.phase_step * FINEST)
        return int(max(min(np.ceil(MARGIN * np.sqrt(bent / self.allowed)), finest), 1))

    def stations(self) -> int:
        """About how many stations it takes for the curve; its own number where that is enough.

        Where beta may swing between two stations nothing is known. No more stations are asked for than the fastest
        swing needs.
        """
        n, more = self.s.size, list[float]()
        most = np.inf if self.line is None else n * self.line.phase_step * FINEST
        if self.line is not None and self.line.phase_step > APART:
            more = [n * self.line.phase_step / APART]
        if n < most and (missed := self.error_between) > self.allowed:
            more.append(min(n * (missed / self.allowed) ** (1 / VALUE_ORDER), most))
        return max([n, *(int(MARGIN * each) + 1 for each in more)])


def push_along(line: Centreline) -> DrawnCurve:
    """The push along a rod, to a step of its colours."""
    push = line.push(line.s)
    allowed = max(float(np.ptp(push)) / COLOUR_STEPS, ROUNDING * float(np.abs(push).max()))
    return DrawnCurve("push", line.s, push, allowed or 1.0, line)  # off the wall all of it is 0
