"""Grids of cases piece by piece: boxes that follow one another in the flat order, the last axis fastest."""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import xarray as xr

Where = tuple[slice, ...]  # a box of cases
Columns = dict[str, NDArray[Any]]  # name in the file -> (cases, ...)

AT_ONCE = 100_000  # cases that are read at a time
CHUNK = 2**16  # values of an HDF5 chunk: 512 kB


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


def pieces(
    variables: "Mapping[Any, xr.Variable]", names: Sequence[str], most: int | None = None
) -> "Iterator[dict[str, xr.Variable]]":
    """These variables of a dataset and `solved`, as far as it has them, in memory, for at most so many cases.

    most: default: `AT_ONCE`.
    """
    solved = variables["solved"]
    known = [name for name in dict.fromkeys(["solved", *names]) if name in variables]
    for where in blocks(solved.shape, AT_ONCE if most is None else most):
        box = dict(zip(solved.dims, where, strict=True))
        yield {name: variables[name].isel(box, missing_dims="ignore").load() for name in known}


def span(where: Where, shape: tuple[int, ...]) -> tuple[int, int]:
    """The first and the last + 1 of the cases of a box of `blocks`, in flat order."""
    start = int(np.ravel_multi_index([part.start for part in where], shape)) if shape else 0
    return start, start + math.prod(extent(where))


def extent(where: Where) -> tuple[int, ...]:
    """The shape of a box."""
    return tuple(part.stop - part.start for part in where)


def chunk_shape(shape: tuple[int, ...]) -> tuple[int, ...]:
    """The shape of an HDF5 chunk: a stretch of the flat order."""
    sizes, left = [], CHUNK
    for size in reversed(shape):
        sizes.append(max(1, min(size, left)))
        left //= size
    return tuple(reversed(sizes))
