"""Small linear systems, scaled; the root of several equations by Newton's rule; roots of many functions at once."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from .arrays import Array

Point = TypeVar("Point")
DIVERGED = "Newton's rule does not converge"
CLOSE = 1e-7  # a step of Newton's rule this short is the last: the next would be of the size of its square


def solve(matrix: Array, forced: Array) -> Array:
    """The solutions (B, n, k) of square systems (B, n, n), rows and columns scaled; NaN for a singular one."""
    with np.errstate(all="ignore"):
        column = 1 / np.abs(matrix).max(axis=1)
        scaled = matrix * column[:, None, :]
        row = 1 / np.abs(scaled).max(axis=2)
        scaled, right = scaled * row[..., None], forced * row[..., None]
    out = np.full(forced.shape, np.nan)
    for b in np.flatnonzero(np.isfinite(scaled).all(axis=(1, 2)) & np.isfinite(right).all(axis=(1, 2))):
        try:
            x = np.linalg.solve(scaled[b], right[b])
            x += np.linalg.solve(scaled[b], right[b] - scaled[b] @ x)
        except np.linalg.LinAlgError:
            continue
        out[b] = x * column[b][:, None]
    return out


def null_vector(matrix: Array) -> Array:
    """The unit vector t with F' t = 0, of n equations F' (n, n + 1), whose rows are scaled."""
    with np.errstate(all="ignore"):
        size = np.abs(matrix).max(axis=1, keepdims=True)
    return np.asarray(np.linalg.svd(matrix / np.where(size > 0, size, 1.0))[2][-1])


@dataclass(frozen=True)
class Ending:
    """When corrections end.

    rounds: the most corrections. goal: the size of the last one. small: the size of corrections that may be rounding:
    they end where one is not smaller than `stall` times the smallest before. longest: the largest size. growth: the
    largest ratio of a correction that is not small to the smallest before.
    """

    rounds: int
    goal: float
    small: float = 0.0
    longest: float = np.inf
    growth: float = np.inf
    stall: float = 1.0


def newton(x: Point, step: Callable[[Point], tuple[Point, float] | str], ending: Ending) -> Point | str:
    """The root that Newton's rule reaches from x, or why it reaches none.

    The correctors of an equilibrium, of a point of a curve, and of a shape on nodes are this one, each with its step.

    Parameters
    ----------
    x : any type
        The first guess.
    step : callable
        From a guess to the next, and the size of the correction; or why there is none.
    ending : Ending
    """
    least = np.inf
    for _ in range(ending.rounds):
        move = step(x)
        if isinstance(move, str):
            return move
        x, size = move
        if not (size <= min(ending.growth * least, ending.longest) or size <= ending.small):  # also NaN
            return DIVERGED
        if size <= ending.goal or ending.stall * least <= size <= ending.small:
            return x
        least = min(least, size)
    return x if least <= ending.small else DIVERGED


def root(
    equations: Callable[[Array], tuple[Array, Array] | None], x: Array, longest: float, rounds: int = 8
) -> Array | None:
    """The root near x (n,), by Newton's rule; None where it does not converge.

    Parameters
    ----------
    equations : callable
        Of x: the values (n,) and the derivatives (n, n); None where there are none.
    longest : float
        The largest change of an unknown in a step.
    """

    def step(x: Array) -> tuple[Array, float] | str:
        system = equations(x)
        if system is None:
            return DIVERGED
        change = solve(system[1][None], -system[0][None, :, None])[0, :, 0]
        return x + change, float(np.abs(change).max())

    zero = newton(x, step, Ending(rounds, CLOSE, longest=longest, growth=2.0))
    return None if isinstance(zero, str) else zero


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


def enclose(
    at: Callable[[float], tuple[Point, float] | None],
    high: float,
    values: tuple[float, float],
    rounds: int,
    kept: float,
) -> Iterator[tuple[float, Point, float]]:
    """Points ever nearer to where a value changes its sign between 0 and `high`, by false position.

    Yields the width of the bracket that a point leaves, the point, and its value; ends where there is no point.

    Parameters
    ----------
    at : callable
        Of a place: the point and the value there; None where there is none.
    values : tuple of two floats
        At 0 and at `high`.
    rounds : int
        Of points, at most.
    kept : float
        Factor of the value at an end that stays: 0.5 is the Illinois rule; 1, with values 1 and -1, bisection.
    """
    before, after = values
    low = 0.0
    for _ in range(rounds):
        middle = low + (high - low) * min(0.95, max(0.05, before / (before - after)))
        answer = at(middle)
        if answer is None:
            return
        point, value = answer
        if value * before > 0:
            low, before, after = middle, value, kept * after
        else:
            high, before, after = middle, kept * before, value
        yield high - low, point, value


def halve(holds: Callable[[float], object], low: float, high: float, width: float) -> tuple[float, float]:
    """The last place where a condition does not hold, and the first where it does, at most `width` apart."""
    while high - low > width:
        middle = (low + high) / 2
        low, high = (low, middle) if holds(middle) else (middle, high)
    return low, high


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
