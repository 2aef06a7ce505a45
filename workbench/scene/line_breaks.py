"""A long rod in lines, as a text is: each goes on where the one above it ends, all at one scale. No OpenGL."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..figures import style
from ..geometry.tube import TALLEST, Body
from .page_layout import Cell

PITCH = 1.5  # from line to line, in widths of the rod on its cylinder
THINNEST = 4.0  # pixels that a cylinder is wide; below, nothing of its rod is seen
MOST = 500  # lines that are tried
NAMED = 12  # lines at most that say where they begin
ROOM = 0.98  # of a line is for the rod that is cut to fit, as its swings are not known before


@dataclass(frozen=True)
class Lines:
    """How rods are set: in how many lines, how much arc is on each [length] where not all of the rod is (else 0), how
    many pixels a length, and between which heights each line's cylinder stands."""

    count: int
    each: float
    per_unit: float
    ends: tuple[float, float]

    def cut(self, body: Body) -> list[Body]:
        """The rod line by line."""
        low, high = body.span
        each = self.each or (high - low) / self.count
        starts = np.linspace(low, high - each, self.count)
        return [replace(body, span=(float(start), min(float(start + each), high))) for start in starts]

    def cells(self, pieces: Sequence[Body], unit: str) -> list[Cell]:
        """What stands before each line: of some, where it begins."""
        every = -(-self.count // NAMED)
        begins = [style.number(piece.span[0]) for piece in pieces]
        named = [f"s = {at} {unit}" if k == 0 else at if k % every == 0 else "" for k, at in enumerate(begins)]
        return [Cell("", before=text) for text in named]

    def told(self, pieces: Sequence[Body], unit: str) -> list[str]:
        """How the lines are read, and what is not seen."""
        if not self.each:
            return [f"{self.count} lines, one after the other"]
        low, high = (style.number(v) for v in (self.each, pieces[-1].span[1] - pieces[0].span[0]))
        return [f"only {self.count} stretches of {low} {unit}", f"each, spread over {high} {unit}"]


def is_long(bodies: Sequence[Body]) -> bool:
    """Whether one of the rods would be a hair in one view."""
    return any(np.ptp(body.z) > TALLEST * 2 * body.reach for body in bodies)


def lines_for(bodies: Sequence[Body], room: tuple[int, int]) -> Lines:
    """The lines in which rods on one cylinder are largest in a room of pixels, the same for all of them.

    Where a cylinder would then be less than `THINNEST` pixels wide there are as many lines as that leaves, and
    stretches of the rod on them.
    """
    wide = 2 * bodies[0].reach
    beyond = bodies[0].a + 0.3 * bodies[0].R
    tall = max(float(np.ptp(body.z)) for body in bodies)
    count = np.arange(1, MOST + 1)
    per_unit = np.minimum(room[0] / (tall / count + 2 * beyond), room[1] / (count * PITCH * wide))
    best = int(per_unit.argmax())
    if per_unit[best] * wide >= THINNEST:
        found = Lines(int(count[best]), 0.0, 0.0, (0.0, 0.0))
    else:
        many = max(int(room[1] / (PITCH * THINNEST)), 1)
        fits = ROOM * (room[0] * wide / THINNEST - 2 * beyond)
        rise = max(np.ptp(body.z) / (body.span[1] - body.span[0]) for body in bodies)
        found = Lines(many, float(fits / rise), 0.0, (0.0, 0.0))
    pieces = [piece for body in bodies for piece in found.cut(body)]
    ends = min(p.z.min() for p in pieces) - beyond, max(p.z.max() for p in pieces) + beyond
    scale = min(room[0] / (ends[1] - ends[0]), room[1] / (found.count * PITCH * wide))
    return replace(found, per_unit=float(scale), ends=(float(ends[0]), float(ends[1])))
