"""Equilibria that begin or end at rest, beta_t = 0 there but for a hair: the one place where paths of two kinds meet.

As the level falls to G(beta(0)) the orbit that leaves upward and the one that leaves downward become the same, and no
scan of either sees the length pass the rod's. So the rod that starts at rest is shot at, from either end.
"""

import numpy as np

from .landscape import TAU, potential, slope
from .levels import many
from .methods.orbit import solve_orbit
from .reduced import Reduced

_HAIR = 1e-5  # beta_t up to which a start counts as at rest


def resting(problem: Reduced) -> list[tuple[float, float, float]]:
    """Pin, gap and beta_t(0) of each that there is: at most two."""
    assert problem.betaL is not None
    out = []
    first, last = float(problem.beta0[0]), float(problem.betaL[0])
    from_start, from_far = _shot(problem, first, last), _shot(problem, last, first)
    if from_start is not None:
        v, _ = from_start
        out.append((_wrapped(first), v * v, v))
    if from_far is not None:  # the same rod run backwards
        v, w = from_far
        level = float((potential(problem, last) - potential(problem, first))[0]) + v * v
        # next to its start's own level the slope says more than the level does
        leaving = float(-np.copysign(np.sqrt(level), w)) if level > 1e-6 else -w
        if from_start is None or abs(leaving - from_start[0]) > 1e-7:
            out.append((_wrapped(last), v * v, leaving))
    return out


def _shot(problem: Reduced, start: float, target: float) -> tuple[float, float] | None:
    """beta_t at the start and at the end of the rod that starts within a hair of rest; None where it does not end at
    the target, or where rest is a helix."""
    if abs(float(slope(problem, np.array([start]))[0])) < 1e-9:
        return None
    three = many(problem, 3, beta0=np.full(3, start))
    v, eta, off, arriving = 0.0, np.nan, np.nan, np.nan
    for _ in range(8):
        slopes = v + _HAIR * np.array([-0.1, 0.0, 0.1])
        beta, rate, _, _ = solve_orbit(three.started(slopes), 1e-13).at(three.span[:, None])
        eta = float(beta[2, 0] - beta[0, 0]) / (0.2 * _HAIR)
        off, arriving = float(beta[1, 0]) - target, float(rate[1, 0])
        if not abs(off) <= 2 * _HAIR * abs(eta):
            return None
        if abs(off) <= 4e-15 * (1 + abs(target)) * max(1, abs(eta)):
            break
        v -= off / eta
    return (v, arriving) if abs(v) <= _HAIR and abs(off) < 1e-9 else None


def _wrapped(angle: float) -> float:
    angle -= TAU * round(angle / TAU)
    return angle - TAU if angle >= np.pi else angle
