"""As many rings and sides as a picture needs: the drawn tube stays within a tolerance of the true one.

Two things are lost when a rod is drawn with flat triangles. A section of n sides misses its circle by
a (1 - cos(pi/n)). And between two rings the surface is straight while the rod bends, turns and twists: that is
measured, on points of the true surface between the rings, and rings are moved and added until it is small enough. So
a rod whose bends are smaller than a pixel is drawn with hardly any, however many bends it has.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from solver.problem.errors import InputError

from .centreline import Array, Centreline

LEAST_SIDES = 6
PROBES = 8  # points a ring, on which the true surface is compared with the drawn one
SETTLED = 2  # rounds of moving the rings, after which the errors of most stretches are within a tenth of each other
ROUNDS = 10  # with those in which rings are taken away or added; what is off still, bends below a pixel, is halved
MORE = 1.2  # times as many rings are added at most; where that does not do, it is a few stretches that are off
TINTS = 48  # a colour may be off by one part in so many of its scale
MOST_TRIANGLES = 4_000_000  # some 400 MB while it is drawn
SHARE = 0.48  # of the tolerance for the sides, as much for the rings: on a diagonal both are off, elsewhere one


@dataclass(frozen=True, eq=False)
class Detail:
    """Where the rings of a tube stand, (n,) [length], how many sides it has, and how far the surface may be off."""

    s: Array
    sides: int
    off: float


def detail(
    line: Centreline,
    span: tuple[float, float],
    tolerance: float,
    turned: Any = None,
    tint: Any = None,
    blur: float = 0.0,
    sides_of: int = 2,
) -> Detail:
    """Rings between the two arc lengths of `span`, and sides.

    tolerance: [length], half a pixel say. turned: the angle of the section at s, if a stripe turns with it. tint: what
    is shown in colour at s, as a share of its scale; on stretches longer than `blur` it must be shown truly too.
    sides_of: the sides are a multiple of that; of 2, a corner of each ring touches the cylinder.
    Raises `InputError` where it would take more than `MOST_TRIANGLES`.
    """
    missed, smooth = left_open(line, tolerance)
    left = max(tolerance - missed, tolerance / 2)
    sides = int(np.ceil(np.pi / np.arccos(max(1 - SHARE * left / line.a, 0.0))))
    sides = -(-max(sides, LEAST_SIDES) // sides_of) * sides_of
    s = _probes(line, span, SHARE * left, turned, smooth)
    place = _surface(line, s, turned)
    values = tint(s) if tint is not None else None
    if s.size * sides > 2 * PROBES * MOST_TRIANGLES:
        _refuse(line, s.size * sides // PROBES * 2)
    chosen = _moved(s, place, values, SHARE * left, blur)
    if 2 * chosen.size * sides > MOST_TRIANGLES:
        _refuse(line, 2 * chosen.size * sides)
    return Detail(s[chosen], sides, missed + left)


def left_open(line: Centreline, tolerance: float) -> tuple[float, bool]:
    """How far the rod may be from the curve that is drawn [length], and whether this is the smooth one through the
    stations; else straight lines between them are as good."""
    known, loose = line.error, slack(line)
    smooth = known <= max(tolerance / 4, min(loose, tolerance))
    return (known, True) if smooth else (loose, False)


def stations_for(line: Centreline, tolerance: float) -> int:
    """How many stations it takes to draw a rod to a tolerance [length]: those there are, or about how many more."""
    if left_open(line, tolerance)[0] <= tolerance / 2:
        return line.s.size
    return max(line.stations_for(tolerance / 6), line.s.size + 1)


def slack(line: Centreline) -> float:
    """How far the rod can be from straight lines between its stations [length], whatever it does there.

    It is not stretched: of length h between two points c apart it stays within sqrt(h^2 - c^2)/2 of their chord.
    """
    chord = np.hypot(line.rho * np.diff(line.alpha), np.diff(line.z))
    return float(np.sqrt(np.maximum(np.diff(line.s) ** 2 - chord**2, 0)).max() / 2)


def _refuse(line: Centreline, triangles: int) -> None:
    raise InputError(
        f"drawing this rod of length {line.L:.4g} as finely as asked takes some {triangles} triangles, and "
        f"{MOST_TRIANGLES} are the limit: give a larger --pixel-error, or a stretch of it with --from and --to"
    )


def _surface(line: Centreline, s: Array, turned: Any) -> Array:
    """Centre and the section's two radii as one row of nine numbers a point, (k, 9)."""
    place, _, out, across = line.frame(s)
    if turned is not None:
        angle = turned(s)[:, None]
        out, across = np.cos(angle) * out + np.sin(angle) * across, np.cos(angle) * across - np.sin(angle) * out
    return np.concatenate([place, line.a * out, line.a * across], axis=1)


