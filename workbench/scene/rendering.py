"""Rods on their cylinders before a camera: geometry to pixels, with VTK. Needs OpenGL, see `opengl`.

Each pixel is the mean of samples, which are rendered a few at a time. Stretches of a rod behind its cylinder are drawn
in outline, as in a technical drawing, and not in a paler colour, because a pale blue means a small push.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyvista as pv
from matplotlib.colors import to_rgb
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt, find_objects, maximum_filter, maximum_filter1d

from ..figures import colours
from ..geometry.tube_tolerance import MOST_TRIANGLES
from . import dna_strands, surfaces
from .views import Camera, View

COLOUR_PIXELS = 2  # between rings; on shorter intervals colours need not be true
ALL_TRIANGLES = 8_000_000  # of a picture, in equal shares for its rods or lines: they take some 3 GB
THIN = 6.0  # pixels of thickness, below which hidden stretches have no outline
# an edge between two stretches is a step of depth so many times that between two samples at the limb of one.
# x10: turns that touch have no edge, or dashes where their step is about as large
LIMB = 1.1
# Lights fixed to the camera: azimuth and elevation in degrees, intensity. The first is at the camera: nothing that is
# seen is black.
LIGHTS = ((0, 0, 0.3), (-28, 25, 0.32))
LOOK = {"ambient": 0.42, "diffuse": 1.0, "render": False}
FINER = 4  # a pixel has 4 x 4 places; every second has a sample, as on a chessboard, so each row and column has two
AT_ONCE = 5_000_000  # pixels of a picture, up to which 2 x 2 samples of each are rendered at once


@dataclass(frozen=True, eq=False)
class Placed:
    """A view, and where the middle of its box is in the picture, (x, y) in pixels from the lower left."""

    view: View
    middle: tuple[float, float]


@dataclass(frozen=True)
class Drawn:
    """How hidden stretches are drawn.

    Attributes
    ----------
    edge
        The step of depth that is an edge between two stretches; all depths together are 1.
    sliver
        The width in samples of what is left out, such as the lower side of a rod beyond the horizon of the cylinder.
    line
        The width of the outline in samples.
    """

    edge: float
    sliver: float
    line: float


def render(
    placed: Sequence[Placed],
    camera: Camera,
    size: tuple[int, int],
    pixel_error: float,
    transparent: bool = False,
    line: float = 1.0,
    samples: int = FINER,
    background: str = "#ffffff",
) -> tuple[NDArray[np.uint8], bool]:
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
    background
        ``#rrggbb``; that of a transparent picture is white.

    Returns
    -------
    tuple
        The pixels, (height, width, 3 or 4); whether hidden stretches are drawn in outline, as they are where they are
        thick enough.
    """
    drawn = [cell for cell in placed if cell.view.bodies]
    if not drawn:
        blank = np.full((size[1], size[0], 4), (*colours.rgb(background), 0), dtype=np.uint8)
        return blank[..., : 4 if transparent else 3], False
    block = min(samples, 2 if size[0] * size[1] <= AT_ONCE else 1)
    plotter: Any = pv.Plotter(off_screen=True, window_size=[block * n for n in size], lighting="none")
    try:
        plotter.ren_win.SetMultiSamples(0)  # each pixel is a mean anyway
        plotter.set_background("white" if transparent else background)
        for azimuth, elevation, intensity in LIGHTS:
            light = pv.Light(light_type="camera light", intensity=intensity)
            around, above = np.radians([azimuth, elevation])
            light.position = np.sin(around) * np.cos(above), np.sin(above), np.cos(around) * np.cos(above)
            plotter.add_light(light)
        walls: list[Any] = []
        most = min(MOST_TRIANGLES, ALL_TRIANGLES // sum(len(cell.view.bodies) for cell in drawn))
        meshes: dict[Any, tuple[list[surfaces.Part], surfaces.Part]] = {}  # the same rods may be seen from two sides
        for cell in drawn:
            view = cell.view
            same = (*view.bodies, view.cylinder)
            if same not in meshes:
                meshes[same] = _make(view, camera.per_unit, pixel_error, most)
            walls += _place(plotter, cell, *meshes[same], camera, size, line * block)
        depth = _set_camera(plotter, drawn, camera, size)
        outline = _draw(drawn, camera, depth, block, line)
        return _mean(plotter, block, samples, walls, outline, transparent)
    finally:
        plotter.close()


def _draw(placed: Sequence[Placed], camera: Camera, depth: float, block: int, line: float) -> Drawn | None:
    """How outlines are drawn; None of rods too thin for them, or in strands, whose outlines are a tangle."""
    bodies = [body for cell in placed for body in cell.view.bodies]
    if max(2 * body.a for body in bodies) * camera.per_unit < THIN or any(body.paint.strands for body in bodies):
        return None
    a, samples = min(body.a for body in bodies), camera.per_unit * block
    return Drawn(edge_between(a, samples) / depth, 0.42 * a * samples, max(line * block, 1.0))


def edge_between(a: float, samples: float) -> float:
    """The step of depth that is an edge between two stretches of rods of a radius [length]; samples: in a length."""
    return float(min(0.6 * a, LIMB * (2 * a / samples) ** 0.5))


def _set_camera(plotter: Any, placed: Sequence[Placed], camera: Camera, size: tuple[int, int]) -> float:
    """Set up the camera before the placed views; returns the depth that it sees [length]."""
    tilt = abs(camera.toward[2])
    deep = 1.1 * max(cell.view.reach + np.ptp(cell.view.cylinder) / 2 * tilt for cell in placed)
    plotter.camera_position = [2 * deep * camera.toward, (0, 0, 0), camera.up]
    plotter.enable_parallel_projection()
    plotter.camera.parallel_scale = size[1] / camera.per_unit / 2
    plotter.camera.SetClippingRange(deep, 3 * deep)
    return float(2 * deep)


def _make(view: View, per_unit: float, pixel_error: float, most: int) -> tuple[list[surfaces.Part], surfaces.Part]:
    """The rods of a view and their wall before they are turned, at that many pixels per length.

    most: triangles of a rod.
    """
    tubes = []
    for body in view.bodies:
        if body.paint.strands:
            tubes += dna_strands.parts(body)
            continue
        tubes += surfaces.tube_parts(body, body.rings(pixel_error / per_unit, COLOUR_PIXELS / per_unit, most))
    return tubes, surfaces.wall(view.bodies, view.cylinder, per_unit)


def _place(
    plotter: Any,
    placed: Placed,
    tubes: list[surfaces.Part],
    wall: surfaces.Part,
    camera: Camera,
    size: tuple[int, int],
    line: float,
) -> list[Any]:
    """Add the rods and their cylinder, turned about the axis and then moved; returns the parts of this."""
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
        return plotter.add_mesh(
            pv.lines_from_points(circle), color=colours.SOFT, line_width=line, lighting=False, render=False
        )

    for part in tubes:
        add(part, culling="back", specular=0.22, specular_power=30)
    inside = first.side == "inside"
    walls = [add(wall, culling="front" if inside else "back", specular=0.0)]  # inside: the near half is cut away
    walls += [rim(z) for z in ends]
    if not inside:
        ambient = LOOK["ambient"] if camera.is_end_view else 0.75  # an end that faces the lights would be white
        walls += [add(surfaces.disc(first.R, z, z == ends[1]), specular=0.0, ambient=ambient) for z in ends]
    return walls


def _texture(picture: NDArray[np.uint8]) -> Any:
    """A texture whose first row is at the coordinate 0."""
    image = pv.ImageData(dimensions=(picture.shape[1], picture.shape[0], 1))
    image.point_data["colour"] = picture.reshape(-1, 3)
    texture = pv.Texture(image)
    texture.interpolate, texture.repeat, texture.mipmap = True, False, False
    return texture


def outlines(
    rods: NDArray[np.float32], everything: NDArray[np.float32], drawn: Drawn
) -> tuple[NDArray[np.bool_], NDArray[np.bool_], NDArray[np.bool_]]:
    """The samples on the outline of rods in sight, on that of hidden ones, and all samples of hidden ones.

    rods, everything: depths of a picture of the rods alone and of the whole picture, (height, width), 1 where nothing
    is.
    """
    line, dashed, behind = (np.zeros(rods.shape, dtype=bool) for _ in range(3))
    size = int(drawn.sliver) + 1
    for box in find_objects((rods < 1).astype(np.uint8)):  # one, or none without rods
        part = tuple(slice(max(edge.start - size - 1, 0), edge.stop + size + 1) for edge in box)
        depth = rods[part]
        deepest = np.maximum(*(maximum_filter1d(depth, 3, axis=axis) for axis in (0, 1)))
        edges = deepest - depth > drawn.edge  # a background, which has depth 1, is deeper too
        hidden = (depth < 1) & (everything[part] < depth - 1e-4)
        behind[part] = _without_slivers(hidden, drawn.sliver / 2) & (depth < 1)
        for seen, into in ((depth < 1) & ~hidden, line), (behind[part], dashed):
            into[part] = maximum_filter(edges & seen, max(round(drawn.line), 1)) & seen
    return line, dashed, behind


def _without_slivers(mask: NDArray[np.bool_], radius: float) -> NDArray[np.bool_]:
    """A mask without what is thinner than discs of a radius in samples; right angles stay as they are."""
    middles = distance_transform_edt(np.pad(mask, 1))[1:-1, 1:-1] > radius
    return mask & (distance_transform_edt(~middles) <= 1.5 * radius) if middles.any() else middles


def _draw_outlines(
    pixels: NDArray[np.float32], line: NDArray[np.float32], dashed: NDArray[np.float32], behind: NDArray[np.float32]
) -> None:
    """Draw what `outlines` returns; each is the share of a pixel, (height, width)."""
    share = (colours.EDGE_LINE * line + colours.HIDDEN_LINE * dashed)[..., None]
    pixels *= (1 - colours.HIDDEN_SHADE * behind[..., None]) * (1 - share)
    pixels += np.float32(255) * np.array(to_rgb(colours.OUTLINE), dtype=np.float32) * share


def _mean(
    plotter: Any, block: int, samples: int, walls: Sequence[Any], drawn: Drawn | None, transparent: bool
) -> tuple[NDArray[np.uint8], bool]:
    """The mean of all samples of each pixel, (height, width, 3 or 4); whether an outline of a hidden stretch is drawn.

    block: how many samples of each pixel along each direction are rendered at once, of so many in all. walls: what
    hides stretches of the rods. drawn: how these are drawn; default: not at all.
    """
    window, steps = plotter.ren_win, samples // block
    wide, high = window.GetSize()
    sums = np.zeros((high // block, wide // block, 3), dtype=np.uint16)
    covered = np.zeros_like(sums[..., :1])
    lines = np.zeros((3, *sums.shape[:2]), dtype=np.uint8)

    def add(values: NDArray[Any], into: NDArray[Any]) -> None:
        for i, j in np.ndindex(block, block):
            into += values[i::block, j::block]

    moves = [place for place in np.ndindex(steps, steps) if sum(place) % 2 == 0]
    for k, (i, j) in enumerate(moves):
        right, up = (i + 0.5) / steps - 0.5, (j + 0.5) / steps - 0.5
        plotter.camera.SetWindowCenter(2 * right / wide, 2 * up / high)
        if k == 0 and drawn:
            rods = _render_walls_last(plotter, walls)
            for part, into in zip(outlines(rods, _depths(window), drawn), lines, strict=True):
                add(part, into)
        else:
            window.Render()
        shades = pv.convert_array(np.zeros(1, dtype=np.uint8))
        window.GetPixelData(0, 0, wide - 1, high - 1, 0, shades, 0)
        add(np.asarray(pv.convert_array(shades)).reshape(high, wide, 3), sums)
        if transparent:
            add((_depths(window) < 1)[..., None], covered)
    count = len(moves) * block**2
    pixels = sums * np.float32(1 / count)
    if drawn:
        _draw_outlines(pixels, *(lines / block**2).astype(np.float32))
    if transparent:  # what is seen beside white in a pixel
        share = np.maximum(covered, 1) / count
        pixels = np.where(covered > 0, (pixels - 255 * (1 - share)) / share, 255)
        pixels = np.concatenate([pixels, np.rint(covered * (255 / count))], axis=-1)
    return (np.clip(pixels, 0, 255) + np.float32(0.5)).astype(np.uint8)[::-1], bool(lines[1].any())


def _depths(window: Any) -> NDArray[np.float32]:
    """The depths of what was rendered, from 0 at the camera to 1 where nothing is, (height, width) in samples."""
    wide, high = window.GetSize()
    buffer = pv.convert_array(np.zeros(1, dtype=np.float32))
    window.GetZbufferData(0, 0, wide - 1, high - 1, buffer)
    return np.asarray(pv.convert_array(buffer)).reshape(high, wide)


def _render_walls_last(plotter: Any, walls: Sequence[Any]) -> NDArray[np.float32]:
    """Render everything, the walls last; returns the depths without the walls."""
    rods = [actor for actor in plotter.actors.values() if actor not in walls]
    _show(walls, False)
    plotter.ren_win.Render()
    depths = _depths(plotter.ren_win)
    _show(walls, True)
    _show(rods, False)
    plotter.renderer.SetErase(False)
    plotter.ren_win.Render()
    plotter.renderer.SetErase(True)
    _show(rods, True)
    return depths


def _show(actors: Sequence[Any], shown: bool) -> None:
    for actor in actors:
        actor.SetVisibility(shown)
