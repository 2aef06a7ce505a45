"""The order of a sweep: which case each case continues from, and where blocks begin. It depends on the grid alone.

The first case is the middle of the grid, along a followed axis the first value. From it the cases continue along the
first axis, from each of these along the second, and so on: a tree in which each case is one step from the one it
continues from.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

LINE = 256  # cases of a line that is solved in one block where there are several lines
BLOCK_OF_ONE, BLOCK_OF_LONG = 8, 32  # cases a block: of a single line, and of lines longer than that


@dataclass(frozen=True)
class Grid:
    """The order of a sweep. shape: of the grid; places are counted along the axes, the last fastest. follows: whether
    the last axis is followed, from its first value on."""

    shape: tuple[int, ...]
    follows: bool = False

    @property
    def first(self) -> tuple[int, ...]:
        """The cell that the others continue from: the middle, or the begin of a followed axis."""
        middle = tuple((n - 1) // 2 for n in self.shape)
        return (*middle[:-1], 0) if self.follows else middle

    def cell(self, place: int) -> tuple[int, ...]:
        return tuple(int(i) for i in np.unravel_index(place, self.shape))

    def place(self, cell: tuple[int, ...]) -> int:
        return int(np.ravel_multi_index(cell, self.shape))

    def parent(self, place: int) -> tuple[int, int] | None:
        """The place that a case continues from, and the axis between the two; None for the first case."""
        cell, first = list(self.cell(place)), self.first
        for k in range(len(cell) - 1, -1, -1):
            if cell[k] != first[k]:
                cell[k] += 1 if cell[k] < first[k] else -1
                return self.place(tuple(cell)), k
        return None

    def pieces(self, start: int, stop: int) -> Iterable[tuple[int, int, int]]:
        """Of the cases `start` to `stop` each stretch on one line of the last axis: begin, end, and the case in it that
        the others of the stretch continue from."""
        n, middle = self.shape[-1], self.first[-1]
        a = start
        while a < stop:
            line = a // n * n
            b = min(line + n, stop)
            yield a, b, min(max(line + middle, a), b - 1)
            a = b


def block_size(shape: tuple[int, ...], most: int) -> int:
    """Cases a block, at most `most`: whole lines where they are short and several."""
    n = shape[-1]
    if len(shape) == 1 or math.prod(shape) == n:
        return max(1, min(BLOCK_OF_ONE, most))
    if n > min(LINE, most):
        return max(1, min(BLOCK_OF_LONG, most))
    return n * max(1, min(BLOCK_OF_LONG, most) // n)
