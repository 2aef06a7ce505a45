"""Rods on their cylinders before a camera: geometry to pixels, with VTK. Needs OpenGL, see `opengl`."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from ..figures import colours
from . import hidden, sampling, surfaces
from .camera import Camera
from .views import View

COLOUR_PIXELS = 2  # between rings; on shorter intervals colours need not be true
THIN = 6.0  # pixels of thickness, below which hidden stretches have no outline
# Lights fixed to the camera: azimuth and elevation in degrees, intensity. The first is at the camera: nothing that is
# seen is black.
LIGHTS = ((0, 0, 0.3), (-28, 25, 0.32))
LOOK = {"ambient": 0.42, "diffuse": 1.0, "smooth_shading": False, "show_scalar_bar": False, "render": False}


@dataclass(frozen=True, eq=False)
class Placed:
    """A view, and where the middle of its box is in the picture, (x, y) in pixels from the lower left."""

    view: View
    middle: tuple[float, float]


def render(
    placed: Sequence[Placed],
    camera: Camera,
    size: tuple[int, int],
    pixel_error: float,
    transparent: bool = False,
    line: float = 1.0,
    samples: int = sampling.FINER,
) -> tuple[NDArray[np.uint8], float, bool]:
    """Render all views into one picture.

    Parameters
    ----------
    size
        Width and height in pixels.
    transparent
        The picture has no background: a fourth channel holds how much of each pixel is covered.
    line
        Width of lines in pixels.
    samples
        Along each side of a pixel.

    Returns
    -------
    tuple
        The pixels, (height, width, 3 or 4); the error of the drawn surface in pixels: at most `pixel_error` where the
        stations allow it; whether hidden stretches are drawn in outline, as they are where they are thick enough.
    """
    drawn = [one for one in placed if one.view.bodies]
    background = np.full((size[1], size[0], 4), 255, dtype=np.uint8)
    if not drawn:
        background[..., 3] = 0
        return background if transparent else background[..., :3], 0.0, False
    block = sampling.block_for(size, samples)
    plotter: Any = pv.Plotter(off_screen=True, window_size=[block * n for n in size], lighting="none")
    try:
        plotter.ren_win.SetMultiSamples(0)  # each pixel is a mean anyway
        plotter.set_background("white")
        for light in _lights():
            plotter.add_light(light)
        walls: list[Any] = []
        made: dict[Any, _Made] = {}  # the same rods may be seen from two sides
        for one in drawn:
            view = one.view
            same = (*view.bodies, view.cylinder)
            if same not in made:
                made[same] = _make(view, camera.per_unit, pixel_error)
            walls += _place(plotter, one, made[same], camera, size, line * block)
        depth = _set_camera(plotter, drawn, camera, size)
        outline = _draw(drawn, camera, depth, block, line)
        window = sampling.Window(plotter, size, block, samples)
        pixels, alpha, outlined = sampling.mean(window, walls, outline, transparent)
    finally:
        plotter.close()
    error = max(one.error for one in made.values())
    return (np.concatenate([pixels, alpha], axis=-1) if transparent else pixels), error, outlined


def _draw(placed: Sequence[Placed], camera: Camera, depth: float, block: int, line: float) -> hidden.Drawn | None:
    """How the hidden stretches are drawn; None where nothing is hidden, or too thin for an outline."""
    bodies = [(one.view, body) for one in placed for body in one.view.bodies]
    thick = max(2 * body.a for _, body in bodies) * camera.per_unit
    if thick < THIN or not any(view.hides(body, camera) for view, body in bodies):
        return None
    edge = 0.6 * min(body.a for _, body in bodies)
    return hidden.Drawn(edge / depth, 0.7 * edge * camera.per_unit * block, max(line * block, 1.0))


def _set_camera(plotter: Any, placed: Sequence[Placed], camera: Camera, size: tuple[int, int]) -> float:
    """Set up the camera before the placed views; returns the depth that it sees [length]."""
    deep = 0.0
    for one in placed:
        half = one.view.reach + np.ptp(one.view.cylinder) / 2 * abs(camera.toward[2])
        deep = max(deep, half)
    deep *= 1.1
    plotter.camera_position = [2 * deep * camera.toward, (0, 0, 0), camera.up]
    plotter.enable_parallel_projection()
    plotter.camera.parallel_scale = size[1] / camera.per_unit / 2
    plotter.camera.SetClippingRange(deep, 3 * deep)
    return float(2 * deep)


@dataclass(frozen=True, eq=False)
class _Made:
    """The surfaces of a view before it is turned, and the error of the rods' in pixels."""

    tubes: list[surfaces.Part]
    wall: surfaces.Part
    error: float


