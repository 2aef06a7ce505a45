"""The regions of a map pixel by pixel: the curves bound them, and the stored lattice says which is which."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

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
    everywhere, _ = _most(areas, coarse, numbers, count)
    found = np.where(share[areas] >= CLEAR, winner[areas], coarse)
    found = np.where(np.isnan(share)[areas], everywhere[areas], found)
    rows, columns = ndimage.distance_transform_edt(wall, return_distances=False, return_indices=True)
    return np.asarray(found[rows, columns])


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
