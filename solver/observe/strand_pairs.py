"""Pairs of stretches of a rod that come near each other: many rods at a time, by halving. Lengths in units of rho.

beta is periodic, so the curve repeats but for a screw: a turn and a rise, each period the same. Where two points meet,
so do the two that lie whole periods before them, the first of them in the first period. So the first period is compared
with itself and with each later one that comes near it; stretches of both are halved where they might meet. The pairs of
all rods are compared together; the result for one rod does not depend on the others.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core import measures as core_pairs
from ..numerics.arrays import Array, Integers
from ..orbit.marched_orbit import MarchedOrbit

PARTS = 16  # of a period, to begin with
FINEST = 2.0**-8  # of the radius: shorter stretches count as points, with an error of a thousandth of 2 a
_DEEPEST = 48  # halvings: the places of shorter stretches differ by rounding alone
_GRID = 4 * PARTS  # of a period: contains the middles of the parts and of their halves
_ROUNDS, PAIRS = 10_000_000, 300_000  # largest number of periods and of pairs of stretches compared for a rod
_WINDOW, TOGETHER, _FEW = 2**16, 8, 64  # periods listed at once; compared together; of a rod that needs no list
_ROWS, _MANY = 128, 2**20  # periods compared with the first, and pairs of all rods, at once


@dataclass(frozen=True, eq=False)
class Strands:
    """B rods.

    orbit: their orbits. period, turn, rise: (B,), the period and the gain of alpha and of z in it. length, a: (B,), of
    the rod, and its radius. apart: (B,), smallest distance along the rod of points that meet. alpha, z: (B, _GRID + 1),
    of the first period.
    """

    orbit: Any
    period: Array
    turn: Array
    rise: Array
    length: Array
    a: Array
    apart: Array
    alpha: Array
    z: Array


@dataclass(frozen=True, eq=False)
class Pairs:
    """Pairs of stretches, (N,) each: of which rod, rising; stretch i of the first period and stretch j of the k-th
    after it, where each period is cut into PARTS 2^level."""

    rod: Integers
    k: Integers
    i: Integers
    j: Integers
    level: int = 0

    def take(self, index: Any) -> "Pairs":
        """The pairs that an index picks."""
        return Pairs(self.rod[index], self.k[index], self.i[index], self.j[index], self.level)

    def halves(self) -> "Pairs":
        """The four pairs of halves of each pair."""
        rod, k, i, j = (np.repeat(v, 4) for v in (self.rod, self.k, self.i, self.j))
        child = np.arange(k.size) % 4
        return Pairs(rod, k, 2 * i + child // 2, 2 * j + child % 2, self.level + 1)


def strands(orbit: Any, length: Array, a: Array, tightest: Array) -> Strands:
    """The rods of an `Orbit` or a `MarchedOrbit`; length, a, largest curvature: (B,), in units of rho."""
    period = period_of(orbit, tightest)
    _, _, alpha, z = orbit.at((period / _GRID)[:, None] * np.arange(_GRID + 1))
    return Strands(orbit, period, alpha[:, -1], z[:, -1], length, a, apart(a, tightest), alpha, z)


def period_of(orbit: Any, tightest: Array) -> Array:
    """The lengths after which the rods repeat, (B,)."""
    with np.errstate(divide="ignore"):  # a helix repeats after any length
        return np.where(np.isfinite(orbit.period), orbit.period, 1 / tightest)


def whole_periods(length: Array, period: Array) -> Integers:
    """The number of periods compared, (B,)."""
    return np.minimum(length // period, _ROUNDS).astype(np.int64)


def apart(a: Array, tightest: Array) -> Any:
    """The smallest distance along the rod of two points that meet, (B,)."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(tightest > 0, 2 / tightest * (np.pi - np.arcsin(np.minimum(a * tightest, 1))), np.inf)


def meets(
    orbit: Any, length: Array, a: Array, tightest: Array, most_pairs: int = PAIRS, together: int = TOGETHER
) -> Array:
    """Whether each rod meets itself, as `meets_of`; rods that were marched are searched by the core.

    orbit, length, a, tightest: as of `strands`.
    """
    found, marched = np.empty(length.size), isinstance(orbit, MarchedOrbit)
    core = ~orbit.lost if marched else np.zeros(length.size, dtype=bool)
    if (rows := np.flatnonzero(~core)).size:
        rest = strands(orbit.pick(rows), length[rows], a[rows], tightest[rows])
        found[rows] = meets_of(rest, most_pairs, together)
    if (rows := np.flatnonzero(core)).size:
        mine, of = orbit.pick(rows), (length[rows], a[rows], tightest[rows])
        period = period_of(mine, of[2])
        numbers = {"period": period, "length": of[0], "a": of[1], "apart": apart(*of[1:])}
        limits = core_pairs.Limits(_ROUNDS, most_pairs, together)
        found[rows] = core_pairs.meets(mine, numbers, whole_periods(of[0], period), limits)
    return found


