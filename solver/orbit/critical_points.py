"""The critical points of G (the roots of H): every helix of the given loads, centres and saddles, none missed."""

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from ..core import orbits as core
from ..core.panels import available
from ..mechanics.potential import TAU, slope, slope_rate
from ..numerics.arrays import Array, Booleans, Integers
from ..numerics.roots import bracketed
from ..problem.reduced import Reduced


@dataclass(frozen=True, eq=False)
class CriticalPoints:
    """The critical points of G in [-pi, pi) of B problems, rising; padded to (B, K) with NaN.

    beta: (B, K). centre: (B, K), whether each is a minimum of G; they alternate. count: (B,), even, at least 2.
    A saddle and a centre may share an angle, where H only touches zero: under twist alone, at beta = 0 or pi.
    """

    beta: Array
    centre: Booleans
    count: Integers


@cache
def grid() -> tuple[Array, Array]:
    """Angles and H, H' there as linear functions of (lam - mu, lam + mu, mu, phi, 1): (M,), (5, 2 M).

    Even spacing leaves at most one pair of roots of H in a cell; small loads gather three roots about beta = 0 and
    beta = pi, which points in geometric progression separate.
    """
    near = 2.0 ** -np.arange(6, 42)
    even = np.linspace(-np.pi, np.pi, 193)[:-1] + 1e-3
    angles = np.sort(np.concatenate([even, near, -near, [0.0], near - np.pi, np.pi - near]))
    s, c = np.sin(angles), np.cos(angles)
    up, size = c > 0, np.abs(c)
    bent = s * s * (1 + 2 * size) / (1 + size)
    value = [c * up, c * ~up, bent, -s, -2 * c * s**3]
    rate = [-s * up, -s * ~up, np.where(up, -s, s) + 2 * np.sin(2 * angles), -c, -2 * s * s * (3 * c * c - s * s)]
    return angles, np.ascontiguousarray(np.hstack([value, rate]))


def critical_points(problem: Reduced) -> CriticalPoints:
    """All critical points of G: the roots of H, found as sign changes on a grid and refined inside their brackets."""
    if available():
        found = core.critical_points(np.stack([problem.lam, problem.mu, problem.phi], axis=1), grid())
        if found is not None:
            return CriticalPoints(*found)
    return reference_critical_points(problem)


def reference_critical_points(problem: Reduced) -> CriticalPoints:
    """The same without the core."""
    angles, basis = grid()
    m = angles.size
    loads = np.array(
        [problem.lam - problem.mu, problem.lam + problem.mu, problem.mu, problem.phi, np.ones(problem.size)]
    )
    both = loads.T @ basis
    value, rate = both[:, :m], both[:, m:]
    right = np.append(angles[1:], angles[0] + TAU)
    # a root on the grid has the sign of its left neighbour, so that one where H only touches zero does not count
    rising = np.where(value == 0, np.roll(value, 1, axis=1), value) >= 0
    change = rising != np.roll(rising, -1, axis=1)
    row, cell = np.nonzero(change)
    lo, hi, up = angles[cell], right[cell], ~rising[row, cell]
    guess = _crossing(lo, hi, value[row, cell], value[row, (cell + 1) % m], rate[row, cell], rate[row, (cell + 1) % m])
    row2, lo2, hi2, up2 = _pairs(problem, angles, right, value, rate, change)
    if row2.size:
        guess = np.concatenate([guess, (lo2 + hi2) / 2])
        row, lo, hi, up = (np.concatenate(ab) for ab in ((row, row2), (lo, lo2), (hi, hi2), (up, up2)))
    loads_at = problem.take(row)
    sign = np.where(up, 1.0, -1.0)
    roots = bracketed(lambda x: (sign * slope(loads_at, x), sign * slope_rate(loads_at, x)), lo, hi, guess)
    roots = np.where(roots >= np.pi, roots - TAU, roots)
    row3, roots3, up3 = _touching(problem, angles, value, row2)
    if row3.size:
        row, roots, up = (np.concatenate(ab) for ab in ((row, row3), (roots, roots3), (up, up3)))
    order = np.lexsort((roots, row))
    row, roots, up = row[order], roots[order], up[order]
    count = np.bincount(row, minlength=problem.size)
    place = np.arange(row.size) - np.repeat(np.cumsum(count) - count, count)
    width = int(count.max(initial=0))
    beta = np.full((problem.size, width), np.nan)
    centre = np.zeros((problem.size, width), dtype=bool)
    beta[row, place], centre[row, place] = roots, up
    return CriticalPoints(beta, centre, count)


