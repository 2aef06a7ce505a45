"""When unrolled curves are drawn at two scales: only where at one scale they would be too thin to see.

A rod a thousand times as long as the cylinder is wide is a hair at one scale. The rule: one scale for both directions,
unless the curves would then be less than `LEAST` inches across; then that direction is drawn larger, by the largest
factor of one digit that fits its room.
"""

from math import floor, log10

LEAST = 0.3  # inches
STRAIGHT = 1e-9  # of the other extent: less is rounding, which no scale shows


def stretch(wide: float, high: float, room: tuple[float, float], widest: float | None = None) -> float:
    """How many times larger the width is drawn than the height: 1, above 1, or below 1 where the height is enlarged.

    wide, high: what is drawn, in lengths; room: inches to the right and up; widest: of what stands side by side in
    `wide`, the widest, all of it where left out.
    """
    widest = wide if widest is None else widest
    if min(wide, high) <= STRAIGHT * max(wide, high):
        return 1.0
    across, up = room[0] / wide, room[1] / high  # inches per length that would fill the room
    if widest * up < LEAST and across > up:
        return _round(across / up)
    if high * across < LEAST and up > across:
        return 1 / _round(up / across)
    return 1.0


def larger(factor: float, name: str = "") -> str:
    """What an axis says of itself or of the other: ``, drawn 50 times larger``, or nothing."""
    return f", {name} drawn {factor:g} times larger".replace("  ", " ") if factor > 1 else ""


def _round(ratio: float) -> float:
    """The ratio cut to one digit."""
    power = 10.0 ** floor(log10(ratio * (1 + 1e-9)))
    return float(floor(ratio / power * (1 + 1e-9)) * power)