def meets_of(rods: Strands, most_pairs: int = PAIRS, together: int = TOGETHER) -> Array:
    """Whether each rod meets itself, (B,): 1 or 0, NaN where more than `most_pairs` pairs would have to be compared.

    Never 0 for a rod of which a shorter one gives 1: the points compared do not depend on the length. together: the
    number of periods of a rod compared at once; it does not change the result.
    """
    periods = whole_periods(rods.length, rods.period)
    # no point between two of the grid is farther from both than half their distance
    margin = rods.a + rods.period / _GRID
    high = np.ptp(rods.z, axis=1) + 2 * margin
    wide = np.ptp(rods.alpha, axis=1) + 2 * np.arcsin(np.minimum(1.0, margin))
    enough = (periods < _ROUNDS) | (np.abs(periods * rods.rise) > high)
    met, left = np.zeros(periods.size, dtype=bool), np.full(periods.size, most_pairs)
    rod, k, lists = _near_periods(rods, periods, high, wide, together)
    while k.size:
        here, used = _search(rods, rod, k, left)
        met, left = met | here, left - used
        lists = {i: ks for i, ks in lists.items() if left[i] > 0 and not met[i]}
        rod, k = _next(lists)
    return np.where(met, 1.0, np.where(enough & (left > 0), 0.0, np.nan))


def _near_periods(
    rods: Strands, periods: Integers, high: Array, wide: Array, together: int
) -> tuple[Integers, Integers, Any]:
    """Rods and periods k that come near the first period, (R,) each, to begin with; and lists of more."""
    first = _first_periods(rods)
    k = np.arange(min(int(periods.max()), _FEW - 1) + 1)
    near = _comes_near(k, rods.turn[:, None], rods.rise[:, None], high[:, None], wide[:, None])
    near &= (k >= first[:, None]) & (k <= periods[:, None])
    simple = (periods < _FEW) & (np.count_nonzero(near, axis=1) <= together)
    lists = {
        int(i): _list(int(first[i]), int(periods[i]), rods.turn[i], rods.rise[i], high[i], wide[i], together)
        for i in np.flatnonzero(~simple)
    }
    rod, k = np.nonzero(near & simple[:, None])
    more = _next(lists)
    rod, k = np.concatenate([rod, more[0]]), np.concatenate([k, more[1]])
    order = np.argsort(rod, kind="stable")
    return rod[order], k[order], lists