def _make(view: View, per_unit: float, pixel_error: float) -> _Made:
    """The surfaces of a view drawn at that many pixels per length."""
    tubes, error = [], 0.0
    for body in view.bodies:
        rings = body.rings(pixel_error / per_unit, COLOUR_PIXELS / per_unit)
        error = max(error, rings.error * per_unit)
        tubes += surfaces.tube_parts(body, body.surface(rings))
    return _Made(tubes, surfaces.wall(view.bodies, view.cylinder, per_unit), error)


def _place(plotter: Any, placed: Placed, made: _Made, camera: Camera, size: tuple[int, int], line: float) -> list[Any]:
    """Add the rods and their cylinder, turned about the axis and then moved; returns what hides stretches of them."""
    view = placed.view
    ends, first = view.cylinder, view.bodies[0]
    low, high = view.box(camera)
    where = ((np.array(placed.middle) - np.array(size) / 2) / camera.per_unit - (low + high) / 2) @ camera.page
    where = where - camera.toward * (camera.toward[2] * sum(ends) / 2)
    turn = view.turn

    def add(part: surfaces.Part, **options: Any) -> Any:
        mesh = pv.PolyData(part.points @ turn.T + where, faces=np.insert(part.triangles, 0, 3, axis=1).ravel())
        mesh.point_data.active_normals = part.normals @ turn.T
        mesh.active_texture_coordinates = part.at
        return plotter.add_mesh(mesh, texture=_texture(part.texture), interpolation="Phong", **(LOOK | options))

    def rim(z: float) -> Any:
        beyond = 0.5 / camera.per_unit * (1 if z == ends[1] else -1)  # before the edge of the wall
        circle = surfaces.rim(first.R, z + beyond) @ turn.T + where
        return plotter.add_mesh(pv.lines_from_points(circle), color=colours.SOFT, line_width=line, lighting=False,
                                render=False)  # fmt: skip

    for part in made.tubes:
        add(part, culling="back", specular=0.22, specular_power=30)
    inside = first.side == "inside"
    walls = [add(made.wall, culling="front" if inside else "back", specular=0.0)]  # inside: the near half is cut away
    walls += [rim(z) for z in ends]
    if not inside:
        walls += [add(surfaces.disc(first.R, z, z == ends[1]), specular=0.0, ambient=0.75) for z in ends]
    return [] if inside else walls


def _texture(picture: NDArray[np.uint8]) -> Any:
    """A texture whose first row is at the coordinate 0."""
    image = pv.ImageData(dimensions=(picture.shape[1], picture.shape[0], 1))
    image.point_data["colour"] = picture.reshape(-1, 3)
    found = pv.Texture(image)
    found.interpolate, found.repeat, found.mipmap = True, False, False
    return found


def _lights() -> list[pv.Light]:
    found = []
    for azimuth, elevation, intensity in LIGHTS:
        around, above = np.radians([azimuth, elevation])
        light = pv.Light(light_type="camera light", intensity=intensity)
        light.position = np.sin(around) * np.cos(above), np.sin(above), np.cos(around) * np.cos(above)
        found.append(light)
    return found
