"""Regions of a map: cells of equal number or of a property, their borders along the edges of cells, room for a number.

A cell (j, i) has the values y[j] and x[i]; arrays over the cells are (rows, columns).
"""

from collections.abc import Iterator

import numpy as np
from matplotlib.path import Path
from numpy.typing import NDArray

Values = NDArray[np.float64]
Mask = NDArray[np.bool_]


def runs(mask: Mask) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
    """The runs of True in each row of a mask: the row, the first index and the index after the last, (runs,) each."""
    padded = np.zeros((mask.shape[0], mask.shape[1] + 2), dtype=np.int8)
    padded[:, 1:-1] = mask
    change = np.diff(padded, axis=1)
    row, first = np.nonzero(change == 1)
    return row, first, np.nonzero(change == -1)[1]


def path(mask: Mask, x: Values, y: Values) -> Path:
    """The cells of a mask as one path; x, y: the edges of the cells."""
    row, first, last = runs(mask)
    left, right, low, high = x[first], x[last], y[row], y[row + 1]
    corners = np.stack([left, low, right, low, right, high, left, high, left, low], axis=1).reshape(-1, 2)
    codes = np.tile(np.array([Path.MOVETO, Path.LINETO, Path.LINETO, Path.LINETO, Path.CLOSEPOLY], np.uint8), row.size)
    return Path(corners, codes)


def borders(numbers: Values, x: Values, y: Values) -> Values:
    """The lines between neighbouring cells of different numbers, (lines, 2 points, 2); none beside a NaN."""

    def differ(a: Values, b: Values) -> Mask:
        return (a != b) & np.isfinite(a) & np.isfinite(b)

    column, low, high = runs(differ(numbers[:, 1:], numbers[:, :-1]).T)
    upright = np.stack([x[column + 1], y[low], x[column + 1], y[high]], axis=1)
    row, first, last = runs(differ(numbers[1:], numbers[:-1]))
    level = np.stack([x[first], y[row + 1], x[last], y[row + 1]], axis=1)
    return np.concatenate([upright, level]).reshape(-1, 2, 2)


def places(numbers: Values, cell: tuple[float, float], room: tuple[float, float]) -> Iterator[tuple[float, int, int]]:
    """A place for the number of each region that has room: the number, and the row and the column of a cell.

    Parameters
    ----------
    numbers : array, (rows, columns)
        NaN belongs to no region.
    cell : pair of float
        Height and width of a cell in inches, in the mean.
    room : pair of float
        Half the height and half the width of the text of a number in inches.
    """
    from scipy import ndimage

    sizes = cell[0] / room[0], cell[1] / room[1]  # of a cell, where the half text is 1 x 1
    for number in np.unique(numbers[np.isfinite(numbers)]):
        areas, _ = ndimage.label(numbers == number)
        for k, box in enumerate(ndimage.find_objects(areas), 1):
            if min((part.stop - part.start) * size for part, size in zip(box, sizes, strict=True)) < 2:
                continue
            away = ndimage.distance_transform_edt(np.pad(areas[box] == k, 1), sampling=sizes)
            if away.max() >= 1 + min(sizes) / 2:  # from the middle of a cell to that of the nearest outside
                j, i = _most_central(away)
                yield float(number), box[0].start + j - 1, box[1].start + i - 1


def _most_central(away: Values) -> tuple[int, int]:
    """Of the cells that are about as far from the border as any, the one nearest to their middle."""
    found = np.argwhere(away >= 0.9 * away.max())
    nearest = found[np.abs(found - found.mean(axis=0)).sum(axis=1).argmin()]
    return int(nearest[0]), int(nearest[1])
