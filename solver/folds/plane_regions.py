"""The regions into which curves divide the unit square, on a raster."""

import numpy as np

from ..numerics.arrays import Booleans, Integers
from .curve_crossings import Pieces

_LEAST = 6  # points of the raster of a region


def regions_of(pieces: Pieces, n: int) -> tuple[Integers, list[tuple[int, int]]]:
    """The number of the region of each point of the raster (n, n), the largest region 0, and -1 in pieces of the
    square that are too small; and row and column of the point of each region that is farthest from its border."""
    import scipy.ndimage
    import scipy.sparse

    across, up = _cut(pieces, n, 0), _cut(pieces, n, 1)
    number = np.arange(n * n).reshape(n, n)
    right, above = ~across[:, : n - 1], ~up.T[: n - 1]
    one = np.concatenate([number[:, :-1][right], number[:-1][above]])
    other = np.concatenate([number[:, 1:][right], number[1:][above]])
    graph = scipy.sparse.coo_array((np.ones(one.size, dtype=np.int8), (one, other)), shape=(n * n, n * n))
    total, parts = scipy.sparse.csgraph.connected_components(graph, directed=False)
    size = np.bincount(parts, minlength=total)
    order = np.argsort(-size, kind="stable")
    rank = np.full(total, -1, dtype=np.int64)
    large = order[size[order] >= _LEAST]
    rank[large] = np.arange(large.size)
    labels = rank[parts].reshape(n, n)
    inner = []
    for region in range(large.size):
        away = scipy.ndimage.distance_transform_edt(np.pad(labels == region, 1))[1:-1, 1:-1]
        row, column = np.unravel_index(int(np.argmax(away)), away.shape)
        inner.append((int(row), int(column)))
    return labels, inner


def _cut(pieces: Pieces, n: int, axis: int) -> Booleans:
    """Whether a curve passes between two neighbouring points of the raster along an axis: of each line of points (n),
    and each gap (n, the last of which is beyond the border)."""
    cut = np.zeros((n, n), dtype=bool)
    first, last = pieces.first * n - 0.5, pieces.last * n - 0.5
    a, b = first[:, 1 - axis], last[:, 1 - axis]
    low, high = np.ceil(np.minimum(a, b)).astype(int), np.ceil(np.maximum(a, b)).astype(int)
    count = high - low
    piece = np.repeat(np.arange(count.size), count)
    line = np.repeat(low, count) + np.arange(piece.size) - np.repeat(np.cumsum(count) - count, count)
    share = (line - a[piece]) / (b[piece] - a[piece])
    place = first[piece, axis] + share * (last[piece, axis] - first[piece, axis])
    gap = np.floor(place).astype(int)
    inside = (line >= 0) & (line < n) & (gap >= 0) & (gap < n - 1)
    cut[line[inside], gap[inside]] = True
    return cut
