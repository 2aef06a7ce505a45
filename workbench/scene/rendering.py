"""Rods on their cylinders before a camera: geometry to pixels, with VTK. Needs OpenGL, see `gl`."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from ..figures import style
from ..geometry import tube
from ..geometry.centreline import Array
from ..geometry.tube import Body
from .page_layout import Cell

FINER = 2  # each pixel is the mean of 2 x 2
BLUR = 2  # pixels between rings, below which a colour is not looked at
MOST_PIXELS = 24_000_000  # taken at once: the ambient shading holds some 50 bytes of each
GLASS = 0.45  # opacity of each of its walls; what is behind both is still darker than they are
ABOVE = 0.3  # rad from which the camera looks down
LEAST_CELL = 190  # pixels of width, for the label
# Three lights fixed to the camera: azimuth and elevation in degrees, intensity
LIGHTS = ((40, 40, 0.75), (-50, 15, 0.4), (0, -50, 0.3))


@dataclass(frozen=True, eq=False)
class View:
    """A camera in parallel projection, and the cell that it fills.

    toward: to the camera; up: up on the page; focus: the middle of the cell; per_unit: pixels per length; size:
    width and height of the cell in pixels.
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
class Shot:
    """What stands in a cell: rods on one cylinder, or none; turned about the axis by an angle. clear: the cylinder is
    of glass, so that a rod that goes round it is seen all the way."""

    bodies: Sequence[Body]
    cell: Cell
    turned: float = 0.0
    clear: bool = False


def ends_of(curves: Sequence[Body]) -> tuple[float, float]:
    """Where the cylinder begins and ends, a little beyond the rods; without rods somewhere."""
    if not curves:
        return 0.0, 5.0
    beyond = max(curve.a for curve in curves) + 0.3 * max(curve.R for curve in curves)
    return min(curve.z.min() for curve in curves) - beyond, max(curve.z.max() for curve in curves) + beyond


def view_of(curves: Sequence[Body], ends: tuple[float, float], room: tuple[int, int], lying: bool) -> View:
    """The camera that faces the rods' mean azimuth, as near as the room of a cell (in pixels) allows.

    It looks from a little above, so that the end of the cylinder is seen; the axis goes up the page, or lying to
    its right.
    """
    out, axis = _front(curves), np.array([0.0, 0.0, 1.0])
    toward = np.cos(ABOVE) * out + np.sin(ABOVE) * axis
    if lying:
        toward = toward + np.tan(ABOVE) * np.cross(out, axis)
    toward /= np.linalg.norm(toward)
    flat = axis - toward * (toward @ axis)
    flat /= np.linalg.norm(flat)
    up = np.cross(toward, flat) if lying else flat
    page = np.array([np.cross(up, toward), up])
    reach = max((curve.reach for curve in curves), default=1.0)
    around = np.linspace(0, 2 * np.pi, 73)
    rims = [np.stack([reach * np.cos(around), reach * np.sin(around), np.full(73, z)], axis=-1) for z in ends]
    seen = np.concatenate(rims) @ page.T
    low, high = seen.min(axis=0), seen.max(axis=0)
    width, height = (high - low) * 1.05 + 0.1 * reach
    per_unit = min(room[0] / width, room[1] / height)
    size = (max(int(width * per_unit), min(LEAST_CELL, room[0])), int(height * per_unit))
    return View(toward, up, (low + high) / 2 @ page, per_unit, size)


def side_view(curves: Sequence[Body], ends: tuple[float, float], per_unit: float, size: tuple[int, int]) -> View:
    """The camera that sees the axis in its true length, going to the right; it looks along x or along y."""
    front, axis = _front(curves), np.array([0.0, 0.0, 1.0])
    out = np.sign(front) * (np.abs(front) == np.abs(front).max())
    return View(out, np.cross(out, axis), sum(ends) / 2 * axis, per_unit, size)


def _front(curves: Sequence[Body]) -> Array:
    """From the axis to where the rods are."""
    mean = np.mean([np.exp(1j * curve.alpha).mean() for curve in curves] or [1.0])
    azimuth = np.angle(mean) if abs(mean) > 0.05 else 0.0  # a rod that goes all around has no front
    return np.array([np.cos(azimuth), np.sin(azimuth), 0.0])


