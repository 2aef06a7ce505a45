"""Where two branches of equilibria meet and cease to exist."""

import numpy as np

from solver.equilibria import Equilibrium

from .tracking import Found, Meet, apart

BACK = 3.0  # times the last step: from how far before its end the approach of two branches is measured
TIMES = 3

Two = tuple[Equilibrium, Equilibrium]


def place(at: Found, meet: Meet) -> tuple[float, float, float]:
    """Axis, beta'(0) and energy at a fold: the square of the distance of the two start slopes falls as a line, so it
    is drawn on to zero, from nearer and nearer."""
    last, two = _last(at, meet)
    before = last - BACK * (meet.beyond - last)
    earlier = _like(at(before), two)
    end = (last + meet.beyond) / 2
    for _ in range(TIMES):
        if earlier is None or _square(earlier) <= _square(two):
            break
        drawn = last + (last - before) * _square(two) / (_square(earlier) - _square(two))
        low, high = sorted((last, meet.beyond))
        end = min(max(drawn, low), high)
        nearer = last + 0.8 * (end - last)
        nearest = _like(at(nearer), two)
        if nearest is None:
            break
        before, earlier, last, two = last, two, nearer, nearest
    return end, (two[0].dbeta0 + two[1].dbeta0) / 2, (two[0].energy + two[1].energy) / 2


def _last(at: Found, meet: Meet) -> tuple[float, Two]:
    """The last value at which both are, and the two there."""
    (x, one), (y, other) = meet.first, meet.second
    last = min((x, y), key=lambda value: -abs(value - meet.beyond))
    two = _like(at(last), (one, other)) if x != y else (one, other)
    return (last, two) if two else (x, (one, other))


def _like(found: list[Equilibrium], two: Two) -> Two | None:
    """The two of them most like these; None where their indices are gone, or one is the like of both."""
    far = apart(list(two), found)
    if not far.size or not np.isfinite(far).any(axis=1).all():
        return None
    i, j = (int(k) for k in far.argmin(axis=1))
    return found[i], found[j]


def _square(two: Two) -> float:
    return (two[0].dbeta0 - two[1].dbeta0) ** 2
