"""Error and condition number of one orbit from its arcs.

At the end of the forward arc the transfer matrix is E; reflected at the turning point it comes back as S E^-1 S E, with
S = diag(1, -1), and on the way back the arc's own transfer applies to S times that. Each period adds a multiple of one
shear.
"""

from typing import Any

import numpy as np

from .arc_march import EPS, NODES
from .loader import compiled

SAFETY = 3.0


@compiled
def there_and_back(arc: Any, out: Any) -> None:
    """S E^-1 S E with S = diag(1, -1) and det E = 1: the transfer out to a turning point and back, (2, 2)."""
    a, b, c, d = arc.e11, arc.e12, arc.e21, arc.e22
    out[0, 0], out[0, 1] = d * a + b * c, 2 * b * d
    out[1, 0], out[1, 1] = 2 * a * c, out[0, 0]


@compiled
def multiply(a: Any, b: Any, out: Any) -> None:
    """out = a b, all (2, 2) and none the same."""
    for i in range(2):
        for j in range(2):
            out[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j]


@compiled
def largest_growth(
    grown: Any,
    n: int,
    m: Any,
    sign: float,
    begin: float,
    span: float,
    period: float,
    periods: float,
    extra: Any,
    weight: float,
    best: float,
) -> float:
    """The largest growth of beta at the first n nodes of an arc travelled one way, at times begin + sign t; or `best`.

    m: transfer (2, 2) from the start of the rod to what the arc's own transfer applies to. periods: how many whole ones
    the rod passes; extra: what the transfer (2, 2) gains in each.
    """
    for k in range(n):
        time = begin + sign * grown[k, 0]
        if time > span * (1 + 4 * EPS):
            continue
        p, q = grown[k, 1], grown[k, 2]
        x, y = p * m[0, 0] + q * m[1, 0], p * m[0, 1] + q * m[1, 1]
        best = max(best, max(abs(x), weight * abs(y)))
        if periods > 0:
            many = periods if time + periods * period <= span else periods - 1
            x, y = (
                x + many * (x * extra[0, 0] + y * extra[1, 0]),
                y + many * (x * extra[0, 1] + y * extra[1, 1]),
            )
            best = max(best, max(abs(x), weight * abs(y)))
    return best


@compiled
def largest_solutions(rate: float, span: float) -> tuple[float, float]:
    """The largest values on [0, span] of the two solutions of eta_tt = -rate eta that begin as 1 and as t."""
    root = np.sqrt(abs(rate))
    angle = min(root * span, 700.0)
    if not angle > 1e-150:
        return 1.0, span
    if rate > 0:
        return 1.0, (np.sin(angle) if angle < np.pi / 2 else 1.0) / root
    return np.cosh(angle), np.sinh(angle) / root


@compiled
def beside_helix(lam: float, mu: float, phi: float, span: float, beta: float, v: float, weight: float) -> float:
    """The condition number where H' hardly changes, else 0: `linearised_growth.beside_helix` of one rod."""
    s, c = np.sin(beta), np.cos(beta)
    s2, c2 = 2 * s * c, (c - s) * (c + s)
    size = abs(c)
    H = (lam - (-mu if c < 0 else mu)) * c + mu * s * s * (1 + 2 * size) / (1 + size) - (phi + 2 * c * s * s) * s
    rate = -lam * s + 2 * mu * s2 - phi * c - 2 * s * s * (3 * c * c - s * s)
    second = -lam * c + 4 * mu * c2 + phi * s + 2 * s2 - 8 * s2 * c2
    even, odd = largest_solutions(rate, span)
    half = largest_solutions(rate, span / 2)[1]
    strays = abs(v) * odd + 2 * abs(H) * half * half
    change = abs(second) * strays + (abs(lam) + 8 * abs(mu) + abs(phi) + 20) * strays * strays / 2
    root = np.sqrt(abs(rate))
    time = min(span, 1 / root) if root > 0 else span
    return max(1.0, max(even, odd * weight)) if change * span * time < 0.1 else 0.0


@compiled
def condition_of_arcs(
    span: float, weight: float, librates: bool, count: Any, arcs: Any, grown: Any, m: Any, extra: Any
) -> float:
    """The condition number of one orbit, from the growth at the nodes of its arcs; inf where rounding decides it.

    m (4, 2, 2) and extra (2, 2) are room to work in.
    """
    ahead = arcs[0].time
    n, k = count[0] * NODES, count[1] * NODES
    period = 2 * (ahead + arcs[1].time) if librates else ahead
    periods = np.floor(span / period)
    if librates:
        there_and_back(arcs[0], m[0])
        m[1] = m[0]
        if k > 0:
            there_and_back(arcs[1], m[2])
            multiply(m[2], m[0], m[1])
    else:
        m[1, 0, 0], m[1, 0, 1], m[1, 1, 0], m[1, 1, 1] = arcs[0].e11, arcs[0].e12, arcs[0].e21, arcs[0].e22
    extra[0, 0], extra[0, 1], extra[1, 0], extra[1, 1] = m[1, 0, 0] - 1, m[1, 0, 1], m[1, 1, 0], m[1, 1, 1] - 1
    m[3] = np.eye(2)
    best = largest_growth(grown[0], n, m[3], 1.0, 0.0, span, period, periods, extra, weight, 1.0)
    if librates:
        m[3, 0], m[3, 1] = m[0, 0], -m[0, 1]
        best = largest_growth(grown[0], n, m[3], -1.0, 2 * ahead, span, period, periods, extra, weight, best)
        if k > 0:
            best = largest_growth(grown[1], k, m[0], 1.0, 2 * ahead, span, period, periods, extra, weight, best)
            m[3, 0], m[3, 1] = m[1, 0], -m[1, 1]
            best = largest_growth(grown[1], k, m[3], -1.0, period, span, period, periods, extra, weight, best)
    # what the products of large transfers round off, as often as it is repeated
    largest = 1.0
    for i in range(n):
        largest = max(largest, max(abs(grown[0, i, 1]), abs(grown[0, i, 2]) * weight))
    for i in range(k):
        largest = max(largest, max(abs(grown[1, i, 1]), abs(grown[1, i, 2]) * weight))
    return best if EPS * largest * largest * max(1.0, periods) < 0.1 * best else np.inf


@compiled
def error_of_arcs(span: float, beta0: float, librates: bool, arcs: Any) -> float:
    """The estimated error of beta along one orbit: that of its arcs, and what it is late by after all its periods."""
    ahead, back = arcs[0].time, arcs[1].time
    period = 2 * (ahead + back) if librates else ahead
    periods = np.floor(span / period)
    late = periods * arcs[0].late
    if librates:
        late = 2 * (periods + (span > periods * period + ahead)) * arcs[0].late
        late += 2 * (periods + (span > periods * period + 2 * ahead + back)) * arcs[1].late
    fastest = max(arcs[0].fastest, arcs[1].fastest)
    shift = fastest * late
    if librates:
        shift = min(shift, arcs[0].range + arcs[1].range)
    return SAFETY * (max(arcs[0].error, arcs[1].error) + shift) + EPS * (span * fastest + max(1.0, abs(beta0)))
