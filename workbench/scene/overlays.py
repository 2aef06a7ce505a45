"""What is drawn over the first view: rings where a rod passes through itself, and the names of rods. No OpenGL.

Lengths are in pixels at `style.DPI`, from the upper left of the picture.
"""

from collections.abc import Sequence

import numpy as np

from ..geometry import self_contact
from ..geometry.centreline import Array
from . import marks
from .arrangement import EDGE, Box
from .camera import Camera
from .views import View


def rings(view: View, box: Box, camera: Camera, per_unit: float) -> list[tuple[float, float]]:
    """Where the rods of a view pass through themselves in sight: x and y of each place."""
    return [_on_page(view, box, camera, per_unit, camera.page @ place) for place in _seen(view, camera)]


def names(
    view: View, box: Box, camera: Camera, per_unit: float, texts: Sequence[str], size: tuple[float, float]
) -> list[tuple[float, float, str, str]]:
    """The names of the rods of a view beside them: left edge, middle line, text and colour of each."""
    curves, places = [], []
    for body in view.bodies:
        at = view.places(body)
        curve = np.array([_on_page(view, box, camera, per_unit, place) for place in at @ camera.page.T])
        seen = at[:, :2] @ camera.toward[:2] > 0
        curves.append(curve)
        places.append(curve[seen] if seen.any() else curve)
    found = marks.beside(places, texts, curves, size, view.bodies[0].a * per_unit)
    colour = [body.paint.colour for body in view.bodies]
    return [(x, y, text, c) for (x, y), text, c in zip(found, texts, colour, strict=True)]


def _seen(view: View, camera: Camera) -> list[Array]:
    """The places, (3,) each [length], where the rods pass through themselves and the cylinder does not hide it."""
    found = []
    across = np.cross(camera.toward, [0.0, 0.0, 1.0])
    for body in view.bodies:
        begins = body.line.at(np.array(body.span[:1]))[2][0]
        for place in self_contact.places(body.line, body.span):
            at = view.turn @ (place - [0, 0, begins])
            behind = at[:2] @ camera.toward[:2] < 0 and abs(across @ at) < body.R
            if not behind or body.side == "inside":
                found.append(at)
    return found


def _on_page(view: View, box: Box, camera: Camera, per_unit: float, place: Array) -> tuple[float, float]:
    """A place of a view, (2,) [length], in the picture."""
    low, high = view.box(camera)
    x, up = (place - (low + high) / 2) * per_unit
    return float(box.x + box.width / 2 + x), float(box.y + box.height - EDGE - (high - low)[1] / 2 * per_unit - up)
