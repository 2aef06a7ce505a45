"""The colours of a scene: the colour map of each quantity, the colour bar, and the look of rod and cylinder."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from matplotlib.colors import Colormap, ListedColormap, to_hex, to_rgb

from ..data import labels
from ..figures.style import LIFTED, PUSHED, RAMP, RAMP_ENDS

if TYPE_CHECKING:
    from .body import Body

UNPAINTED = "#d9c9a3"  # the rod beside its stripe
SURFACE = "#e3e6ea"  # the cylinder
PUSH_RAMP = ListedColormap(RAMP(np.linspace(0, 0.6, 256)), "push")  # ends before it comes near the colour of lift-off
AXIS_RAMP = ListedColormap(RAMP(np.linspace(*RAMP_ENDS, 256)), "ramp")  # the ramp as far as it is used on white


@dataclass(frozen=True, eq=False)
class Paint:
    """The colour of a tube: one for all, or by a value along it between `low` and `high`, with another below `low`.

    stripe: the colour of a stripe that turns with the material; default: none.
    """

    colour: str = PUSHED
    ramp: Any = None
    low: float = 0.0
    high: float = 1.0
    below: str = ""
    stripe: str = ""


@dataclass(frozen=True, eq=False)
class Bar:
    """A colour bar: its map, the values at its ends, and the quantity with its unit."""

    ramp: Colormap
    low: float
    high: float
    label: str


Painted = tuple[Paint, Bar | None]


def one_colour(ds: xr.Dataset, bodies: Sequence["Body"]) -> Painted:
    """All rods in the colour of a push."""
    return Paint(PUSHED), None


def by_push(ds: xr.Dataset, bodies: Sequence["Body"]) -> Painted:
    """By the cylinder's push, one scale for all rods; where it would have to pull, the colour of lift-off."""
    high = max((body.extremes()[1] for body in bodies), default=None)
    if high is None:
        return Paint(PUSHED), None
    if high <= 0:
        return Paint(LIFTED), None
    unit = labels.unit(f"{ds.attrs['force_unit']}/{ds.attrs['length_unit']}")
    return Paint(ramp=PUSH_RAMP, high=high, below=LIFTED), Bar(PUSH_RAMP, 0.0, high, f"push of the cylinder [{unit}]")


def by_curvature(ds: xr.Dataset, bodies: Sequence["Body"]) -> Painted:
    """By the curvature, one scale for all rods; one colour where it is the same everywhere."""
    extremes = np.array([body.extremes() for body in bodies] or [(0.0, 0.0)])
    low, high = float(extremes[:, 0].min()), float(extremes[:, 1].max())
    if high - low < 1e-9 * high or high == 0:
        return Paint(PUSHED), None
    return Paint(ramp=RAMP, low=low, high=high), Bar(RAMP, low, high, f"curvature κ [1/{ds.attrs['length_unit']}]")


def hex_of(ramp: Colormap, share: float) -> str:
    """A colour of a ramp as ``#rrggbb``."""
    return to_hex(ramp(share))


def linear(colour: str) -> Any:
    """A colour of the screen (sRGB) as the light it stands for, (3,), which is what glTF stores."""
    c = np.array(to_rgb(colour))
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
