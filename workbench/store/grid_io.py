"""Read and write cases in flat order, piece by piece, where the file has one dimension for each axis."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

Where = tuple[slice, ...]
Slab = tuple[tuple[Any, ...], int]  # an index into the leading axes, and how many cases it picks

PACKED = 2**16  # values of an HDF5 chunk: 512 kB


def slabs(shape: tuple[int, ...], start: int, stop: int) -> Iterator[Slab]:
    """The cases `start` to `stop` of a grid as boxes, in order; a few for each axis, however many cases."""
    if not shape:
        yield (), 1
        return
    if len(shape) == 1:
        yield (slice(start, stop),), stop - start
        return
    inner = math.prod(shape[1:])
    (first, after), (last, before) = divmod(start, inner), divmod(stop, inner)
    if first == last:
        yield from _within(shape, first, after, before)
        return
    if after:
        yield from _within(shape, first, after, inner)
        first += 1
    if first < last:
        yield (slice(first, last), *(slice(None) for _ in shape[1:])), (last - first) * inner
    if before:
        yield from _within(shape, last, 0, before)


def _within(shape: tuple[int, ...], i: int, start: int, stop: int) -> Iterator[Slab]:
    for index, count in slabs(shape[1:], start, stop):
        yield (i, *index), count


def write(variable: Any, shape: tuple[int, ...], start: int, rows: NDArray[Any]) -> None:
    """Store rows (cases, ...) as the cases from `start` on of a variable over the grid, (*shape, ...)."""
    done = 0
    for index, count in slabs(shape, start, start + len(rows)):
        box = _extent(index, shape) + rows.shape[1:]
        variable[(*index, ...)] = rows[done : done + count].reshape(box)
        done += count


def read(variable: Any, shape: tuple[int, ...], start: int, stop: int) -> NDArray[Any]:
    """The rows of the cases `start` to `stop`, (cases, ...)."""
    inner = variable.shape[len(shape) :]
    boxes = [np.asarray(variable[(*index, ...)]).reshape(-1, *inner) for index, _ in slabs(shape, start, stop)]
    return np.concatenate(boxes)


def blocks(shape: tuple[int, ...], most: int) -> Iterator[Where]:
    """Slices that together cover an array in its order, each of at most so many numbers."""
    if not shape:
        yield ()
        return
    cut = next(k for k in range(len(shape)) if math.prod(shape[k + 1 :]) <= most or k == len(shape) - 1)
    step = max(1, most // math.prod(shape[cut + 1 :]))
    for outer in np.ndindex(*shape[:cut]):
        for start in range(0, shape[cut], step):
            stop = min(start + step, shape[cut])
            yield (*(slice(i, i + 1) for i in outer), slice(start, stop), *(slice(0, n) for n in shape[cut + 1 :]))


def packing(shape: tuple[int, ...]) -> tuple[int, ...]:
    """The shape of an HDF5 chunk: a stretch of the flat order."""
    sizes, left = [], PACKED
    for size in reversed(shape):
        sizes.append(max(1, min(size, left)))
        left //= size
    return tuple(reversed(sizes))


def _extent(index: tuple[Any, ...], shape: tuple[int, ...]) -> tuple[int, ...]:
    """The shape of a box: an axis that the index fixes is none."""
    ranges = (range(*part.indices(size)) for part, size in zip(index, shape, strict=True) if isinstance(part, slice))
    return tuple(len(one) for one in ranges)
