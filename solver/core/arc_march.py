"""The march along one arc: from the start of an orbit to a turning point, or once round a rotation.

The march keeps the series of each step for reading, the transfer matrix of a change of the start for the condition
number, and the covariance of the errors: what the steps leave out and round off, propagated by their transfer matrices.
"""

from typing import Any

import numpy as np

from .loader import compiled
from .taylor_step import (
    ETA,
    ORDER,
    ZETA,
    B,
    V,
    crossing,
    expand,
    keep,
    left_out,
    reach,
    value,
    value_and_rate,
)

EPS = 2.0**-52
MOST = 60  # steps of an arc: more are needed only next to a saddle or under huge loads, where `orbit` is better
NODES = 2  # of each step, at which the growth of a change of the start is recorded
STEADY = 1e6  # growth beyond which the march has too few digits left to tell where the orbit goes
LOST, LIBRATES, ROTATES = 0, 1, 2  # how an arc ends: not at all, at a turning point, or after a whole turn

# The record of an arc. time, azimuth, height, swirl: what they gain from the start to the end of the arc. error: the
# standard deviation of beta, its largest along the rod. late: error of the time at the end. fastest: largest |beta_t|.
# range: change of beta over the arc. e11 .. e22: transfer matrix of a change of (beta, beta_t).
ARC = np.dtype(
    [(name, float) for name in ("time", "azimuth", "height", "swirl", "error", "late", "fastest", "range")]
    + [("steps", np.int64)]
    + [(name, float) for name in ("e11", "e12", "e21", "e22")]
)


@compiled
def end_of_step(w: Any, h: float, beta0: float, direction: float) -> tuple[float, int]:
    """The length of a step that begins with the series w and may be h long, cut where the arc ends; and how it ends."""
    far, speed = value_and_rate(w[B], ORDER, h)
    if speed * direction < 0:
        return crossing(w[V], ORDER - 1, 0.0, h), LIBRATES
    if abs(far - beta0) >= 2 * np.pi:
        return crossing(w[B], ORDER, beta0 + direction * 2 * np.pi, h), ROTATES
    return h, LOST


@compiled
def march_arc(
    loads: Any,
    beta0: float,
    v0: float,
    goal: float,
    limit: float,
    w: Any,
    since: Any,
    width: Any,
    kept: Any,
    grown: Any,
    arc: Any,
) -> int:
    """March one arc and return LIBRATES, ROTATES or LOST.

    loads: lam, mu, phi. goal: what a step may leave out. limit: how far the rod goes. w: room for a table of series.
    Fills since and width (MOST,): begin and length of each step; kept (MOST, 4, ORDER + 1): its series; grown
    (MOST * NODES, 3): time, and the growth of beta for a change of beta and of beta_t, at each node; and arc: an `ARC`.
    """
    lam, mu, phi = loads
    heights = abs(lam) + abs(mu) + abs(phi) + 1
    # two zeros of beta_t lie at least pi / sqrt(max H') apart (Sturm): no step holds two
    longest = 3.0 / np.sqrt(abs(lam) + 2 * abs(mu) + abs(phi) + 2)
    direction = np.sign(v0)
    beta, v, t = beta0, v0, 0.0
    alpha = z = swirl = 0.0
    a, b, c, d = 1.0, 0.0, 0.0, 1.0
    pbb = pbv = pvv = 0.0  # covariance of the errors of beta and beta_t
    lb = lv = 0.0  # their errors by the rounding of the loads
    worst = 0.0
    fastest = abs(v0)
    for k in range(MOST):
        expand(w, lam, mu, phi, beta, v)
        h = min(reach(w, goal), longest)
        if not h > 0:
            return LOST
        if k == 0 and direction == 0:
            direction = np.sign(value(w[V], ORDER - 1, h))
        h, end = end_of_step(w, h, beta0, direction)
        since[k], width[k] = t, h
        keep(w, alpha, z, swirl, kept[k])
        n = NODES * k
        last = t < limit < t + h  # the end of the rod is a node too
        x = limit - t if last else h / 2
        e, f = value(w[ETA], ORDER, x), value(w[ZETA], ORDER, x)
        if last:
            eb = np.sqrt(e * e * pbb + 2 * e * f * pbv + f * f * pvv) + abs(e * lb + f * lv)
            worst = max(worst, eb + left_out(w, x) + EPS * (max(1.0, abs(beta)) + heights * x * x) / 2)
        grown[n, 0], grown[n, 1], grown[n, 2] = t + x, e * a + f * c, e * b + f * d
        e, ev = value_and_rate(w[ETA], ORDER, h)
        f, fv = value_and_rate(w[ZETA], ORDER, h)
        grown[n + 1, 0], grown[n + 1, 1], grown[n + 1, 2] = t + h, e * a + f * c, e * b + f * d
        a, b, c, d = grown[n + 1, 1], grown[n + 1, 2], ev * a + fv * c, ev * b + fv * d
        if not max(max(abs(a), abs(b)), max(abs(c), abs(d))) < STEADY:
            return LOST
        # what the step leaves out, and rounds off
        out = left_out(w, h)
        qb = out + EPS * max(1.0, abs(beta)) / 2
        qv = out * (ORDER + 1) / h + EPS * (abs(v) + heights * h) / 2
        pbb, pbv, pvv = (
            e * e * pbb + 2 * e * f * pbv + f * f * pvv + qb * qb,
            e * ev * pbb + (e * fv + f * ev) * pbv + f * fv * pvv,
            ev * ev * pbb + 2 * ev * fv * pbv + fv * fv * pvv + qv * qv,
        )
        lb, lv = e * lb + f * lv + EPS * heights * h * h / 4, ev * lb + fv * lv + EPS * heights * h / 2
        eb, ev = np.sqrt(pbb) + abs(lb), np.sqrt(pvv) + abs(lv)
        if t + h <= limit:
            worst = max(worst, eb)
        fastest = max(fastest, abs(value(w[V], ORDER - 1, h / 2)))
        beta, v = value_and_rate(w[B], ORDER, h)
        fastest = max(fastest, abs(v))
        alpha, z, swirl = value(kept[k, 1], ORDER, h), value(kept[k, 2], ORDER, h), value(kept[k, 3], ORDER, h)
        t += h
        if end != LOST:
            arc.time, arc.azimuth, arc.height, arc.swirl = t, alpha, z, swirl
            arc.error, arc.fastest, arc.steps = worst, fastest, k + 1
            arc.range = abs(beta - beta0)
            arc.e11, arc.e12, arc.e21, arc.e22 = a, b, c, d
            arc.late = ev / abs(value_and_rate(w[V], ORDER - 1, h)[1]) if end == LIBRATES else eb / abs(v)
            return end
    return LOST
