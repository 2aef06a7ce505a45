"""Brackets of the levels at which the length of a path equals that of the rod, and the levels inside them.

The sign of the length less the rod's, along the grid of levels, shows every bracket but those of two roots between two
points of the grid; these are searched for wherever the length comes near the rod's without passing it (a dip).
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..core import levels as core
from ..numerics.arrays import Array, Booleans, Integers
from .level_grid import LevelGrid
from .transit_times import CUTTING, NODES, Boundary, Levels, Paths, TransitTimes, transit_times

_ZOOM, _ROUNDS = 17, 6  # points of the finer grid at a dip, and how often it is refined
_SHALLOW = 0.5  # of the rise to the next of even steps: the bottom lies less below the lowest point
_ROUNDING = 1e-14  # of the rod's length: bound of the rounding of a sum of times


@dataclass(frozen=True, eq=False)
class Brackets:
    """K pairs of levels between which the length of a path passes that of the rod, (K,) each.

    pin, sign: of both levels. first, second: their y, equal where the root is known already. path: number of the path.
    rises: whether the length grows with the level.
    """

    pin: Integers
    sign: Array
    first: Array
    second: Array
    path: Integers
    rises: Booleans

    def take(self, index: Any) -> "Brackets":
        return Brackets(**{name: v[index] for name, v in vars(self).items()})


def join_brackets(parts: list[Brackets]) -> Brackets:
    names = ("pin", "sign", "first", "second", "path", "rises")
    columns: dict[str, Any] = {name: np.concatenate([getattr(p, name) for p in parts]) for name in names}
    return Brackets(**columns)


def brackets_on_grid(
    boundary: Boundary, grid: LevelGrid, seen: TransitTimes, some: Paths, before: int
) -> tuple[Brackets, int]:
    """The brackets of N paths, of which the first has the number `before`; and the evaluations of G."""
    levels, counts = grid.levels, some.counts(boundary.rising)
    if not levels.y.size:  # no level joins the ends but a helix's own
        none = np.empty(0)
        return Brackets(none.astype(int), none, none, none, none.astype(int), none.astype(bool)), 0
    off = seen.lengths(counts) - boundary.problem.span[0]
    rate = seen.rates(counts)
    for own in np.flatnonzero(grid.place):  # at a saddle's own height the length is infinite, or continuous
        sides = [rate[:, j] for j in (own - 1, own + 1) if 0 <= j < levels.y.size]
        steep = np.fmax.reduce(sides) > 0
        off[:, own] = np.where(steep, np.inf, off[:, own] if own else np.nan)
    known, above = _above(off, boundary.problem.span[0])
    n, k = np.nonzero(known[:, :-1] & known[:, 1:] & (above[:, :-1] != above[:, 1:]))
    beside = grid.place[k] | grid.place[k + 1]
    real = np.where(grid.place[k], k + 1, k)  # the real one, beside a saddle's own height
    place = levels.take(np.where(beside, real, k + 1))
    with np.errstate(divide="ignore", invalid="ignore"):
        deep = place.y + np.where(rate[n, real] > 0, off[n, real] / rate[n, real], 0.0)
        # next to the level at which the rod begins or ends at rest the length is linear in beta_t there
        share = -off[n, k] / (off[n, k + 1] - off[n, k])
        rests = grid.at_end & (k == 1) & (rate[n, k] == 0)
        at_rest = np.maximum(levels.y[min(2, levels.y.size - 1)] + 2 * np.log(share), boundary.deepest)
    y = np.where(beside, deep, np.where(rests, at_rest, np.nan))
    first = np.where(np.isnan(y), levels.y[k], y)
    second = np.where(np.isnan(y), place.y, y)
    direct = Brackets(place.pin, place.sign, first, second, n + before, above[n, k + 1])
    dips, calls = _dips(boundary, grid, some, off)
    return join_brackets([direct, replace(dips, path=dips.path + before)]), calls


def _above(off: Array, span: float) -> tuple[Booleans, Booleans]:
    """Where lengths are known, and where they are not below the rod's, (N, M).

    A length that differs from the rod's by rounding alone takes the side of the level before it, so that rounding makes
    no bracket.
    """
    known = ~np.isnan(off)
    with np.errstate(invalid="ignore"):
        above, sure = off >= 0, ~(np.abs(off) <= _ROUNDING * span)
    sure[:, 1:] |= ~known[:, :-1]
    sure[:, 0] = True
    last = np.maximum.accumulate(np.where(sure, np.arange(off.shape[1]), 0), axis=1)
    return known, np.take_along_axis(above, last, axis=1)


def roots_in(boundary: Boundary, some: Brackets, counts: Array) -> tuple[Array, int]:
    """y of the root in each bracket, (K,), NaN where none was found; and the evaluations of G."""
    y = some.second.copy()
    open_ = np.flatnonzero(some.first != some.second)
    if not open_.size:
        return y, 0
    some, counts = some.take(open_), counts[open_]
    low, high = np.minimum(some.first, some.second), np.maximum(some.first, some.second)
    roots = core.level_roots(boundary, some.pin, some.sign, counts, low, high, NODES, CUTTING)
    if roots is None:  # the loads are not finite
        roots = np.full(open_.size, np.nan), 0
    y[open_] = roots[0]
    return y, roots[1]


def _dips(boundary: Boundary, grid: LevelGrid, some: Paths, off: Array) -> tuple[Brackets, int]:
    """Brackets of the two roots between grid points where the length comes near the rod's, passes it and returns."""
    counts, size = some.counts(boundary.rising), np.abs(off)
    with np.errstate(invalid="ignore"):
        same = (off[:, 1:-1] * off[:, :-2] > 0) & (off[:, 1:-1] * off[:, 2:] > 0)
        least = same & (size[:, 1:-1] < size[:, :-2]) & (size[:, 1:-1] <= size[:, 2:])
        # the bottom of a dip lies below its lowest point by a fraction of the rise to the next ones: of a parabola by
        # 1/8 at even steps, and by 4/5 where one step is four times the other
        rise = np.fmax(size[:, :-2] - size[:, 1:-1], size[:, 2:] - size[:, 1:-1])
        near = least & (size[:, 1:-1] < rise) & np.isfinite(rise)
    path, least_at = np.nonzero(near)
    out: list[tuple[int, float, float, float, int, bool]] = []
    calls = 0
    for n, k in zip(path, least_at + 1, strict=True):
        cells = grid.cell(int(k) - 1), grid.cell(int(k))
        if None in cells:
            continue
        found, more = _dip(boundary, cells, counts[n], bool(off[n, k] > 0))
        out += [(*cell, int(n), rises) for cell, rises in found]
        calls += more
    columns = zip(*out, strict=True) if out else iter([()] * 6)
    kinds = (int, float, float, float, int, bool)
    return Brackets(*(np.array(c, dtype=kind) for c, kind in zip(columns, kinds, strict=True))), calls


