"""What a rod of a scene is painted in: one colour, or the colours of a quantity and their bar."""

from dataclasses import dataclass, replace

from matplotlib.colors import Colormap

from solver.problem.errors import InputError

from ..figures import colours
from ..figures.colours import NEUTRAL
from ..words import labels

PUSH_RAMP = colours.push_ramp()

Extremes = tuple[float, float] | None  # the least and the largest value of all rods; None without rods


@dataclass(frozen=True, eq=False)
class Paint:
    """The colour of a tube: one for all, or by a value along it between `low` and `high`.

    stripe: the colour of a stripe that turns with the material; default: none.
    """

    colour: str = NEUTRAL
    ramp: Colormap | None = None
    low: float = 0.0
    high: float = 1.0
    stripe: str = ""


@dataclass(frozen=True, eq=False)
class Bar:
    """A colour bar: the colours of a paint between two values, and the quantity with its unit."""

    paint: Paint
    low: float
    high: float
    label: str


Painted = tuple[Paint, Bar | None]


def one_colour(units: dict[str, str], extremes: Extremes) -> Painted:
    """All rods in a neutral colour, which says nothing of the push."""
    return Paint(NEUTRAL), None


def with_stripe(units: dict[str, str], extremes: Extremes) -> Painted:
    """A stripe on an unpainted rod."""
    return Paint(colours.UNPAINTED, stripe=colours.STRIPE), None


def by_push(units: dict[str, str], extremes: Extremes) -> Painted:
    """By the cylinder's push, one scale for all rods, as far below 0 as above it and pale there."""
    low, end = colours.push_scale(*extremes) if extremes else (0.0, 0.0)
    if end == 0:
        return Paint(NEUTRAL), None
    unit = labels.unit(f"{units['force']}/{units['length']}")
    paint = Paint(ramp=PUSH_RAMP, low=-end, high=end)
    return paint, Bar(paint, low, end, colours.push_words(unit, low))


def by_curvature(units: dict[str, str], extremes: Extremes) -> Painted:
    """By the curvature, one scale for all rods; one colour where it is the same everywhere."""
    low, high = extremes or (0.0, 0.0)
    if high - low <= 1e-9 * high:
        return Paint(NEUTRAL), None
    paint = Paint(ramp=colours.ramp(), low=low, high=high)
    return paint, Bar(paint, low, high, f"curvature κ [1/{units['length']}]")


def set_range(paint: Paint, bar: Bar, chosen: tuple[float, float]) -> Painted:
    """The same colours between two other values.

    Raises `InputError` for a scale of pushes that is not pale at 0.
    """
    low, high = chosen
    if paint.ramp is not PUSH_RAMP:
        paint = replace(paint, low=low, high=high)
    elif low not in (0.0, -high):
        raise InputError(
            f"the colours of a push are pale at 0, so --color-range is 0,HIGH or -HIGH,HIGH, got {low:g},{high:g}"
        )
    else:
        paint = replace(paint, low=-high, high=high)
    return paint, replace(bar, paint=paint, low=low, high=high)
