"""A rod drawn as DNA: two strands about its centreline, base pairs between them, marks at its ends and its middle.

The centreline and the rotation of its material are computed. The helix of the strands is drawn: `PAIRS` base pairs a
turn, `RISE` apart, turned with the material; the rod itself is a solid bar.
"""

from collections.abc import Sequence

import numpy as np

from solver.problem import units
from solver.problem.errors import InputError

from ..geometry import tube
from ..geometry.centreline import Array, Centreline
from .body import Body
from .scene_kinds import PAIRS, RISE
from .surfaces import Part, plain_texture

GROOVE = np.radians(150.0)  # between the two strands about the centreline
STRAND, BAR = 0.2, 0.07  # radii of a strand and of a base pair, in radii of the rod
RINGS, SIDES, BAR_SIDES = 42, 20, 10  # rings of a strand in one turn of the helix; sides of strands and of base pairs
LIT = 0.72  # on the texture of a colour: nearly full light
LEADER = 1.5  # radii of the rod: the words stay before the cylinder
MOST = 3000  # base pairs


def rise_of(line: Centreline) -> float:
    """The distance of base pairs in the unit of length of a rod."""
    return RISE * units.LENGTHS["nm"] / units.LENGTHS[line.unit]


def parts(body: Body) -> list[Part]:
    """The two strands and the base pairs of a rod.

    Raises `InputError` for a rod that is longer than `MOST` base pairs, or shorter than one.
    """
    colours, (low, high), rise = body.paint.strands, body.span, rise_of(body.line)
    count = pairs_of(body)
    s = np.linspace(low, high, max(int(RINGS * (high - low) / (PAIRS * rise)), 2))
    drawn = [_tube(_strand(body, s, side), body.places(s), STRAND * body.a, colours[side]) for side in (0, 1)]
    middles = low + (np.arange(count) + 0.5) * (high - low) / count
    ends = [_strand(body, middles, side) for side in (0, 1)]
    bars = [_bar(first, last, BAR * body.a) for first, last in zip(*ends, strict=True)]
    return [*drawn, _together(bars, colours[2])]


def pairs_of(body: Body) -> int:
    """How many base pairs a rod has. Raises `InputError` as `parts` does."""
    count = round((body.span[1] - body.span[0]) / rise_of(body.line))
    if not 1 <= count <= MOST:
        raise InputError(
            f"a rod of length {body.line.L:.4g} {body.line.unit} has {count} base pairs of {RISE} nm; the kind "
            f"double-helix draws 1 to {MOST}"
        )
    return count


def marks(body: Body) -> list[tuple[Array, str]]:
    """A line from the first base pair, the middle one and the last one to its words, (2, 3), with them.

    Those of the ends lead along the axis away from the rod.
    """
    at = np.array([body.span[0], sum(body.span) / 2, body.span[1]])
    feet, out = body.places(at), body.line.frame(at)[2]
    up = np.array([0.0, 0.0, np.sign(feet[2, 2] - feet[0, 2]) or 1.0])
    words = "base pair 1", "dyad" if body.whole else "middle", f"base pair {pairs_of(body)}"
    leaders = np.stack([feet, feet + LEADER * body.a * np.stack([-up, out[1], up])], axis=1)
    return list(zip(leaders, words, strict=True))


def _strand(body: Body, s: Array, side: int) -> Array:
    """The axis of one strand at s, (k, 3): the helix turns right-handed along the rod, on top of its material."""
    _, along, out, _ = body.line.frame(s)
    rolled = body.stripe_angle()
    material = np.zeros(s.size) if rolled is None else -rolled(s)
    angle = material + 2 * np.pi * (s - body.span[0]) / (PAIRS * rise_of(body.line)) + side * GROOVE
    across = np.cross(along, out)
    radius = (1 - STRAND) * body.a
    return body.places(s) + radius * (np.cos(angle)[:, None] * out + np.sin(angle)[:, None] * across)


def _tube(axis: Array, about: Array, radius: float, colour: str) -> Part:
    """A tube about the axis of a strand, (n, 3), which turns about a centreline, (n, 3)."""
    along = np.gradient(axis, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    out = axis - about
    out -= along * np.sum(out * along, axis=1, keepdims=True)
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    return _part(tube.mesh((axis, along, out, np.cross(out, along)), radius, SIDES), colour)


def _bar(first: Array, last: Array, radius: float) -> tube.Mesh:
    """A straight bar between two places."""
    along = (last - first) / np.linalg.norm(last - first)
    aside = np.cross(along, np.eye(3)[np.argmin(np.abs(along))])
    out = aside / np.linalg.norm(aside)
    twice = [np.tile(each, (2, 1)) for each in (along, out, np.cross(out, along))]
    return tube.mesh((np.stack([first, last]), twice[0], twice[1], twice[2]), radius, BAR_SIDES)


def _together(meshes: Sequence[tube.Mesh], colour: str) -> Part:
    """One surface of several."""
    starts = np.cumsum([0, *(len(mesh.points) for mesh in meshes[:-1])])
    triangles = np.concatenate([mesh.triangles + start for mesh, start in zip(meshes, starts, strict=True)])
    points, normals = (np.concatenate([getattr(mesh, name) for mesh in meshes]) for name in ("points", "normals"))
    return _part(tube.Mesh(points, normals, triangles), colour)


def _part(mesh: tube.Mesh, colour: str) -> Part:
    at = np.full((len(mesh.points), 2), (0.5, LIT))
    return Part(mesh.points, mesh.normals, mesh.triangles, plain_texture(colour), at)
