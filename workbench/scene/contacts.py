"""Where a rod passes through itself, as a picture shows it. No OpenGL."""

import numpy as np

from ..geometry import self_contact
from ..geometry.centreline import Array
from .camera import Camera
from .views import View


def seen(view: View, camera: Camera) -> list[Array]:
    """The places on the page, (2,) each [length], where the rods of a view pass through themselves in sight."""
    found = []
    for body in view.bodies:
        begins = body.line.at(np.array(body.span[:1]))[2][0]
        for place in self_contact.places(body.line, body.span):
            at = view.turn @ (place - [0, 0, begins])
            behind = at[:2] @ camera.toward[:2] < 0 and abs(np.cross(camera.toward, [0, 0, 1]) @ at) < body.R
            if not behind:
                found.append(camera.page @ at)
    return found
