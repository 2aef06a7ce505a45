"""The rod on its cylinder in three dimensions: off-screen pictures of a stored dataset, never solving.

The tube has the rod's true radius and touches the surface; where the cylinder would have to pull to hold it
there, it has a second colour. All views are parallel projections, so one scale bar is right everywhere.
Needs OpenGL: ask `gl.probe` first, as without it VTK ends the process.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyvista as pv
import xarray as xr
from numpy.typing import NDArray

from solver.errors import InputError

from . import picking, sheet, style, tube
from .dataset import axes_of
from .sheet import Cell, Sheet
from .tube import Array, Curve

KINDS = (".png", ".jpg")
FINER = 2  # each pixel is the mean of 2 x 2
ABOVE = 0.3  # rad from which the camera looks down
LYING = 1.3  # how much taller than wide a scene is laid on its side
MOST_CELLS = 9
AT_ONCE = 3  # columns of cells
LEAST_CELL = 190  # pixels of width, for the label
PAGE, ROW = (1600, 1200), (2000, 1100)  # pixels of a sheet with one case, and at most of one with a row
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
    """What stands in a cell: a rod, or why there is none; turned about the axis by an angle."""

    curve: Curve | None
    cell: Cell
    turned: float = 0.0


def render(ds: xr.Dataset, path: str | Path, at: Mapping[str, float] | None = None) -> Path:
    """Draw one case large, seen from its front and from its side.

    at: values of axes; the nearest stored case is drawn, at the study's base where an axis is left out. Raises
    `InputError` for an axis or value that is not there, and for a case without a shape.
    """
    path = _checked(path)
    where = picking.case(ds, at)
    curve = tube.read(ds, where)
    chosen = ", ".join(_told(ds, name, i) for name, i in where.items())
    if curve is None:
        outcome = str(ds["outcome"].isel(where).values)
        raise InputError(f"nothing to draw{f' at {chosen}' if chosen else ''}: {outcome}")
    lying = np.ptp(_ends([curve])) > LYING * 2 * curve.reach
    front = Shot(curve, Cell("facing the rod"))
    side = Shot(curve, Cell("turned by 90° about the axis"), -np.pi / 2)
    _save(ds, path, [[front], [side]] if lying else [[front, side]], chosen, PAGE, lying)
    return path


def render_row(
    ds: xr.Dataset, path: str | Path, axis: str, at: Mapping[str, float] | None = None, most: int = MOST_CELLS
) -> Path:
    """Draw the cases along an axis side by side, at one scale and with one camera.

    at: values of the other axes, the study's base where left out. most: how many cells at most, evenly chosen.
    A case without a shape leaves an empty cell that says why. Raises `InputError`.
    """
    path = _checked(path)
    cases = picking.spread(picking.line(ds, axis, at), most)
    shots = []
    for where in cases:
        curve, why = _try(ds, where)
        shots.append(Shot(curve, Cell(style.shown(float(ds[axis].values[where[axis]]), ds[axis]), why)))
    others = [_told(ds, name, i) for name, i in cases[0].items() if name != axis]
    _save(ds, path, [shots], ", ".join([style.axis_label(axis, ds[axis]), *others]), ROW, False)
    return path


def draw(ds: xr.Dataset, path: str | Path) -> dict[str, Path]:
    """The scenes of a study, name -> file: a row along each axis, or the one case large. Raises `InputError`.

    path: of the file; with several axes each row's file has the axis's name appended.
    """
    path = Path(path)
    axes = axes_of(ds)
    if not axes:
        return {"scene": render(ds, path)}
    files = {axis: path.with_stem(f"{path.stem}_{axis}") if len(axes) > 1 else path for axis in axes}
    return {f"scene {axis}": render_row(ds, file, axis) for axis, file in files.items()}


def _try(ds: xr.Dataset, where: dict[str, int]) -> tuple[Curve | None, str]:
    """The curve, or why there is none."""
    try:
        curve = tube.read(ds, where)
    except InputError as error:
        return None, str(error)
    return curve, "" if curve else str(ds["outcome"].isel(where).values)


def _ends(curves: Sequence[Curve]) -> tuple[float, float]:
    """Where the cylinder begins and ends, a little beyond the rods; without rods somewhere."""
    if not curves:
        return 0.0, 5.0
    beyond = max(curve.a for curve in curves) + 0.3 * max(curve.R for curve in curves)
    return min(curve.z.min() for curve in curves) - beyond, max(curve.z.max() for curve in curves) + beyond


def _view(curves: Sequence[Curve], ends: tuple[float, float], room: tuple[int, int], lying: bool) -> View:
    """The camera that faces the rods' mean azimuth, as near as the room of a cell (in pixels) allows.

    It looks from a little above, so that the end of the cylinder is seen; the axis goes up the page, or lying to
    its right.
    """
    mean = np.mean([np.exp(1j * curve.alpha).mean() for curve in curves] or [1.0])
    azimuth = np.angle(mean) if abs(mean) > 0.05 else 0.0  # a rod that goes all around has no front
    out, axis = np.array([np.cos(azimuth), np.sin(azimuth), 0.0]), np.array([0.0, 0.0, 1.0])
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


def photograph(shots: Sequence[Sequence[Shot]], ends: tuple[float, float], view: View) -> NDArray[np.uint8]:
    """All cells in one picture, (height, width, 3), each with room for its label below.

    Taken a few columns at a time, as what the ambient shading holds of a picture is ten times its size.
    """
    columns = len(shots[0])
    parts = [[row[j : j + AT_ONCE] for row in shots] for j in range(0, columns, AT_ONCE)]
    reach = max((shot.curve.reach for row in shots for shot in row if shot.curve), default=1.0)
    return np.concatenate([_taken(part, ends, view, reach) for part in parts], axis=1)


def _taken(shots: Sequence[Sequence[Shot]], ends: tuple[float, float], view: View, reach: float) -> NDArray[np.uint8]:
    """Some cells in one picture: one scene with one camera.

    The projection is parallel, so rods that stand apart on the page look as if each were seen alone.
    """
    pitch = np.array([view.size[0], view.size[1] + sheet.LABEL])
    width, height = (int(n) for n in pitch * (len(shots[0]), len(shots)))
    if not any(shot.curve for row in shots for shot in row):
        return np.full((height, width, 3), 255, dtype=np.uint8)
    plotter: Any = pv.Plotter(off_screen=True, window_size=[FINER * width, FINER * height], lighting="none")
    try:
        plotter.ren_win.SetMultiSamples(0)  # each pixel is a mean anyway
        plotter.set_background("white")
        for light in _lights():
            plotter.add_light(light)
        for i, row in enumerate(shots):
            for j, shot in enumerate(row):
                if shot.curve:
                    steps = np.array([j - (len(row) - 1) / 2, (len(shots) - 1) / 2 - i]) * pitch
                    steps[1] += sheet.LABEL / 2
                    _place(plotter, shot, ends, steps / view.per_unit @ view.page)
        # Near, as the ambient shading holds distances from the camera in half precision: far away it would band.
        away = 1.1 * (reach + (ends[1] - ends[0]) / 2)
        plotter.camera_position = [view.focus + away * view.toward, view.focus, view.up]
        plotter.enable_parallel_projection()
        plotter.camera.parallel_scale = height / view.per_unit / 2
        plotter.renderer.ResetCameraClippingRange()
        plotter.enable_ssao(radius=0.5 * reach, bias=0.02 * reach, kernel_size=32, blur=True)
        fine = np.asarray(plotter.screenshot(return_img=True))[..., :3]
    finally:
        plotter.close()
    sums = np.zeros((height, width, 3), dtype=np.uint16)
    for i, j in np.ndindex(FINER, FINER):
        sums += fine[i::FINER, j::FINER]
    return (sums // FINER**2).astype(np.uint8)


def _place(plotter: Any, shot: Shot, ends: tuple[float, float], where: Array) -> None:
    """The rod and the cylinder, turned about the axis and then moved."""
    curve = shot.curve
    assert curve is not None
    looks = {"ambient": 0.2, "diffuse": 0.85, "smooth_shading": False, "show_scalar_bar": False, "render": False}

    def add(mesh: pv.PolyData, **how: Any) -> None:
        turned = mesh.rotate_z(np.degrees(shot.turned), transform_all_input_vectors=True)
        plotter.add_mesh(turned.translate(where), interpolation="Phong", **{**looks, **how})

    for mesh, colour in rod(curve):
        add(mesh, color=colour, specular=0.35, specular_power=25)
    low, high = ends
    wall = pv.Cylinder(
        center=(0, 0, (low + high) / 2), direction=(0, 0, 1), radius=curve.R, height=high - low, resolution=180,
        capping=False,
    ).compute_normals(cell_normals=False)  # fmt: skip
    if curve.side == "inside":  # cut open: the near half of the wall is hardly there
        add(wall, color=style.SURFACE, culling="front")
        add(wall, color=style.SOFT, culling="back", opacity=0.12)
    else:
        add(wall, color=style.SURFACE)
    for z in ends:
        end = pv.Disc(center=(0, 0, z), inner=0, outer=curve.R, normal=(0, 0, 1), c_res=180)
        if curve.side == "outside":
            add(end, color=style.SURFACE)
        add(end.extract_feature_edges(), color=style.SOFT, line_width=FINER * 1.2, lighting=False)


def rod(curve: Curve) -> list[tuple[pv.PolyData, str]]:
    """The tube in two parts, each with its colour: where the cylinder pushes, and where it would have to pull."""
    sides = 28 if curve.s.size < 3000 else 16
    points, normals, triangles, held = tube.mesh(curve, sides)
    parts = []
    for colour, chosen in ((style.PUSHED, held), (style.LIFTED, ~held)):
        if chosen.any():
            part = pv.PolyData(points, faces=np.insert(triangles[chosen], 0, 3, axis=1).ravel())
            part.point_data.active_normals = normals
            parts.append((part, colour))
    return parts


def _lights() -> list[pv.Light]:
    found = []
    for azimuth, elevation, intensity in LIGHTS:
        around, above = np.radians([azimuth, elevation])
        light = pv.Light(light_type="camera light", intensity=intensity)
        light.position = np.sin(around) * np.cos(above), np.sin(above), np.cos(around) * np.cos(above)
        found.append(light)
    return found


def _save(
    ds: xr.Dataset, path: Path, shots: Sequence[Sequence[Shot]], chosen: str, page: tuple[int, int], lying: bool
) -> None:
    """Photograph the shots and write the sheet; page: its width and height in pixels, at most."""
    curves = [shot.curve for row in shots for shot in row if shot.curve]
    ends = _ends(curves)
    room = page[0] - 2 * sheet.MARGIN, page[1] - sheet.HEAD - sheet.FOOT
    view = _view(curves, ends, (room[0] // len(shots[0]), room[1] // len(shots) - sheet.LABEL), lying)
    pixels = photograph(shots, ends, view)
    inside = "inside the cylinder, cut open" if ds.attrs["side"] == "inside" else ""
    subtitle = " · ".join(fact for fact in (chosen, style.reading(ds), inside) if fact)
    unit = str(ds.attrs["length_unit"])
    cells = [[shot.cell for shot in row] for row in shots]
    least = page if page == PAGE else (1300, 0)
    drawn = Sheet(
        str(ds.attrs["title"]), subtitle, pixels, cells, view.per_unit, unit, view.page.T, _legend(curves),
        _notes(curves, unit), least,
    )  # fmt: skip
    sheet.figure(drawn).savefig(path, dpi=style.DPI)


def _legend(curves: Sequence[Curve]) -> list[tuple[str, str]]:
    if not curves:
        return []
    if not all(np.isfinite(curve.push).all() for curve in curves):
        return [(style.PUSHED, "the rod (where it would lift off is not stored)")]
    return [(style.PUSHED, "the cylinder pushes"), (style.LIFTED, "it would have to pull: the rod would lift off")]


def _notes(curves: Sequence[Curve], unit: str) -> list[str]:
    notes = []
    part = [curve for curve in curves if not curve.whole]
    if part:
        shown, L = style.number(part[0].shown), style.number(part[0].L)
        notes.append(f"only the first {shown} {unit} of {L} {unit} are drawn")
    if any(curve.overlaps for curve in curves):
        notes.append("where turns cross, the equations let\nthe rod pass through itself")
    return notes


def _told(ds: xr.Dataset, name: str, index: int) -> str:
    return f"{style.symbol(name)} = {style.shown(float(ds[name].values[index]), ds[name])}"


def _checked(path: str | Path) -> Path:
    path = Path(path)
    style.picture_kind(path, KINDS)
    return path
