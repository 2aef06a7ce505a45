"""The algebra of the potential: where it turns, and how far it lies below a level, without losing digits.

Dimensionless throughout (lengths in rho): beta_t^2 + G(beta) = eta and beta_tt = -H(beta), H = G'/2; eqs. (32), (35).
A centre is a minimum of G (a stable helix of the dynamics in t), a saddle a maximum.
"""

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..numerics.arrays import Array
from ..numerics.roots import bracketed
from ..problem.reduced import Reduced

TAU = 2 * np.pi


def potential(problem: Any, beta: Any) -> Any:
    """G(beta), eq. (32) corrected; beta broadcasts against the problems' (B,)."""
    s, c = np.sin(beta), np.cos(beta)
    return (2 * (problem.lam - problem.mu * c) - s**3) * s + 2 * problem.phi * c


def slope(problem: Any, beta: Any) -> Any:
    """H(beta) = G'/2, eq. (35) corrected; written so that lam and mu cancel exactly about beta = 0 and beta = pi."""
    even, twist, rest = slope_terms(problem, np.sin(beta), np.cos(beta))
    return even + twist - rest


def slope_size(problem: Any, beta: Any) -> Any:
    """The size of the terms that `slope` is the sum of: its rounding is that many eps."""
    even, twist, rest = slope_terms(problem, np.sin(beta), np.cos(beta))
    return np.abs(even) + np.abs(twist) + np.abs(rest)


def slope_terms(problem: Any, s: Any, c: Any) -> tuple[Any, Any, Any]:
    """The terms of H = first + second - third, from sin and cos of beta."""
    s2, size = s * s, np.abs(c)
    even = (problem.lam - np.where(c < 0, -problem.mu, problem.mu)) * c
    # the rest of lam cos(beta) - mu cos(2 beta): |cos(beta)| - cos(2 beta), without a difference
    return even, problem.mu * (s2 * (1 + 2 * size) / (1 + size)), (problem.phi + 2 * c * s2) * s


def slope_bends(problem: Any, beta: Any) -> tuple[Any, Any]:
    """The second and the third derivative of H."""
    s, c = np.sin(beta), np.cos(beta)
    s2, c2 = 2 * s * c, (c - s) * (c + s)
    s4, c4 = 2 * s2 * c2, (c2 - s2) * (c2 + s2)
    # 2 cos sin^3 = sin(2b)/2 - sin(4b)/4
    second = -problem.lam * c + 4 * problem.mu * c2 + problem.phi * s + 2 * s2 - 4 * s4
    third = problem.lam * s - 8 * problem.mu * s2 + problem.phi * c + 4 * c2 - 16 * c4
    return second, third


def slope_rate(problem: Any, beta: Any) -> Any:
    """H'(beta): positive about a centre, negative about a saddle."""
    return slope_rate_of(problem, np.sin(beta), np.cos(beta))


def slope_rate_of(problem: Any, s: Any, c: Any) -> Any:
    """H'(beta) from sin and cos of beta."""
    return -problem.lam * s + 4 * problem.mu * s * c - problem.phi * c - 2 * s * s * (3 * c * c - s * s)


@dataclass(frozen=True, eq=False)
class Extrema:
    """The critical points of G in [-pi, pi) of B problems, rising; padded to (B, K) with NaN.

    beta: (B, K). centre: (B, K), whether each is a minimum of G; they alternate. count: (B,), even, at least 2.
    A saddle and a centre may share an angle, where H only touches zero: with nothing but twist, at an end of the axis.
    """

    beta: Array
    centre: NDArray[np.bool_]
    count: NDArray[np.int64]


@cache
def _grid() -> tuple[Array, Array]:
    """Angles and H, H' there as linear functions of (lam - mu, lam + mu, mu, phi, 1): (M,), (5, 2 M).

    Even spacing leaves at most one pair of roots of H in a cell; small loads gather three roots about beta = 0 and
    beta = pi, which points in geometric progression tell apart.
    """
    near = 2.0 ** -np.arange(6, 42)
    even = np.linspace(-np.pi, np.pi, 193)[:-1] + 1e-3
    angles = np.sort(np.concatenate([even, near, -near, [0.0], near - np.pi, np.pi - near]))
    s, c = np.sin(angles), np.cos(angles)
    up, size = c > 0, np.abs(c)
    bent = s * s * (1 + 2 * size) / (1 + size)
    value = [c * up, c * ~up, bent, -s, -2 * c * s**3]
    rate = [-s * up, -s * ~up, np.where(up, -s, s) + 2 * np.sin(2 * angles), -c, -2 * s * s * (3 * c * c - s * s)]
    return angles, np.hstack([value, rate])


