"""Many start problems at once to 25 digits: Taylor series in double-double arithmetic, NumPy only.

A family apart from every method of the solver, and checked itself against forty digits of mpmath. A number is a pair
(high, low) stacked on the first axis. beta is carried as what it has moved from beta(0), beside its sine and cosine,
so that nothing but sums and products is ever needed.
"""

from typing import Any

import mpmath
import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
ORDER = 30
_SPLIT = 134217729.0  # 2^27 + 1


def _sum(a: Array, b: Array) -> Array:
    """a + b of pairs."""
    s = a[0] + b[0]
    v = s - a[0]
    e = (a[0] - (s - v)) + (b[0] - v) + a[1] + b[1]
    high = s + e
    return np.stack([high, e - (high - s)])


def _product(a: Array, b: Array) -> Array:
    """a b of pairs."""
    p = a[0] * b[0]
    x, y = _SPLIT * a[0], _SPLIT * b[0]
    ah, bh = x - (x - a[0]), y - (y - b[0])
    al, bl = a[0] - ah, b[0] - bh
    e = ((ah * bh - p) + ah * bl + al * bh) + al * bl + a[0] * b[1] + a[1] * b[0]
    high = p + e
    return np.stack([high, e - (high - p)])


def _over(a: Array, n: float) -> Array:
    """A pair over a small whole number."""
    q = a[0] / n
    back = _product(np.stack([q, 0 * q]), np.stack([np.full_like(q, n), 0 * q]))
    rest = ((a[0] - back[0]) - back[1]) + a[1]
    low = rest / n
    high = q + low
    return np.stack([high, low - (high - q)])


def _total(a: Array) -> Array:
    """The sum of pairs (2, k, B) over k."""
    while a.shape[1] > 1:
        half = a.shape[1] // 2
        rest = a[:, 2 * half :]
        a = np.concatenate([_sum(a[:, :half], a[:, half : 2 * half]), rest], axis=1)
    return a[:, 0]


def _cauchy(a: Array, b: Array, k: int) -> Array:
    """Coefficient k of the product of two series (2, order, B)."""
    return _total(_product(a[:, : k + 1], b[:, k::-1] if k else b[:, :1]))


def pair(values: Any) -> Array:
    """mpmath numbers as pairs, (2, B)."""
    high = np.array([float(v) for v in values])
    return np.stack([high, np.array([float(v - mpmath.mpf(h)) for v, h in zip(values, high, strict=True)])])


def _series(state: list[Array], lam: Array, mu: Array, phi: Array) -> list[Array]:
    """Coefficients of moved, speed, sine, cosine, alpha, z about a point, each (2, ORDER + 1, B)."""
    B = lam.shape[1]
    moved, v, s, c, alpha, z = (np.zeros((2, ORDER + 1, B)) for _ in range(6))
    for column, value in zip((moved, v, s, c, alpha, z), state, strict=True):
        column[:, 0] = value
    ss, css, csss = (np.zeros((2, ORDER + 1, B)) for _ in range(3))
    for k in range(ORDER):
        ss[:, k] = _cauchy(s, s, k)
        css[:, k] = _cauchy(c, ss, k)
        csss[:, k] = _cauchy(s, css, k)
        # H = lam c - mu (1 - 2 s^2) - phi s - 2 c s^3
        pull = _sum(_product(lam, c[:, k]), _product(mu, 2 * ss[:, k]))
        pull = _sum(_sum(pull, -_product(phi, s[:, k])), -2 * csss[:, k])
        if k == 0:
            pull = _sum(pull, -mu)
        n = float(k + 1)
        moved[:, k + 1] = _over(v[:, k], n)
        v[:, k + 1] = _over(-pull, n)
        s[:, k + 1] = _over(_cauchy(v, c, k), n)
        c[:, k + 1] = _over(-_cauchy(v, s, k), n)
        alpha[:, k + 1] = _over(s[:, k], n)
        z[:, k + 1] = _over(c[:, k], n)
    return [moved, v, s, c, alpha, z]


def _step(columns: list[Array]) -> Array:
    """How far the series reach, (B,): where the last terms of sine, cosine and speed are 1e-26 of the first."""
    reach = np.inf
    for column in columns[1:4]:
        size = np.maximum(
            np.abs(column[0, 0]), 1.0 if column is not columns[1] else np.abs(column[0]).max(axis=0) * 1e-8
        )
        for k in (ORDER, ORDER - 1):
            with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
                reach = np.fmin(reach, (1e-26 * size / np.abs(column[0, k])) ** (1.0 / k))
    return np.asarray(reach)


def march(lam: Any, mu: Any, phi: Any, beta0: Any, v0: Any, t: Array, most: int = 4000) -> Array:
    """beta, alpha, z at t (B, n), as floats, (3, B, n); NaN where `most` steps do not reach the end.

    lam .. v0: floats (B,), taken as exact; rows of t rise from at least 0.
    """
    lam, mu, phi, start, v0 = (np.asarray(x, dtype=float) for x in (lam, mu, phi, beta0, v0))
    with mpmath.workdps(45):
        sine, cosine = (pair([f(mpmath.mpf(float(b))) for b in start]) for f in (mpmath.sin, mpmath.cos))
    zero = np.zeros((2, start.size))
    exact = [np.stack([x, 0 * x]) for x in (lam, mu, phi, v0)]
    state = [zero, exact[3], sine, cosine, zero, zero]
    out = np.full((3, *t.shape), np.nan)
    now = np.zeros((2, start.size))
    rows, column = np.arange(start.size), np.zeros(start.size, dtype=int)
    for _ in range(most):
        series = _series(state, *(x[:, rows] for x in exact[:3]))
        reach = _step(series)
        while True:  # every station within reach of this expansion
            inside = column < t.shape[1]
            goal = t[rows, np.minimum(column, t.shape[1] - 1)]
            gap = (goal - now[0]) - now[1]
            here = np.flatnonzero(inside & (gap <= reach))
            if not here.size:
                break
            h = np.stack([gap[here], 0 * gap[here]])
            at = [value_of(series[j][:, :, here], h) for j in (0, 4, 5)]
            moved = _sum(at[0], np.stack([start[rows[here]], 0 * gap[here]]))
            out[:, rows[here], column[here]] = moved[0], at[1][0], at[2][0]
            column[here] += 1
        left = np.flatnonzero(column < t.shape[1])
        if not left.size:
            break
        h = np.stack([reach[left], 0 * reach[left]])
        state = [value_of(x[:, :, left], h) for x in series]
        now, rows, column = _sum(now[:, left], h), rows[left], column[left]
    return out


def value_of(series: Array, h: Array) -> Array:
    """A series (2, order, B) at h (2, B)."""
    value = series[:, -1]
    for k in range(series.shape[1] - 2, -1, -1):
        value = _sum(_product(value, h), series[:, k])
    return value
