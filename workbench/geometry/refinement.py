"""As many rings and sides as a picture needs: the drawn tube stays within a tolerance of the true one.

Flat triangles lose two things. A section of n sides misses its circle by a (1 - cos(pi/n)). And between two rings the
surface is straight while the rod bends, turns and twists: that error is measured at points of the true surface between
the rings, and rings are moved and added until it is small enough. So a rod whose bends are smaller than a pixel is
drawn with few rings, however many bends it has.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from solver.problem.errors import InputError

from .centreline import Array, Centreline

LEAST_SIDES = 6
STEP = 0.5  # rad around the cylinder, in which the bend of the surface is seen
PROBES = 8  # points a ring, at which the true surface is compared with the drawn one
SETTLED = 2  # rounds of moving the rings, after which the errors of most intervals are within a tenth of each other
ROUNDS = 10  # with those that remove or add rings; intervals that still fail (bends below a pixel) are halved
MORE = 1.2  # times as many rings are added at most; where that is not enough, only a few intervals fail
COLOUR_STEPS = 48  # a colour may be off by one part in so many of its scale
MOST_TRIANGLES = 4_000_000  # some 400 MB while it is drawn
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
    turned: Callable[[Array], Array] | None = None,
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
    turned
        The angle of the section at s [rad], for a stripe that turns with it.
    colour
        What the colour shows at s, as a share of its scale; it is shown truly on intervals longer than `colour_length`.
    sides_multiple
        The number of sides is a multiple of this; with 2, a corner of each ring touches the cylinder.
    most
        Triangles.

    Raises
    ------
    InputError
        The tube would take more than `most` triangles.
    """
    missed = line.error
    left = max(tolerance - missed, tolerance / 2)
    sides = int(np.ceil(np.pi / np.arccos(max(1 - SHARE * left / line.a, 0.0))))
    sides = -(-max(sides, LEAST_SIDES) // sides_multiple) * sides_multiple
    s = _probes(line, span, SHARE * left, turned, most)
    if s.size * sides > 2 * PROBES * most:
        _refuse(line, s.size * sides // PROBES * 2, most)
    place = _surface(line, s, turned)
    values = colour(s) if colour is not None else None
    chosen = _place(s, place, values, SHARE * left, colour_length)
    if 2 * chosen.size * sides > most:
        _refuse(line, 2 * chosen.size * sides, most)
    return Rings(s[chosen], sides, missed + left)


def stations_for(line: Centreline, tolerance: float) -> int:
    """About how many stations it takes to draw a rod to a tolerance [length]; its own number where that is enough."""
    if line.error <= tolerance / 2:
        return line.s.size
    return max(line.stations_for(tolerance / 6), line.s.size + 1)


def _refuse(line: Centreline, triangles: int, most: int) -> None:
    part = "" if most == MOST_TRIANGLES else " for a part of the picture"
    raise InputError(
        f"drawing this rod of length {line.L:.4g} with that pixel error takes some {triangles} triangles"
        f"{part}, and {most} are the limit: give a larger --pixel-error, or draw a part of the rod with --from and --to"
    )


def _surface(line: Centreline, s: Array, turned: Any) -> Array:
    """Centre and the section's two radii as one row of nine numbers a point, (k, 9)."""
    place, _, out, across = line.frame(s)
    if turned is not None:
        angle = turned(s)[:, None]
        out, across = np.cos(angle) * out + np.sin(angle) * across, np.cos(angle) * across - np.sin(angle) * out
    return np.concatenate([place, line.a * out, line.a * across], axis=1)


def _probes(line: Centreline, span: tuple[float, float], tolerance: float, turned: Any, most: int) -> Array:
    """Points so near that the surface between them is as good as straight.

    A point moves off a straight line by |r''| ds^2/8. Bends that are smaller than the tolerance may lie between two
    points: there the points are rare, also on those bends.
    """
    low, high = span
    inside = line.s[(line.s > low) & (line.s < high)]
    s = np.concatenate([[low], inside, [high]])
    # a helix may go around several times between two stations
    parts = np.maximum(np.ceil(np.abs(np.diff(line.at(s)[0])) / STEP), 4)
    if (total := int(parts.sum())) > PROBES * most:
        _refuse(line, 2 * LEAST_SIDES * total // PROBES, most)
    fine = np.unique(np.interp(np.arange(total + 1), np.concatenate([[0.0], np.cumsum(parts)]), s))
    place = _surface(line, fine, turned)
    h = np.diff(fine)
    rate = np.diff(place, axis=0) / h[:, None]
    bend = np.diff(rate, axis=0) / ((h[1:] + h[:-1]) / 2)[:, None]
    size = np.linalg.norm(bend[:, :3], axis=1) + np.linalg.norm(bend[:, 3:], axis=1)
    size = np.concatenate([size[:1], size, size[-1:]])
    density = np.sqrt(np.maximum(size[1:], size[:-1]) / (8 * tolerance)) * PROBES
    count = np.concatenate([[0.0], np.cumsum(density * h)])
    number = max(int(np.ceil(count[-1])), PROBES) + 1
    if number > PROBES * most:
        _refuse(line, 2 * LEAST_SIDES * number // PROBES, most)
    if not count[-1]:
        return np.linspace(low, high, number)
    points = np.interp(np.linspace(0, count[-1], number), count, fine)
    points[0] = low  # where the rod begins straight, `count` is 0 at several points
    return points


def _errors(s: Array, place: Array, values: Array | None, at: Any, tolerance: float, colour_length: float) -> Array:
    """The greatest distance of the true surface from the straight one between each two rings, (n - 1,) [length].

    at: the indices of the probes where rings stand. An error of colour counts as one of length, by `COLOUR_STEPS`.
    """
    start = at[:-1]
    which = np.repeat(np.arange(start.size), np.diff(at))  # the interval of each probe but the last
    first, last = at[which], at[which + 1]
    share = ((s[:-1] - s[first]) / (s[last] - s[first]))[:, None]
    gap = place[:-1] - (1 - share) * place[first] - share * place[last]
    u, v = gap[:, 3:6], gap[:, 6:]
    p, q, r = (np.einsum("ij,ij->i", *pair) for pair in ((u, u), (v, v), (u, v)))
    section = np.sqrt(np.maximum((p + q) / 2 + np.hypot((p - q) / 2, r), 0))  # the largest of |u cos + v sin|
    error = np.linalg.norm(gap[:, :3], axis=1) + section
    if values is not None:
        colour = values[:-1] - (1 - share[:, 0]) * values[first] - share[:, 0] * values[last]
        visible = s[last] - s[first] > colour_length
        error = np.maximum(error, np.where(visible, tolerance * COLOUR_STEPS * np.abs(colour), 0.0))
    return np.maximum.reduceat(error, start)


def _place(s: Array, place: Array, values: Array | None, tolerance: float, colour_length: float) -> Any:
    """Indices of the probes where rings stand: about as few as keep each interval within the tolerance."""
    at = np.unique(np.linspace(0, s.size - 1, max((s.size - 1) // PROBES, 2) + 1).round().astype(int))
    middles, more = np.arange(s.size - 1) + 0.5, 1.0
    for step in range(ROUNDS):
        error = _errors(s, place, values, at, tolerance, colour_length)
        worst = float(error.max()) / tolerance
        if step >= SETTLED and worst > 1:
            more = min(more * min(np.sqrt(worst), 1.05), MORE)
        # the error goes with the square of the distance; an interval far better than needed becomes four times as long
        density = np.clip(np.sqrt(error / tolerance), 0.25, 4.0) / np.diff(at)
        count = np.concatenate([[0.0], np.cumsum(np.interp(middles, (at[1:] + at[:-1]) / 2, density))])
        intervals = max(int(np.ceil(count[-1] * more)), 1)
        if step >= SETTLED and worst <= 1 and intervals > 0.9 * (at.size - 1):
            break
        levels = np.linspace(0, count[-1], intervals + 1)
        at = np.unique(np.interp(levels, count, np.arange(s.size)).round().astype(int))
    while True:
        error = _errors(s, place, values, at, tolerance, colour_length)
        halves = (at[:-1] + at[1:]) // 2
        more = halves[(error > tolerance) & (halves > at[:-1])]
        if not more.size:
            return at
        at = np.unique(np.concatenate([at, more]))