def photograph(
    shots: Sequence[Sequence[Shot]], ends: tuple[float, float], view: View, pixel_error: float, label: int
) -> tuple[NDArray[np.uint8], float]:
    """All cells in one picture, (height, width, 3), each with room for its label below, `label` pixels high.

    Returns with it by how many pixels the drawn surface may be off; `pixel_error` where the stations allow it. Taken a
    few columns at a time, as what the ambient shading holds of a picture is ten times its size.
    """
    columns, high = len(shots[0]), len(shots) * (view.size[1] + label)
    at_once = max(MOST_PIXELS // (FINER**2 * high * view.size[0]), 1)
    parts = [[row[j : j + at_once] for row in shots] for j in range(0, columns, at_once)]
    reach = max((body.reach for row in shots for shot in row for body in shot.bodies), default=1.0)
    taken = [_taken(part, ends, view, reach, pixel_error, label) for part in parts]
    return np.concatenate([pixels for pixels, _ in taken], axis=1), max(off for _, off in taken)


def _taken(
    shots: Sequence[Sequence[Shot]], ends: tuple[float, float], view: View, reach: float, pixel_error: float, label: int
) -> tuple[NDArray[np.uint8], float]:
    """Some cells in one picture: one scene with one camera.

    The projection is parallel, so rods that stand apart on the page look as if each were seen alone.
    """
    pitch = np.array([view.size[0], view.size[1] + label])
    width, height = (int(n) for n in pitch * (len(shots[0]), len(shots)))
    if not any(shot.bodies for row in shots for shot in row):
        return np.full((height, width, 3), 255, dtype=np.uint8), 0.0
    # one cell alone may be too large, as in prints; its pixels are small enough then
    finer = FINER if FINER**2 * width * height <= MOST_PIXELS else 1
    plotter: Any = pv.Plotter(off_screen=True, window_size=[finer * width, finer * height], lighting="none")
    off = 0.0
    try:
        plotter.ren_win.SetMultiSamples(0)  # each pixel is a mean anyway
        plotter.set_background("white")
        for light in _lights():
            plotter.add_light(light)
        for i, row in enumerate(shots):
            for j, shot in enumerate(row):
                if shot.bodies:
                    steps = np.array([j - (len(row) - 1) / 2, (len(shots) - 1) / 2 - i]) * pitch
                    steps[1] += label / 2
                    off = max(off, _place(plotter, shot, ends, steps / view.per_unit @ view.page, view, pixel_error))
        # Near, as the ambient shading holds distances from the camera in half precision: far away it would band.
        away = 1.1 * (reach + (np.ptp(ends) / 2 if abs(view.toward[2]) > 1e-9 else 0.0))
        plotter.camera_position = [view.focus + away * view.toward, view.focus, view.up]
        plotter.enable_parallel_projection()
        plotter.camera.parallel_scale = height / view.per_unit / 2
        plotter.renderer.ResetCameraClippingRange()
        plotter.enable_ssao(radius=0.5 * reach, bias=0.02 * reach, kernel_size=32, blur=True)
        fine = np.asarray(plotter.screenshot(return_img=True))[..., :3]
    finally:
        plotter.close()
    sums = np.zeros((height, width, 3), dtype=np.uint16)
    for i, j in np.ndindex(finer, finer):
        sums += fine[i::finer, j::finer]
    return (sums // finer**2).astype(np.uint8), off


def _place(plotter: Any, shot: Shot, ends: tuple[float, float], where: Array, view: View, pixel_error: float) -> float:
    """The rods and their cylinder, turned about the axis and then moved; by how many pixels the rods may be off."""
    looks = {"ambient": 0.2, "diffuse": 0.85, "smooth_shading": False, "show_scalar_bar": False, "render": False}

    def add(mesh: pv.PolyData, **how: Any) -> None:
        turned = mesh.rotate_z(np.degrees(shot.turned), transform_all_input_vectors=True)
        plotter.add_mesh(turned.translate(where), interpolation="Phong", **{**looks, **how})

    off = 0.0
    for body in shot.bodies:
        drawn = body.detail(pixel_error / view.per_unit, BLUR / view.per_unit)
        off = max(off, drawn.off * view.per_unit)
        for mesh, how in painted(body, tube.mesh(body, drawn)):
            add(mesh, specular=0.35, specular_power=25, **how)
    low, high = ends
    first = shot.bodies[0]
    wall = pv.Cylinder(
        center=(0, 0, (low + high) / 2), direction=(0, 0, 1), radius=first.R, height=high - low, resolution=180,
        capping=False,
    ).compute_normals(cell_normals=False)  # fmt: skip
    if first.side == "inside":  # cut open: the near half of the wall is hardly there
        add(wall, color=style.SURFACE, culling="front")
        add(wall, color=style.SOFT, culling="back", opacity=0.12)
    else:
        add(wall, color=style.SURFACE, opacity=GLASS if shot.clear else 1.0)
    for z in ends:
        end = pv.Disc(center=(0, 0, z), inner=0, outer=first.R, normal=(0, 0, 1), c_res=180)
        if first.side == "outside":
            add(end, color=style.SURFACE)
        add(end.extract_feature_edges(), color=style.SOFT, line_width=FINER * 1.2, lighting=False)
    return off


def painted(body: Body, mesh: tube.Mesh) -> list[tuple[pv.PolyData, dict[str, Any]]]:
    """The tube as VTK has it, in one part or with its stripe in two, each with how it is coloured."""
    paint = body.paint

    def part(chosen: Any) -> pv.PolyData:
        found = pv.PolyData(mesh.points, faces=np.insert(mesh.triangles[chosen], 0, 3, axis=1).ravel())
        found.point_data.active_normals = mesh.normals
        return found

    if paint.stripe:
        return [(part(~mesh.striped), {"color": paint.colour}), (part(mesh.striped), {"color": paint.stripe})]
    if mesh.values is None:
        return [(part(slice(None)), {"color": paint.colour})]
    whole = part(slice(None))
    whole.point_data["value"] = mesh.values
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
