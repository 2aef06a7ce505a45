"""What a scene shows in the cells of its page, before which camera, and how these stand in rows and columns. No OpenGL.

The projection is parallel, so one scale holds for all of the picture.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from solver.numerics.arrays import Booleans
from solver.orbits import frames
from solver.problem.errors import InputError, no_such

from ..figures import arrangement, fonts
from ..figures.arrangement import Arrangement
from ..geometry.centreline import Array
from ..stored.stored_study import StoredStudy
from .body import ARROW, Body
from .scene_kinds import Cell

# name -> its views, each with the angle about the axis from the side where the rod is and the angle above the plane
# across the axis, in degrees
CAMERAS: dict[str, tuple[tuple[float, float], ...]] = {
    "oblique": ((25.0, 20.0),),
    "sides": ((0.0, 0.0), (90.0, 0.0)),
    "front": ((0.0, 0.0),),
    "side": ((90.0, 0.0),),
    "end": ((0.0, -90.0),),  # as one looks along the axis from s = 0
}
LOW_SIDE_DOWN = np.radians(-120.0)  # azimuth of a viewer of a lying cylinder who looks down on its low side
STEEPEST = 60.0  # degrees; beyond, lengths along the axis are hardly seen
BELOW = 0.05  # inches from a view to its caption
EDGE = 0.015  # around what is drawn, for its lines
EMPTY = 0.75  # least width of a column with a cell without a rod, for its reason
DOT, ROUND = 0.23, 0.085  # the width of the dot of an equilibrium and the gap after it; its radius
ROWS = 6  # rows that are tried
SLID, STEPS = 2.0, 201  # how far an arrow is moved, in radii of the cylinder, and places at which that is asked
LYING = 1.3  # how much taller than wide a scene must be to be laid on its side


@dataclass(frozen=True, eq=False)
class Camera:
    """A camera in parallel projection.

    Attributes
    ----------
    toward, up
        Directions to the camera, and up on the page, (3,).
    per_unit
        Pixels per length.
    seen_from
        Direction to the viewer in the axes of the first view's rods, (3,), where it was turned.
    down
        Direction of the weight of the rods, (3,); default: no weight, or several directions.
    """

    toward: Array
    up: Array
    per_unit: float = 1.0
    seen_from: Array | None = None
    down: Array | None = None

    @property
    def page(self) -> Array:
        """Directions to the right and up on the page, (2, 3)."""
        return np.array([np.cross(self.up, self.toward), self.up])

    @property
    def is_end_view(self) -> bool:
        """Whether it looks along the axis."""
        return self.along_axis < 1e-9

    @property
    def along_axis(self) -> float:
        """The share of a length along the axis that is seen: 1 from the side."""
        return float(np.hypot(*self.page[:, 2]))

    def box(self, reach: float, ends: tuple[float, float]) -> tuple[Array, Array]:
        """The least and the largest coordinates on the page of a cylinder between two heights, (2,) each [length]."""
        across = reach * np.sqrt(np.maximum(1 - self.page[:, 2] ** 2, 0.0))  # the largest x cos t + y sin t of a rim
        along = np.outer(ends, self.page[:, 2])
        return along.min(axis=0) - across, along.max(axis=0) + across


def views_of(text: str | None) -> tuple[tuple[float, float], ...]:
    """The views that --camera names, each as azimuth and elevation [deg]; default: one, oblique.

    Raises `InputError` for what is neither a name of `CAMERAS` nor two angles.
    """
    if text is None:
        return CAMERAS["oblique"]
    if text in CAMERAS:
        return CAMERAS[text]
    try:
        azimuth, elevation = (float(part) for part in text.split(","))
    except ValueError:
        raise no_such("camera", text, [*CAMERAS, "AZIMUTH,ELEVATION in degrees"]) from None
    if not (-360 <= azimuth <= 360 and -STEEPEST <= elevation <= STEEPEST):
        raise InputError(
            f"--camera takes an azimuth between -360 and 360 and an elevation between {-STEEPEST:g} and {STEEPEST:g} "
            f"degrees, got {text}"
        )
    return ((azimuth, elevation),)


def one_view_of(text: str | None, shown: str) -> tuple[float, float]:
    """The one view of each rod, as azimuth and elevation [deg]; shown: what. Raises `InputError` for several."""
    view, *others = views_of(text)
    if others:
        raise InputError(f"{shown} is seen from one side, and --camera {text} has several: choose front or side")
    return view


def gravity(stored: StoredStudy, where: Mapping[str, int]) -> Array | None:
    """The direction of the weight of the rods of a case, (3,); None without weight or for several directions."""
    if "weight" not in stored or not stored["weight"].values.any():
        return None
    if "inclination" not in stored:
        return np.array([0.0, 0.0, -1.0])
    angles = np.unique(stored["inclination"].isel(where, missing_dims="ignore").values)
    return np.array([np.sin(angles[0]), 0.0, -np.cos(angles[0])]) if len(angles) == 1 else None


def front_camera(
    bodies: Sequence[Body], elevation: float = 0.0, lying: bool = False, down: Array | None = None
) -> Camera:
    """The camera before the rods' mean azimuth; the axis goes up the page, or with `lying` to its right.

    elevation: the angle by which it looks down on the plane across the axis [deg]; beyond `STEEPEST` it looks along the
    axis, with alpha = 0 up. down: as of `Camera`; a viewer of a lying cylinder then has its low side below.
    """
    if abs(elevation) > STEEPEST:
        return Camera(np.array([0.0, 0.0, np.sign(elevation)]), np.array([1.0, 0.0, 0.0]), down=down)
    low = down is not None and bool(np.hypot(*down[:2]) > 1e-9)
    azimuth = LOW_SIDE_DOWN if low else azimuth_of(bodies)
    out, axis = frames.outward(np.array(azimuth)), np.array([0.0, 0.0, 1.0])
    above = np.radians(elevation)
    toward = np.cos(above) * out + np.sin(above) * axis
    flat = np.cos(above) * axis - np.sin(above) * out
    return Camera(toward, np.cross(toward, flat) if lying else flat, down=down)


def lies(camera: Camera) -> bool:
    """Whether the axis goes across the page rather than up."""
    return abs(camera.page[0, 2]) > abs(camera.page[1, 2])


def upright(camera: Camera) -> Camera:
    """The camera turned so that the weight points down the page; the same where there is none."""
    if camera.down is None:
        return camera
    up = camera.toward * (camera.down @ camera.toward) - camera.down
    size = float(np.linalg.norm(up))
    return camera if size < 1e-6 else replace(camera, up=up / size)


def azimuth_of(bodies: Sequence[Body]) -> float:
    """The mean azimuth of rods [rad]; 0 of those all around the cylinder, which have no front."""
    mean = np.mean([np.exp(1j * body.alpha).mean() for body in bodies] or [1.0])
    return float(np.angle(mean)) if abs(mean) > 0.05 else 0.0


def camera_of(bodies: Sequence[Body], camera: Camera) -> Camera:
    """The camera turned so that the weight points down the page; rods that are compressed along the axis lie."""
    return camera if bodies and bodies[0].squeeze < 1 and not camera.is_end_view else upright(camera)


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
            for at, away, *_ in body.pushes:
                tip = camera.page @ self.arrow(body, at, away, ARROW * body.R, camera)[1]
                low, high = np.minimum(low, tip), np.maximum(high, tip)
        if abs(camera.page[0, 2]) < 1e-9 and not camera.is_end_view:
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

    def arrow(self, body: Body, at: Array, away: Array, long: float, camera: Camera) -> Array:
        """An arrow as long in the plane of the page as it says, its start and tip, (2, 3) as they are turned [length].

        It points along the direction `away` as that is seen and starts at the outline of the rod, or, within `SLID`
        radii of the cylinder from there, where this no longer hides it; at, away: as of `Body.pushes`.
        """
        seen = camera.page @ self.turn @ away
        size = float(np.linalg.norm(seen))
        way = (seen / size if size > 1e-9 else np.array([0.0, 1.0])) @ camera.page
        axis, beyond = self.turn @ (at - body.a * away), body.a + np.linspace(0, SLID * body.R, STEPS)
        hidden = self.covers(axis + np.outer(beyond, way), camera)
        start = beyond[np.argmin(hidden)]  # the first one where all are hidden
        return np.asarray(axis + np.outer([start, start + long], way))

    def hides(self, body: Body, camera: Camera) -> bool:
        """Whether the cylinder hides a part of a rod."""
        if body.side == "inside":
            return False
        place = self.places(body)
        across = np.cross(camera.toward, [0.0, 0.0, 1.0])
        near = np.abs(place @ across) < np.linalg.norm(across) * (body.R + 0.6 * body.a)
        return bool((near & (place[:, :2] @ camera.toward[:2] < 0)).any())

    def crossings(self, camera: Camera) -> tuple[list[Array], int]:
        """The places, (3,) each [length], where rods pass through themselves in sight; how many others there are."""
        seen, hidden = [], 0
        for body in self.bodies:
            for at in (self.turn @ place for place in body.crossings):
                if self.covers(at[None], camera)[0] or self._stands_before(at, camera):
                    hidden += 1
                else:
                    seen.append(at)
        return seen, hidden

    def _stands_before(self, at: Array, camera: Camera) -> bool:
        """Whether a rod stands before a place (3,), which is turned.

        Where its line passes the line of sight, by less than half a radius, it is more than that nearer to the eye.
        """
        for body in self.bodies:
            away = body.dense @ self.turn.T - at
            before = away @ camera.toward
            beside = np.linalg.norm(away - before[:, None] * camera.toward, axis=1)
            near = np.flatnonzero(beside < body.a / 2)
            runs = np.split(near, np.flatnonzero(np.diff(near) > 1) + 1)
            if any(before[run[beside[run].argmin()]] > body.a / 2 for run in runs if run.size):
                return True
        return False

    def covers(self, places: Array, camera: Camera) -> Booleans:
        """Whether the cylinder stands before places outside it, (n, 3) as they are turned; an open one never. (n,)"""
        body, way = self.bodies[0], camera.toward
        if body.side == "inside":
            return np.zeros(len(places), dtype=bool)
        steep = max(float(way[:2] @ way[:2]), 1e-12)
        nearer = -places[:, :2] @ way[:2] / steep  # how far before a place its line of sight is nearest the axis
        miss = ((places[:, :2] + nearer[:, None] * way[:2]) ** 2).sum(axis=1)
        half = np.sqrt(np.maximum(body.R**2 - miss, 0.0) / steep)
        into, out = (places[:, 2] + (nearer + side * half) * way[2] for side in (-1, 1))
        low, high = self.cylinder
        between = (np.maximum(into, out) > low) & (np.minimum(into, out) < high)
        return np.asarray((nearer > 0) & (miss < body.R**2) & between)

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
    sides = views_of(camera)
    tall = bool(np.ptp(ends_of(context)) > LYING * 2 * max(body.reach for body in context))
    lying = tall and sides != CAMERAS["end"]
    if down is not None and camera is None:
        sides = ((0.0, 0.0 if lying else sides[0][1]),)
    flat = front_camera(context, sides[0][1], lying or down is not None, down)
    return camera_of(context, flat), sides, lying


def arrange(
    rows: Sequence[Sequence[View]],
    camera: Camera,
    room: tuple[float, float],
    pitch: float = 0.0,
    columns: Sequence[str] = (),
    edge: float = EDGE,
) -> Arrangement:
    """The largest arrangement of views, each above its caption, in a room of width and height in inches.

    pitch: from row to row in heights of a row, where rows have no captions; default: the captions decide. columns: the
    headings of columns, the first of all. edge: above and below what is drawn.
    """
    size = np.array(
        [[np.subtract(*view.box(camera)[::-1]) if view.bodies else (0.0, 0.0) for view in row] for row in rows]
    )
    words = np.array([[_caption_size(view.cell) for view in row] for row in rows])
    for k, head in enumerate(columns[1:]):
        words[:, k, 0] = np.maximum(words[:, k, 0], fonts.width_of(head, fonts.NORMAL))
    return arrangement.arrange(size if size.any() else np.ones_like(size), words, room, (EDGE, edge), pitch)


def in_rows(views: Sequence[View], camera: Camera, room: tuple[float, float]) -> list[list[View]]:
    """The views in as many rows as let them be largest, nearly so in fewer; the last row is filled up."""

    if lies(camera):
        lines = [replace(view.cell, caption=view.cell.line or view.cell.caption) for view in views]
        views = [replace(view, cell=cell) for view, cell in zip(views, lines, strict=True)]

    def cut(columns: int) -> list[list[View]]:
        filled = [*views, *[View([], Cell())] * (-len(views) % columns)]
        return [filled[i : i + columns] for i in range(0, len(filled), columns)]

    arranged = arrangement.in_rows(len(views), lambda _, columns: arrange(cut(columns), camera, room), ROWS, room[0])
    return cut(arranged[0])


def _caption_size(cell: Cell) -> tuple[float, float]:
    """Width and height of the words below a view."""
    first, *more = cell.caption.split("\n")
    dot = DOT if cell.number is not None else 0.0
    wide = max(fonts.width_of(line, fonts.NORMAL) + dot * (line == first) for line in (first, *more))
    high = fonts.height_of(cell.caption, fonts.NORMAL)
    return max(wide, EMPTY if cell.why_empty else 0.0), high + BELOW * bool(high)
