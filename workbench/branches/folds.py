"""Folds: where two branches of equilibria meet and cease to exist."""

import numpy as np

from solver.equilibria import Equilibrium

from .tracking import Meeting, Search, distances

BACK = 3.0  # times the last step: how far before the end of two branches the extrapolation starts
ROUNDS = 3

Pair = tuple[Equilibrium, Equilibrium]


def fold_at(at: Search, meeting: Meeting) -> tuple[float, float, float]:
    """Axis value, beta'(0) [rad/length] and energy [force length] of the fold in which two branches meet.

    Near a fold the square of the difference of the two start slopes is linear in the axis value. It is extrapolated
    to zero, three times, each time from values closer to the fold.
    """
    last, pair = _last_pair(at, meeting)
    before = last - BACK * (meeting.beyond - last)
    earlier = _nearest_pair(at(before), pair)
    end = (last + meeting.beyond) / 2
    for _ in range(ROUNDS):
        if earlier is None or _squared(earlier) <= _squared(pair):
            break
        zero = last + (last - before) * _squared(pair) / (_squared(earlier) - _squared(pair))
        low, high = sorted((last, meeting.beyond))
        end = min(max(zero, low), high)
        closer = last + 0.8 * (end - last)
        closest = _nearest_pair(at(closer), pair)
        if closest is None:
            break
        before, earlier, last, pair = last, pair, closer, closest
    return end, (pair[0].dbeta0 + pair[1].dbeta0) / 2, (pair[0].energy + pair[1].energy) / 2


def _last_pair(at: Search, meeting: Meeting) -> tuple[float, Pair]:
    """The last axis value at which both branches exist, and their equilibria there."""
    (x, one), (y, other) = meeting.first, meeting.second
    last = min((x, y), key=lambda value: -abs(value - meeting.beyond))
    pair = _nearest_pair(at(last), (one, other)) if x != y else (one, other)
    return (last, pair) if pair else (x, (one, other))


def _nearest_pair(found: list[Equilibrium], pair: Pair) -> Pair | None:
    """The equilibria nearest to a pair; None if none has their indices."""
    far = distances(list(pair), found)
    if not far.size or not np.isfinite(far).any(axis=1).all():
        return None
    i, j = (int(k) for k in far.argmin(axis=1))
    return found[i], found[j]


def _squared(pair: Pair) -> float:
    return (pair[0].dbeta0 - pair[1].dbeta0) ** 2
