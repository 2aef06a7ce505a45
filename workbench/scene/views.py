"""What a scene shows in the cells of its page, and how these stand in rows and columns. No OpenGL."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..figures import arrangement, fonts
from ..figures.arrangement import Arrangement
from ..geometry.centreline import Array
from . import long_rod
from .body import Body
from .camera import Camera, front_camera, views_of
from .captions import Cell

BELOW = 0.05  # inches from a view to its caption
EDGE = 0.015  # around what is drawn, for its lines; above and below not where rows have a pitch
EMPTY = 0.75  # least width of a column with a cell without a rod, for its reason
DOT = 0.21  # the width of the dot of an equilibrium and the gap after it
ROWS = 6  # rows that are tried
LYING = 1.3  # how much taller than wide a scene must be to be laid on its side


@dataclass(frozen=True, eq=False)
class View:
    """What stands in a cell: rods on one cylinder, or none.

    turned: the angle about the axis by which all of it is turned [rad]. ends: the heights between which its cylinder
    stands [length]; default: a little beyond the rods. frame: the rods for which there is room; default: those shown.
    """

    bodies: Sequence[Body]
    cell: Cell
    turned: float = 0.0
    ends: tuple[float, float] | None = None
    frame: Sequence[Body] = ()

    def box(self, camera: Camera) -> tuple[Array, Array]:
        """The least and the largest coordinates on the page of what is shown, (2,) each [length].

        To the left and to the right of an upright cylinder there is as much room.
        """
        low, high = camera.box(self.bodies[0].R, self.cylinder)
        for body in self.frame or self.bodies:
            seen = self.places(body) @ camera.page.T
            low, high = np.minimum(low, seen.min(axis=0) - body.a), np.maximum(high, seen.max(axis=0) + body.a)
        if abs(camera.page[0, 2]) < 1e-9:
            wide = max(-low[0], high[0])
            low, high = np.array([-wide, low[1]]), np.array([wide, high[1]])
        return low, high

    @property
    def turn(self) -> Array:
        """The matrix that turns places about the axis, (3, 3)."""
        cos, sin = np.cos(self.turned), np.sin(self.turned)
        return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])

    def places(self, body: Body) -> Array:
        """The centreline of a rod as it is turned, (n, 3) [length]."""
        return body.dense @ self.turn.T

    def hides(self, body: Body, camera: Camera) -> bool:
        """Whether the cylinder hides a part of a rod."""
        if body.side == "inside":
            return False
        place = self.places(body)
        across = np.cross(camera.toward, [0.0, 0.0, 1.0])
        near = np.abs(place @ across) < np.linalg.norm(across) * (body.R + 0.6 * body.a)
        return bool((near & (place[:, :2] @ camera.toward[:2] < 0)).any())

    def crossings(self, camera: Camera) -> tuple[list[Array], int]:
        """The places, (3,) each [length], where rods pass through themselves in sight; how many the cylinder hides."""
        across = np.cross(camera.toward, [0.0, 0.0, 1.0])
        seen, hidden = [], 0
        for body in self.bodies:
            for at in (self.turn @ place for place in body.crossings):
                behind = at[:2] @ camera.toward[:2] < 0 and abs(across @ at) < body.R
                if behind and body.side != "inside":
                    hidden += 1
                else:
                    seen.append(at)
        return seen, hidden

    @property
    def cylinder(self) -> tuple[float, float]:
        """The heights between which the cylinder stands [length]."""
        return self.ends or ends_of(self.bodies)

    @property
    def reach(self) -> float:
        """The largest distance from the axis of what is shown [length]."""
        return max(body.reach for body in self.bodies)


def ends_of(bodies: Sequence[Body]) -> tuple[float, float]:
    """Where the cylinder begins and ends [length], a little beyond the rods; 0 and 5 without rods."""
    if not bodies:
        return 0.0, 5.0
    beyond = max(body.a for body in bodies) + 0.3 * max(body.R for body in bodies)
    return min(body.z.min() for body in bodies) - beyond, max(body.z.max() for body in bodies) + beyond


def camera_before(
    context: Sequence[Body], camera: str | None, down: Array | None
) -> tuple[Camera, tuple[tuple[float, float], ...], bool]:
    """The camera before rods in one view, the sides from which it sees them, and whether they lie.

    They lie where that is larger; rods with weight, which acts along `down`, lie or are inclined as they are.
    """
    lying = bool(np.ptp(ends_of(context)) > LYING * 2 * max(body.reach for body in context))
    sides = views_of(camera)
    if down is not None and camera is None:
        sides = ((0.0, 0.0 if lying else sides[0][1]),)
    flat = front_camera(context, sides[0][1], lying or down is not None, down)
    return long_rod.camera_of(context, flat), sides, lying


def arrange(
    rows: Sequence[Sequence[View]], camera: Camera, room: tuple[float, float], pitch: float = 0.0,
    columns: Sequence[str] = (),
) -> Arrangement:  # fmt: skip
    """The largest arrangement of views, each above its caption, in a room of width and height in inches.

    pitch: from row to row in heights of a row, where rows have no captions; default: the captions decide. columns: the
    headings of columns, the first of all.
    """
    size = np.array([[np.subtract(*view.box(camera)[::-1]) if view.bodies else (0.0, 0.0) for view in row]
                     for row in rows])  # fmt: skip
    words = np.array([[_caption_size(view.cell) for view in row] for row in rows])
    for k, head in enumerate(columns[1:]):
        words[:, k, 0] = np.maximum(words[:, k, 0], fonts.width_of(head, fonts.NORMAL))
    size, edges = size if size.any() else np.ones_like(size), (EDGE, 0.0 if pitch else EDGE)
    return arrangement.arrange(size, words, room, edges, pitch)


def in_rows(views: Sequence[View], camera: Camera, room: tuple[float, float]) -> list[list[View]]:
    """The views in as many rows as let them be largest, nearly so in fewer; the last row is filled up."""

    def cut(columns: int) -> list[list[View]]:
        filled = [*views, *[View([], Cell())] * (-len(views) % columns)]
        return [filled[i : i + columns] for i in range(0, len(filled), columns)]

    found = arrangement.in_rows(len(views), lambda _, columns: arrange(cut(columns), camera, room), ROWS, room[0])
    return cut(found[0])


def _caption_size(cell: Cell) -> tuple[float, float]:
    """Width and height of the words below a view."""
    first, *more = cell.caption.split("\n")
    dot = DOT if cell.number is not None else 0.0
    wide = max(fonts.width_of(line, fonts.NORMAL) + dot * (line == first) for line in (first, *more))
    high = fonts.height_of(cell.caption, fonts.NORMAL)
    return max(wide, EMPTY if cell.why_empty else 0.0), high + BELOW * bool(high)
