"""Roots of many functions at once, each inside its own bracket."""

from collections.abc import Callable

import numpy as np

from .arrays import Array


def bracketed(
    f: Callable[[Array], tuple[Array, Array]],
    lo: Array,
    hi: Array,
    start: Array | None = None,
    rounds: int = 120,
) -> Array:
    """Roots by Newton's rule kept inside brackets that shrink, all (P,).

    f returns value and derivative, and must be negative at `lo` and not negative at `hi` (`lo` may be the larger).
    A Newton step that leaves the bracket, or does not halve the step before last, becomes a bisection.
    """
    x = (lo + hi) / 2 if start is None else start
    older = np.abs(hi - lo)
    last = np.zeros_like(older)  # no step yet
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for _ in range(rounds):
            value, rate = f(x)
            below = value < 0
            lo, hi = np.where(below, x, lo), np.where(below, hi, x)
            new = x - value / rate
            step = np.abs(new - x)
            outside = ~((new - lo) * (new - hi) <= 0) | (step > older / 2)
            if outside.any():
                new = np.where(outside, np.where(value == 0, x, (lo + hi) / 2), new)
                step = np.abs(new - x)
            # Newton's steps shrink to the square, so the next one would be step (step/last)^2
            if (step * np.fmin(step / last, 1) ** 2 <= 4e-16 * np.abs(new)).all():
                return new
            older, last, x = (older if not last.any() else last), step, new
    return x
