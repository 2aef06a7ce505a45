"""How an orbit answers to a change of its start: the condition number, without following any change along the rod.

Two changes of the start span all others. One along the flow f = (beta_t, -H) stays along it: it becomes f(t). One
across becomes a(t) f(t) + b(t), b across the flow and of size 1/|f(t)|, because the flow keeps areas; only the
shear a(t) has to be integrated, a' = (1 - H') (beta_t^2 - H^2) / (beta_t^2 + H^2)^2. It grows by the same amount
each period, so a rod of a million bends is again no more work than one of three, and next to a saddle no large
numbers cancel.
"""

from typing import Any

import numpy as np

from .chebyshev import basis
from .course import HELIX, LIBRATION, Course
from .landscape import slope, slope_rate
from .panels import Panels
from .reduced import Array, Reduced


def condition(
    problem: Reduced, way: Course, panels: Panels, since: Array, first: Any, count: Any, duration: Array
) -> Array:
    """Largest |d beta/d beta(0)| and w |d beta/d beta_t(0)| along the rod, at least 1, (B,).

    w = max(1, |beta_t(0)|, sqrt|H'(beta(0))|): a change of the slope counts as one of the angle would a quarter of a
    swing later, so that the number does not depend on where in its swing an orbit happens to start.
    `since`, `first`, `count`, `duration` say when and where the panels of each part begin, as in `methods.orbit.Orbit`.
    """
    assert problem.dbeta0 is not None
    v0, H0 = problem.dbeta0, slope(problem, problem.beta0)
    natural = np.sqrt(np.abs(slope_rate(problem, problem.beta0)))
    weight = np.maximum(np.maximum(1, np.abs(v0)), natural)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        worst = np.where(way.kind == HELIX, _helix(problem, weight), 1.0)
        if panels.part.size:
            b = panels.part // 2
            largest = _along(problem, way, panels, since, first, count, duration, H0, weight)
            np.maximum.at(worst, b, np.where(np.isnan(largest), np.inf, largest))
    return worst


def _along(
    problem: Reduced,
    way: Course,
    panels: Panels,
    since: Array,
    first: Any,
    count: Any,
    duration: Array,
    H0: Array,
    weight: Array,
) -> Array:
    """The largest growth on each panel, over all the times the rod meets it, (P,)."""
    span, part = problem.span, panels.part
    b, second = part // 2, part % 2 == 1
    # in a time in which the orbit's own rates are near one
    unit = np.sqrt(np.abs(problem.lam) + np.abs(problem.mu) + np.abs(problem.phi) + 1)
    v0, H0, weight = problem.dbeta0 / unit, H0 / unit**2, weight / unit
    points = basis(panels.series.shape[2] - 1)
    v, H, _ = _flow(problem, panels, unit)
    size = v * v + H * H
    running = shear(problem, panels, unit) @ points.values
    rank = np.arange(part.size) - first[part]
    table = np.zeros((count.size, int(count.max()) + 1))
    table[part, rank + 1] = running[:, -1]
    table = np.cumsum(table, axis=1)
    running += table[part, rank, None]
    clock = since[:, None] + (panels.duration / 2)[:, None] * (1 + points.nodes)
    # the way out, and in a libration the way back, with the signs that reflection turns
    folded = way.kind == LIBRATION
    ahead, total = table[0::2, -1], table[:, -1]
    there, whole = duration[0::2], duration[0::2] + duration[1::2]
    period = np.where(folded, 2, 1) * whole
    period = np.where(period > 0, period, np.inf)[b, None]
    rounds = np.floor(span[b, None] / period)
    a_round = np.where(folded, 2 * (ahead + total[1::2]), ahead)[b, None]
    begin, shift = np.where(second, 2 * there[b], 0)[:, None], np.where(second, 2 * ahead[b], 0)[:, None]
    end = np.where(second, 2 * whole[b], 2 * there[b])[:, None]
    flow2 = v0 * v0 + H0 * H0
    along = np.stack([v0 / flow2, -H0 / flow2 * weight])[:, b, None]
    across = np.stack([H0, v0 * weight])[:, b, None]
    way_out = (way.direction[b] * np.where(second, -1, 1))[:, None]
    largest = np.zeros(part.size)
    for a, time, sign, open_ in (
        (shift + running, begin + clock, way_out, True),
        (shift + 2 * total[part, None] - running, end - clock, -way_out, folded[b, None]),
    ):
        met = open_ & ((time <= span[b, None]) | (rounds > 0))
        # the last of the rounds may end before this place
        many = np.where(rounds > 0, rounds - (time + rounds * period > span[b, None]), 0)
        for extra in (0.0, a_round * many):
            grown = np.abs((along + across * (a + extra)) * (sign * v) + across * (H / size)).max(axis=0)
            largest = np.maximum(largest, np.where(met, grown, 0).max(axis=1))
    return largest


def _flow(problem: Reduced, panels: Panels, unit: Array) -> tuple[Array, Array, Array]:
    """|beta_t|, H and H' at the panels' nodes, (P, n) each, in a unit of time for each problem: 1/unit, (B,)."""
    b = panels.part // 2
    at, one = problem.take(b), unit[b, None]
    loads = Reduced(*(v[:, None] for v in (at.lam, at.mu, at.phi, at.span, at.beta0)))
    points = basis(panels.series.shape[2] - 1)
    beta, v = panels.series[:, 0] @ points.values, panels.series[:, 1] @ points.values
    return v / one, slope(loads, beta) / one**2, slope_rate(loads, beta) / one**2


def shear(problem: Reduced, panels: Panels, unit: Array) -> Array:
    """The series of the shear a(t) on each panel from its near end, (P, n + 1), in time of 1/unit, (B,)."""
    points = basis(panels.series.shape[2] - 1)
    v, H, rate = _flow(problem, panels, unit)
    size = v * v + H * H
    pace = (1 - rate) * ((v - H) * (v + H) / size) / size
    scale: Array = (panels.duration / 2 * unit[panels.part // 2])[:, None]
    return (pace * scale) @ points.analyse @ points.integrate


def _helix(problem: Reduced, weight: Array) -> Array:
    """Growth about a constant angle: bounded about a centre, exponential about a saddle, (B,)."""
    rate = slope_rate(problem, problem.beta0)
    root = np.sqrt(np.abs(rate))
    angle = np.minimum(root * problem.span, 700)
    straight = np.minimum(1 / np.maximum(root, 1e-300), problem.span)
    even = np.where(rate >= 0, 1, np.cosh(angle))
    odd = np.where(rate >= 0, straight, np.sinh(angle) / np.maximum(root, 1e-300))
    return np.maximum(1, np.maximum(even, odd * weight))