def _crossing(lo: Array, hi: Array, v0: Array, v1: Array, r0: Array, r1: Array) -> Array:
    """The root of the inverse cubic through two values of opposite sign and their rates; if outside, of the secant."""
    rise = v1 - v0
    w = -v0 / rise
    secant = lo + (hi - lo) * w
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        cubic = secant + w * (1 - w) * ((1 - w) * (rise / r0 - (hi - lo)) - w * (rise / r1 - (hi - lo)))
        return np.where((cubic - lo) * (cubic - hi) <= 0, cubic, secant)


def _pairs(
    problem: Reduced, angles: Array, right: Array, value: Array, rate: Array, change: Any
) -> tuple[Any, Array, Array, Any]:
    """Brackets of two roots of H that share a cell: row, lo, hi, whether H rises through each."""
    v2, r2 = np.roll(value, -1, axis=1), np.roll(rate, -1, axis=1)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        # H approaches zero from both sides, and its tangents reach zero inside the cell
        reach = np.abs(value / rate) + np.abs(v2 / r2) < right - angles
    row, cell = np.nonzero(~change & (value * rate < 0) & (v2 * r2 > 0) & reach)
    if not row.size:
        return row, np.empty(0), np.empty(0), np.empty(0, dtype=bool)
    at, lo, hi = problem.take(row), angles[cell], right[cell]
    sign = np.sign(r2[row, cell])
    tip = bracketed(
        lambda x: (
            sign * slope_rate(at, x),
            (slope_rate(at, x + 1e-6) - slope_rate(at, x - 1e-6)) / 2e-6 * sign,
        ),
        lo,
        hi,
    )
    crosses = slope(at, tip) * value[row, cell] < 0
    row, lo, hi, tip, start = row[crosses], lo[crosses], hi[crosses], tip[crosses], value[row, cell][crosses]
    ends = np.concatenate([lo, tip]), np.concatenate([tip, hi])
    return np.concatenate([row, row]), *ends, np.concatenate([start < 0, start >= 0])


def _touching(problem: Reduced, angles: Array, value: Array, known: Any) -> tuple[Any, Array, Any]:
    """Rows, angles and whether each is a centre, of pairs of roots that the grid cannot separate about 0 and -pi.

    Where lam = mu, H = x (3/2 mu x - phi - 2 x^2) for small x = beta: one root is 0, and under a small axial force
    another is next to it; without axial force H only touches zero, a saddle and a centre in one. An orbit that passes
    them would lose every digit if G were known about a far critical point only. Likewise about pi where lam = -mu,
    where angles are no finer than a float's. known: rows whose two roots about pi are separated already.
    """
    zero = int(np.searchsorted(angles, 0.0))
    found: list[tuple[Any, Array, Any]] = []
    for at, sign, before, after in (
        (0.0, 1, value[:, zero - 1], value[:, zero + 1]),
        (-np.pi, -1, value[:, -1], value[:, 0]),
    ):
        row = np.flatnonzero((problem.lam == sign * problem.mu) & (before * after > 0))
        row = row[~np.isin(row, known)] if at else row
        mu, phi = sign * problem.mu[row], sign * problem.phi[row]
        with np.errstate(over="ignore"):
            other = at + sign * 2 * phi / (1.5 * mu + np.copysign(np.sqrt(np.maximum(2.25 * mu * mu - 8 * phi, 0)), mu))
        other = np.where(other < -np.pi, other + TAU, other)
        # H has one sign outside the two: where that is minus, the first of them in rising order is the centre
        first = (before[row] < 0) ^ (other < at) ^ (other > at + 1)
        found += [(row, np.full(row.size, at), first), (row, other, ~first)]
    row, roots, up = (np.concatenate(parts) for parts in zip(*found, strict=True))
    return row, roots, up
