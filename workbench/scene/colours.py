"""The colours of a scene: the colour map of each quantity, the colour bar, and the look of rod and cylinder."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from matplotlib.colors import Colormap, LinearSegmentedColormap, to_hex, to_rgb

from solver.problem.errors import InputError

from ..data import labels
from ..data.push_colours import STOPS
from ..figures.style import LIFTED, RAMP

if TYPE_CHECKING:
    from .body import Body


NEUTRAL = "#8d96a1"  # a rod in one colour
UNPAINTED, STRIPE = "#d9c9a3", "#5d4a72"  # the rod beside its stripe, and the stripe; no colours of the push
SEVERAL = ("#5b2a86", "#c2457f", "#259e73")  # several rods on one cylinder
SURFACE = "#e6e1d8"  # the cylinder: warm, so a pale blue rod stands out from it
PUSH_RAMP = LinearSegmentedColormap.from_list("push", [(at, to_hex(np.array(rgb) / 255)) for at, rgb in STOPS], 256)  # type: ignore[arg-type]


@dataclass(frozen=True, eq=False)
class Paint:
    """The colour of a tube: one for all, or by a value along it between `low` and `high`, with another below `low`.

    stripe: the colour of a stripe that turns with the material; default: none.
    """

    colour: str = NEUTRAL
    ramp: Any = None
    low: float = 0.0
    high: float = 1.0
    below: str = ""
    stripe: str = ""


@dataclass(frozen=True, eq=False)
class Bar:
    """A colour bar: its map, the values at its ends, the quantity with its unit, and whether below it is a pull."""

    ramp: Colormap
    low: float
    high: float
    label: str
    pulls: bool = False


Painted = tuple[Paint, Bar | None]


def one_colour(ds: xr.Dataset, bodies: Sequence["Body"]) -> Painted:
    """All rods in a neutral colour, which says nothing of the push."""
    return Paint(NEUTRAL), None


def by_push(ds: xr.Dataset, bodies: Sequence["Body"]) -> Painted:
    """By the cylinder's push, one scale for all rods; where it would have to pull, the colour of lift-off."""
    high = max((body.extremes()[1] for body in bodies), default=None)
    if high is None:
        return Paint(NEUTRAL), None
    if high <= 0:
        return Paint(LIFTED), None
    unit = labels.unit(f"{ds.attrs['force_unit']}/{ds.attrs['length_unit']}")
    return Paint(ramp=PUSH_RAMP, high=high, below=LIFTED), Bar(
        PUSH_RAMP, 0.0, high, f"push of the cylinder [{unit}]", pulls=True
    )


def by_curvature(ds: xr.Dataset, bodies: Sequence["Body"]) -> Painted:
    """By the curvature, one scale for all rods; one colour where it is the same everywhere."""
    extremes = np.array([body.extremes() for body in bodies] or [(0.0, 0.0)])
    low, high = float(extremes[:, 0].min()), float(extremes[:, 1].max())
    if high - low < 1e-9 * high or high == 0:
        return Paint(NEUTRAL), None
    return Paint(ramp=RAMP, low=low, high=high), Bar(RAMP, low, high, f"curvature κ [1/{ds.attrs['length_unit']}]")


def ranged(paint: Paint, bar: Bar | None, chosen: tuple[float, float]) -> Painted:
    """The same colours between two other values. Raises `InputError` where a scale of pushes would not begin at 0."""
    if bar is None:
        return paint, bar
    low, high = chosen
    if bar.pulls and low != 0:
        raise InputError(f"the colours of a push begin at 0, so --color-range is 0,HIGH, got {low:g},{high:g}")
    return replace(paint, low=low, high=high), replace(bar, low=low, high=high)


def hex_of(ramp: Colormap, share: float) -> str:
    """A colour of a ramp as ``#rrggbb``."""
    return to_hex(ramp(share))


def linear(colour: str) -> Any:
    """A colour of the screen (sRGB) as the light it stands for, (3,), which is what glTF stores."""
    c = np.array(to_rgb(colour))
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