def _rise(size: Array, least: int) -> float:
    """How much the sizes rise from the least one to the next ones, which are at even steps."""
    beside = size[max(least - 1, 0) : least + 2]
    return float(beside.max() - size[least])


def _dip(boundary: Boundary, cells: Any, counts: Array, above: bool) -> tuple[list[Any], int]:
    """The cells in which the length of one path passes that of the rod, of two neighbouring cells refined.

    Each with whether the length grows with the level; and the evaluations of G.
    """
    calls = 0
    for _ in range(_ROUNDS):
        y = np.stack([np.linspace(a, b, _ZOOM) for _, _, a, b in cells])
        pin, sign = (np.repeat([cell[j] for cell in cells], _ZOOM) for j in (0, 1))
        seen = transit_times(boundary, Levels(pin, sign, y.reshape(-1)))
        calls += seen.calls
        length = seen.lengths_along(np.broadcast_to(counts, (pin.size, 3))).reshape(2, _ZOOM)
        off = length - boundary.problem.span[0]
        over = off >= 0
        if (over != above).any():
            passes = np.argwhere(over[:, :-1] != over[:, 1:])
            return [((*cells[a][:2], y[a, b], y[a, b + 1]), bool(over[a, b + 1])) for a, b in passes], calls
        if np.isnan(off).any():
            return [], calls
        least = int(np.argmin(np.abs(off)))
        if np.abs(off).min() > _SHALLOW * _rise(np.abs(off)[least // _ZOOM], least % _ZOOM):
            return [], calls
        c, j = divmod(least, _ZOOM)
        before = (c, j - 1) if j else (0, _ZOOM - 2)
        after = (c, j) if j < _ZOOM - 1 else (1, 0)
        cells = [(*cells[a][:2], y[a, b], y[a, b + 1]) for a, b in (before, after)]
    return [], calls
