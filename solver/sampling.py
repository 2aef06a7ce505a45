"""Where along the rod the observables are read: points that do not depend on the stations asked for.

Where the method knows the orbit: composite Gauss points over one period, counted as often as it repeats, and over what
is left of the rod. Elsewhere the stations themselves, with straight lines between them.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np

from .methods.base import Trajectory
from .reduced import Array
from .solution import Solution

ORBITS = ("orbit", "swing", "shooting")  # the methods that know the orbit

_PARTS, _POINTS = 96, 6
_ZOOMS, _ZOOM_POINTS = 6, 17

Quantity = Callable[[Solution], Array]


@dataclass(frozen=True, eq=False)
class Sampled:
    """A solution read at points that show all of each rod.

    solution: at the points, arrays (*cases, K). parts: (B, P), lengths in t of the parts, as often as they count; each
    part has the same rule of points. pitch: (B, 1), the length in t of a part of the first round.
    """

    solution: Solution
    parts: Array
    pitch: Array
    read: Callable[[Array], Solution] | None

    def integral(self, quantity: Quantity) -> Any:
        """Integral along the rod of a smooth quantity, (*cases) [its unit times length]."""
        values = self._split(quantity(self.solution))
        weights = _rule(values.shape[-1])[1]
        return self._whole((values @ weights * self.parts).sum(axis=1))

    def integral_of_size(self, quantity: Quantity) -> Any:
        """Integral of |quantity|, its changes of sign found inside the parts, (*cases)."""
        values = self._split(quantity(self.solution))
        if self.read is None:  # the trapezoidal rule's error in |f| is smallest when its kinks are left alone
            return self.integral(lambda at: np.abs(quantity(at)))
        return self._whole((_signed(values)[0] * self.parts).sum(axis=1))

    def share_not_negative(self, quantity: Quantity) -> Any:
        """Share of the length on which quantity >= 0, (*cases)."""
        values = self._split(quantity(self.solution))
        share = (_signed(values)[1] * self.parts).sum(axis=1) / self.parts.sum(axis=1)
        return self.solution._each(np.clip(share, 0, 1))

    def largest(self, quantity: Quantity) -> Any:
        """Largest value along the rod, (*cases), found by closing in on the largest at the points."""
        values = quantity(self.solution)
        best = values.max(axis=-1)
        if self.read is None:
            return best
        t = self.solution.t
        at = np.take_along_axis(t, values.reshape(t.shape).argmax(axis=1)[:, None], axis=1)
        reach, span = self.pitch, self.solution.problem.span[:, None]
        for _ in range(_ZOOMS):
            near = np.clip(at + reach * np.linspace(-1, 1, _ZOOM_POINTS), 0, span)
            values = quantity(self.read(near))
            at = np.take_along_axis(near, values.reshape(near.shape).argmax(axis=1)[:, None], axis=1)
            best = np.fmax(best, values.max(axis=-1))
            reach = 2 * reach / (_ZOOM_POINTS - 1)
        return best

    def _split(self, values: Array) -> Array:
        """Values at the points of each part, (B, P, points)."""
        if self.read is None:
            flat = values.reshape(self.parts.shape[0], -1)
            return np.stack([flat[:, :-1], flat[:, 1:]], axis=-1)
        return values.reshape(*self.parts.shape, -1)

    def _whole(self, values: Array) -> Any:
        """Sums in t as integrals along s, in the shape of the cases."""
        return self.solution._each(values) * self.solution._rho[..., 0][()]


def sampled(sol: Solution) -> Sampled:
    """The points at which to read a solution."""
    orbit = sol.trajectory.orbit
    if orbit is None:
        return Sampled(sol, np.diff(sol.t, axis=1), sol.problem.span[:, None], None)
    span = orbit.problem.span[:, None]
    period = orbit.period[:, None]
    with np.errstate(invalid="ignore", divide="ignore"):
        rounds = np.where(period < span, np.floor(span / period), 0)
        left = np.where(rounds > 0, np.clip(span - rounds * period, 0, period), 0)
    whole = np.where(rounds > 0, period, span)
    share = ((np.arange(_PARTS)[:, None] + _rule(_POINTS)[0]) / _PARTS).ravel()
    parts = np.repeat(np.concatenate([whole * np.maximum(rounds, 1), left], axis=1) / _PARTS, _PARTS, axis=1)
    read = make_reader(sol)
    return Sampled(read(np.concatenate([whole * share, left * share], axis=1)), parts, whole / _PARTS, read)


def make_reader(sol: Solution) -> Callable[[Array], Solution]:
    """A function that reads the same orbits at other t (B, n); NaN where a case has no shape."""
    orbit, was = sol.trajectory.orbit, sol.trajectory
    shapeless = ~np.isfinite(was.beta).all(axis=1)

    def read(t: Array) -> Solution:
        beta, dbeta, alpha, z = orbit.at(t)
        for values in (beta, dbeta, alpha, z):
            values[shapeless] = np.nan
        told = was.outcome, was.error, was.condition, was.evaluations
        return replace(sol, trajectory=Trajectory(beta, dbeta, alpha, z, lambda: orbit.swirl(t), *told, orbit), t=t)

    return read


def _signed(values: Array) -> tuple[Array, Array]:
    """Integral of |f| and measure of f >= 0 over [0, 1] for each part, from values at its points: (B, P) each.

    Where f changes sign, that of the polynomial through the points is followed between them, one change a gap.
    """
    points, weights, antiderivative = _rule(values.shape[-1])
    size, share = np.abs(values) @ weights, (values >= 0) @ weights
    row, part = np.nonzero((values.max(axis=-1) > 0) & (values.min(axis=-1) < 0))
    if not row.size:
        return size, share
    y = values[row, part]
    primitive = y @ antiderivative  # coefficients of the integral from 0, rising powers
    slope = primitive[:, 1:] * np.arange(1, primitive.shape[1])
    edges = [np.zeros(row.size)]
    for k in range(points.size - 1):
        y0, y1 = y[:, k], y[:, k + 1]
        with np.errstate(divide="ignore", invalid="ignore"):
            x = points[k] + (points[k + 1] - points[k]) * y0 / (y0 - y1)
            for _ in range(3):
                step = _horner(slope, x) / _horner(slope[:, 1:] * np.arange(1, slope.shape[1]), x)
                x = np.clip(np.where(np.isfinite(step), x - step, x), points[k], points[k + 1])
        edges.append(np.where(y0 * y1 < 0, x, edges[-1]))
    edges.append(np.ones(row.size))
    pieces = [(_horner(primitive, b) - _horner(primitive, a), b - a) for a, b in pairwise(edges)]
    size[row, part] = sum(np.abs(area) for area, _ in pieces)
    share[row, part] = sum(np.where(area >= 0, width, 0) for area, width in pieces)
    return size, share


def _horner(coefficients: Array, x: Array) -> Array:
    """Polynomials (P, n), rising powers, each at its own x (P,)."""
    value = np.zeros_like(x)
    for k in range(coefficients.shape[1] - 1, -1, -1):
        value = value * x + coefficients[:, k]
    return value


@cache
def _rule(n: int) -> tuple[Array, Array, Array]:
    """n points on [0, 1], their weights, and values-to-antiderivative, (n, n + 1): the ends for n = 2, else Gauss."""
    if n == 2:
        points, weights = np.array([0.0, 1.0]), np.array([0.5, 0.5])
    else:
        x, w = np.polynomial.legendre.leggauss(n)
        points, weights = (x + 1) / 2, w / 2
    powers = np.linalg.inv(np.vander(points, increasing=True)).T
    antiderivative = np.concatenate([np.zeros((n, 1)), powers / np.arange(1, n + 1)], axis=1)
    return points, weights, antiderivative
