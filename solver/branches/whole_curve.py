"""A fold or pitchfork curve as its points and as a fine polyline, and how lines across such curves change counts."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..numerics.arclength import FOLD
from ..numerics.arrays import ROUGHLY, Array, Booleans, Integers
from .fold_tracing import STOPPED, Point, SpecialLine

PIECES = 8  # of the polyline between two points: with it a curve looks smooth. x10: only memory


@dataclass(frozen=True, eq=False)
class WholeCurve:
    """N points of a curve in order.

    kind: FOLD or PITCHFORK. z: (N, 2), in the unit square. ways: (N, 2), unit tangents in the order of the points, zero
    at a cusp. more: (N, 2), towards the side of two more equilibria, zero where it changes. dbeta0: (N,), beta_t(0).
    marks: (N, m), numbers that tell the equilibria from others. ends: how it ends at either side. lower: the lower
    Morse index of the two equilibria that meet.
    """

    kind: str
    z: Array
    ways: Array
    more: Array
    dbeta0: Array
    marks: Array
    ends: tuple[str, str]
    lower: int

    @property
    def cusps(self) -> Integers:
        """The numbers of the points that are cusps."""
        return np.flatnonzero(~self.more.any(axis=1) & (self.kind == FOLD) & (len(self.z) > 1))

    def holds(self, z: Array, mark: Array) -> bool:
        """Whether an equilibrium at z lies on the curve."""
        return lies_on(np.column_stack([self.z, self.marks]), np.append(z, mark))

    def dense(self) -> tuple[Array, Array]:
        """The curve as a fine polyline (M, 2), and towards which side two more equilibria exist, (M, 2).

        Between two points it is the cubic with the tangents of both.
        """
        if len(self.z) < 2:
            return self.z, self.more
        chord = np.linalg.norm(np.diff(self.z, axis=0), axis=1)[:, None, None]
        t = (np.arange(PIECES) / PIECES)[None, :, None]
        a, b, m, n = self.z[:-1, None], self.z[1:, None], self.ways[:-1, None] * chord, self.ways[1:, None] * chord
        line = (2 * t**3 - 3 * t**2 + 1) * a + (t**3 - 2 * t**2 + t) * m + (3 * t**2 - 2 * t**3) * b + (t**3 - t**2) * n
        has_side = np.asarray(self.more.any(axis=1))  # a cusp has no side of its own
        side = np.where(has_side[:-1, None], self.more[:-1], self.more[1:])
        return np.vstack([line.reshape(-1, 2), self.z[-1:]]), np.vstack([np.repeat(side, PIECES, axis=0), side[-1:]])

    @property
    def exact(self) -> Booleans:
        """Which of the points of `dense` are points of the curve itself, (M,)."""
        return np.arange(PIECES * (len(self.z) - 1) + 1) % PIECES == 0


def whole_curve(line: SpecialLine[Point]) -> WholeCurve:
    """A traced line as a curve."""
    points, kind, lower = line.points, line.first.kind, line.first.lower
    z, more = (np.array([getattr(point, name) for point in points]) for name in ("z", "more"))
    chord = np.gradient(z, axis=0) if len(z) > 1 else np.zeros_like(z)
    ways = np.array([point.way * np.sign(point.way @ along) for point, along in zip(points, chord, strict=True)])
    if kind == FOLD:
        ways[~more.any(axis=1)] = 0.0
    dbeta0 = np.array([point.dbeta0 for point in points])
    return WholeCurve(kind, z, ways, more, dbeta0, np.array([point.mark for point in points]), line.ends, lower)


def fold_alone(z: Array, dbeta0: float, mark: Array) -> WholeCurve:
    """A fold curve of which nothing but one point is known."""
    none = np.zeros((1, 2))
    return WholeCurve(FOLD, z[None], none, none, np.array([dbeta0]), mark[None], (STOPPED, STOPPED), 0)


def lies_on(points: Array, x: Array) -> bool:
    """Whether x (n,) lies on the polyline through points (N, n), as closely as such a polyline follows its curve."""
    first, last = (points[:-1], points[1:]) if len(points) > 1 else (points, points)
    chord = last - first
    share = np.clip(((x - first) * chord).sum(axis=1) / np.maximum((chord * chord).sum(axis=1), 1e-300), 0, 1)
    far = np.linalg.norm(first + share[:, None] * chord - x, axis=1)
    # a point this near to a known curve lies on it
    return bool((far < ROUGHLY + 0.1 * np.linalg.norm(chord, axis=1)).any())


@dataclass(frozen=True, eq=False)
class CurvePieces:
    """The pieces of all curves: first, last: (N, 2), their ends in shares; more: (N, 2), the side of two more
    equilibria; lower: (N,), the lower index of the two."""

    first: Array
    last: Array
    more: Array
    lower: Integers


def pieces_of(curves: Sequence[WholeCurve]) -> CurvePieces:
    """The pieces of curves between the points of their polylines."""
    empty, lines = np.zeros((0, 2)), [curve.dense() for curve in curves]
    first = np.concatenate([empty, *(line[:-1] for line, _ in lines)])
    last = np.concatenate([empty, *(line[1:] for line, _ in lines)])
    more = np.concatenate([empty, *(side[:-1] for _, side in lines)])
    lower = np.array([curve.lower for curve in curves], dtype=np.int64)
    return CurvePieces(first, last, more, np.repeat(lower, [len(line) - 1 for line, _ in lines]))


def change_along(pieces: CurvePieces, start: Array, end: Array) -> Counter[int]:
    """How many more equilibria of each index exist at the end of a straight line than at its start.

    Each piece that the line crosses adds two, where the line enters their side, or takes them away.
    """
    along, piece = end - start, pieces.last - pieces.first
    side_first, side_last = (_cross(along, point - start) for point in (pieces.first, pieces.last))
    side_start, side_end = (_cross(piece, point - pieces.first) for point in (start, end))
    hit = ((side_first > 0) != (side_last > 0)) & ((side_start > 0) != (side_end > 0))
    normal = np.stack([-piece[hit, 1], piece[hit, 0]], axis=1)  # the line crosses the piece along this normal
    toward = np.sign((normal @ along) * (normal * pieces.more[hit]).sum(axis=1))
    change: Counter[int] = Counter()
    for lower, sign in zip(pieces.lower[hit].tolist(), toward.tolist(), strict=True):
        change.update({lower: int(sign), lower + 1: int(sign)})
    return without_zeros(change)


def without_zeros(counts: Counter[int]) -> Counter[int]:
    """The counts that are not 0."""
    return Counter({index: n for index, n in counts.items() if n})


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
