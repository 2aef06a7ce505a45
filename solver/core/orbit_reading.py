"""The values of marched orbits anywhere along the rod, from the series of their arcs."""

from typing import Any

import numpy as np

from .loader import compiled
from .taylor_step import ORDER, value


@compiled
def read(
    t: Any,
    lost: Any,
    librates: Any,
    arcs: Any,
    first: Any,
    count: Any,
    since: Any,
    width: Any,
    series: Any,
    angle: Any,
    speed: Any,
    azimuth: Any,
    height: Any,
) -> None:
    """beta, beta_t, alpha, z at t (B, n), into angle, speed, azimuth, height, (B, n) each.

    lost: (B,), NaN then. librates: (B,), else the orbit rotates. arcs: (B, 2) of `ARC`. first, count: (B, 2), the steps
    of each arc; since, width, series: of all steps.
    """
    for i in range(t.shape[0]):
        if lost[i]:
            angle[i] = speed[i] = azimuth[i] = height[i] = np.nan
            continue
        ahead, back = arcs[i, 0].time, arcs[i, 1].time
        period = 2 * (ahead + back) if librates[i] else ahead
        k = first[i, 0]
        turn = 0.0 if librates[i] else np.sign(series[k, 0, 1]) * 2 * np.pi
        for j in range(t.shape[1]):
            local, periods, arc, mirrored = fold(t[i, j], period, ahead, back, librates[i])
            k = find(since, first[i, arc], count[i, arc], k, local)
            x = min(local - since[k], width[k])
            beta, alpha, z = series[k, 0, ORDER], series[k, 1, ORDER], series[k, 2, ORDER]
            v = 0.0
            for n in range(1, ORDER + 1):
                v = v * x + beta
                beta = beta * x + series[k, 0, ORDER - n]
                alpha = alpha * x + series[k, 1, ORDER - n]
                z = z * x + series[k, 2, ORDER - n]
            angle[i, j], speed[i, j] = beta + turn * periods, -v if mirrored else v
            azimuth[i, j] = unfold(alpha, arcs[i, 0].azimuth, arcs[i, 1].azimuth, librates[i], arc, mirrored, periods)
            height[i, j] = unfold(z, arcs[i, 0].height, arcs[i, 1].height, librates[i], arc, mirrored, periods)


@compiled
def read_swirl(
    t: Any, lost: Any, librates: Any, arcs: Any, first: Any, count: Any, since: Any, width: Any, series: Any, out: Any
) -> None:
    """The integral of sin(beta) cos(beta) from the start to t (B, n), into out (B, n); arguments as in `read`."""
    for i in range(t.shape[0]):
        if lost[i]:
            out[i] = np.nan
            continue
        ahead, back = arcs[i, 0].time, arcs[i, 1].time
        period = 2 * (ahead + back) if librates[i] else ahead
        k = first[i, 0]
        for j in range(t.shape[1]):
            local, periods, arc, mirrored = fold(t[i, j], period, ahead, back, librates[i])
            k = find(since, first[i, arc], count[i, arc], k, local)
            total = value(series[k, 3], ORDER, min(local - since[k], width[k]))
            out[i, j] = unfold(total, arcs[i, 0].swirl, arcs[i, 1].swirl, librates[i], arc, mirrored, periods)


@compiled
def fold(t: float, period: float, ahead: float, back: float, librates: bool) -> tuple[float, float, int, bool]:
    """Time within an arc, whole periods passed, which arc, whether on its way back."""
    periods = np.floor(t / period)
    rest = max(t - periods * period, 0.0)
    if not librates:
        return rest, periods, 0, False
    if rest <= 2 * ahead:
        return (rest, periods, 0, False) if rest <= ahead else (2 * ahead - rest, periods, 0, True)
    rest -= 2 * ahead
    return (rest, periods, 1, False) if rest <= back else (max(2 * back - rest, 0.0), periods, 1, True)


@compiled
def find(since: Any, first: int, count: int, near: int, local: float) -> int:
    """The step of an arc in which a time lies, searched from the step `near` on."""
    k = min(max(near, first), first + count - 1)
    while k > first and local < since[k]:
        k -= 1
    while k + 1 < first + count and local >= since[k + 1]:
        k += 1
    return k


@compiled
def unfold(total: float, there: float, after: float, librates: bool, arc: int, mirrored: bool, periods: float) -> float:
    """A quantity that grows along the rod, from its value within an arc and its gains over both arcs."""
    if not librates:
        return total + periods * there
    limit = after if arc == 1 else there
    found = 2 * limit - total if mirrored else total
    if arc == 1:
        found += 2 * there
    return found + periods * 2 * (there + after)
