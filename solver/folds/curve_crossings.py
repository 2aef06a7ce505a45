"""Where straight lines in the plane of shares cross traced curves, and how the numbers of equilibria change there."""

from collections import Counter
from dataclasses import dataclass

import numpy as np

from ..numerics.arrays import Array, Integers


@dataclass(frozen=True, eq=False)
class Pieces:
    """The pieces of all curves: first, last: (N, 2), their ends in shares; more: (N, 2), the side of two more
    equilibria; lower: (N,), the lower index of the two; curve: (N,), the number of the curve."""

    first: Array
    last: Array
    more: Array
    lower: Integers
    curve: Integers


def join_pieces(lines: list[tuple[Array, Array]], lower: list[int]) -> Pieces:
    """The pieces of curves given as polylines (points, side of each)."""
    empty = np.zeros((0, 2))
    first = np.concatenate([empty, *(line[:-1] for line, _ in lines)])
    last = np.concatenate([empty, *(line[1:] for line, _ in lines)])
    more = np.concatenate([empty, *(side[:-1] for _, side in lines)])
    count = [line.shape[0] - 1 for line, _ in lines]
    whole = np.repeat(np.array(lower, dtype=np.int64), count)
    return Pieces(first, last, more, whole, np.repeat(np.arange(len(lines)), count))


def crossings(pieces: Pieces, start: Array, end: Array) -> tuple[Integers, Array, Array]:
    """The pieces that the line from start (2,) to end (2,) crosses, where (shares of the line), and the sign: +1 where
    it enters the side of two more equilibria."""
    along = end - start
    side_first, side_last = (_cross(along, point - start) for point in (pieces.first, pieces.last))
    piece = pieces.last - pieces.first
    side_start, side_end = _cross(piece, start - pieces.first), _cross(piece, end - pieces.first)
    hit = np.flatnonzero(((side_first > 0) != (side_last > 0)) & ((side_start > 0) != (side_end > 0)))
    place = side_start[hit] / (side_start[hit] - side_end[hit])
    normal = np.stack([-piece[hit, 1], piece[hit, 0]], axis=1)  # the line crosses the piece along this normal
    toward = np.sign((normal @ along) * (normal * pieces.more[hit]).sum(axis=1))
    return hit, place, toward


def change_along(pieces: Pieces, start: Array, end: Array) -> Counter[int]:
    """How many more equilibria of each index exist at the end of a straight line than at its start."""
    hit, _, toward = crossings(pieces, start, end)
    change: Counter[int] = Counter()
    for lower, sign in zip(pieces.lower[hit], toward, strict=True):
        for index in (int(lower), int(lower) + 1):
            change[index] += int(sign)
    return Counter({index: n for index, n in change.items() if n})


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
