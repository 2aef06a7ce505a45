"""Rods on their cylinders before a camera: geometry to pixels, with VTK. Needs OpenGL, see `opengl`."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from ..figures import style
from ..geometry.centreline import Array
from . import colours
from .body import Body, Surface
from .page import Cell

FINER = 2  # each pixel is the mean of 2 x 2
COLOUR_PIXELS = 2  # between rings; on shorter intervals colours need not be true
MOST_PIXELS = 24_000_000  # rendered at once: the ambient shading holds some 50 bytes of each
GLASS = 0.45  # opacity of each wall of a clear cylinder; what is behind both walls is still darker than they are
ABOVE = 0.3  # rad by which the camera looks down
LEAST_CELL = 190  # pixels of width, for the caption
# Three lights fixed to the camera: azimuth and elevation in degrees, intensity
LIGHTS = ((40, 40, 0.75), (-50, 15, 0.4), (0, -50, 0.3))


@dataclass(frozen=True, eq=False)
class Camera:
    """A camera in parallel projection, and the cell that it fills.

    Attributes
    ----------
    toward, up
        Directions to the camera, and up on the page, (3,).
    focus
        The middle of the cell, (3,) [length].
    per_unit
        Pixels per length.
    size
        Width and height of the cell in pixels.
    """

    toward: Array
    up: Array
    focus: Array
    per_unit: float
    size: tuple[int, int]

    @property
    def page(self) -> Array:
        """Directions to the right and up on the page, (2, 3)."""
        return np.array([np.cross(self.up, self.toward), self.up])


@dataclass(frozen=True, eq=False)
class View:
    """What stands in a cell: rods on one cylinder, or none.

    turned: the angle about the axis by which all of it is turned [rad]. clear: the cylinder is of glass, so that a rod
    that winds about it is seen all the way.
    """

    bodies: Sequence[Body]
    cell: Cell
    turned: float = 0.0
    clear: bool = False


def ends_of(bodies: Sequence[Body]) -> tuple[float, float]:
    """Where the cylinder begins and ends [length], a little beyond the rods; 0 and 5 without rods."""
    if not bodies:
        return 0.0, 5.0
    beyond = max(body.a for body in bodies) + 0.3 * max(body.R for body in bodies)
    return min(body.z.min() for body in bodies) - beyond, max(body.z.max() for body in bodies) + beyond


def front_camera(bodies: Sequence[Body], ends: tuple[float, float], room: tuple[int, int], lying: bool) -> Camera:
    """The camera that faces the rods' mean azimuth, as near as the room of a cell (in pixels) allows.

    It looks down a little, so that the end of the cylinder is seen; the axis goes up the page, or with `lying` to its
    right.
    """
    out, axis = _front(bodies), np.array([0.0, 0.0, 1.0])
    toward = np.cos(ABOVE) * out + np.sin(ABOVE) * axis
    if lying:
        toward = toward + np.tan(ABOVE) * np.cross(out, axis)
    toward /= np.linalg.norm(toward)
    flat = axis - toward * (toward @ axis)
    flat /= np.linalg.norm(flat)
    up = np.cross(toward, flat) if lying else flat
    page = np.array([np.cross(up, toward), up])
    reach = max((body.reach for body in bodies), default=1.0)
    around = np.linspace(0, 2 * np.pi, 73)
    rims = [np.stack([reach * np.cos(around), reach * np.sin(around), np.full(73, z)], axis=-1) for z in ends]
    seen = np.concatenate(rims) @ page.T
    low, high = seen.min(axis=0), seen.max(axis=0)
    width, height = (high - low) * 1.05 + 0.1 * reach
    per_unit = min(room[0] / width, room[1] / height)
    size = (max(int(width * per_unit), min(LEAST_CELL, room[0])), int(height * per_unit))
    return Camera(toward, up, (low + high) / 2 @ page, per_unit, size)


def side_camera(bodies: Sequence[Body], ends: tuple[float, float], per_unit: float, size: tuple[int, int]) -> Camera:
    """The camera that sees the axis in its true length, to the right; it looks along x or along y."""
    front, axis = _front(bodies), np.array([0.0, 0.0, 1.0])
    out = np.sign(front) * (np.abs(front) == np.abs(front).max())
    return Camera(out, np.cross(out, axis), sum(ends) / 2 * axis, per_unit, size)


def _front(bodies: Sequence[Body]) -> Array:
    """The direction from the axis to the rods."""
    mean = np.mean([np.exp(1j * body.alpha).mean() for body in bodies] or [1.0])
    azimuth = np.angle(mean) if abs(mean) > 0.05 else 0.0  # a rod all around the cylinder has no front
    return np.array([np.cos(azimuth), np.sin(azimuth), 0.0])


def render(
    views: Sequence[Sequence[View]],
    ends: tuple[float, float],
    camera: Camera,
    pixel_error: float,
    caption: int,
    most_pixels: int = MOST_PIXELS,
) -> tuple[NDArray[np.uint8], float]:
    """Render all cells into one picture.

    Parameters
    ----------
    views
        Rows of cells.
    ends
        The heights between which the cylinders stand [length].
    caption
        The room below each cell in pixels.
    most_pixels
        Of a picture rendered at once: more are rendered a few columns at a time, as the ambient shading holds ten times
        the size of a picture.

    Returns
    -------
    tuple
        The pixels, (height, width, 3), and the error of the drawn surface in pixels: at most `pixel_error` where the
        stations allow it.
    """
    columns, high = len(views[0]), len(views) * (camera.size[1] + caption)
    at_once = max(most_pixels // (FINER**2 * high * camera.size[0]), 1)
    parts = [[row[j : j + at_once] for row in views] for j in range(0, columns, at_once)]
    reach = max((body.reach for row in views for view in row for body in view.bodies), default=1.0)
    rendered = [_render_part(part, ends, camera, reach, pixel_error, caption, most_pixels) for part in parts]
    return np.concatenate([pixels for pixels, _ in rendered], axis=1), max(error for _, error in rendered)


def _render_part(
    views: Sequence[Sequence[View]],
    ends: tuple[float, float],
    camera: Camera,
    reach: float,
    pixel_error: float,
    caption: int,
    most_pixels: int,
) -> tuple[NDArray[np.uint8], float]:
    """Some cells in one picture: one scene with one camera.

    The projection is parallel, so each of the rods that stand apart on the page looks as if it were alone.
    """
    pitch = np.array([camera.size[0], camera.size[1] + caption])
    width, height = (int(n) for n in pitch * (len(views[0]), len(views)))
    if not any(view.bodies for row in views for view in row):
        return np.full((height, width, 3), 255, dtype=np.uint8), 0.0
    # one cell alone may be too large, as in prints; its pixels are small enough then
    finer = FINER if FINER**2 * width * height <= most_pixels else 1
    plotter: Any = pv.Plotter(off_screen=True, window_size=[finer * width, finer * height], lighting="none")
    error = 0.0
    try:
        plotter.ren_win.SetMultiSamples(0)  # each pixel is a mean anyway
        plotter.set_background("white")
        for light in _lights():
            plotter.add_light(light)
        for i, row in enumerate(views):
            for j, view in enumerate(row):
                if view.bodies:
                    steps = np.array([j - (len(row) - 1) / 2, (len(views) - 1) / 2 - i]) * pitch
                    steps[1] += caption / 2
                    where = steps / camera.per_unit @ camera.page
                    error = max(error, _place(plotter, view, ends, where, camera, pixel_error))
        # Near, as the ambient shading holds distances from the camera in half precision: far away it would band.
        away = 1.1 * (reach + (np.ptp(ends) / 2 if abs(camera.toward[2]) > 1e-9 else 0.0))
        plotter.camera_position = [camera.focus + away * camera.toward, camera.focus, camera.up]
        plotter.enable_parallel_projection()
        plotter.camera.parallel_scale = height / camera.per_unit / 2
        plotter.renderer.ResetCameraClippingRange()
        plotter.enable_ssao(radius=0.5 * reach, bias=0.02 * reach, kernel_size=32, blur=True)
        fine = np.asarray(plotter.screenshot(return_img=True))[..., :3]
    finally:
        plotter.close()
    sums = np.zeros((height, width, 3), dtype=np.uint16)
    for i, j in np.ndindex(finer, finer):
        sums += fine[i::finer, j::finer]
    return (sums // finer**2).astype(np.uint8), error


def _place(
    plotter: Any, view: View, ends: tuple[float, float], where: Array, camera: Camera, pixel_error: float
) -> float:
    """Add the rods and their cylinder, turned about the axis and then moved; returns the rods' error in pixels."""
    looks = {"ambient": 0.2, "diffuse": 0.85, "smooth_shading": False, "show_scalar_bar": False, "render": False}

    def add(mesh: pv.PolyData, **options: Any) -> None:
        turned = mesh.rotate_z(np.degrees(view.turned), transform_all_input_vectors=True)
        plotter.add_mesh(turned.translate(where), interpolation="Phong", **{**looks, **options})

    error = 0.0
    for body in view.bodies:
        rings = body.rings(pixel_error / camera.per_unit, COLOUR_PIXELS / camera.per_unit)
        error = max(error, rings.error * camera.per_unit)
        for mesh, options in painted(body, body.surface(rings)):
            add(mesh, specular=0.35, specular_power=25, **options)
    low, high = ends
    first = view.bodies[0]
    wall = pv.Cylinder(
        center=(0, 0, (low + high) / 2), direction=(0, 0, 1), radius=first.R, height=high - low, resolution=180,
        capping=False,
    ).compute_normals(cell_normals=False)  # fmt: skip
    if first.side == "inside":  # cut open: the near half of the wall is nearly transparent
        add(wall, color=colours.SURFACE, culling="front")
        add(wall, color=style.SOFT, culling="back", opacity=0.12)
    else:
        add(wall, color=colours.SURFACE, opacity=GLASS if view.clear else 1.0)
    for z in ends:
        end = pv.Disc(center=(0, 0, z), inner=0, outer=first.R, normal=(0, 0, 1), c_res=180)
        if first.side == "outside":
            add(end, color=colours.SURFACE)
        add(end.extract_feature_edges(), color=style.SOFT, line_width=FINER * 1.2, lighting=False)
    return error


