"""Boxes in rows, all at one scale and as large as a room allows: unrolled views, and the views of a scene.

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
APART = 0.2  # between columns that are not even
WORTH = 1.05  # a scale so many times larger is worth another row
FINE = 1e-6  # to which the scale of a flow is found
LOOSE = 1.0  # between columns of rows that are not even, at most


@dataclass(frozen=True, eq=False)
class Arrangement:
    """Where boxes stand.

    boxes: left, top, width and height of each, (rows, columns, 4), or of all one after the other, (1, count, 4). size:
    width and height of all, with the words below the last row. scale: inches per length to the right. factor: how many
    times larger lengths down are drawn.
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

    too_large = 1.01 * max(room) / max(float(sizes.max()), 1e-300)
    scale = max(float(brentq(over, 0.0, too_large)) if over(0.0) < 0 else 0.0, 1e-9)
    widths, heights, gaps = lengths(scale)
    left = np.concatenate([[0.0], np.cumsum(widths[:-1] + GAP)])
    top = np.concatenate([[0.0], np.cumsum(heights[:-1] + gaps[:-1])])
    boxes = np.stack(np.broadcast_arrays(left, top[:, None], widths, heights[:, None]), axis=-1)
    return Arrangement(boxes, (float(left[-1] + widths[-1]), float(top[-1] + heights[-1] + gaps[-1])), scale)


def flow(sizes: Values, words: Values, room: tuple[float, float], rows: int, even: bool, least: float) -> Arrangement:
    """Boxes one after the other, as large as they fit into a room of width and height.

    A row is as high as its highest column, and takes the whole width where it has several. The key has a row of its own
    where it leaves less free beside it than it would leave below it in the last row.

    Parameters
    ----------
    sizes : array, (count, 2)
        Width and height of each [length]; the last, of a key, has none.
    words : array, (count, 2)
        Those of the words above each; of the key all of it.
    room : pair of float
        Width and height.
    rows : int
        At most.
    even : bool
        Whether the columns of all rows stand as in the fullest one; else a box that has no room to the right of the
        one before stands below it where the row is high enough, and no view follows to the right of it.
    least : float
        The least scale; where it needs more room, that is taken.
    """
    count = len(sizes)

    def broken(scale: float) -> list[_Row]:
        boxes = np.maximum(sizes * [scale, 0], words) + sizes * [0, scale]
        lines: list[_Row] = []
        for k, (wide, high) in enumerate(boxes):
            last = lines[-1] if lines else None
            is_key = k == count - 1
            is_below = last is not None and last.has_room_below(wide, high, room[0])
            is_open = is_key or (last is not None and len(last.columns[-1]) == 1)
            if last and is_key and is_below:
                last.columns[-1].append(k)
            elif (
                last
                and is_open
                and last.has_room_beside(wide, room[0])
                and not (is_key and last.high * wide > high * room[0])
            ):
                last.columns.append([k])
            elif last and not even and is_below:
                last.columns[-1].append(k)
            else:
                lines.append(_Row(boxes, [[k]], GAP if even else APART))
        return lines

    def fits(scale: float) -> bool:
        lines = broken(scale)
        high = sum(line.high for line in lines) + BETWEEN * (len(lines) - 1)
        return len(lines) <= rows and high <= room[1] and max(line.wide for line in lines) <= room[0]

    scale, too_large = max(least, 1e-9), max(room) / max(float(sizes.max()), 1e-300)
    while too_large > scale * (1 + FINE):
        middle = float(np.sqrt(scale * too_large))
        scale, too_large = (middle, too_large) if fits(middle) else (scale, middle)
    lines = broken(scale)
    if not even and len(lines) == 1:
        lines[0].stack(room[0])
    gaps = [line.gap(room[0], count - 1) for line in lines]
    most, top, drawn = min(gaps) if even else LOOSE if len(lines) > 1 else np.inf, 0.0, np.zeros((count, 4))
    above = np.inf
    for line, gap in zip(lines, gaps, strict=True):
        is_last = any(count - 2 in column for column in line.columns)  # of the views
        left, above = 0.0, min(gap, most, above if is_last else np.inf)
        for column in line.columns:
            down, left = top, max(min(left, room[0] - line.width(column)), 0.0)
            apart = BETWEEN + (line.high - line.height(column)) / max(len(column) - 1, 1)  # down to the foot of its row
            for k in column:
                drawn[k] = left, down, *line.boxes[k]
                down += line.boxes[k, 1] + apart
            left += line.width(column) + above
        top += line.high + BETWEEN
    return Arrangement(drawn[None], (float((drawn[:, 0] + drawn[:, 2]).max()), float(top - BETWEEN)), scale)


