"""G about one critical point, exact to relative accuracy in the distance from it."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..mechanics.potential import TAU
from ..numerics.arrays import Array
from ..numerics.roots import bracketed
from ..problem.reduced import Reduced


@dataclass(frozen=True, eq=False)
class LocalPotential:
    """G about critical points o: G(o + x) - G(o) = -q K(x) with q = sin^2(x/2), exact to relative accuracy in x.

    The linear term 2 H(o) sin(x) is left out, so o must be a root of H. level: eta - G(o). All fields are (P, 1).
    """

    lam: Array
    mu: Array
    phi: Array
    o: Array
    level: Array
    _fixed: tuple[Array, ...]

    @classmethod
    def about(cls, problem: Reduced, o: Array, level: Any = 0.0) -> "LocalPotential":
        """The potential about o (P,), where eta - G(o) = level (P,)."""
        lam, mu, phi, o = (v[:, None] for v in (problem.lam, problem.mu, problem.phi, o))
        level = np.broadcast_to(level, o.shape[0])[:, None]
        s, c = np.sin(o), np.cos(o)
        fixed = s, c, mu * (c - s) * (c + s), 2 * mu * s * c, lam * s + phi * c - 2 * s**4
        return cls(lam, mu, phi, o, level, fixed)

    def take(self, index: Any) -> "LocalPotential":
        """The potentials that an index selects."""
        picked = (v[index] for v in (self.lam, self.mu, self.phi, self.o, self.level))
        lam, mu, phi, o, level = picked
        return LocalPotential(lam, mu, phi, o, level, tuple(v[index] for v in self._fixed))

    @property
    def faintest(self) -> Array:
        """The rounding of K under these loads, (P, 1)."""
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

        The level must lie below a saddle's o or above a centre's; in log(x) and log(drop) the function is
        nearly linear, however small the root is.
        """
        side = np.sign(limit)[:, None]
        wanted = np.log(np.abs(self.level))

        def f(y: Array) -> tuple[Array, Array]:
            x = side * np.exp(y[:, None])
            K, K_rate = self.steepness_and_rate(x)
            rate = x * (1 / np.tan(x / 2) + K_rate / K)
            return (np.log(np.sin(x / 2) ** 2 * np.abs(K)) - wanted)[:, 0], rate[:, 0]

        with np.errstate(divide="ignore", invalid="ignore"):
            # start: interpolation between eighths of the limit, and the law of a parabola below the first of them
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
