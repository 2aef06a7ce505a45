"""In how many lines a long rod is set, as text is: the one rule of scenes and of unrolled views."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..words import labels

TALLEST = 30.0  # diameters of the cylinder; beyond, the rod would be a hair
PITCH = 1.5  # from line to line, in widths of a line
MOST = 500  # lines that are tried
LABELLED = 12  # lines at most that carry the arc length at which they begin
ROOM = 0.98  # of a line is for the rod that is cut to fit, as its bends at the cuts are not known before


@dataclass(frozen=True)
class Lines:
    """How rods are set in lines.

    count: the number of lines. each: the arc on each line [length] where parts of the rod are left out, else 0.
    """

    count: int
    each: float = 0.0

    def cut(self, low: float, high: float) -> list[tuple[float, float]]:
        """The arc lengths between which a rod that is drawn between two of them is on each line."""
        each = self.each or (high - low) / self.count
        starts = np.linspace(low, high - each, self.count)
        return [(float(start), min(float(start + each), high)) for start in starts]

    def heads(self, spans: Sequence[tuple[float, float]], unit: str) -> list[str]:
        """What stands before the lines: before some the arc length at which the line begins."""
        every = -(-self.count // LABELLED)
        begins = [labels.number(start) for start, _ in spans]
        return [f"s = {at} {unit}" if k == 0 else at if k % every == 0 else "" for k, at in enumerate(begins)]

    def note(self, spans: Sequence[tuple[float, float]], unit: str) -> str:
        """How the lines are read, and which parts are left out."""
        if not self.each:
            return f"{self.count} lines, one after the other"
        each, of = (labels.number(length) for length in (self.each, spans[-1][1] - spans[0][0]))
        return f"only {self.count} pieces of {each} {unit} each, spread over {of} {unit}"


def is_long(height: float, radius: float) -> bool:
    """Whether a rod of that height on a cylinder of that radius would be too thin to see in one piece."""
    return bool(height > TALLEST * 2 * radius)


def set_in_lines(
    tall: float, wide: float, rise: float, room: tuple[float, float], thinnest: float, beyond: float = 0.0
) -> Lines:
    """The lines in which rods are largest in a room; pieces of them where lines would be too thin to see.

    Parameters
    ----------
    tall, wide : float
        The height of the tallest rod, and the width of a line [length].
    rise : float
        The largest height over the arc of a rod.
    room : pair of float
        Its width and height, in pixels or inches.
    thinnest : float
        The least width of a line, in the same.
    beyond : float
        Length that a line needs at either end.
    """
    count: Any = np.arange(1, MOST + 1)
    scale = np.minimum(room[0] / (tall / count + 2 * beyond), room[1] / (count * PITCH * wide))
    best = int(scale.argmax())
    if scale[best] * wide >= thinnest:
        return Lines(int(count[best]))
    return Lines(max(int(room[1] / (PITCH * thinnest)), 1), ROOM * (room[0] * wide / thinnest - 2 * beyond) / rise)