def _probes(line: Centreline, span: tuple[float, float], tolerance: float, turned: Any, smooth: bool) -> Array:
    """Points so near that the surface between them is as good as straight; the stations, where those are all there is.

    A point moves off a straight line by |r''| ds^2/8. Bends that are smaller than the tolerance are passed over: the
    points then are rare, but they are so on those bends too.
    """
    low, high = span
    inside = line.s[(line.s > low) & (line.s < high)]
    s = np.concatenate([[low], inside, [high]])
    if not smooth:
        return s
    fine = np.unique(np.concatenate([s[:-1] + k / 4 * np.diff(s) for k in range(4)] + [s[-1:]]))
    place = _surface(line, fine, turned)
    h = np.diff(fine)
    rate = np.diff(place, axis=0) / h[:, None]
    bend = np.diff(rate, axis=0) / ((h[1:] + h[:-1]) / 2)[:, None]
    size = np.linalg.norm(bend[:, :3], axis=1) + np.linalg.norm(bend[:, 3:], axis=1)
    size = np.concatenate([size[:1], size, size[-1:]])
    density = np.sqrt(np.maximum(size[1:], size[:-1]) / (8 * tolerance)) * PROBES
    count = np.concatenate([[0.0], np.cumsum(density * h)])
    wanted = max(int(np.ceil(count[-1])), PROBES) + 1
    if wanted > PROBES * MOST_TRIANGLES:
        _refuse(line, 2 * LEAST_SIDES * wanted // PROBES)
    return np.interp(np.linspace(0, count[-1], wanted), count, fine) if count[-1] else np.linspace(low, high, wanted)


def _off(s: Array, place: Array, values: Array | None, rings: Any, tolerance: float, blur: float) -> Array:
    """How far the true surface is from the straight one between each two rings, at most, (n - 1,)."""
    start = rings[:-1]
    at = np.repeat(np.arange(start.size), np.diff(rings))  # the stretch of each probe but the last
    first, last = rings[at], rings[at + 1]
    share = ((s[:-1] - s[first]) / (s[last] - s[first]))[:, None]
    gap = place[:-1] - (1 - share) * place[first] - share * place[last]
    u, v = gap[:, 3:6], gap[:, 6:]
    p, q, r = (np.einsum("ij,ij->i", *pair) for pair in ((u, u), (v, v), (u, v)))
    turn = np.sqrt(np.maximum((p + q) / 2 + np.hypot((p - q) / 2, r), 0))  # the largest of |u cos + v sin|
    off = np.linalg.norm(gap[:, :3], axis=1) + turn
    if values is not None:
        tint = values[:-1] - (1 - share[:, 0]) * values[first] - share[:, 0] * values[last]
        seen = s[last] - s[first] > blur
        off = np.maximum(off, np.where(seen, tolerance * TINTS * np.abs(tint), 0.0))
    return np.maximum.reduceat(off, start)


def _moved(s: Array, place: Array, values: Array | None, tolerance: float, blur: float) -> Any:
    """Indices of the probes where rings stand: as few as keep each stretch within the tolerance, near enough."""
    rings = np.unique(np.linspace(0, s.size - 1, max((s.size - 1) // PROBES, 2) + 1).round().astype(int))
    middles, more = np.arange(s.size - 1) + 0.5, 1.0
    for step in range(ROUNDS):
        off = _off(s, place, values, rings, tolerance, blur)
        worst = float(off.max()) / tolerance
        if step >= SETTLED and worst > 1:
            more = min(more * min(np.sqrt(worst), 1.05), MORE)
        # off goes with the square of the distance; a stretch that is far better than needed is made four times as long
        density = np.clip(np.sqrt(off / tolerance), 0.25, 4.0) / np.diff(rings)
        count = np.concatenate([[0.0], np.cumsum(np.interp(middles, (rings[1:] + rings[:-1]) / 2, density))])
        stretches = max(int(np.ceil(count[-1] * more)), 1)
        if step >= SETTLED and worst <= 1 and stretches > 0.9 * (rings.size - 1):
            break
        wanted = np.linspace(0, count[-1], stretches + 1)
        rings = np.unique(np.interp(wanted, count, np.arange(s.size)).round().astype(int))
    while True:
        off = _off(s, place, values, rings, tolerance, blur)
        halves = (rings[:-1] + rings[1:]) // 2
        more = halves[(off > tolerance) & (halves > rings[:-1])]
        if not more.size:
            return rings
        rings = np.unique(np.concatenate([rings, more]))
