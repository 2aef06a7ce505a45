"""What a scene shows in the cells of its page, and where these stand in rows and columns. No OpenGL.

Lengths on a picture are in inches from its upper left.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from ..figures import style
from ..geometry.centreline import Array
from .body import Body
from .camera import Camera
from .captions import Cell

GAP, BETWEEN = 0.13, 0.14  # between columns, and from a caption to the next row
BELOW = 0.05  # from a view to its caption
EDGE = 0.015  # around what is drawn, for its lines; above and below not where rows have a pitch
EMPTY = 0.75  # least width of a column with a cell without a rod, for its reason
DOT = 0.21  # the width of the dot of an equilibrium and the gap after it
ROWS = 6  # rows that are tried


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


@dataclass(frozen=True)
class Box:
    """A view's place in the picture: left and top edge, width and height."""

    cell: Cell
    x: float
    y: float
    width: float
    height: float


@dataclass(frozen=True, eq=False)
class Arrangement:
    """All boxes of a picture, row by row, its width and height, and the inches per length at which they fit."""

    rows: Sequence[Sequence[Box]]
    size: tuple[float, float]
    per_unit: float


def arrange(
    rows: Sequence[Sequence[View]], camera: Camera, room: tuple[float, float], gutter: float = 0.0, pitch: float = 0.0
) -> Arrangement:
    """The largest arrangement of views, all at one scale, in a room of width and height.

    A column is as wide as its widest view or caption, a row as high as its highest view; views stand on a common line.

    Parameters
    ----------
    camera
        Its `per_unit` is not used.
    gutter
        Room before the first column.
    pitch
        From row to row in heights of a row, where rows have no captions; default: the captions decide.
    """
    size = np.array([[np.subtract(*view.box(camera)[::-1]) if view.bodies else (0.0, 0.0) for view in row]
                     for row in rows])  # fmt: skip
    size = size if size.any() else np.ones_like(size)
    wide, high, edge = size[..., 0].max(axis=0), size[..., 1].max(axis=1), 0.0 if pitch else EDGE
    least = np.array([max(map(_least_width, column)) for column in zip(*rows, strict=True)])
    words = np.array([max(style.height_of(view.cell.caption, style.NORMAL) for view in row) for row in rows])
    below = np.where(words > 0, words + BELOW, 0.0) + BETWEEN * (np.arange(len(rows)) < len(rows) - 1)
    below = np.zeros(len(high)) if pitch else below
    free = room[0] - gutter - (len(wide) - 1) * GAP

    def over(per_unit: float) -> float:
        return float(np.maximum(wide * per_unit + 2 * EDGE, least).sum() - free)

    most = (room[1] - below.sum() - 2 * edge * len(high)) / (high.sum() * (pitch or 1.0))
    most = max(float(most), 1e-9)
    per_unit = most if over(most) <= 0 else float(brentq(over, 0.0, most)) if over(0.0) < 0 else free / wide.sum()
    widths, heights = np.maximum(wide * per_unit + 2 * EDGE, least), high * per_unit + 2 * edge
    below = heights * (pitch - 1) if pitch else below
    left = gutter + np.concatenate([[0.0], np.cumsum(widths[:-1] + GAP)])
    top = np.concatenate([[0.0], np.cumsum(heights[:-1] + below[:-1])])
    boxes = [[Box(view.cell, left[j], top[i], widths[j], heights[i]) for j, view in enumerate(row)]
             for i, row in enumerate(rows)]  # fmt: skip
    return Arrangement(boxes, (float(left[-1] + widths[-1]), float(top[-1] + heights[-1] + below[-1])), per_unit)


def in_rows(views: Sequence[View], camera: Camera, room: tuple[float, float]) -> list[list[View]]:
    """The views in as many rows as let them be largest, of almost equal scales that with fewer; the last row is filled
    up."""
    best: tuple[float, list[list[View]]] = (0.0, [[view] for view in views])
    for count in range(1, min(len(views), ROWS) + 1):
        columns = -(-len(views) // count)
        if -(-len(views) // columns) != count:
            continue
        rows = [list(views[i : i + columns]) for i in range(0, len(views), columns)]
        rows[-1] += [View([], Cell())] * (columns - len(rows[-1]))
        found = arrange(rows, camera, room)
        if found.per_unit > 1.05 * best[0] and found.size[0] <= room[0] + 1e-6:
            best = found.per_unit, rows
    return best[1]


def _least_width(view: View) -> float:
    first, *more = view.cell.caption.split("\n")
    dot = DOT if view.cell.number is not None else 0.0
    wide = max(style.width_of(line, style.NORMAL) + dot * (line == first) for line in (first, *more))
    return max(wide, EMPTY if view.cell.why_empty else 0.0)
