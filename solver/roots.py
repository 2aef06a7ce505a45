"""Roots of many functions at once, each inside its own bracket."""

from collections.abc import Callable

import numpy as np

from .reduced import Array


def bracketed(
    f: Callable[[Array], tuple[Array, Array]], lo: Array, hi: Array, start: Array | None = None, rounds: int = 120
) -> Array:
    """Roots by Newton's rule kept inside brackets that shrink, all (P,).

    f returns value and derivative, and must be negative at `lo` and not negative at `hi` (`lo` may be the larger).
    A Newton step that leaves the bracket, or does not halve the step before last, becomes a bisection.
    """
    lo, hi = lo.copy(), hi.copy()
    x = (lo + hi) / 2 if start is None else start.copy()
    last = older = np.abs(hi - lo)
    for _ in range(rounds):
        value, rate = f(x)
        below = value < 0
        lo, hi = np.where(below, x, lo), np.where(below, hi, x)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            new = x - value / rate
        outside = ~((new - lo) * (new - hi) <= 0) | (np.abs(new - x) > older / 2)
        new = np.where(outside, (lo + hi) / 2, new)
        new = np.where(value == 0, x, new)
        older, last = last, np.abs(new - x)
        if (last <= 4e-16 * np.abs(new)).all():
            return new
        x = new
    return x
