"""Boxes in rows and columns, all at one scale and as large as a room allows: unrolled views, and the views of a scene.

Lengths on the page are in inches from its upper left.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

Values = NDArray[np.float64]

GAP, BETWEEN = 0.13, 0.14  # between columns, and from the words of a row to the next row
WORTH = 1.05  # a scale so many times larger is worth another row


@dataclass(frozen=True, eq=False)
class Arrangement:
    """Where boxes stand.

    boxes: left, top, width and height of each, (rows, columns, 4). size: width and height of all, with the words below
    the last row. scale: inches per length to the right. factor: how many times larger lengths down are drawn.
    """

    boxes: Values
    size: tuple[float, float]
    scale: float
    factor: float = 1.0

    @property
    def places(self) -> Values:
        """The boxes one after the other, (rows * columns, 4)."""
        return self.boxes.reshape(-1, 4)


def arrange(
    sizes: Values,
    words: Values,
    room: tuple[float, float],
    edge: Any = 0.0,
    pitch: float = 0.0,
    least: float = 0.0,
    most: float = np.inf,
) -> Arrangement:
    """The largest arrangement in a room of width and height.

    A column is as wide as its widest box or words, a row as high as its highest box.

    Parameters
    ----------
    sizes : array, (rows, columns, 2)
        Width and height of each [length].
    words : array, (rows, columns, 2)
        Those of the words below each.
    room : pair of float
        Width and height.
    edge : float or pair of float
        Around each box; to the left and right, and above and below.
    pitch : float
        From row to row in heights of a row; default: the words decide.
    least, most : float
        Between which the scale is; where the least needs more room, it is taken.
    """
    wide, high = sizes[..., 0].max(axis=0), sizes[..., 1].max(axis=1)
    narrowest, below = words[..., 0].max(axis=0), words[..., 1].max(axis=1)
    below[:-1] += BETWEEN
    beside, above = np.broadcast_to(2 * np.asarray(edge), 2)

    def lengths(scale: float) -> tuple[Values, Values, Values]:
        heights = high * scale + above
        return np.maximum(wide * scale + beside, narrowest), heights, heights * (pitch - 1) if pitch else below

    def over(scale: float) -> float:
        widths, heights, gaps = lengths(scale)
        return float(max(widths.sum() + GAP * (len(widths) - 1) - room[0], heights.sum() + gaps.sum() - room[1]))

    largest = min(most, 1.01 * max(room) / max(float(sizes.max()), 1e-300))
    scale = largest if over(largest) <= 0 else float(brentq(over, 0.0, largest)) if over(0.0) < 0 else 0.0
    scale = max(scale, least or 1e-9)
    widths, heights, gaps = lengths(scale)
    left = np.concatenate([[0.0], np.cumsum(widths[:-1] + GAP)])
    top = np.concatenate([[0.0], np.cumsum(heights[:-1] + gaps[:-1])])
    boxes = np.stack(np.broadcast_arrays(left, top[:, None], widths, heights[:, None]), axis=-1)
    return Arrangement(boxes, (float(left[-1] + widths[-1]), float(top[-1] + heights[-1] + gaps[-1])), scale)


def in_rows(
    count: int, arranged: Callable[[int, int], Arrangement], most: int, width: float, worth: float = WORTH
) -> tuple[int, Arrangement]:
    """The number of columns, and the arrangement, in which so many boxes are largest, nearly so in fewer rows.

    arranged: the arrangement in so many rows and columns. most: rows that are tried. width: what it may have.
    worth: a scale so many times larger is worth another row.
    """
    best: tuple[int, Arrangement] | None = None
    largest = 0.0
    for rows in range(1, min(count, most) + 1):
        columns = -(-count // rows)
        if -(-count // columns) != rows:
            continue
        layout = arranged(rows, columns)
        fits = layout.size[0] <= width + 1e-6
        seen = layout.scale * min(layout.factor, 1.0)
        if best is None or best[1].size[0] > width + 1e-6 or (fits and seen > worth * largest):
            best, largest = (columns, layout), seen
    assert best is not None
    return best
