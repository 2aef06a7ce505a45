"""Where the views of a scene stand: in rows and columns, each in a box as large as what it shows. No OpenGL.

Lengths are in pixels at `style.DPI`; a picture's are from its upper left.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from . import measure
from .camera import Camera
from .cells import Cell
from .views import View

GAP = 26.0  # between columns
BELOW = 10.0  # from a view to its caption
BETWEEN = 24.0  # from a caption to the next row
EDGE = 3.0  # around what is drawn, for its lines; above and below not where rows have a pitch
EMPTY = 150.0  # least width of a column with a cell without a rod, for its reason
DOT = 42.0  # the width of the dot of an equilibrium and the gap after it


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
    """All boxes of a picture, row by row, its width and height, and the pixels per length at which they fit."""

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
    size = _sizes(rows, camera)
    wide, high = size[..., 0].max(axis=0), size[..., 1].max(axis=1)
    edge = 0.0 if pitch else EDGE
    least = np.array([max(map(_least_width, column)) for column in zip(*rows, strict=True)])
    words = np.array([max(_words(view.cell) for view in row) for row in rows])
    below = np.where(words > 0, words + BELOW, 0.0) + BETWEEN
    below[-1] -= BETWEEN
    below = np.zeros(len(high)) if pitch else below
    free = room[0] - gutter - (len(wide) - 1) * GAP

    def over(per_unit: float) -> float:
        return float(np.maximum(wide * per_unit + 2 * EDGE, least).sum() - free)

    most = (room[1] - below.sum() - 2 * edge * len(high)) / (high.sum() * (pitch or 1.0))
    most = max(float(most), 1e-9)
    per_unit = most if over(most) <= 0 else float(brentq(over, 0.0, most)) if over(0.0) < 0 else free / wide.sum()
    widths = np.maximum(wide * per_unit + 2 * EDGE, least)
    heights = high * per_unit + 2 * edge
    if pitch:
        below = heights * (pitch - 1)
    left = gutter + np.concatenate([[0.0], np.cumsum(widths[:-1] + GAP)])
    top = np.concatenate([[0.0], np.cumsum(heights[:-1] + below[:-1])])
    boxes = [
        [Box(view.cell, left[j], top[i], widths[j], heights[i]) for j, view in enumerate(row)]
        for i, row in enumerate(rows)
    ]
    return Arrangement(boxes, (float(left[-1] + widths[-1]), float(top[-1] + heights[-1] + below[-1])), per_unit)


def in_rows(views: Sequence[View], camera: Camera, room: tuple[float, float], filler: View) -> list[list[View]]:
    """The views in as many rows as let them be largest; the last row is filled up.

    Of almost equal scales that with fewer rows.
    """
    best: tuple[float, list[list[View]]] = (0.0, [list(views)])
    for count in range(1, min(len(views), 6) + 1):
        columns = -(-len(views) // count)
        if -(-len(views) // columns) != count:
            continue
        rows = [list(views[i : i + columns]) for i in range(0, len(views), columns)]
        rows[-1] += [filler] * (columns - len(rows[-1]))
        scale = arrange(rows, camera, room).per_unit
        if scale > 1.05 * best[0]:
            best = scale, rows
    return best[1]


def _sizes(rows: Sequence[Sequence[View]], camera: Camera) -> np.ndarray:
    """Width and height of what each view shows, (rows, columns, 2) [length]; 0 without rods."""
    found = np.zeros((len(rows), len(rows[0]), 2))
    for i, row in enumerate(rows):
        for j, view in enumerate(row):
            if view.bodies:
                low, high = view.box(camera)
                found[i, j] = high - low
    if not found.any():
        found[:] = 1.0
    return found


def _words(cell: Cell) -> float:
    """The height of the words below a view."""
    return measure.height(cell.caption)


def _least_width(view: View) -> float:
    lines = view.cell.caption.split("\n")
    wide = max(measure.width(line) for line in lines)
    wide = max(wide, measure.width(lines[0]) + DOT) if view.cell.number is not None else wide
    return max(wide, EMPTY if view.cell.why_empty else 0.0)
