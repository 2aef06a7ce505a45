"""The kind twist: a stripe on the rod that turns with its material."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import xarray as xr

from ..colours import STRIPE, UNPAINTED, Paint, Painted
from .base import CURVE, Kind

if TYPE_CHECKING:
    from ..body import Body


def striped(ds: xr.Dataset, bodies: Sequence["Body"]) -> Painted:
    """A stripe on an unpainted rod."""
    return Paint(UNPAINTED, stripe=STRIPE), None


def legend(bodies: Sequence["Body"]) -> list[tuple[str, str]]:
    """The stripe."""
    return [(STRIPE, "a stripe along the material: it turns as the rod is twisted and bent")]


KIND = Kind("twist", "a stripe on the rod that turns with its material", "one", CURVE | {"gamma"}, paint=striped,
            legend=legend)  # fmt: skip
