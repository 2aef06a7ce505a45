"""In how many lines a long rod is set, as text is: the one rule of scenes and of unrolled views."""

from typing import Any

import numpy as np

TALLEST = 30.0  # diameters of the cylinder; beyond, the rod would be a hair
PITCH = 1.5  # from line to line, in widths of a line
MOST = 500  # lines that are tried
LABELLED = 12  # lines at most that carry the arc length at which they begin


def is_long(height: float, radius: float) -> bool:
    """Whether a rod of that height on a cylinder of that radius would be too thin to see in one piece."""
    return bool(height > TALLEST * 2 * radius)


def largest(tall: float, wide: float, beyond: float, room: tuple[float, float]) -> tuple[int, float]:
    """The number of lines in which rods are largest in a room, and how much of the room a length then has.

    Parameters
    ----------
    tall, wide : float
        The height of the tallest rod, and the width of a line [length].
    beyond : float
        Length that a line needs at either end.
    room : pair of float
        Its width and height, in pixels or inches.

    Returns
    -------
    pair
        The number of lines, and pixels or inches per length.
    """
    count: Any = np.arange(1, MOST + 1)
    scale = np.minimum(room[0] / (tall / count + 2 * beyond), room[1] / (count * PITCH * wide))
    best = int(scale.argmax())
    return int(count[best]), float(scale[best])
