"""The surfaces of a scene with the colours on them: triangles and textures. NumPy only.

A texture holds the colour of a value from left to right and the light from black to full upward, so a surface has the
exact colour of its value at each pixel, also where that jumps.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.colors import to_rgb
from numpy.typing import NDArray

from ..figures.colours import SURFACE
from ..geometry.centreline import Array
from . import shading
from .body import Body, Surface
from .paint import Paint

FACETS = 180  # of a cylinder
WALL_PIXELS = 4.0  # between points of the wall at which its light is computed
MOST_WALL = 1000  # of these points along each direction
COLUMNS = 8192  # of a texture: between a push and a pull of a thousandth of the scale no colours are mixed


@dataclass(frozen=True, eq=False)
class Part:
    """A surface: points and normals, (n, 3); triangles (m, 3); texture (rows, columns, 3); places on it, (n, 2)."""

    points: Array
    normals: Array
    triangles: NDArray[np.int64]
    texture: NDArray[np.uint8]
    at: Array


def tube_parts(body: Body, surface: Surface) -> list[Part]:
    """The tube in one part, or with its stripe in two."""
    mesh, paint = surface.mesh, body.paint
    up = _row(surface.light)
    if paint.stripe:
        at = np.stack([np.full(up.size, 0.5), up], axis=-1)
        halves = ((~surface.striped, paint.colour), (surface.striped, paint.stripe))
        return [Part(mesh.points, mesh.normals, mesh.triangles[some], one(colour), at) for some, colour in halves]
    across = np.full(up.size, 0.5) if surface.values is None else place_on(paint, surface.values)
    texture = one(paint.colour) if surface.values is None else texture_of(paint)
    return [Part(mesh.points, mesh.normals, mesh.triangles, texture, np.stack([across, up], axis=-1))]


def wall(bodies: Sequence[Body], ends: tuple[float, float], per_unit: float) -> Part:
    """The wall of a cylinder with the shadows of the rods that touch it."""
    R = bodies[0].R
    around = int(np.clip(2 * np.pi * R * per_unit / WALL_PIXELS, 32, MOST_WALL))
    along = int(np.clip((ends[1] - ends[0]) * per_unit / WALL_PIXELS, 4, MOST_WALL))
    angle, z = np.linspace(0, 2 * np.pi, around), np.linspace(*ends, along)
    grid = np.stack(np.broadcast_arrays(R * np.cos(angle), R * np.sin(angle), z[:, None]), axis=-1)
    light = np.ones((along, around))
    for body in bodies:
        s = np.linspace(*body.span, int(np.clip(4 * (body.span[1] - body.span[0]) / body.a, 2, 400_000)))
        found = shading.on_wall(grid.reshape(-1, 3), body.places(s), body.a)
        light = np.minimum(light, found.reshape(light.shape))
    texture = np.round(255 * np.array(to_rgb(SURFACE)) * light[..., None]).astype(np.uint8)
    turn = np.linspace(0, 2 * np.pi, FACETS + 1)
    out = np.stack([np.cos(turn), np.sin(turn), np.zeros(turn.size)], axis=-1)
    points = np.concatenate([R * out + [0, 0, height] for height in ends])
    share = (turn / (2 * np.pi) * (around - 1) + 0.5) / around  # the middles of the first and the last texel
    at = np.concatenate([np.stack([share, np.full(turn.size, v)], axis=-1) for v in (0.5 / along, 1 - 0.5 / along)])
    k = np.arange(FACETS)
    low, high = np.stack([k, k + 1, k + FACETS + 2], axis=-1), np.stack([k, k + FACETS + 2, k + FACETS + 1], axis=-1)
    return Part(points, np.concatenate([out, out]), np.concatenate([low, high]), texture, at)


def disc(R: float, z: float, top: bool) -> Part:
    """An end of a cylinder."""
    turn = np.linspace(0, 2 * np.pi, FACETS, endpoint=False)
    ring = np.stack([R * np.cos(turn), R * np.sin(turn), np.full(FACETS, z)], axis=-1)
    points = np.concatenate([ring, [[0.0, 0.0, z]]])
    k, ahead = np.arange(FACETS), np.roll(np.arange(FACETS), -1)
    triangles = np.stack([k, ahead, np.full(FACETS, FACETS)] if top else [ahead, k, np.full(FACETS, FACETS)], axis=-1)
    normals = np.broadcast_to([0.0, 0.0, 1.0 if top else -1.0], points.shape)
    return Part(points, normals, triangles, one(SURFACE), np.full((points.shape[0], 2), 0.75))


def rim(R: float, z: float) -> Array:
    """The circle at an end of a cylinder, (n, 3)."""
    turn = np.linspace(0, 2 * np.pi, FACETS + 1)
    return np.stack([R * np.cos(turn), R * np.sin(turn), np.full(turn.size, z)], axis=-1)


def texture_of(paint: Paint, columns: int = COLUMNS) -> NDArray[np.uint8]:
    """The colours of a scale from left to right; black below, full light above."""
    assert paint.ramp is not None
    row = np.round(255 * np.asarray(paint.ramp((np.arange(columns) + 0.5) / columns))[:, :3])
    return np.stack([0 * row, row]).astype(np.uint8)


def place_on(paint: Paint, values: Array) -> Array:
    """Where on its texture a value has its colour."""
    return np.clip((values - paint.low) / ((paint.high - paint.low) or 1.0), 0.0, 1.0)


def one(colour: str) -> NDArray[np.uint8]:
    """The texture of one colour."""
    row = np.round(255 * np.array([to_rgb(colour)] * 2))
    return np.stack([0 * row, row]).astype(np.uint8)


def _row(light: Array) -> Array:
    """Where on a texture of two rows the light is: between the middles of both."""
    return 0.25 + 0.5 * light
