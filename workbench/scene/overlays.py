"""What is drawn over views: rings where a rod passes through itself, and the names of rods. No OpenGL.

Lengths are in pixels at `style.DPI`, from the upper left of the picture.
"""

from collections.abc import Sequence

import numpy as np

from ..geometry.centreline import Array
from . import marks
from .arrangement import EDGE, Box
from .camera import Camera
from .views import View

SMALLEST, LARGEST = 6.0, 13.0  # radius of a ring
NEARER = 0.7  # of the distance of a name to any other rod it is at most from its own
RING = 0.75  # radius of a ring in radii of its rod


def rings(
    views: Sequence[tuple[View, Box]], camera: Camera, per_unit: float
) -> tuple[list[tuple[float, float]], float]:
    """Where the rods of views pass through themselves in sight: x and y of each place, and the radius of all rings.

    per_unit: pixels per length of a view that is not enlarged.
    """
    found, radius = [], LARGEST
    for view, box in views:
        seen, _ = view.crossings(camera)
        found += [_on_page(view, box, camera, per_unit, camera.page @ place) for place in seen]
        if seen:
            thinnest = RING * min(body.a for body in view.bodies) * per_unit
            radius = min(radius, max(thinnest, SMALLEST))
    return found, radius


def names(
    view: View, box: Box, camera: Camera, per_unit: float, texts: Sequence[str], size: tuple[float, float]
) -> list[tuple[float, float, str, str]]:
    """The names of the rods of a view beside them: left edge, middle line, text and colour of each.

    A name that would stand as near to another rod as to its own is left out; the legend has all of them.
    """
    curves, places = [], []
    for body in view.bodies:
        at = view.places(body)
        curve = np.array([_on_page(view, box, camera, per_unit, place) for place in at @ camera.page.T])
        seen = at[:, :2] @ camera.toward[:2] > 0
        curves.append(curve)
        places.append(curve[seen] if seen.any() else curve)
    found = marks.beside(places, texts, curves, size, view.bodies[0].a * per_unit)
    named = []
    for k, ((x, y), text, body) in enumerate(zip(found, texts, view.bodies, strict=True)):
        away = [marks.gap((x, y), text, curve) for curve in curves]
        if all(away[k] < NEARER * gap for j, gap in enumerate(away) if j != k):
            named.append((x, y, text, body.paint.colour))
    return named


def _on_page(view: View, box: Box, camera: Camera, per_unit: float, place: Array) -> tuple[float, float]:
    """A place of a view, (2,) [length], in the picture."""
    low, high = view.box(camera)
    x, up = (place - (low + high) / 2) * per_unit
    return float(box.x + box.width / 2 + x), float(box.y + box.height - EDGE - (high - low)[1] / 2 * per_unit - up)
