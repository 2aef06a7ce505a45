"""The camera of a scene: parallel projection, so one scale holds for all of the picture. No OpenGL."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from solver.problem.errors import InputError, no_such

from ..geometry.centreline import Array

if TYPE_CHECKING:
    import xarray as xr

    from .body import Body

# name -> its views, each with the angle about the axis from the side where the rod is and the angle above the plane
# across the axis, in degrees
CAMERAS: dict[str, tuple[tuple[float, float], ...]] = {
    "oblique": ((25.0, 20.0),),
    "sides": ((0.0, 0.0), (90.0, 0.0)),
    "front": ((0.0, 0.0),),
    "side": ((90.0, 0.0),),
}
LOW_SIDE_DOWN = np.radians(-120.0)  # azimuth of a viewer of a lying cylinder who looks down on its low side
STEEPEST = 60.0  # degrees; beyond, lengths along the axis are hardly seen


@dataclass(frozen=True, eq=False)
class Camera:
    """A camera in parallel projection.

    Attributes
    ----------
    toward, up
        Directions to the camera, and up on the page, (3,).
    per_unit
        Pixels per length.
    seen_from
        Direction to the viewer in the axes of the first view's rods, (3,), where it was turned.
    down
        Direction of the weight of the rods, (3,); default: no weight, or several directions.
    """

    toward: Array
    up: Array
    per_unit: float = 1.0
    seen_from: Array | None = None
    down: Array | None = None

    @property
    def page(self) -> Array:
        """Directions to the right and up on the page, (2, 3)."""
        return np.array([np.cross(self.up, self.toward), self.up])

    @property
    def along_axis(self) -> float:
        """The share of a length along the axis that is seen: 1 from the side."""
        return float(np.hypot(*self.page[:, 2]))

    def box(self, reach: float, ends: tuple[float, float]) -> tuple[Array, Array]:
        """The least and the largest coordinates on the page of a cylinder between two heights, (2,) each [length]."""
        across = reach * np.sqrt(np.maximum(1 - self.page[:, 2] ** 2, 0.0))  # the largest x cos t + y sin t of a rim
        along = np.outer(ends, self.page[:, 2])
        return along.min(axis=0) - across, along.max(axis=0) + across


def views_of(text: str | None) -> tuple[tuple[float, float], ...]:
    """The views that --camera names, each as azimuth and elevation [deg]; default: one, oblique.

    Raises `InputError` for what is neither a name of `CAMERAS` nor two angles.
    """
    if text is None:
        return CAMERAS["oblique"]
    if text in CAMERAS:
        return CAMERAS[text]
    try:
        azimuth, elevation = (float(part) for part in text.split(","))
    except ValueError:
        raise no_such("camera", text, [*CAMERAS, "AZIMUTH,ELEVATION in degrees"]) from None
    if not (-360 <= azimuth <= 360 and -STEEPEST <= elevation <= STEEPEST):
        raise InputError(
            f"--camera takes an azimuth between -360 and 360 and an elevation between {-STEEPEST:g} and {STEEPEST:g} "
            f"degrees, got {text}"
        )
    return ((azimuth, elevation),)


def one_view_of(text: str | None, shown: str) -> tuple[float, float]:
    """The same of a picture with one view of each rod; shown: what it shows. Raises `InputError` for several views."""
    view, *others = views_of(text)
    if others:
        raise InputError(f"{shown} is seen from one side, and --camera {text} has several: choose front or side")
    return view


def gravity(ds: "xr.Dataset", where: Mapping[str, int]) -> Array | None:
    """The direction of the weight of the rods of a case, (3,); None without weight or for several directions."""
    if "weight" not in ds or not ds["weight"].values.any():
        return None
    angles = np.unique(ds["inclination"].isel(where, missing_dims="ignore").values) if "inclination" in ds else [0.0]
    return np.array([np.sin(angles[0]), 0.0, -np.cos(angles[0])]) if len(angles) == 1 else None


def front_camera(
    bodies: Sequence["Body"], elevation: float = 0.0, lying: bool = False, down: Array | None = None
) -> Camera:
    """The camera before the rods' mean azimuth; the axis goes up the page, or with `lying` to its right.

    elevation: the angle by which it looks down on the plane across the axis [deg]. down: as of `Camera`; a viewer of a
    lying cylinder then has its low side below.
    """
    low = down is not None and bool(np.hypot(*down[:2]) > 1e-9)
    azimuth = LOW_SIDE_DOWN if low else azimuth_of(bodies)
    out, axis = np.array([np.cos(azimuth), np.sin(azimuth), 0.0]), np.array([0.0, 0.0, 1.0])
    above = np.radians(elevation)
    toward = np.cos(above) * out + np.sin(above) * axis
    flat = np.cos(above) * axis - np.sin(above) * out
    return Camera(toward, np.cross(toward, flat) if lying else flat, down=down)


def upright(camera: Camera) -> Camera:
    """The camera turned so that the weight points down the page; the same where there is none."""
    if camera.down is None:
        return camera
    up = camera.toward * (camera.down @ camera.toward) - camera.down
    size = float(np.linalg.norm(up))
    return camera if size < 1e-6 else replace(camera, up=up / size)


def azimuth_of(bodies: Sequence["Body"]) -> float:
    """The mean azimuth of rods [rad]; 0 of those all around the cylinder, which have no front."""
    mean = np.mean([np.exp(1j * body.alpha).mean() for body in bodies] or [1.0])
    return float(np.angle(mean)) if abs(mean) > 0.05 else 0.0
