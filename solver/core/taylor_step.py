"""One step of Taylor's method: the series of an orbit about one point, and how far it may be used.

H = lam cos b - mu cos 2b - phi sin b - sin(2b)/2 + sin(4b)/4, eq. (35) with its products written as multiple angles:
then every coefficient of the series of sin and cos follows from lower ones by sums of products.
"""

from typing import Any

import numpy as np

from .loader import compiled

ORDER = 20
ROWS = 9
B, V, S, C, S2, C2, RATE, ETA, ZETA = range(ROWS)  # rows of a table of series; eta(0) = 1, zeta_t(0) = 1


@compiled
def expand(w: Any, lam: float, mu: float, phi: float, beta: float, v: float) -> None:
    """Fill the table w (ROWS, ORDER + 1) with the series about a point where beta and beta_t are given.

    Rows: beta, beta_t, sin and cos of beta and of 2 beta, H', and the two solutions of eta_tt = -H' eta.
    """
    w[B, 0], w[B, 1], w[V, 0] = beta, v, v
    w[S, 0], w[C, 0] = np.sin(beta), np.cos(beta)
    w[ETA, 0], w[ETA, 1], w[ZETA, 0], w[ZETA, 1] = 1.0, 0.0, 0.0, 1.0
    for k in range(ORDER - 1):
        sc = ss = vc = vs = 0.0
        for i in range(k + 1):
            j = k - i
            sc += w[S, i] * w[C, j]
            ss += w[S, i] * w[S, j]
            vc += w[V, i] * w[C, j]
            vs += w[V, i] * w[S, j]
        w[S2, k] = 2 * sc
        w[C2, k] = -2 * ss
        if k == 0:
            w[C2, 0] += 1.0
        w[S, k + 1], w[C, k + 1] = vc / (k + 1), -vs / (k + 1)
        s4 = c4 = 0.0
        for i in range(k + 1):
            s4 += w[S2, i] * w[C2, k - i]
            c4 += w[S2, i] * w[S2, k - i]
        s4, c4 = 2 * s4, -2 * c4
        if k == 0:
            c4 += 1.0
        pull = lam * w[C, k] - mu * w[C2, k] - phi * w[S, k] - w[S2, k] / 2 + s4 / 4
        w[RATE, k] = -lam * w[S, k] + 2 * mu * w[S2, k] - phi * w[C, k] - w[C2, k] + c4
        eta = zeta = 0.0
        for i in range(k + 1):
            eta += w[RATE, i] * w[ETA, k - i]
            zeta += w[RATE, i] * w[ZETA, k - i]
        both = (k + 1.0) * (k + 2.0)
        w[V, k + 1] = -pull / (k + 1)
        w[B, k + 2] = -pull / both
        w[ETA, k + 2], w[ZETA, k + 2] = -eta / both, -zeta / both
    last = ORDER - 1
    vc = vs = 0.0
    for i in range(last + 1):
        vc += w[V, i] * w[C, last - i]
        vs += w[V, i] * w[S, last - i]
    w[S, ORDER], w[C, ORDER] = vc / ORDER, -vs / ORDER
    w[V, ORDER] = w[S2, last] = 0.0


@compiled
def reach(w: Any, goal: float) -> float:
    """How far the series may be used for its last four terms to stay below `goal`: one or two may vanish by chance."""
    least = np.inf
    for k in range(ORDER - 3, ORDER + 1):
        size = max(abs(w[B, k]), max(abs(w[S, k - 1]), abs(w[C, k - 1])) / k)
        if size > 0:
            least = min(least, np.log(goal / size) / k)
    return float(np.exp(least))


@compiled
def left_out(w: Any, h: float) -> float:
    """What the series of beta leaves out at h: a geometric rest, its ratio that of the last eight terms."""
    power = h
    for _ in range(ORDER - 8):
        power *= h
    earlier = last = 0.0
    for k in range(ORDER - 7, ORDER - 3):
        earlier = max(earlier, abs(w[B, k]) * power)
        power *= h
    for k in range(ORDER - 3, ORDER + 1):
        last = max(last, abs(w[B, k]) * power)
        power *= h
    ratio = min(np.sqrt(np.sqrt(last / max(earlier, 1e-300))), 0.8)
    power, last = 1.0, 0.0
    for k in range(ORDER, ORDER - 4, -1):
        last = max(last, abs(w[B, k]) * h**k * power)
        power *= ratio
    return float(last * ratio / (1 - ratio))


@compiled
def keep(w: Any, alpha: float, z: float, swirl: float, kept: Any) -> None:
    """beta and the integrals of sin, cos and sin cos of it, from what they are at the step's start, into (4, n)."""
    kept[0, 0], kept[1, 0], kept[2, 0], kept[3, 0] = w[B, 0], alpha, z, swirl
    for i in range(ORDER):
        share = 1.0 / (i + 1)
        kept[0, i + 1] = w[B, i + 1]
        kept[1, i + 1], kept[2, i + 1] = w[S, i] * share, w[C, i] * share
        kept[3, i + 1] = w[S2, i] * share / 2


@compiled
def value(row: Any, n: int, x: float) -> float:
    """The series with coefficients row[0 .. n] at x."""
    total = row[n]
    for k in range(n - 1, -1, -1):
        total = total * x + row[k]
    return float(total)


@compiled
def value_and_rate(row: Any, n: int, x: float) -> tuple[float, float]:
    """The series with coefficients row[0 .. n] and its derivative at x."""
    total, rate = row[n], 0.0
    for k in range(n - 1, -1, -1):
        rate = rate * x + total
        total = total * x + row[k]
    return total, rate


@compiled
def crossing(row: Any, n: int, level: float, h: float) -> float:
    """Where in [0, h] the series, monotone there or with one change of sign of its distance, passes `level`."""
    lo, hi = 0.0, h
    above = value(row, n, h) > level
    x = h
    for _ in range(60):
        y, rate = value_and_rate(row, n, x)
        if y == level:
            return x
        if (y > level) == above:
            hi = x
        else:
            lo = x
        step = (y - level) / rate if rate != 0 else np.inf
        new = x - step
        if not lo < new < hi:
            new = (lo + hi) / 2
        if abs(new - x) <= 1e-16 * h:
            return new
        x = new
    return x
