"""Coordinates on the equilibria of one path, in which continuation follows an equilibrium.

The level of an orbit is measured from a saddle or from one of the two ends (`Path`). Next to a saddle the coordinate is
log|gap|, as transit times are linear in it; where beta_t is small at an end, the coordinate is that beta_t, with its
sign.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..levels.line_point import LinePoint, Path
from ..levels.transit_times import DOWN, UP, wrap
from ..mechanics.potential import TAU, slope
from ..numerics.arrays import Array

_SAME = 1e-6  # in scales: coordinates of one equilibrium
CORNER = "corner"
_LEAST = 1e-9  # gap to a saddle of an orbit that is followed from its start: rounding grows by its inverse
_PLAIN = 1e-4  # the same, where this is the best way


@dataclass(frozen=True)
class Chart:
    """A coordinate x on the equilibria of one path near `at`.

    kind: where the level is measured from, a "saddle", the "start" or the "end"; or a "corner": from the start, and the
    far end is where the orbit is after the length of the rod, whatever its angle. scale: the change of x over which the
    orbit changes its form. logarithmic: whether x is log|gap|; else x is beta_t at that end, with its sign.
    """

    kind: str
    at: Path
    scale: float
    logarithmic: bool


def charts(place: LinePoint, path: Path, hinged: bool = False) -> list[Chart]:
    """Coordinates in which the equilibrium can be followed, the best first.

    The others are needed where the best one ends and the branch does not, as where its saddle meets a centre.
    hinged: whether an end moment is given. The rod may then turn at both ends, where the length at which an orbit meets
    beta(L) has no derivative, so a corner is best unless the rod comes close to a saddle.
    """
    gap = path.sign * float(np.exp(max(path.y, place.blank.deepest)))
    angles, gaps, reached = _saddles(place, path, gap)
    nearest = float(np.abs(gaps).min())
    signed, logarithmic = [], []
    for kind, angle in (("start", place.start), ("end", place.end)):
        depth = max(gap + place.fall(path.pin, angle), 0.0)
        known = path.pin == angle and path.sign > 0
        at = Path(angle, 1.0, path.y if known else float(np.log(max(depth, 1e-300))), path.leaving, path.turns)
        signed.append((depth, Chart(kind, at, float(np.sqrt(nearest)), False)))
        logarithmic.append((depth, Chart(kind, at, _scale(at.y), True)))
    for angle, level in zip(angles[reached], gaps[reached], strict=True):
        known = path.sign == np.sign(level) and abs(path.pin - angle) < 1e-9
        y = path.y if known else float(np.log(max(abs(level), 1e-300)))
        at = Path(float(angle), float(np.sign(level)), y, path.leaving, path.turns)
        logarithmic.append((abs(level), Chart("saddle", at, _scale(y), True)))
    first, second = (sorted(rows, key=lambda one: one[0]) for rows in (signed, logarithmic))
    at_rest = first[0][0] < 0.5 * nearest
    every = [chart for _, chart in ([*first, *second] if at_rest else [*second, *first])]
    if hinged and nearest > _LEAST:
        every.insert(0 if at_rest and nearest > _PLAIN else len(every), replace(signed[0][1], kind=CORNER))
    return every


def _scale(y: float) -> float:
    """The scale of log|gap|: where y is large and negative, the length is linear in it."""
    return max(1.0, 0.2 * abs(y))


def _saddles(place: LinePoint, path: Path, gap: float) -> tuple[Array, Array, Any]:
    """The saddles that the orbit passes or turns before.

    Their angles, the orbit's level above each, and whether the rod itself, from end to end, reaches it.
    """
    problem, angles, m = place.problem, place.angles, place.angles.size
    level = np.array([gap + place.fall(path.pin, float(b)) for b in angles])
    shift = float(problem.beta0[0]) - wrap(float(problem.beta0[0]))
    behind, far = (_behind(angles, float(b[0]) - shift) for b in (problem.beta0, problem.betaL))
    stops = [int(k) for k in np.flatnonzero(level <= 0)]
    if stops:
        highest = min(k + m * -((k - behind - 1) // m) for k in stops)
        lowest = max(k - m * -((behind - k) // m) for k in stops)
    else:
        lowest, highest = behind + 1, behind + m
    if path.turns > 1:
        low, high = lowest, highest
    elif path.turns == 1:
        low = min(behind, far) + 1 if path.leaving == UP else lowest
        high = highest if path.leaving == UP else max(behind, far)
    else:
        low, high = min(behind, far) + 1, max(behind, far)
    whole, reached = (np.unique(np.arange(i, j + 1) % m) for i, j in ((lowest, highest), (low, high)))
    saddles = whole[np.isin(angles[whole], place.saddles)]
    return angles[saddles], level[saddles], np.isin(saddles, reached)


def _behind(angles: Array, angle: float) -> int:
    """The number of the last critical point not above an angle, counted on through whole turns."""
    whole_turns = int(np.floor((angle + np.pi) / TAU))
    return int(np.count_nonzero(angles <= angle - TAU * whole_turns)) - 1 + angles.size * whole_turns


def coordinate(chart: Chart) -> float:
    """x of the path at which the chart was made."""
    if chart.logarithmic:
        return chart.at.y
    direction = chart.at.arriving if chart.kind == "end" else chart.at.leaving
    return direction * float(np.exp(chart.at.y / 2))


def path_at(place: LinePoint, chart: Chart, x: float) -> Path | None:
    """The path at x; None where its saddle no longer exists."""
    at = chart.at
    if chart.kind == "saddle":
        apart = np.abs((place.saddles - at.pin + np.pi) % TAU - np.pi)
        near = int(np.argmin(apart))
        return None if apart[near] > 0.3 else replace(at, pin=float(place.saddles[near]), y=x)
    pin = place.start if chart.kind == "start" else place.end
    if chart.logarithmic:
        return replace(at, pin=pin, y=x)
    y = 2 * float(np.log(max(abs(x), 1e-150)))
    now, was = (UP if x > 0 else DOWN), (at.leaving if chart.kind == "start" else at.arriving)
    if now == was:
        return replace(at, pin=pin, y=y)
    # beta_t passes through 0 at this end, and at the other one too where G is as high there
    at_start, at_end = (chart.kind == name or place.is_tied for name in ("start", "end"))
    more = 0
    if at_start:
        more += _turns_gained(place, place.start, at.leaving)
    if at_end:
        more += _turns_gained(place, place.end, -at.arriving)
    return Path(pin, 1.0, y, -at.leaving if at_start else at.leaving, at.turns + more)


def _turns_gained(place: LinePoint, end: float, inward: int) -> int:
    """The turning points that a rod gains where beta_t passes through 0 at one end; -1: it loses one.

    inward: UP or DOWN, where beta goes from that end before. At an end on a centre it gains none.
    """
    if (place.angles == end).any():
        return 0
    lower = float(slope(place.problem, np.array([end]))[0]) < 0
    return 1 if lower == (inward == UP) else -1


def same_equilibrium(place: LinePoint, one: Path, other: Path) -> bool:
    """Whether two paths of one problem are the same orbit, from whichever angles their levels are measured."""
    if (one.leaving, one.turns, one.helix) != (other.leaving, other.turns, other.helix):
        return False
    if one.helix:
        return True
    first, second = charts(place, one)[0], charts(place, other)[0]
    if (first.kind, first.logarithmic, first.at.sign) != (second.kind, second.logarithmic, second.at.sign):
        return False
    near = abs(np.sin((first.at.pin - second.at.pin) / 2)) < _SAME
    return near and abs(coordinate(first) - coordinate(second)) < _SAME * first.scale


def excess(place: LinePoint, chart: Chart, x: Array) -> Array:
    """Length of the orbit less that of the rod at each x, (M,); NaN where there is no such orbit."""
    every = [path_at(place, chart, float(value)) for value in x]
    known = [path for path in every if path is not None and path.turns >= 0]
    return place.lengths(known) - place.problem.span[0] if len(known) == x.size else np.full(x.size, np.nan)