def _first_periods(rods: Strands) -> Integers:
    """The number of a period before which none is far enough along the rod from the first, (B,)."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.fmax(np.floor(np.fmin(rods.apart / rods.period, _ROUNDS)) - 2, 0).astype(np.int64)


def _comes_near(k: Any, turn: Any, rise: Any, high: Any, wide: Any) -> Any:
    around = np.abs(np.mod(k * turn + np.pi, 2 * np.pi) - np.pi)
    return (np.abs(k * rise) <= high) & (around <= wide)


def _list(
    first: int, periods: int, turn: float, rise: float, high: float, wide: float, together: int
) -> Iterator[Integers]:
    """The periods from number `first` on that come near the first one of a rod, some at a time."""
    last = min(periods, int(min(high / abs(rise), float(_ROUNDS))) + 1) if rise else periods
    for begin in range(first // _WINDOW * _WINDOW, last + 1, _WINDOW):
        k = np.arange(max(begin, first), min(begin + _WINDOW, last + 1))
        k = k[_comes_near(k, turn, rise, high, wide)]
        for block in range(0, k.size, together):
            yield k[block : block + together]


def _next(lists: dict[int, Iterator[Integers]]) -> tuple[Integers, Integers]:
    """Rods and the next periods of each list, (R,) each."""
    parts = [(i, ks) for i, some in lists.items() for ks in [next(some, None)] if ks is not None]
    none = np.empty(0, dtype=np.int64)
    rod = np.repeat([i for i, _ in parts], [ks.size for _, ks in parts]) if parts else none
    return rod.astype(np.int64), np.concatenate([none, *(ks for _, ks in parts)])


def _search(rods: Strands, rod: Integers, k: Integers, left: Integers) -> tuple[NDArray[np.bool_], Integers]:
    """Whether stretches of the first period of each rod meet those of its periods k, and the pairs compared, (B,) each.

    rod, k: (R,). left: (B,), how many pairs may be compared, about.
    """
    met, used = np.zeros(left.size, dtype=bool), np.zeros(left.size, dtype=np.int64)
    waiting = [_whole(rods, rod, k, used)]
    while waiting:
        pairs = waiting.pop()
        pairs = pairs.take(used[pairs.rod] <= left[pairs.rod])
        if not pairs.k.size:
            continue
        size = rods.period / PARTS * 0.5**pairs.level
        near, here = _near(rods, pairs, size)
        met[pairs.rod[here]] = True
        pairs = pairs.take(near & ~met[pairs.rod] & ((size > FINEST * rods.a) & (pairs.level < _DEEPEST))[pairs.rod])
        for some in _split(pairs):
            finer = some.halves()
            finer = finer.take(_possible(rods, finer, size / 2))
            used += np.bincount(finer.rod, minlength=used.size)
            waiting.append(finer)
    return met, used


def _split(pairs: Pairs) -> list[Pairs]:
    """The pairs in as many lots as memory requires; those of one rod stay together."""
    if 4 * pairs.k.size <= _MANY or pairs.rod[0] == pairs.rod[-1]:
        return [pairs]
    counts = np.bincount(pairs.rod)
    lot = np.cumsum(counts) // (_MANY // 4)
    edges = np.flatnonzero(np.diff(lot[pairs.rod])) + 1
    return [pairs.take(slice(a, b)) for a, b in zip([0, *edges], [*edges, pairs.k.size], strict=True)]


def _whole(rods: Strands, rod: Integers, k: Integers, used: Integers) -> Pairs:
    """The pairs of parts of the first and the k-th period whose heights allow them to meet.

    Adds to `used` (B,) the number of pairs that are on the rod, in order, and far enough apart along it.
    """
    part, middle = np.arange(PARTS), slice(2, None, 4)
    found: list[tuple[Integers, ...]] = []
    for block in (slice(b, b + _ROWS) for b in range(0, rod.size, _ROWS)):
        r, n = rod[block], k[block]
        size, length = (rods.period[r] / PARTS)[:, None], rods.length[r, None]
        before, begins = part * size, (n * rods.period[r])[:, None] + part * size
        some = (begins[:, None] >= before[:, :, None]) & (before < length)[:, :, None] & (begins < length)[:, None]
        some &= (begins + size)[:, None] - before[:, :, None] >= rods.apart[r, None, None]
        used += np.bincount(r, weights=np.count_nonzero(some, axis=(1, 2)), minlength=used.size).astype(np.int64)
        z = rods.z[r, middle]
        most = (2 * rods.a[r, None] + size) * (1 + 1e-12)
        later = z + (n * rods.rise[r])[:, None]
        some &= np.abs(later[:, None] - z[:, :, None]) <= most[:, :, None]
        row, i, j = np.nonzero(some)
        found.append((r[row], n[row], i, j))
    of, k, i, j = (np.concatenate(v) for v in zip(*found, strict=True))
    return Pairs(of, k, i, j)


def _possible(rods: Strands, pairs: Pairs, size: Array) -> Any:
    """Whether two stretches are on the rod, in order, and somewhere far enough apart along it, (N,)."""
    size, length = size[pairs.rod], rods.length[pairs.rod]
    begins, before = pairs.k * rods.period[pairs.rod] + pairs.j * size, pairs.i * size
    some = (before < length) & (begins < length) & (begins >= before)
    return some & (begins + size - before >= rods.apart[pairs.rod])


def _near(rods: Strands, pairs: Pairs, size: Array) -> tuple[Any, Any]:
    """Whether the stretches might meet, and whether their middles do, (N,) each."""
    rod, k = pairs.rod, pairs.k
    (alpha_i, alpha_j), (z_i, z_j) = _middles(rods, pairs, size)
    chord = 2 * np.sin((alpha_j + k * rods.turn[rod] - alpha_i) / 2)
    distance = np.hypot(chord, z_j + k * rods.rise[rod] - z_i)
    size, thick = size[rod], 2 * rods.a[rod]
    first, later = (pairs.i + 0.5) * size, k * rods.period[rod] + (pairs.j + 0.5) * size
    met = (distance < thick) & (later <= rods.length[rod]) & (later - first > np.pi * rods.a[rod])
    return distance <= thick + size, met


def _middles(rods: Strands, pairs: Pairs, size: Array) -> Any:
    """alpha and z in the middles of stretches i and j, ((N,), (N,)) each; each point of a rod is computed once."""
    step = 2 >> pairs.level
    if step:  # of the grid
        places = [(pairs.rod, step * (2 * v + 1)) for v in (pairs.i, pairs.j)]
        return [[values[place] for place in places] for values in (rods.alpha, rods.z)]
    parts = PARTS << pairs.level
    key = np.concatenate([pairs.rod * parts + pairs.i, pairs.rod * parts + pairs.j])
    points, place = np.unique(key, return_inverse=True)
    rod = points // parts
    both = rods.orbit.along(rod, (points % parts + 0.5) * size[rod])
    return [np.split(values[place], 2) for values in both]
