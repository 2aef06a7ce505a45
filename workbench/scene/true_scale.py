"""What a picture with a compressed axis hides: a part of the rod at true scale, and the rod seen along the hole.

Both stand below the view. Lengths on the page are in inches, to the right and down.
"""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Rectangle
from numpy.typing import NDArray

from ..figures import colours, fonts
from ..figures.views_on_paper import end_view
from ..words import labels
from .body import Body
from .long_rod import UPRIGHT
from .signs import EYE, draw_eye, draw_scale
from .views import Camera, View

HIGH = 1.2  # inches of all of it
STRIP = 0.24  # inches of the cylinder in the part at true scale
HOLE = 0.3  # inches, the radius of the cylinder seen along its axis
APART = 0.3  # inches between the two
WORDS, BAR = 0.1, 0.2  # inches from one of them to the words below it, and from there to the bar of the scale

Values = NDArray[np.float64]


def is_needed(views: list[View]) -> bool:
    """Whether a picture shows one view, of one rod whose axis is compressed."""
    bodies = [body for view in views for body in view.bodies]
    return len(views) == len(bodies) == 1 and bodies[0].squeeze < 1


def draw(ax: Axes, view: View, camera: Camera, corner: tuple[float, float], wide: float, unit: str) -> None:
    """Draw both; corner: the upper left; wide: inches; unit: of length."""
    (body,) = view.bodies
    places = view.places(body) / [1, 1, body.squeeze]
    up = camera.page[int(abs(camera.page[0, 2]) > abs(camera.page[1, 2])), :2]  # on a page along which the axis runs
    up = up / np.linalg.norm(up)
    low_side = np.zeros(2) if camera.down is None else (view.turn @ camera.down)[:2]
    size = float(np.linalg.norm(low_side))
    x, middle = corner[0] + 2 * EYE + HOLE, corner[1] + HOLE
    hole_up = -low_side / size if size > UPRIGHT else up
    _draw_hole(ax, body, places, hole_up, (x, middle))
    words: dict[str, Any] = {"size": fonts.SMALL, "va": "top"}
    ax.text(corner[0], middle + HOLE + WORDS, "its end and its middle\nline, along the hole", **words)
    if camera.seen_from is not None:
        to_viewer = np.ravel(end_view(camera.toward[None], hole_up)) * [1, -1]
        to_viewer /= np.linalg.norm(to_viewer)
        draw_eye(ax, np.array([x, middle]) + (HOLE + EYE) * to_viewer, to_viewer)
    x += HOLE + APART
    low, high = map(labels.number, _draw_part(ax, body, places, up, (x, middle), corner[0] + wide - x))
    text, below = f"a part of it at true scale: z = {low} to {high} {unit}", middle + STRIP / 2 + WORDS
    ax.text(x, below, text, **words)
    beside = x + fonts.width_of(text, fonts.SMALL) + APART
    draw_scale(ax, beside, below + BAR, STRIP / (2 * body.R), unit, 1.0)


def _draw_hole(ax: Axes, body: Body, places: Values, up: Values, middle: tuple[float, float]) -> None:
    """Draw the end of the rod and the line of its middle, as one sees them who looks along z: all of the rod would fill
    the hole. up: a direction across the axis, (2,)."""
    scale = HOLE / body.R
    right, above = end_view(places, up)
    x, y = middle[0] + scale * right, middle[1] - scale * above
    ax.add_patch(Circle(middle, HOLE, facecolor=colours.SURFACE, edgecolor=colours.SOFT, linewidth=0.8))
    ax.add_patch(
        Circle((x[0], y[0]), body.a * scale, facecolor=colours.NEUTRAL, edgecolor="none", gid="end of the rod")
    )
    ax.plot(x, y, color=colours.INK, linewidth=0.8, gid="end view")


def _draw_part(
    ax: Axes, body: Body, places: Values, up: Values, left: tuple[float, float], wide: float
) -> tuple[float, float]:
    """Draw the middle part of the rod that has room; returns the heights between which it is [length]."""
    scale, z = STRIP / (2 * body.R), places[:, 2]
    middle, half = float(z.min() + z.max()) / 2, min(wide / scale, float(np.ptp(z))) / 2
    x, y = left[0] + scale * (z - middle + half), left[1] - scale * places[:, :2] @ up
    wall = Rectangle((left[0], left[1] - STRIP / 2), 2 * half * scale, STRIP, facecolor=colours.SURFACE,
                     edgecolor=colours.SOFT, linewidth=0.8, gid="at true scale")  # fmt: skip
    ax.add_patch(wall)
    band = ax.fill_between(x, y - body.a * scale, y + body.a * scale, color=colours.NEUTRAL, linewidth=0)
    band.set_clip_path(wall)  # also between stations
    return middle - half, middle + half
