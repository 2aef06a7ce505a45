"""The surfaces of a scene with their colours and light: triangles and textures. NumPy and SciPy only.

A texture holds the colour of a value from left to right and the light from black to full upward, so a surface has the
exact colour of its value at each pixel, also where that jumps. Contact is seen by its shadow: how much of the light
from all around reaches a surface is computed from the geometry and not from the pixels of a picture, so it has no
noise, no bands, and does not depend on the resolution.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.colors import to_rgb
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from solver.orbits import frames

from ..figures.colours import DEPTH, REACH, SURFACE, rgb
from ..geometry import tube
from ..geometry.centreline import Array
from ..geometry.tube_tolerance import Rings
from .body import STRIPE, Body
from .scene_kinds import OFF_WALL, PUSH_RAMP, Paint

APART = np.pi  # radii along the rod: nearer points are the same stretch
FACETS = 180  # of a cylinder
WALL_PIXELS = 4.0  # between points of the wall at which its light is computed
MOST_WALL = 1000  # of these points along each direction
COLUMNS = 8193  # of a texture: between a push and a pull of a thousandth of the scale no colours are mixed


@dataclass(frozen=True, eq=False)
class Part:
    """A surface: points and normals, (n, 3); triangles (m, 3); texture (rows, columns, 3); places on it, (n, 2)."""

    points: Array
    normals: Array
    triangles: NDArray[np.int64]
    texture: NDArray[np.uint8]
    at: Array


def tube_parts(body: Body, drawn: Rings) -> list[Part]:
    """The tube about a rod, closed at both ends, its corners on the true surface; with a stripe in two parts.

    drawn: its rings and sides.
    """
    s, sides, paint = drawn.s, drawn.sides, body.paint
    place, along, out, across = body.line.frame(s)
    if body.squeeze < 1:
        along = along * [1, 1, body.squeeze]
        along /= np.linalg.norm(along, axis=-1, keepdims=True)
        across = np.cross(along, out) * np.sign(np.sum(np.cross(along, out) * across, axis=-1, keepdims=True))
    turned = body.stripe_angle()
    angle = np.zeros(s.size) if turned is None else turned(s)
    mesh = tube.mesh((body.places(s), along, out, across), body.a, sides, angle)
    normals = mesh.normals[: s.size * sides].reshape(s.size, sides, 3)
    light = light_on_tube(s, place, normals, out, body.a, body.side == "inside")
    ends = [np.append(light[k], light[k].mean()) for k in (0, -1)]
    up = 0.25 + 0.5 * np.concatenate([light.ravel(), *ends])  # between the middles of the two rows of a texture
    values = np.full(up.size, 0.5) if paint.ramp is None else place_on(paint, tube.at_points(body.value(s), sides))
    colours = [plain_texture(paint.colour) if paint.ramp is None else texture_of(paint)]
    triangles = [mesh.triangles]
    if paint.stripe:
        side = np.arange(sides)
        painted = np.tile(np.repeat((side + sides // (2 * STRIPE)) % sides < sides // STRIPE, 2), s.size - 1)
        striped = np.concatenate([painted, np.zeros(2 * sides, dtype=bool)])
        triangles = [mesh.triangles[~striped], mesh.triangles[striped]]
        colours.append(plain_texture(paint.stripe))
    at = np.stack([values, up], axis=-1)
    return [Part(mesh.points, mesh.normals, *part, at) for part in zip(triangles, colours, strict=True)]


def wall(bodies: Sequence[Body], ends: tuple[float, float], per_unit: float) -> Part:
    """The wall of a cylinder with the shadows of the rods that touch it."""
    R = bodies[0].R
    around = int(np.clip(2 * np.pi * R * per_unit / WALL_PIXELS, 32, MOST_WALL))
    along = int(np.clip((ends[1] - ends[0]) * per_unit / WALL_PIXELS, 4, MOST_WALL))
    angle, z = np.linspace(0, 2 * np.pi, around), np.linspace(*ends, along)
    grid = frames.position(R, angle, z[:, None])
    light = np.ones((along, around))
    for body in bodies:
        s = np.linspace(*body.span, int(np.clip(4 * (body.span[1] - body.span[0]) / body.a, 2, 400_000)))
        shaded = light_on_wall(grid.reshape(-1, 3), body.places(s), body.a)
        light = np.minimum(light, shaded.reshape(light.shape))
    texture = np.round(255 * np.array(to_rgb(SURFACE)) * light[..., None]).astype(np.uint8)
    turn = np.linspace(0, 2 * np.pi, FACETS + 1)
    out = frames.outward(turn)
    points = np.concatenate([rim(R, height) for height in ends])
    share = (turn / (2 * np.pi) * (around - 1) + 0.5) / around  # the middles of the first and the last texel
    at = np.concatenate([np.stack([share, np.full(turn.size, v)], axis=-1) for v in (0.5 / along, 1 - 0.5 / along)])
    k = np.arange(FACETS)
    low, high = np.stack([k, k + 1, k + FACETS + 2], axis=-1), np.stack([k, k + FACETS + 2, k + FACETS + 1], axis=-1)
    return Part(points, np.concatenate([out, out]), np.concatenate([low, high]), texture, at)


def disc(R: float, z: float, top: bool) -> Part:
    """An end of a cylinder."""
    points = np.concatenate([rim(R, z)[:-1], [[0.0, 0.0, z]]])
    k, ahead = np.arange(FACETS), np.roll(np.arange(FACETS), -1)
    triangles = np.stack([k, ahead, np.full(FACETS, FACETS)] if top else [ahead, k, np.full(FACETS, FACETS)], axis=-1)
    normals = np.broadcast_to([0.0, 0.0, 1.0 if top else -1.0], points.shape)
    return Part(points, normals, triangles, plain_texture(SURFACE), np.full((points.shape[0], 2), 0.75))


def rim(R: float, z: float) -> Array:
    """The circle at an end of a cylinder, closed, (`FACETS` + 1, 3)."""
    return frames.position(R, np.linspace(0, 2 * np.pi, FACETS + 1), np.asarray(z))


def texture_of(paint: Paint) -> NDArray[np.uint8]:
    """The colours of a scale from left to right, black below, full light above; no push has a colour of its own."""
    assert paint.ramp is not None
    row = np.round(255 * np.asarray(paint.ramp((np.arange(COLUMNS) + 0.5) / COLUMNS))[:, :3])
    if paint.ramp is PUSH_RAMP:
        row[COLUMNS // 2] = rgb(OFF_WALL)
    return np.stack([0 * row, row]).astype(np.uint8)


def place_on(paint: Paint, values: Array) -> Array:
    """Where on its texture a value has its colour."""
    return np.clip((values - paint.low) / ((paint.high - paint.low) or 1.0), 0.0, 1.0)


def plain_texture(colour: str) -> NDArray[np.uint8]:
    """The texture of one colour."""
    row = np.round(255 * np.array([to_rgb(colour)] * 2))
    return np.stack([0 * row, row]).astype(np.uint8)


def light_on_wall(points: Array, centreline: Array, a: float) -> Array:
    """The light on points of the wall, (n,) between 0 and 1, beside a rod of radius a that touches it.

    A round bar on a plane covers at a distance d from its line of contact all directions up to the angle 2 atan(a/d),
    which leaves d^2/(d^2 + a^2) of diffuse light. `centreline`, (m, 3), is dense.
    """
    away, _ = cKDTree(centreline).query(points, distance_upper_bound=REACH * a)
    flat = np.maximum(np.minimum(away, REACH * a) ** 2 - a**2, 0.0)  # squared distance from the line of contact
    light = flat / (flat + a**2)
    far = (REACH**2 - 1) / REACH**2
    return 1 - DEPTH * (1 - np.minimum(light / far, 1.0))


def light_on_tube(s: Array, place: Array, normals: Array, outward: Array, a: float, inside: bool) -> Array:
    """The light on the points of the rings of a rod, (rings, sides) between 0 and 1.

    Inside a cylinder the wall is cut open before the rod, so it takes no light.

    Parameters
    ----------
    s, place
        Arc length and centre of each ring, (rings,) and (rings, 3) [length].
    normals
        At the points, (rings, sides, 3).
    outward
        From the cylinder's axis, (rings, 3). The wall covers a half of all directions.
    inside
        Whether the rod is inside the cylinder.
    """
    covered = _by_other_stretches(s, place, normals, a)
    if not inside:
        covered += 0.5 * (0.5 - 0.5 * np.einsum("rsi,ri->rs", normals, outward))
    return 1 - DEPTH * np.clip(covered, 0.0, 1.0)


def _by_other_stretches(s: Array, place: Array, normals: Array, a: float) -> NDArray[np.float64]:
    """The share of all directions that other stretches of the rod cover, as spheres at every radius along them."""
    dense = np.linspace(s[0], s[-1], int(np.clip((s[-1] - s[0]) / a, 2, 200_000)) + 1)
    spheres = np.stack([np.interp(dense, s, coordinate) for coordinate in place.T], axis=-1)
    weight = (dense[1] - dense[0]) / (2 * a)  # two spheres stand for a stretch as long as they are wide
    near = cKDTree(place).sparse_distance_matrix(cKDTree(spheres), 3.5 * a, output_type="ndarray")
    ring, other = near["i"], near["j"]
    apart = np.abs(s[ring] - dense[other]) > APART * a
    ring, other = ring[apart], other[apart]
    covered = np.zeros(normals.shape[:2])
    if ring.size:
        toward = spheres[other][:, None] - place[ring][:, None] - a * normals[ring]
        away = np.maximum(np.linalg.norm(toward, axis=-1), a)
        facing = np.maximum(np.einsum("nsi,nsi->ns", toward, normals[ring]), 0.0) / away
        np.add.at(covered, ring, weight * facing * (a / away) ** 2)
    return covered
