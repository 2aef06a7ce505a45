"""One rod on its cylinder at true scale, as a workshop sees it: from the side, and one off the wall along the axis too.

In the side view the axis lies to the right, alpha = 0 is up, and the eye looks from alpha = 90 degrees. In a hole with
a low side, which is at alpha = 0, this side is down, and the eye looks from alpha = -90 degrees. The end view stands to
the right of it, as one looks along the axis from s = 0 (ISO 128, first angle).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from solver.orbits import frames
from solver.problem.units import LENGTHS

from . import fonts
from .drawn_rods import DrawnRod
from .sheet import MILLIMETRES, Sheet

SCALES = [step * 10.0**power for power in range(9, -10, -1) for step in (5.0, 2.0, 1.0)]  # of a drawing, falling
ALONG = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)  # of the scale along a compressed axis, 1 to one of these
NEAR = 2.0  # millimetres along the axis from the end of a rod, within which its extension line stands clear of it
LEFT, ABOVE, BELOW = 24.0, 15.0, 24.0  # millimetres on paper around the views
RIGHT = (12.0, 4.0)  # of them, on a wide and on a narrow sheet
HIGH = (110.0, 70.0)  # of the cylinder with its rod at most, on a wide and on a narrow sheet
TALL = (130.0, 70.0)  # of an end view
CEDED = 2.0, 2.5  # by which factor point forces with their words, and without, make the scale smaller at most
APART = (16.0, 8.0)  # between the two views, on a wide and on a narrow sheet
THICK, HAIR = 0.8, 0.3  # of the rod: thinner, the drawing shows a part of it; thinner, it is a line
SPARE = 4.0  # of cylinder beyond both ends of the rod
# of the smallest and the largest point force, on a wide and on a narrow sheet; from the tip to its words
ARROWS, PAST = ((6.0, 14.0), (4.0, 8.0)), 1.5
SHARES = {"left": 0.0, "bottom": 0.0, "center": 0.5, "right": 1.0, "top": 1.0}  # of words before their place
LEAST = 4.0  # millimetres that the side view has of both
LOW = 40.0  # of the cylinder at most, where its length is compressed
LEVEL = 1e-9  # sine of the inclination of a hole that stands, and has no low side
PER_TURN = 240  # points of a turn

Values = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Force:
    """A point force of the wall in the end view.

    s: where it acts [length]. place: on the rod, (2,) [length]. away: its direction, (2,). long: millimetres of its
    arrow. words: beside its tip; none where they have no room.
    """

    s: float
    place: Values
    away: Values
    long: float
    words: str

    @property
    def beside(self) -> tuple[str, str]:
        """How its words stand, across and upright."""
        right, up = self.away
        across = "center" if abs(right) < 0.3 else "left" if right > 0 else "right"
        return across, "center" if across != "center" else "bottom" if up > 0 else "top"

    def reach(self, mm: float) -> Values:
        """The lower left and the upper right of arrow and words on paper, (2, 2) [mm]; mm: as of `Views`."""
        words = self.room(mm)
        return np.stack([np.minimum(words[0], self.place * mm), np.maximum(words[1], self.place * mm)])

    def room(self, mm: float) -> Values:
        """The lower left and the upper right of its words on paper, (2, 2) [mm]; mm: as of `Views`."""
        size = fonts.small()
        words = MILLIMETRES * np.array([fonts.width_of(self.words, size), fonts.height_of(self.words, size)])
        share = np.array([SHARES[side] for side in self.beside])
        tip = self.place * mm + (self.long + PAST) * self.away
        return np.stack([tip - share * words, tip + (1 - share) * words])


@dataclass(frozen=True, eq=False)
class Views:
    """The rod in its views: in that from the side to the right, upwards and towards the eye, (n,) each [length].

    beta: its angle, (n,). s, end: arc length, (m,), and the whole rod to the right and upwards in the end view, (m, 2).
    scale: millimetres on paper of a millimetre. mm: of paper in a unit of length. whole: whether all of it is drawn
    from the side. low_side: whether alpha = 0 is the low side of the cylinder, and down. ends: the lowest and the
    highest place of rod and cylinder [length]. box: the lower left and the upper right of all that is drawn of the end
    view, from the axis, (2, 2) [mm]; without one upwards alone counts. forces: without words, or none, where the end
    view has no room for them; None where there is no end view. squeeze: of lengths along the axis, before the scale.
    apart: millimetres between the two views.
    """

    x: Values
    y: Values
    near: Values
    beta: Values
    s: Values
    end: Values
    scale: float
    mm: float
    whole: bool
    low_side: bool
    ends: tuple[float, float]
    box: Values
    forces: Sequence[Force] | None
    squeeze: float = 1.0
    apart: float = APART[0]

    @property
    def wide(self) -> float:
        """Millimetres from the start of the rod to the right edge of what is drawn."""
        side = float(np.ptp(self.x)) * self.mm
        return side if self.forces is None else side + SPARE + self.apart + float(np.ptp(self.box[:, 0]))

    def foot(self, k: int, R: float, a: float) -> float:
        """The lowest place of cylinder and rod about an end of the rod, k: 0 or -1 [length]."""
        about = np.abs(self.x - self.x[k]) * self.mm <= NEAR
        return min(-R, float(self.y[about].min()) - a)

    @property
    def middle(self) -> Values:
        """Where the axis is in the end view, to the right and upwards, (2,) [length]."""
        return np.array([float(self.x.max()) + (SPARE + self.apart - float(self.box[0, 0])) / self.mm, 0.0])


def end_view(places: Values, up: Values | Sequence[float]) -> tuple[Values, Values]:
    """Places (n, 3) to the right and upwards, (n,) each, as one sees them who looks along z.

    up: a direction across the axis, (2,).
    """
    return places[:, :2] @ [-up[1], up[0]], places[:, :2] @ np.asarray(up)


def views_of(
    rod: DrawnRod, unit: str, R: float, sheet: Sheet, forces: Sequence[tuple[float, float, str]] | None = None
) -> Views:
    """The views of a rod, at the largest standard scale with which they fit the sheet.

    forces: s, size and words of each point force of the wall, of a rod that has an end view.
    """
    s, place, beta = _dense(rod)
    case = rod.case.case
    low_side = bool(np.any(case.rod.weight or 0.0)) and abs(math.sin(case.cylinder.inclination or 0.0)) > LEVEL
    x = place[:, 2]
    near, y = end_view(place, (-1.0 if low_side else 1.0, 0.0))
    reach = max(R, float(np.hypot(near, y).max()) + rod.a)
    ends = -reach, reach
    if forces is not None:
        ends = min(-R, float(y.min()) - rod.a), max(R, float(y.max()) + rod.a)
    mm, narrow, apart = 1e3 * LENGTHS[unit], sheet.narrow, APART[sheet.narrow]
    arrows: Sequence[Force] | None = None if forces is None else _arrows(rod, forces, s, near, y, ARROWS[narrow])
    room = sheet.width * MILLIMETRES - LEFT - RIGHT[narrow] - 2 * SPARE
    sides = min(-R, float(near.min()) - rod.a), max(R, float(near.max()) + rod.a)

    def box(scale: float, arrows: Sequence[Force] | None) -> Values:
        corners = np.stack([sides, ends], axis=1) * mm * scale
        every = np.stack([corners, *(force.reach(mm * scale) for force in arrows or ())])
        return np.stack([every[:, 0].min(axis=0), every[:, 1].max(axis=0)])

    def beside(scale: float, arrows: Sequence[Force] | None) -> float:
        """Millimetres of the end view, with what is before it."""
        return 0.0 if arrows is None else SPARE + apart + float(np.ptp(box(scale, arrows)[:, 0]))

    def scales(arrows: Sequence[Force] | None) -> list[float]:
        """The standard scales with which all but the length fits, falling; at least the smallest."""
        most = (HIGH if arrows is None else TALL)[narrow]
        fit = [
            scale
            for scale in SCALES
            if np.ptp(box(scale, arrows)[:, 1]) <= most and beside(scale, arrows) <= room - LEAST
        ]
        return fit or SCALES[-1:]

    if arrows:
        each = zip((arrows, [replace(arrow, words="") for arrow in arrows]), CEDED, strict=True)
        arrows = next((fewer for fewer, ceded in each if scales(fewer)[0] >= scales([])[0] / ceded), [])
    fits = scales(arrows)
    scale = next((scale for scale in fits if np.ptp(x) * mm * scale + beside(scale, arrows) <= room), SCALES[-1])
    if not (whole := 2 * rod.a * mm * scale >= THICK):
        scale = fits[0]
    arrows = arrows and _without_overlap(arrows, mm * scale)
    outside = np.abs(x - x[0]) * mm * scale > room - beside(scale, arrows)
    k = s.size if whole else int(np.argmax(np.append(outside, True)))
    end, squeeze = np.stack([near, y], axis=1), 1.0
    if arrows is None and np.ptp(end[:k], axis=0).max() < rod.a:  # the part of a rod that is whole would be a bar
        scale = next((low for low in fits if np.ptp(box(low, None)[:, 1]) <= LOW), SCALES[-1])
        squeeze, k = min(_round_scale(room / (float(np.ptp(x)) * mm)) / scale, 1.0), s.size
    x, y, near, beta = (values[:k] for values in (squeeze * x, y, near, beta))
    whole = k == s.size
    return Views(
        x, y, near, beta, s, end, scale, mm * scale, whole, low_side, ends, box(scale, arrows), arrows, squeeze, apart
    )


def _round_scale(scale: float) -> float:
    """The largest scale of round numbers that is no larger than this one."""
    power = 10.0 ** math.floor(-math.log10(scale))
    return 1 / (power * next(step for step in ALONG if step * power * scale >= 1 - LEVEL))


def _dense(rod: DrawnRod) -> tuple[Values, Values, Values]:
    """Arc length, place and angle of a rod at as many points as its turns need, (n,), (n, 3) and (n,)."""
    alpha = rod["alpha"]
    count = int(max(PER_TURN * np.abs(np.diff(alpha)).sum() / (2 * np.pi), alpha.size, 400))
    s = np.linspace(0, float(rod["s"][-1]), min(count, 200_000))
    alpha, beta, z = (np.interp(s, rod["s"], rod[name]) for name in ("alpha", "beta", "z"))
    if np.ndim(rod.radius):
        across = frames.position(rod.radius, rod["alpha"], rod["z"])
        return s, np.stack([np.interp(s, rod["s"], column) for column in across.T], axis=1), beta
    return s, frames.position(rod.radius, alpha, z), beta


def _arrows(
    rod: DrawnRod,
    forces: Sequence[tuple[float, float, str]],
    s: Values,
    near: Values,
    y: Values,
    lengths: tuple[float, float],
) -> list[Force]:
    """The point forces as they are drawn: outside a cylinder away from its axis, inside towards it.

    lengths: of the arrow of a force of no size and of the largest [mm].
    """
    largest = max((size for _, size, _ in forces), default=1.0)
    sign = -1.0 if rod.case.attrs["side"] == "inside" else 1.0
    drawn = []
    for at, size, words in forces:
        place = np.array([np.interp(at, s, near), np.interp(at, s, y)])
        away = sign * place / max(float(np.hypot(*place)), 1e-300)
        long = float(np.interp(size / largest, (0, 1), lengths))
        drawn.append(Force(at, place + rod.a * away, away, long, words))
    return drawn


def _without_overlap(forces: Sequence[Force], mm: float) -> list[Force]:
    """Point forces whose words stand apart: words that would stand on others follow below these."""
    drawn = list[Force]()
    for force in forces:
        low, high = force.room(mm)
        for i, other in enumerate(drawn):
            first, last = other.room(mm)
            if other.words and (low < last).all() and (first < high).all():
                drawn[i] = replace(other, words=f"{other.words}\n{force.words}")
                force = replace(force, words="")
                break
        drawn.append(force)
    return drawn
