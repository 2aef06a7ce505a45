"""Roots of many functions at once, each inside its own bracket."""

from collections.abc import Callable

import numpy as np

from .arrays import Array


def bracket(
    f: Callable[[Array], tuple[Array, Array]],
    lo: Array,
    hi: Array,
    start: Array | None = None,
    steps: int = 120,
) -> Array:
    """Roots by Newton's rule kept inside shrinking brackets.

    A Newton step that leaves the bracket, or does not halve the step before last, is replaced by a bisection.

    Parameters
    ----------
    f : callable
        Value and derivative at x (P,).
    lo, hi : array (P,)
        Places where f is negative and where it is not; `lo` may be the larger.
    start : array (P,), optional
        First guess. Default: the middle.
    steps : int
        Largest number of steps.

    Returns
    -------
    array (P,)
    """
    x = (lo + hi) / 2 if start is None else start
    older = np.abs(hi - lo)
    last = np.zeros_like(older)  # no step was made yet
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for _ in range(steps):
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


def bisect(f: Callable[[Array], Array], lo: Array, hi: Array, steps: int) -> Array:
    """The middles (P,) of brackets (P,) of roots after so many bisections; f: the values at x (P,)."""
    if not lo.size:
        return lo
    first = f(lo)
    for _ in range(steps):
        x = (lo + hi) / 2
        below = f(x) * first > 0
        lo, hi = np.where(below, x, lo), np.where(below, hi, x)
    return (lo + hi) / 2
