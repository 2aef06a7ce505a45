"""Where the rod would pass through itself: turns whose centrelines come closer than two radii.

Points pi a apart or less along the rod are close because they are neighbours: an arc no tighter than the rod itself
(radius a) keeps its ends two radii apart from there on. More is known (Schur): points less than
2/kappa (pi - asin(kappa a)) apart, kappa the largest curvature, cannot meet, so only farther ones are looked at.

beta repeats, so the curve repeats but for a screw: a turn and a rise, each period the same. Whatever two points meet,
so do the two that lie whole periods before them, the first of them in the first period. So the first period is held
against itself and against each later one that the rises bring near; stretches of both are halved where they might
meet. All lengths here are in units of rho.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from .reduced import Array, flat
from .solution import Solution

_PARTS = 16  # of a period, to begin with
_FINEST = 2.0**-8  # of the radius: stretches no longer than that are points, which a thousandth of 2 a may escape
_ROUNDS, _PAIRS = 10_000_000, 300_000  # periods and pairs of stretches looked at before giving up
_COARSE, _DENSE, _MOST = 0.5, 0.125, 200_000  # of the radius: stations apart; points made of them, and how many


def overlaps(sol: Solution, kappa_max: Any, low: Any, high: Any) -> Any:
    """1 where the rod would pass through itself, else 0, NaN where that cannot be told, (*cases).

    It does where two points farther apart along the rod than pi a come closer in space than 2 a, or where kappa a is 1
    or more. kappa_max: the largest curvature, (*cases) [1/length]; low, high: the smallest and largest beta, (*cases).
    Rods that keep their way along the axis, or about it for less than a turn, are told by these alone. Of the others
    points are taken from the orbit, as dense as the rod is thick; where the method knows none, from the stations, and
    where these are farther apart than a/2 a rod that does not meet itself at them might between them. A case that is
    not solved cannot be told either.
    """
    case, orbit = sol.case, sol.trajectory.orbit
    rho = flat(case.rho, case.shape)
    a = flat(case.rod.a, case.shape) / rho
    tightest = flat(kappa_max, case.shape) * rho
    found = np.full(case.size, np.nan)
    known = np.reshape(sol.solved, -1) & np.isfinite(tightest)
    thick = a * tightest >= 1
    with np.errstate(invalid="ignore", divide="ignore"):
        apart = np.where(tightest > 0, 2 / tightest * (np.pi - np.arcsin(np.minimum(a * tightest, 1))), np.inf)
        range_ = flat(low, case.shape), flat(high, case.shape)
        free = (sol.problem.span <= apart) | _climbs(*range_, a, apart)
        free |= _goes_round_once(*range_, a, apart, sol.problem.span)
    found[known & thick], found[known & ~thick & free] = 1, 0
    for i in np.flatnonzero(known & ~thick & ~free):
        length = float(sol.problem.span[i])
        if orbit is None:
            found[i] = _at_stations(sol, int(i), a[i])
        else:
            found[i] = meets(_strand(orbit.take(i), length, a[i], tightest[i]))
    whole = found if np.isnan(found).any() else found.astype(np.int64)
    return whole.reshape(case.shape)[()]


def _climbs(low: Array, high: Array, a: Array, apart: Array) -> Any:
    """Whether the rod keeps its way along the axis, and gains two radii there on any stretch long enough to meet."""
    way = np.round((low + high) / (2 * np.pi))
    ahead = np.maximum(np.abs(low - np.pi * way), np.abs(high - np.pi * way))
    return (ahead < np.pi / 2) & (np.cos(ahead) * apart > 2 * a)


def _goes_round_once(low: Array, high: Array, a: Array, apart: Array, span: Array) -> Any:
    """Whether the rod keeps its way about the axis, is less than a turn long, and gains two radii there likewise."""
    aside = np.floor((low + high) / (2 * np.pi)) + 0.5
    off = np.maximum(np.abs(low - np.pi * aside), np.abs(high - np.pi * aside))
    thick = 2 * np.arcsin(np.minimum(a, 1))
    return (off < np.pi / 2) & (np.cos(off) * apart > thick) & (span < 2 * np.pi - thick) & (a < 1)


def _apart(a: float, tightest: float) -> float:
    """How far apart along the rod two points that meet must be."""
    return 2 / tightest * (np.pi - np.arcsin(a * tightest)) if tightest > 0 else np.inf


@dataclass(frozen=True)
class Strand:
    """One rod: alpha and z of its points t (n,); what both gain each period; its length, its radius a, and how far
    apart along it points that meet must be."""

    curve: Callable[[Array], tuple[Array, Array]]
    period: float
    turn: float
    rise: float
    length: float
    a: float
    apart: float


def _strand(orbit: Any, length: float, a: float, tightest: float) -> Strand:
    def curve(t: Array) -> tuple[Array, Array]:
        _, _, alpha, z = orbit.at(t[None])
        return alpha[0], z[0]

    period = float(orbit.period[0])
    if not np.isfinite(period):  # a helix is its own image at any step
        period = 1 / tightest
    alpha, z = curve(np.array([period]))
    return Strand(curve, period, float(alpha[0]), float(z[0]), length, a, _apart(a, tightest))


def meets(rod: Strand) -> float:
    """1 or 0, or NaN where more would have to be looked at than is bearable; see `overlaps`. Never 0 for a rod of
    which a shorter one gives 1: the points looked at do not depend on the length."""
    first = min(rod.period, rod.length)
    alpha, z = rod.curve(np.linspace(0, first, 4 * _PARTS + 1))
    # no point between two of these is farther from both than half their distance
    margin = rod.a + first / (4 * _PARTS)
    high, wide = np.ptp(z) + 2 * margin, np.ptp(alpha) + 2 * np.arcsin(min(1.0, margin))
    rounds, left = int(min(rod.length // rod.period, _ROUNDS)), _PAIRS
    for begin in range(0, rounds + 1, 2**16):
        k = np.arange(begin, min(begin + 2**16, rounds + 1))
        if abs(k[0] * rod.rise) > high:
            return 0
        around = np.abs(np.mod(k * rod.turn + np.pi, 2 * np.pi) - np.pi)
        k = k[(np.abs(k * rod.rise) <= high) & (around <= wide)]
        for block in range(0, k.size, 8):
            met, used = _closed_in(rod, k[block : block + 8], left)
            left -= used
            if met:
                return 1
            if left <= 0:
                return np.nan
    return 0 if rounds < _ROUNDS or abs(rounds * rod.rise) > high else np.nan


def _closed_in(rod: Strand, k: Array, left: int) -> tuple[bool, int]:
    """Whether stretches of the first period meet those k periods on, (K,), and how many pairs were looked at: hardly
    more than `left`."""
    size, used = rod.period / _PARTS, 0
    k, i, j = (v.ravel() for v in np.meshgrid(k, np.arange(_PARTS), np.arange(_PARTS), indexing="ij"))
    while True:
        # whether two stretches are on the rod, in order, and anywhere far enough apart along it
        begins, before = k * rod.period + j * size, i * size
        some = (before < rod.length) & (begins < rod.length) & (begins >= before)
        some &= begins + size - before >= rod.apart
        k, i, j = k[some], i[some], j[some]
        used += k.size
        if not k.size or used > left:
            return False, used
        near, met = _near(rod, k, i, j, size)
        if met or size <= _FINEST * rod.a:
            return met, used
        k, i, j = (np.repeat(v[near], 4) for v in (k, i, j))
        size, child = size / 2, np.arange(k.size) % 4
        i, j = 2 * i + child // 2, 2 * j + child % 2


def _near(rod: Strand, k: Array, i: Array, j: Array, size: float) -> tuple[Array, bool]:
    """Which pairs of stretches might meet, and whether the middles of any two do."""
    parts, place = np.unique(np.concatenate([i, j]), return_inverse=True)
    at = (parts + 0.5) * size
    alpha, z = rod.curve(at)
    one, other = np.split(place, 2)
    chord = 2 * np.sin((alpha[other] + k * rod.turn - alpha[one]) / 2)
    distance = np.hypot(chord, z[other] + k * rod.rise - z[one])
    later = k * rod.period + at[other]
    met = (distance < 2 * rod.a) & (later <= rod.length) & (later - at[one] > np.pi * rod.a)
    return distance <= 2 * rod.a + size, bool(met.any())


def _at_stations(sol: Solution, i: int, a: float) -> float:
    """The same from the stations of case i alone."""
    t, told = sol.t[i], sol.trajectory
    alpha, z, beta = told.alpha[i], told.z[i], told.beta[i]
    points = np.stack([np.cos(alpha), np.sin(alpha), z], axis=-1)
    dense = np.diff(t).max() <= _COARSE * a
    if dense:
        s, c = np.sin(beta), np.cos(beta)
        tangent = np.stack([-s * np.sin(alpha), s * np.cos(alpha), c], axis=-1)
        kept = np.append(True, np.diff(t) > 0)
        count = int(min((t[-1] - t[0]) / (_DENSE * a), _MOST)) + 2
        even = np.linspace(t[0], t[-1], count)
        t, points = even, scipy.interpolate.CubicHermiteSpline(t[kept], points[kept], tangent[kept])(even)
    if t.size > _MOST:
        return np.nan
    pairs = scipy.spatial.cKDTree(points).query_pairs(2 * a, output_type="ndarray")
    met = bool((np.abs(t[pairs[:, 0]] - t[pairs[:, 1]]) > np.pi * a).any())
    whole = t[0] == 0 and t[-1] >= sol.problem.span[i] * (1 - 1e-12)
    return 1.0 if met else 0.0 if dense and whole else np.nan
