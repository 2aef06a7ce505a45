"""Regions of a map: cells of equal number or of a property, their borders, room for a number, pixels between curves.

A cell (j, i) has the values y[j] and x[i]; arrays over the cells are (rows, columns).
"""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.path import Path
from numpy.typing import NDArray
from scipy import ndimage

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


def place(mask: Mask, cell: tuple[float, float], size: tuple[float, float]) -> tuple[float, float] | None:
    """The row and the column about which a box has most room inside a mask; None where it does not fit.

    Parameters
    ----------
    mask : array, (rows, columns)
    cell, size : pair of float
        Height and width of a cell in the mean, and of the box, in inches.
    """
    rows, columns = (max(int(np.ceil(length / step)), 1) for length, step in zip(size, cell, strict=True))
    if rows > mask.shape[0] or columns > mask.shape[1]:
        return None
    free = ndimage.uniform_filter(np.pad(mask, 1).astype(float), (rows, columns))[1:-1, 1:-1] > 1 - 0.5 / (
        rows * columns
    )
    if not free.any():
        return None
    away = ndimage.distance_transform_edt(np.pad(free, 1))[1:-1, 1:-1]
    central = np.argwhere(away >= 0.9 * away.max())
    row, column = central[np.abs(central - central.mean(axis=0)).sum(axis=1).argmin()]
    return float(row + 0.5 * (rows % 2)), float(column + 0.5 * (columns % 2))


def areas(numbers: Values) -> Iterator[tuple[float, Mask]]:
    """The connected areas of equal number, each with its number; NaN belongs to none."""
    for number in np.unique(numbers[np.isfinite(numbers)]):
        labels, count = ndimage.label(numbers == number)
        for k in range(1, count + 1):
            yield float(number), labels == k


PIXELS = 1200  # along the longer side
CLEAR = 0.98  # of the cells in an area: with fewer of one region the area is drawn as the lattice has it

Numbers = NDArray[np.int64]


def fine(regions: Any, lines: Sequence[Any]) -> Numbers:
    """The region at each pixel, (rows, columns), with the borders along the curves.

    Parameters
    ----------
    regions
        The region of each cell of the lattice, (m, n); -1 for none.
    lines
        The curves as points in shares of the width and the height of the map, (k, 2) each; NaN parts a curve.
    """
    regions = np.asarray(regions, dtype=np.int64)
    times = max(PIXELS // max(regions.shape), 1)
    shape = regions.shape[0] * times, regions.shape[1] * times
    coarse = np.repeat(np.repeat(regions, times, axis=0), times, axis=1)
    wall = _draw(lines, shape)
    areas, count = ndimage.label(~wall)
    if not count:
        return coarse
    numbers = np.unique(coarse)
    middles = (slice(times // 2, None, times),) * 2  # where the region of a cell is known
    winner, share = _most(areas[middles], regions, numbers, count)
    winner = np.where(np.isnan(share), _most(areas, coarse, numbers, count)[0], winner)
    areas_of_pixels = np.where((share < CLEAR)[areas], coarse, winner[areas])
    rows, columns = ndimage.distance_transform_edt(wall, return_distances=False, return_indices=True)
    return np.asarray(areas_of_pixels[rows, columns])


def _most(areas: Any, regions: Any, numbers: Any, count: int) -> tuple[Any, Any]:
    """The region that most places of each area have, (areas,), and their share; NaN where an area has none."""
    votes = np.stack([np.bincount(areas[regions == number], minlength=count + 1) for number in numbers])
    with np.errstate(invalid="ignore"):
        return numbers[votes.argmax(axis=0)], votes.max(axis=0) / votes.sum(axis=0)


def _draw(lines: Sequence[Any], shape: tuple[int, int]) -> NDArray[np.bool_]:
    """The pixels that curves pass through, without a gap at a corner."""
    wall = np.zeros(shape, dtype=bool)
    size = np.array(shape[::-1])
    for line in lines:
        points = np.asarray(line, dtype=float) * size - 0.5
        for a, b in pairwise(points):
            if not np.isfinite([a, b]).all():
                continue
            steps = np.linspace(0, 1, 2 + int(2 * np.abs(b - a).max()))[:, None]
            column, row = np.rint(a + (b - a) * steps).astype(int).T
            inside = (row >= 0) & (row < shape[0]) & (column >= 0) & (column < shape[1])
            wall[row[inside], column[inside]] = True
    return ndimage.binary_dilation(wall, structure=np.ones((2, 2)))
