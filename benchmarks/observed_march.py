"""Observables of start problems by a way of their own: on the steps of `march_25_digits`.

Integrals by Gauss's rule between the zeros of push, zeros and extremes by bisection between many points of each step;
nothing is shared with the solver but the formulas of the physics notes, which are written out again here.
"""

from itertools import pairwise
from typing import Any

import mpmath
import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import NDArray
from scipy.optimize import brentq, minimize_scalar

from benchmarks.march_25_digits import _series, _step, _sum, pair, value_of

Array = NDArray[Any]
_POINTS = 241  # of a step
_GAUSS = np.polynomial.legendre.leggauss(24)


def steps(numbers: Array, most: int = 3000) -> list[list[tuple[Array, float]]]:
    """For each rod (lam, mu, phi, span, beta0, v0), rows of `numbers` (B, 6), its steps: the Taylor coefficients of
    beta, beta_t, sin and cos (4, n) and how far the rod goes on them; empty where `most` steps do not reach the end."""
    lam, mu, phi, span, beta0, v0 = numbers.T
    with mpmath.workdps(45):
        sine, cosine = (pair([f(mpmath.mpf(float(b))) for b in beta0]) for f in (mpmath.sin, mpmath.cos))
    zero = np.zeros((2, beta0.size))
    loads = [np.stack([x, 0 * x]) for x in (lam, mu, phi)]
    state = [zero, np.stack([v0, 0 * v0]), sine, cosine, zero, zero]
    now, rows = np.zeros((2, beta0.size)), np.arange(beta0.size)
    found: list[list[tuple[Array, float]]] = [[] for _ in beta0]
    for _ in range(most):
        series = _series(state, *(x[:, rows] for x in loads))
        reach = np.minimum(_step(series), 0.5)
        left = (span[rows] - now[0]) - now[1]
        for k, i in enumerate(rows):
            one = np.stack([series[j][0, :, k] for j in range(4)])
            one[0, 0] = (series[0][0, 0, k] + beta0[i]) + series[0][1, 0, k]
            found[i].append((one, float(min(reach[k], left[k]))))
        on = np.flatnonzero(left > reach)
        if not on.size:
            return found
        h = np.stack([reach[on], 0 * reach[on]])
        state = [value_of(x[:, :, on], h) for x in series]
        now, rows = _sum(now[:, on], h), rows[on]
    for i in rows:
        found[i] = []
    return found


def push_and_curvature(numbers: Array, at: Array) -> tuple[Array, Array]:
    """f rho^3/A and kappa rho where beta_t, sin and cos are `at[1:]`."""
    lam, mu, phi = numbers[:3]
    v, s, c = at[1:4]
    H = lam * c - mu * (c * c - s * s) - (phi + 2 * c * s * s) * s
    f = s * (lam - mu * c - s**3) + H * (3 * s * c - mu) - 3 * v * v * (c * c - s * s)
    return f, np.hypot(v, s * s)


def numbers_along(numbers: Array, way: list[tuple[Array, float]]) -> dict[str, float]:
    """What the solver calls kappa_mean .. potential, in units of A and rho; `size`: the largest |f|, |kappa|."""
    lam, mu, phi, span = numbers[:4]
    total = dict.fromkeys(("kappa_mean", "push_mean", "pull_mean", "attached", "bending_energy", "routh"), 0.0)
    pushes, kappas, angles = [], [], []

    def at(series: Array, x: Any) -> Array:
        return np.stack([polyval(x, row) for row in series])

    for series, h in way:
        x = np.linspace(0, h, _POINTS)
        f, kappa = push_and_curvature(numbers, at(series, x))
        one = lambda y, k, series=series: float(push_and_curvature(numbers, at(series, np.float64(y)))[k])  # noqa: E731
        for values, k, seen in ((f, 0, pushes), (kappa, 1, kappas)):
            seen += [values.min(), values.max()]
            for sign in (1, -1):
                m = int(np.argmax(sign * values))
                if h > 1e-6:
                    beside = x[max(m - 1, 0)], x[min(m + 1, _POINTS - 1)]
                    best = minimize_scalar(
                        lambda y, k=k, sign=sign, one=one: -sign * one(y, k), bounds=beside, method="bounded",
                        options={"xatol": 1e-12},
                    )  # fmt: skip
                    seen.append(-sign * best.fun)
        angles += [series[0, 0], float(polyval(h, series[0]))]
        turning = np.flatnonzero(np.diff(np.sign(polyval(x, series[1]))) != 0)
        for k in turning:
            angles.append(float(polyval(brentq(lambda y, s=series: polyval(y, s[1]), x[k], x[k + 1]), series[0])))
        change = np.flatnonzero((f[1:] > 0) != (f[:-1] > 0))
        roots = [brentq(one, x[k], x[k + 1], args=(0,), xtol=1e-16) for k in change]
        cells = np.linspace(0, h, 101 if kappa.min() < kappa.max() / 2 else 11)  # short ones next to kinks of kappa
        edges = np.unique([*cells, *roots])
        for a, b in pairwise(edges):
            y, w = (a + b) / 2 + (b - a) / 2 * _GAUSS[0], (b - a) / 2 * _GAUSS[1]
            beta, v, s, c = at(series, y)
            f, kappa = push_and_curvature(numbers, np.stack([beta, v, s, c]))
            total["kappa_mean"] += w @ kappa / span
            total["push_mean"] += w @ np.maximum(f, 0) / span
            total["pull_mean"] += w @ np.maximum(-f, 0) / span
            total["attached"] += (b - a) / span * (f[f.size // 2] > 0)
            total["bending_energy"] += w @ kappa**2 / 2
            total["routh"] += w @ (kappa**2 / 2 + mu * s * c - phi * c - lam * s)
    total["contact_size_mean"] = total["push_mean"] + total["pull_mean"]
    total["push_min"], total["push_max"] = float(min(pushes)), float(max(pushes))
    total["kappa_max"] = float(max(kappas))
    total["amplitude"] = float(max(angles) - min(angles))
    return total
