"""Room for words on a map: places inside regions, and places beside regions that are too small for their words.

Lengths are in inches, places are (up, across) from the lower left of the map.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray
from scipy import ndimage

from . import style

STEP = 0.025  # of the lattice on which places are looked for
PAD = 0.02  # around words
FAR = 0.5  # of the largest distance from other regions
NEAREST = 0.12  # from the words to what they name, at least

Place = tuple[float, float]


@dataclass(frozen=True, eq=False)
class Room:
    """The regions of a map on a fine lattice.

    Attributes
    ----------
    numbers
        The region at each place, (rows, columns) from below; NaN belongs to no region.
    inches
        Height and width of the map.
    taken
        Where words cannot stand, (rows, columns): borders, and what is drawn.
    """

    numbers: NDArray[np.float64]
    inches: tuple[float, float]
    taken: NDArray[np.bool_]

    @property
    def step(self) -> NDArray[np.float64]:
        """Height and width of a place of the lattice."""
        return np.array(self.inches) / self.numbers.shape

    def take(self, middle: Place, size: tuple[float, float]) -> None:
        """Keep words away from a box of that height and width."""
        low = np.floor((np.array(middle) - np.array(size) / 2) / self.step).astype(int).clip(0)
        high = np.ceil((np.array(middle) + np.array(size) / 2) / self.step).astype(int).clip(0)
        self.taken[low[0] : high[0], low[1] : high[1]] = True

    def region(self, place: Place) -> float:
        """The region at a place."""
        return float(self.numbers[self._index(place)])

    def take_curve(self, places: NDArray[np.float64]) -> None:
        """Keep words away from a curve, (n, 2)."""
        row, column = np.round(places / self.step).astype(int).clip(0, np.array(self.numbers.shape) - 1).T
        self.taken[row, column] = True

    def deepest(self, number: float) -> Place:
        """The middle of the places of a region that are far from other regions."""
        away = ndimage.distance_transform_edt(self.numbers == number, sampling=self.step)
        far = np.argwhere(away >= FAR * away.max())
        row, column = far[np.abs(far - far.mean(axis=0)).sum(axis=1).argmin()]
        return float((row + 0.5) * self.step[0]), float((column + 0.5) * self.step[1])

    def areas(self, number: float) -> list[NDArray[np.bool_]]:
        """The connected areas of a region, (rows, columns) each."""
        found, count = ndimage.label(self.numbers == number)
        return [found == k for k in range(1, count + 1)]

    def holds(self, area: NDArray[np.bool_], place: Place) -> bool:
        """Whether a place lies in an area."""
        return bool(area[self._index(place)])

    def inside(self, area: NDArray[np.bool_], size: tuple[float, float]) -> Place | None:
        """The middle of words of that height and width, as far inside an area as there is room; None without room."""
        free, low = self._free(size, area)
        if not free.any():
            return None
        away = ndimage.distance_transform_edt(np.pad(free, 1))[1:-1, 1:-1]
        row, column = np.unravel_index(int(np.argmax(away)), free.shape)
        return self._middle(row, column, low)

    def beside(self, place: Place, size: tuple[float, float], number: float | None = None) -> Place | None:
        """The middle of words of that height and width, as near to a place as there is room; None without room.

        number: the region in which they stand; default: any.
        """
        free, low = self._free(size, np.isfinite(self.numbers) if number is None else self.numbers == number)
        if not free.any():
            return None
        rows, columns = np.nonzero(free)
        middles = (np.column_stack([rows, columns]) + np.array(low) / 2) * self.step
        gaps = np.maximum(np.abs(middles - place) - np.array(size) / 2, 0)
        apart = np.hypot(*gaps.T)
        k = int(np.argmin(np.where(apart >= NEAREST, apart, np.inf)))
        return self._middle(rows[k], columns[k], low)

    def _free(self, size: tuple[float, float], mask: NDArray[np.bool_]) -> tuple[NDArray[np.bool_], tuple[int, int]]:
        """The lower left corners at which a box lies in a mask and covers nothing, and the places that it covers."""
        rows, columns = (max(int(np.ceil((length + 2 * PAD) / step)), 1)
                         for length, step in zip(size, self.step, strict=True))  # fmt: skip
        if rows > mask.shape[0] or columns > mask.shape[1]:
            return np.zeros((0, 0), dtype=bool), (rows, columns)
        blocked = self.taken | ~mask
        whole = np.pad(blocked.astype(np.int64).cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
        covered = whole[rows:, columns:] - whole[:-rows, columns:] - whole[rows:, :-columns] + whole[:-rows, :-columns]
        return covered == 0, (rows, columns)

    def _index(self, place: Place) -> tuple[int, int]:
        row, column = (np.array(place) / self.step).astype(int).clip(0, np.array(self.numbers.shape) - 1)
        return int(row), int(column)

    def _middle(self, row: Any, column: Any, low: tuple[int, int]) -> Place:
        return float((row + low[0] / 2) * self.step[0]), float((column + low[1] / 2) * self.step[1])


def room(numbers: Any, up: Any, across: Any, inches: tuple[float, float]) -> Room:
    """The room of a map.

    Parameters
    ----------
    numbers
        The region of each cell, (rows, columns) from below; NaN belongs to no region.
    up, across
        The edges of the cells as shares of the height and of the width, (rows + 1,) and (columns + 1,).
    inches
        Height and width of the map.
    """
    places = []
    for edges, length, count in zip((up, across), inches, np.shape(numbers), strict=True):
        middles = (np.arange(n := max(int(np.ceil(length / STEP)), count)) + 0.5) / n
        places.append(np.clip(np.searchsorted(np.asarray(edges)[1:-1], middles, side="right"), 0, count - 1))
    fine = np.asarray(numbers, dtype=float)[np.ix_(*places)]
    taken = np.zeros(fine.shape, dtype=bool)
    known = np.nan_to_num(fine, nan=-1e300)
    taken[1:] |= known[1:] != known[:-1]
    taken[:, 1:] |= known[:, 1:] != known[:, :-1]
    return Room(fine, inches, taken)


def size_of(said: str) -> tuple[float, float]:
    """Height and width of words in small letters, in lines."""
    lines = said.split("\n")
    return (1 + 1.25 * (len(lines) - 1)) * style.small() / 72, max(
        style.width_of(line, style.small()) for line in lines
    )


def write(ax: Axes, said: str, middle: Place, inches: tuple[float, float], zorder: float = 20) -> Any:
    """Write words about a place of a map."""
    halo = withStroke(linewidth=2.2, foreground="white", alpha=0.85)
    return ax.text(middle[1] / inches[1], middle[0] / inches[0], said, transform=ax.transAxes, ha="center",
                   va="center", size=style.small(), color=style.INK, path_effects=[halo], zorder=zorder)  # fmt: skip


def name_beside(ax: Axes, found: Room, number: float, said: str) -> bool:
    """Write the words of a region beside it, with a line that leads to a dot in it; False where there is no room."""
    size, place = size_of(said), found.deepest(number)
    middle = found.beside(place, size)
    if middle is None:
        return False
    to, start = (np.array(one)[::-1] / np.array(found.inches)[::-1] for one in (place, _edge(middle, size, place)))
    halo = [withStroke(linewidth=2.0, foreground="white", alpha=0.85)]
    look: dict[str, Any] = {"color": style.INK, "transform": ax.transAxes, "path_effects": halo, "clip_on": False}
    ax.plot(*np.transpose([start, to]), linewidth=0.7, zorder=18, gid="leader", **look)
    ax.plot(*to, "o", markersize=2.4, zorder=19, gid="end of a leader", **look)
    write(ax, said, middle, found.inches)
    found.take(middle, (size[0] + 2 * PAD, size[1] + 2 * PAD))
    return True


def _edge(middle: Place, size: tuple[float, float], place: Place) -> Place:
    """Where the line from a place to the middle of words meets the edge of their box."""
    way = np.array(place) - middle
    share = float(np.min(np.array(size) / 2 / np.maximum(np.abs(way), 1e-12)))
    return tuple(np.array(middle) + way * min(share, 1.0))
