"""Rods on their cylinders before a camera: geometry to pixels, with VTK. Needs OpenGL, see `opengl`."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from ..figures import style
from . import hidden, surfaces
from .camera import Camera
from .views import View

FINER = 4  # each pixel is the mean of 4 x 4 samples
COLOUR_PIXELS = 2  # between rings; on shorter intervals colours need not be true
THIN = 6.0  # pixels of thickness, below which hidden stretches have no outline
# Lights fixed to the camera: azimuth and elevation in degrees, intensity. The first is at the camera: nothing that is
# seen is black.
LIGHTS = ((0, 0, 0.34), (-40, 45, 0.28), (50, -10, 0.1))
LOOK = {"ambient": 0.4, "diffuse": 1.0, "smooth_shading": False, "show_scalar_bar": False, "render": False}


@dataclass(frozen=True, eq=False)
class Placed:
    """A view, and where the middle of its box is in the picture, (x, y) in pixels from the lower left."""

    view: View
    middle: tuple[float, float]


def render(
    placed: Sequence[Placed], camera: Camera, size: tuple[int, int], pixel_error: float, transparent: bool = False
) -> tuple[NDArray[np.uint8], float]:
    """Render all views into one picture.

    Parameters
    ----------
    size
        Width and height in pixels.
    transparent
        The picture has no background: a fourth channel holds how much of each pixel is covered.

    Returns
    -------
    tuple
        The pixels, (height, width, 3 or 4), and the error of the drawn surface in pixels: at most `pixel_error` where
        the stations allow it.
    """
    drawn = [one for one in placed if one.view.bodies]
    background = np.full((size[1], size[0], 4), 255, dtype=np.uint8)
    if not drawn:
        background[..., 3] = 0
        return background if transparent else background[..., :3], 0.0
    plotter: Any = pv.Plotter(off_screen=True, window_size=list(size), lighting="none")
    try:
        plotter.ren_win.SetMultiSamples(0)  # each pixel is a mean anyway
        plotter.set_background("white")
        for light in _lights():
            plotter.add_light(light)
        walls: list[Any] = []
        error = 0.0
        for one in drawn:
            made, off = _place(plotter, one, camera, size, pixel_error)
            walls, error = walls + made, max(error, off)
        depth = _set_camera(plotter, drawn, camera, size)
        thick = max(2 * body.a for one in drawn for body in one.view.bodies) * camera.per_unit
        pixels, alpha = _mean(
            plotter, walls if thick > THIN else [], depth, size, _edge(drawn), camera.per_unit, transparent
        )
    finally:
        plotter.close()
    return (np.concatenate([pixels, alpha], axis=-1) if transparent else pixels), error


def _mean(
    plotter: Any, walls: list[Any], depth: float, size: tuple[int, int], edge: float, per_unit: float, transparent: bool
) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """The mean of all samples of each pixel: colours, (height, width, 3), and what is covered, (height, width, 1)."""
    sums = np.zeros((size[1], size[0], 3), dtype=np.uint16)
    covered = np.zeros((size[1], size[0], 1), dtype=np.uint16)
    some: dict[int, NDArray[np.float32]] = {}  # four of the samples, which are enough for outlines
    for k in _samples(plotter, size):
        sums += _colours(plotter, size)
        wanted = k % (FINER * 2) < FINER and k % 2 == 0
        if wanted or transparent:
            z = _depths(plotter, size)
            covered += (z < 1)[..., None]
            some |= {k: z} if wanted else {}
    if walls:
        for actor in walls:
            actor.SetVisibility(False)
        lines, shadow = np.zeros((2, size[1], size[0]))
        for k in _samples(plotter, size, list(some)):
            line, behind = hidden.lines(_depths(plotter, size), some[k], edge / depth, 0.7 * edge * per_unit)
            lines += line / len(some)
            shadow += behind / len(some)
        pixels = hidden.drawn(sums / FINER**2, lines, shadow)
    else:
        pixels = sums / FINER**2
    if transparent:  # what is seen beside white in a pixel
        share = np.maximum(covered, 1) / FINER**2
        pixels = np.where(covered > 0, (pixels - 255 * (1 - share)) / share, 255)
    alpha = np.round(covered * (255 / FINER**2)).astype(np.uint8)
    return np.clip(np.round(pixels), 0, 255).astype(np.uint8)[::-1], alpha[::-1]


def _samples(plotter: Any, size: tuple[int, int], chosen: Sequence[int] | None = None) -> Iterator[int]:
    """Render the samples of all pixels one after the other: the picture moved by parts of a pixel."""
    for k in range(FINER**2) if chosen is None else chosen:
        i, j = ((n + 0.5) / FINER - 0.5 for n in divmod(k, FINER))
        plotter.camera.SetWindowCenter(2 * i / size[0], 2 * j / size[1])
        plotter.ren_win.Render()
        yield k


def _colours(plotter: Any, size: tuple[int, int]) -> NDArray[np.uint8]:
    found = pv.convert_array(np.zeros(1, dtype=np.uint8))
    plotter.ren_win.GetPixelData(0, 0, size[0] - 1, size[1] - 1, 0, found, 0)
    return np.asarray(pv.convert_array(found)).reshape(size[1], size[0], 3)


def _depths(plotter: Any, size: tuple[int, int]) -> NDArray[np.float32]:
    found = pv.convert_array(np.zeros(1, dtype=np.float32))
    plotter.ren_win.GetZbufferData(0, 0, size[0] - 1, size[1] - 1, found)
    return np.asarray(pv.convert_array(found)).reshape(size[1], size[0])


def _edge(placed: Sequence[Placed]) -> float:
    """The step of depth that is drawn as an edge of a hidden rod [length]."""
    return 0.6 * min(body.a for one in placed for body in one.view.bodies)


def _set_camera(plotter: Any, placed: Sequence[Placed], camera: Camera, size: tuple[int, int]) -> float:
    """Set up the camera before the placed views; returns the depth that it sees [length]."""
    deep = 0.0
    for one in placed:
        deep = max(deep, one.view.reach + np.ptp(one.view.cylinder) / 2 * abs(camera.toward[2]))
    deep *= 1.1
    plotter.camera_position = [2 * deep * camera.toward, (0, 0, 0), camera.up]
    plotter.enable_parallel_projection()
    plotter.camera.parallel_scale = size[1] / camera.per_unit / 2
    plotter.camera.SetClippingRange(deep, 3 * deep)
    return float(2 * deep)


def _place(
    plotter: Any, placed: Placed, camera: Camera, size: tuple[int, int], pixel_error: float
) -> tuple[list[Any], float]:
    """Add the rods and their cylinder, turned about the axis and then moved.

    Returns what hides stretches of the rods, and the rods' error in pixels.
    """
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
        return plotter.add_mesh(mesh, texture=_texture(part.texture), interpolation="Phong", **LOOK, **options)

    def rim(z: float) -> Any:
        beyond = 0.5 / camera.per_unit * (1 if z == ends[1] else -1)  # before the edge of the wall
        circle = surfaces.rim(first.R, z + beyond) @ turn.T + where
        return plotter.add_mesh(pv.lines_from_points(circle), color=style.SOFT, line_width=1.3, lighting=False,
                                render=False)  # fmt: skip

    error = 0.0
    for body in view.bodies:
        rings = body.rings(pixel_error / camera.per_unit, COLOUR_PIXELS / camera.per_unit)
        error = max(error, rings.error * camera.per_unit)
        for part in surfaces.tube_parts(body, body.surface(rings)):
            add(part, culling="back", specular=0.22, specular_power=30)
    inside = first.side == "inside"
    wall = surfaces.wall(view.bodies, ends, camera.per_unit)
    walls = [add(wall, culling="front" if inside else "back", specular=0.0)]  # inside: the near half is cut away
    walls += [rim(z) for z in ends]
    if not inside:
        walls += [add(surfaces.disc(first.R, z, z == ends[1]), specular=0.0) for z in ends]
    return [] if inside else walls, error


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
