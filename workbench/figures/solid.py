"""Rods on their cylinder in three dimensions, drawn by Matplotlib alone: shaded faces, the farthest first.

A picture has a parallel projection from one side: `to_page` gives the places on the page in units of length.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from numpy.typing import NDArray

from solver.mechanics import frames

from ..geometry import tube
from . import colours

ELEVATION = np.radians(22.0)  # of the eye above the horizon
SIDES, STRIPS = 32, 60  # of a tube, of half a cylinder
LIGHT = np.array([-0.45, 0.55, 0.7])  # to the right, up, towards the eye
SHADE = 0.5  # brightness of a face that looks away from the light
VEIL = 0.86  # how much of a rod behind the cylinder is hidden

Values = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Eye:
    """From where a rod is seen. azimuth: of the eye about the axis; shift: of what is drawn, to the right [length]."""

    azimuth: float
    shift: float = 0.0

    def to_page(self, points: Any) -> Values:
        """Places on the page, (..., 2), of points in space (..., 3)."""
        return np.asarray(self.project(points)[..., :2] + [self.shift, 0.0])

    def project(self, points: Any) -> Values:
        """Points or directions as seen: to the right, up, towards the eye."""
        x, y, z = np.moveaxis(np.asarray(points, dtype=float), -1, 0)
        cos, sin = np.cos(self.azimuth), np.sin(self.azimuth)
        right, near = y * cos - x * sin, x * cos + y * sin
        up, out = np.cos(ELEVATION), np.sin(ELEVATION)
        return np.stack([right, z * up - near * out, z * out + near * up], axis=-1)


def rod(ax: Axes, eye: Eye, rod: Any, shades: Any, ends: tuple[float, float], R: float) -> None:
    """Draw a rod on the outside of its cylinder.

    Parameters
    ----------
    rod
        alpha, beta, z along the rod, rho and a, as of `drawn_rods.DrawnRod`.
    shades
        The colour of each station, (n, 3) between 0 and 1.
    ends
        The height at which the cylinder begins and ends [length].
    R
        The radius of the cylinder [length].
    """
    alpha = rod["alpha"]
    place = frames.position(rod.rho, alpha, rod["z"])
    frame = place, frames.tangent(alpha, rod["beta"]), frames.outward(alpha), frames.binormal(alpha, rod["beta"])
    points, normals = (part[: len(place) * SIDES].reshape(len(place), SIDES, 3)
                       for part in tube.surface(frame, rod.a, SIDES, sharp=False))  # fmt: skip
    ends_of = np.stack([place[:1], place[-1:]])[:, :, None].repeat(SIDES, axis=2)  # each end is closed by a disc
    rings = np.concatenate([ends_of[0], points, ends_of[1]])
    normals = np.concatenate([-frame[1][:1, None].repeat(SIDES, 1), normals[:-1], frame[1][-1:, None].repeat(SIDES, 1)])
    faces = np.stack([rings[:-1], np.roll(rings, -1, 1)[:-1], np.roll(rings, -1, 1)[1:], rings[1:]], axis=2)
    of = np.r_[0, : len(place) - 1, len(place) - 1]  # the station of each ring of faces
    behind = np.cos(alpha[of] - eye.azimuth) < 0
    base = np.asarray(shades)[of, None].repeat(SIDES, axis=1)
    for part, order in ((behind, 1.0), (~behind, 3.0)):
        _faces(ax, eye, faces[part], normals[part], base[part], order)
    _cylinder(ax, eye, R, ends)


def _faces(ax: Axes, eye: Eye, faces: Values, normals: Values, shades: Values, order: float) -> None:
    """Shaded faces, (..., 4, 3), the farthest first."""
    corners, seen = eye.project(faces.reshape(-1, 4, 3)), eye.project(normals.reshape(-1, 3))
    towards = seen[:, 2] > -0.05
    light = np.clip(seen @ (LIGHT / np.linalg.norm(LIGHT)), 0, 1)[:, None]
    shaded = np.clip(shades.reshape(-1, 3) * (SHADE + (1.08 - SHADE) * light) + 0.35 * light**24, 0, 1)
    first = np.argsort(corners[towards, :, 2].mean(axis=1))
    drawn = shaded[towards][first]
    ax.add_collection(PolyCollection(
        list(corners[towards][first][..., :2] + [eye.shift, 0.0]), facecolors=drawn, edgecolors=drawn, linewidths=0.25,
        zorder=order, rasterized=True))  # fmt: skip


def _cylinder(ax: Axes, eye: Eye, R: float, ends: tuple[float, float]) -> None:
    """The near half of the surface, over what lies behind it, and the flat end above."""
    angle = eye.azimuth + np.linspace(-np.pi / 2, np.pi / 2, STRIPS + 1)
    low, high = (ring(R, z, angle) for z in ends)
    light = np.clip(eye.project(frames.outward((angle[1:] + angle[:-1]) / 2)) @ LIGHT, 0, 1)[:, None]
    base = np.array(colours.rgb(colours.SURFACE)) / 255
    shades = np.clip(base * (0.8 + 0.22 * light), 0, 1)
    strips = np.stack([low[:-1], low[1:], high[1:], high[:-1]], axis=1)
    ax.add_collection(PolyCollection(list(eye.to_page(strips)), facecolors=shades, linewidths=0, antialiaseds=False,
                                     alpha=VEIL, zorder=2, rasterized=True))  # fmt: skip
    ax.fill(*eye.to_page(ring(R, ends[1])).T, facecolor=colours.CUT, edgecolor=colours.SOFT, linewidth=0.5, zorder=2.1)
    for side in (0, -1):
        ax.plot(*eye.to_page([low[side], high[side]]).T, color=colours.SOFT, linewidth=0.5, zorder=2.1)
    ax.plot(*eye.to_page(low).T, color=colours.SOFT, linewidth=0.5, zorder=2.1)


def ring(radius: float, z: float, angles: Any = None) -> Values:
    """Points of a circle about the axis, (n, 3)."""
    angles = np.linspace(0, 2 * np.pi, 121) if angles is None else np.asarray(angles)
    return np.stack([radius * np.cos(angles), radius * np.sin(angles), np.full(angles.shape, z)], axis=-1)