@dataclass(frozen=True)
class _Row:
    """A row of columns, each the numbers of its boxes, of which `boxes` has width and height, (count, 2).

    apart: between its columns at least.
    """

    boxes: Values
    columns: list[list[int]]
    apart: float

    def width(self, column: list[int]) -> float:
        return float(self.boxes[column, 0].max())

    def height(self, column: list[int]) -> float:
        return float(self.boxes[column, 1].sum()) + BETWEEN * (len(column) - 1)

    @property
    def wide(self) -> float:
        return sum(map(self.width, self.columns)) + self.apart * (len(self.columns) - 1)

    @property
    def high(self) -> float:
        return max(map(self.height, self.columns))

    def stack(self, room: float) -> None:
        """Put the last views below the ones before them while the row is high enough; the key comes below them, or to
        the right of them where it is wider and has room in so many inches."""
        key = self.columns.pop() if len(self.columns[-1]) == 1 else [self.columns[-1].pop()]
        while len(self.columns) > 1 and len(self.columns[-2]) == 1:
            last = self.columns.pop()
            together = [*self.columns[-1], *last]
            if self.height([*together, *key]) > self.high:
                self.columns.append(last)
                break
            self.columns[-1] = together
        below, wide = [*self.columns[-1], *key], self.width(key)
        is_within = wide <= self.width(self.columns[-1]) or not self.has_room_beside(wide, room)
        if self.height(below) <= self.high and is_within:
            self.columns[-1] = below
        else:
            self.columns.append(key)

    def gap(self, room: float, key: int) -> float:
        """Inches between columns that take so many inches; what is free is before the key, where it has a column."""
        between = len(self.columns) - 1 - (self.columns[-1] == [key])
        return self.apart + max(room - self.wide, 0.0) / between if between > 0 else np.inf

    def has_room_beside(self, wide: float, room: float) -> bool:
        return self.wide + self.apart + wide <= room

    def has_room_below(self, wide: float, high: float, room: float) -> bool:
        """Whether a box has room below the last column, in a row that is no wider than so many inches."""
        more = max(wide - self.width(self.columns[-1]), 0.0)
        return self.height(self.columns[-1]) + BETWEEN + high <= self.high and self.wide + more <= room


def in_rows(
    count: int,
    arranged: Callable[[int, int], Arrangement],
    most: int,
    width: float,
    worth: float = WORTH,
    flat: float = 1.0,
    ragged: bool = False,
) -> tuple[int, Arrangement]:
    """The number of columns, and the arrangement, in which so many boxes are largest, nearly so in fewer rows.

    arranged: the arrangement in so many rows and columns. most: rows that are tried. width: what it may have.
    worth: a scale so many times larger is worth another row. flat: the height of boxes over the least that is read, at
    one scale: lower ones are drawn higher in more columns. ragged: whether rows have boxes of their own number.
    """
    best: tuple[int, Arrangement] | None = None
    largest = 0.0
    for rows in range(1, min(count, most) + 1):
        columns = -(-count // rows)
        if -(-count // columns) != rows and not ragged:
            continue
        layout = arranged(rows, columns)
        fits = layout.size[0] <= width + 1e-6
        seen = layout.scale * min(layout.factor, layout.factor * flat, 1.0)
        if best is None or best[1].size[0] > width + 1e-6 or (fits and seen > worth * largest):
            best, largest = (columns, layout), seen
    assert best is not None
    return best
