"""The axes x, y and z as the camera of a scene sees them."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from numpy.typing import NDArray

from ..data import labels
from ..figures import style
from . import measure
from .drawing import SMALL, Block, circle, line, pixels, spot, text

TRIAD = 46.0  # an arrow of the axes
FLAT = 0.08  # an axis that is seen shorter points along the sight; all of it is 1


def triad(axes: NDArray[np.float64]) -> Block:
    """The axes x, y, z as the camera sees them: an arrow each, as short as it is seen, or a circle along the sight.

    The circle has a dot for an axis that points at the viewer and a cross for one that points away. Where x and y are
    slanted, and so lie in one line, the azimuth from which the camera looks is said beside them.
    """
    low, high = np.minimum(axes.min(axis=0), 0), np.maximum(axes.max(axis=0), 0)
    size = TRIAD * (high - low) + 30
    toward = np.cross(axes[:, 0], axes[:, 1])
    words = slant(toward)

    def draw(fig: Figure, x: float, y: float) -> None:
        origin = np.array([x, y]) + 15 - TRIAD * low + [0, (max(size[1], 86.0) - size[1]) / 2]
        along = int(np.argmax(np.abs(toward)))
        for k, (name, way) in enumerate(zip("xyz", axes, strict=True)):
            seen = float(np.hypot(*way))
            over = seen > FLAT and any(_along(way, other) and np.hypot(*other) > seen for other in axes)
            if seen > FLAT:
                line(fig, origin, origin + TRIAD * way, color=style.INK, linewidth=1.4)
                (_tick if over else _head)(fig, origin + TRIAD * way, way / seen)
            side = way / max(seen, 0.3) if seen > FLAT else 1.4 * _free_side(axes)
            if over:
                side = 1.3 * np.array([-way[1], way[0]]) / seen  # beside the longer arrow over it
            place = origin + TRIAD * way * (seen > FLAT) + (13 if k != along else 14) * side
            text(fig, place[0], place[1], name, ha="center", va="center", **SMALL)
        if np.hypot(*axes[along]) <= FLAT:
            _along_sight(fig, origin, toward[along] > 0)
        else:
            fig.add_artist(circle(fig, origin[0], origin[1], 3.5, facecolor=style.INK, linewidth=0))
        if words:
            text(fig, x + size[0] + 14, y + max(size[1], 86.0) / 2, words, color=style.SOFT, va="center", **SMALL)

    wide = 14 + measure.width(words, style.SMALL) if words else 0.0
    return Block(float(size[0]) + wide, float(max(size[1], 86.0)), draw)


def _along(one: NDArray[np.float64], other: NDArray[np.float64]) -> bool:
    """Whether two arrows lie over each other."""
    return bool(one @ other > 0.95 * np.hypot(*one) * np.hypot(*other))


def slant(toward: NDArray[np.float64]) -> str:
    """From where the camera looks, where it looks across the axis z but neither along x nor along y; else nothing.

    toward: the direction to the viewer, (3,).
    """
    if abs(toward[2]) > 1e-9 or np.abs(toward[:2]).min() <= FLAT:
        return ""
    return seen_from(toward).replace("from ", "from\n")


def seen_from(toward: NDArray[np.float64]) -> str:
    """From which azimuth the camera looks; toward: the direction to the viewer, (3,)."""
    azimuth = labels.minus_signs(f"{np.degrees(np.arctan2(toward[1], toward[0])):.0f}")
    return f"seen from \N{GREEK SMALL LETTER ALPHA} = {azimuth}°"


def _head(fig: Figure, tip: NDArray[np.float64], way: NDArray[np.float64]) -> None:
    """The head of an arrow; way: its direction, of length 1."""
    across = np.array([-way[1], way[0]])
    corners = [tip + 5 * way, tip - 6 * way + 5 * across, tip - 6 * way - 5 * across]
    fig.add_artist(Polygon(corners, transform=pixels(fig), facecolor=style.INK, linewidth=0))


def _tick(fig: Figure, tip: NDArray[np.float64], way: NDArray[np.float64]) -> None:
    """The end of an arrow that lies over a longer one: a stroke across it, on the side of its letter."""
    line(fig, tip, tip + 7 * np.array([-way[1], way[0]]), color=style.INK, linewidth=1.4)


def _along_sight(fig: Figure, middle: NDArray[np.float64], at_viewer: bool) -> None:
    """A circle with a dot for an arrow that points at the viewer, with a cross for one that points away."""
    fig.add_artist(circle(fig, middle[0], middle[1], 9.0, facecolor="white", edgecolor=style.INK, linewidth=1.2,
                           zorder=3))  # fmt: skip
    if at_viewer:
        spot(fig, middle[0], middle[1], 3.5, style.INK)
        return
    for up in (-1, 1):
        arm = 9.0 * np.sqrt(0.5) * np.array([1, up])
        line(fig, middle - arm, middle + arm, color=style.INK, linewidth=1.2, zorder=4)


def _free_side(axes: NDArray[np.float64]) -> NDArray[np.float64]:
    """The direction on the page that is farthest from the axes, for the letter of one that points at the viewer."""
    away = -axes.sum(axis=0)
    return away / max(float(np.hypot(*away)), 0.3)