def painted(body: Body, surface: Surface) -> list[tuple[pv.PolyData, dict[str, Any]]]:
    """The tube for VTK, in one part or with its stripe in two, each with the options that colour it."""
    paint, mesh = body.paint, surface.mesh

    def part(chosen: Any) -> pv.PolyData:
        found = pv.PolyData(mesh.points, faces=np.insert(mesh.triangles[chosen], 0, 3, axis=1).ravel())
        found.point_data.active_normals = mesh.normals
        return found

    if paint.stripe:
        striped = surface.striped
        return [(part(~striped), {"color": paint.colour}), (part(striped), {"color": paint.stripe})]
    if surface.values is None:
        return [(part(slice(None)), {"color": paint.colour})]
    whole = part(slice(None))
    whole.point_data["value"] = surface.values
    table = pv.LookupTable(paint.ramp, scalar_range=(paint.low, paint.high), n_values=256)
    if paint.below:
        table.below_range_color = paint.below
    return [(whole, {"scalars": "value", "cmap": table, "interpolate_before_map": True})]


def _lights() -> list[pv.Light]:
    found = []
    for azimuth, elevation, intensity in LIGHTS:
        around, above = np.radians([azimuth, elevation])
        light = pv.Light(light_type="camera light", intensity=intensity)
        light.position = np.sin(around) * np.cos(above), np.sin(above), np.cos(around) * np.cos(above)
        found.append(light)
    return found