def extrema(problem: Reduced) -> Extrema:
    """Every helix: the roots of H, found as sign changes on a grid and polished inside their brackets."""
    angles, basis = _grid()
    m = angles.size
    loads = np.array(
        [problem.lam - problem.mu, problem.lam + problem.mu, problem.mu, problem.phi, np.ones(problem.size)]
    )
    both = loads.T @ basis
    value, rate = both[:, :m], both[:, m:]
    right = np.append(angles[1:], angles[0] + TAU)
    # a root on the grid itself goes with its left neighbour, so that one where H only touches zero is none
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
    return Extrema(beta, centre, count)


def _crossing(lo: Array, hi: Array, v0: Array, v1: Array, r0: Array, r1: Array) -> Array:
    """Where the inverse cubic through two values and rates of opposite sign is zero; the secant's root if outside."""
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
        # H heads for zero from both sides, and its tangents reach it inside the cell
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
    """Rows, angles and whether it is a centre, of pairs of roots too near to 0 or -pi for the grid to tell apart.

    Where lam = mu, H = x (3/2 mu x - phi - 2 x^2) for small x = beta: one root is 0, and with hardly any axial force
    another is next to it; with none H only touches zero, a saddle and a centre in one. An orbit that passes them, and
    knows G only about some far extremum, would lose every digit. Likewise about pi where lam = -mu; its angles are no
    finer than a float's. known: rows of which the two roots about pi have been told apart.
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


@dataclass(frozen=True, eq=False)
class Well:
    """G about critical points o: G(o + x) - G(o) = -q K(x) with q = sin^2(x/2), exact to relative accuracy in x.

    The linear term 2 H(o) sin(x) is left out, so o must be a root of H. All fields (P, 1).
    """

    lam: Array
    mu: Array
    phi: Array
    o: Array
    level: Array
    _fixed: tuple[Array, ...]

    @classmethod
    def about(cls, problem: Reduced, o: Array, level: Any = 0.0) -> "Well":
        """Around o (P,), where eta - G(o) = level (P,)."""
        lam, mu, phi, o = (v[:, None] for v in (problem.lam, problem.mu, problem.phi, o))
        level = np.broadcast_to(level, o.shape[0])[:, None]
        s, c = np.sin(o), np.cos(o)
        fixed = s, c, mu * (c - s) * (c + s), 2 * mu * s * c, lam * s + phi * c - 2 * s**4
        return cls(lam, mu, phi, o, level, fixed)

    def take(self, index: Any) -> "Well":
        """The wells that an index picks."""
        picked = (v[index] for v in (self.lam, self.mu, self.phi, self.o, self.level))
        lam, mu, phi, o, level = picked
        return Well(lam, mu, phi, o, level, tuple(v[index] for v in self._fixed))

    @property
    def faintest(self) -> Array:
        """What of K no float of these loads can tell from nothing, (P, 1)."""
        return 1e-17 * (np.abs(self.lam) + np.abs(self.mu) + np.abs(self.phi) + 1)

    def weight(self, reach: Array) -> Array:
        """The size of the terms that K/4 is the sum of, within |x| <= reach (P,), (P,): its rounding is so many eps."""
        s, c, turn, bend, _ = (np.abs(v[:, 0]) for v in self._fixed)
        lam, phi = np.abs(self.lam[:, 0]), np.abs(self.phi[:, 0])
        x = np.minimum(reach, 1)
        return lam * s + phi * c + bend + turn * x + (s + x) ** 2

    def _near(self, sh: Array, ch: Array) -> tuple[Array, Array, Array, Array]:
        """sin(o + x), cos(o + x/2), and cos^2(o + x/2) (S^2 + 2 s S + 3 s^2) with its bracket, x by its half angle.

        o + x is never formed: next to o = pi it would cost the digits of x.
        """
        s, c = self._fixed[0], self._fixed[1]
        S = s * (1 - 2 * sh * sh) + 2 * c * sh * ch
        C = c * ch - s * sh
        bracket = S * S + s * (2 * S + 3 * s)
        return S, C, C * C * bracket, bracket

    def steepness(self, x: Array) -> Array:
        """K(x), (P, n): 4 times -H'(o) at x = 0."""
        sh, ch = np.sin(x / 2), np.cos(x / 2)
        return self._steepness(sh, ch, self._near(sh, ch)[2])

    def _steepness(self, sh: Array, ch: Array, near: Array) -> Array:
        _, _, turn, bend, fixed = self._fixed
        return 4 * (fixed - 2 * ch * (turn * sh + bend * ch) + near)

    def steepness_and_rate(self, x: Array) -> tuple[Array, Array]:
        """K(x) and K'(x), (P, n) each."""
        s, c, turn, bend, _ = self._fixed
        sh, ch = np.sin(x / 2), np.cos(x / 2)
        S, C, near, bracket = self._near(sh, ch)
        cos_x, sin_x = 1 - 2 * sh * sh, 2 * sh * ch
        rate = -C * (s * ch + c * sh) * bracket + 2 * C * C * (c * cos_x - s * sin_x) * (S + s)
        return self._steepness(sh, ch, near), 4 * (-turn * cos_x + bend * sin_x + rate)

    def drop(self, x: Array) -> Array:
        """G(o) - G(o + x) = q K, (P, n)."""
        return np.sin(x / 2) ** 2 * self.steepness(x)

    def speed2(self, x: Array) -> Array:
        """beta_t^2 = level + q K, (P, n)."""
        return self.level + self.drop(x)

    def ratio(self, x: Array, turn: Array) -> Array:
        """(G(turn) - G(x)) / (x^2 - turn^2), (P, n): smooth and exact through the turning point x = turn (P, 1)."""
        s, c, cos2o, sin2o, _ = self._fixed
        mid, d = (x + turn) / 2, x - turn
        sh, ch, sin_mid, cos_mid = np.sin(x / 2), np.cos(x / 2), np.sin(mid), np.cos(mid)
        S, _, near, bracket = self._near(sh, ch)
        sh1, ch1 = np.sin(turn / 2), np.cos(turn / 2)
        S1, C1, _, _ = self._near(sh1, ch1)
        inner = 2 * C1 * C1 * (c * cos_mid - s * sin_mid) * (S + S1 + 2 * s)
        inner = inner - bracket * (2 * s * c * cos_mid + (c - s) * (c + s) * sin_mid) - 2 * cos2o * cos_mid
        W = sin_mid * (self._steepness(sh, ch, near) + 8 * sh1 * sh1 * sin2o) + 4 * sh1 * sh1 * inner
        return 0.5 * np.sinc(d / TAU) * W / (x + turn)

    def turning(self, limit: Array) -> Array:
        """x with speed2(x) = 0 between 0 and `limit`, to relative accuracy, (P,) -> (P,).

        The level must lie below a saddle's o or above a centre's; in log(x) and log(drop) the root is nearly a
        straight line's, however small it is.
        """
        side = np.sign(limit)[:, None]
        wanted = np.log(np.abs(self.level))

        def f(y: Array) -> tuple[Array, Array]:
            x = side * np.exp(y[:, None])
            K, K_rate = self.steepness_and_rate(x)
            rate = x * (1 / np.tan(x / 2) + K_rate / K)
            return (np.log(np.sin(x / 2) ** 2 * np.abs(K)) - wanted)[:, 0], rate[:, 0]

        with np.errstate(divide="ignore", invalid="ignore"):
            # a first look at eighths of the way, and the parabola's law below the first of them
            shares = np.linspace(0.125, 1, 8)
            known = np.log(np.abs(self.drop(limit[:, None] * shares)))
            y = np.log(np.abs(limit))[:, None] + np.log(shares)
            row, cell = np.arange(limit.size), np.minimum(np.count_nonzero(known < wanted, axis=1), 7)
            high, above = y[row, cell], known[row, cell]
            first = cell == 0
            low = np.where(first, -700.0, y[row, cell - 1])
            rate = np.where(first, 2.0, (above - known[row, cell - 1]) / (high - low))
            guess = high + (wanted[:, 0] - above) / rate
            guess = np.where((guess >= low) & (guess <= high), guess, (low + high) / 2)
            return side[:, 0] * np.exp(bracketed(f, low, high, guess))
