"""Small linear systems, scaled; the root of several equations by Newton's rule; roots of many functions at once."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import scipy  # its parts are imported when used

from .arrays import Array, Integers

Point = TypeVar("Point")
State = TypeVar("State")
Step = TypeVar("Step")
DIVERGED = "Newton's rule does not converge"
# relative: how closely a place or a time along a rod is known, a root is enclosed, a series is cut: some roundings.
# x10: a digit less of them
EXACT = 1e-14
# a step of Newton's rule this short is the last: the next would be of the size of its square. x10: places to 1e-12
CLOSE = 1e-7
# rad, or in the scale of the angles: the longest step that Newton's rule is followed. x10: it leads to another root
REACH = 0.5
# of a method that usually takes a tenth of them: one that has not converged then never will. x10: only failures take
# longer
ROUNDS = 60
# of the rate of the product along a step, below which the known zeros hardly matter. x10: known zeros are found again
_SLIGHT = 0.5


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
    rounds : int
        The most steps. A simple root takes fewer than 8; with 30, lines of folds went through double ones, and stopped.
    """

    def step(x: Array) -> tuple[Array, float] | str:
        system = equations(x)
        if system is None:
            return DIVERGED
        change = solve(system[1][None], -system[0][None, :, None])[0, :, 0]
        return x + change, float(np.abs(change).max())

    zero = newton(x, step, Ending(rounds, CLOSE, longest=longest, growth=2.0))
    return None if isinstance(zero, str) else zero


def lead_away(
    state: State,
    newton_step: Callable[[State], tuple[Array, Array, Step] | None],
    move: Callable[[State, Step, float], tuple[State, float] | None],
    known: Sequence[Array],
    ending: Ending,
) -> State | None:
    """A state from which Newton's rule converges by itself, away from the known zeros; None where the steps reach none.

    The equations are multiplied by the product of 1 + 1/r^2 over the known zeros, r being the distance from one of them
    in some numbers: the product has the same zeros but these. Newton's step for the product is that for the equations
    times a number, so nothing but this number is computed.

    Parameters
    ----------
    state : any type
        Where to begin.
    newton_step : callable
        Of a state: the numbers in which distances are taken, their change by a step of Newton's rule for the equations,
        and that step; None where there is none.
    move : callable
        Of a state, a step and a factor: the state after the factor times the step, or less if that is too long, and the
        size of the step itself; None where there is no such state.
    known : sequence of arrays
        The numbers of the known zeros.
    ending : Ending
        Its rounds, and as its goal the size of a step from which Newton's rule converges by itself.
    """
    for _ in range(ending.rounds):
        step = newton_step(state)
        if step is None:
            return None
        numbers, change, whole = step
        rate = 0.0  # of the logarithm of the product
        for zero in known:
            apart = numbers - zero
            square = max(float(apart @ apart), 1e-30)
            rate -= 2 * float(apart @ change) / (square * (square + 1))
        moved = move(state, whole, 1 / (1 - rate) if rate != 1 else np.inf)
        if moved is None:
            return None
        state, size = moved
        if size < ending.goal and abs(rate) < _SLIGHT:
            return state
    return None


def locate(
    at: Callable[[float], Point | str | None],
    ends: dict[float, Point],
    value: Callable[[Point], float],
    flat: float = 0.0,
) -> Point | None:
    """The point of a way where a value of it is zero; None where its sign is the same at both ends, or a point is
    missing.

    at: the point at a place; None, or why there is none. ends: the two ends of the way, by their places. flat: a value
    that is as good as 0.
    """
    points = dict(ends)

    def value_at(place: float) -> float:
        if place not in points:
            point = at(place)
            if point is None or isinstance(point, str):
                raise ArithmeticError
            points[place] = point
        size = float(value(points[place]))
        return 0.0 if abs(size) <= flat else size

    if value_at(min(ends)) * value_at(max(ends)) > 0:
        return None
    try:
        return points[scipy.optimize.brentq(value_at, *ends, xtol=EXACT, rtol=EXACT)]
    except ArithmeticError:
        return None


def enclose(
    at: Callable[[float], Point | str | None],
    ends: dict[float, Point],
    is_changed: Callable[[Point], object],
    width: float,
) -> list[tuple[float, Point]]:
    """The last point of a way before a change, and the first one after it, with their places.

    at, ends: as of `locate`. A missing point counts as one after the change, where equations may be singular. width:
    below which the change is not enclosed more closely.
    """
    points = dict(ends)

    def is_after(place: float) -> object:
        point = at(place)
        if point is None or isinstance(point, str):
            return True
        points[place] = point
        return is_changed(point)

    low, _ = halve(is_after, min(ends), max(ends), width)
    high = min(place for place in points if place > low)
    return [(low, points[low]), (high, points[high])]


def halve(holds: Callable[[float], object], low: float, high: float, width: float) -> tuple[float, float]:
    """The last place where a condition does not hold, and the first where it does, at most `width` apart."""
    while high - low > width:
        middle = (low + high) / 2
        low, high = (low, middle) if holds(middle) else (middle, high)
    return low, high


def sign_changes(f: Callable[[Array], Array], x: Array, value: Array, steps: int = ROUNDS) -> Array:
    """Where f changes its sign between neighbours of rising places x (n,), (P,), by so many bisections; value: f(x), or
    its sign. Neighbours one of which is 0 have no change."""
    sign = np.sign(value)
    k = np.flatnonzero(sign[1:] * sign[:-1] < 0)
    lo, hi = x[k], x[k + 1]
    for _ in range(steps if k.size else 0):
        middle = (lo + hi) / 2
        before = f(middle) * sign[k] > 0
        lo, hi = np.where(before, middle, lo), np.where(before, hi, middle)
    return (lo + hi) / 2


def largest_between(read: Callable[[Array], Array], t: Array, rounds: int = 3, places: int = 17) -> tuple[Array, Array]:
    """The largest of numbers along t, (rows,), and where each is, (rows,): the first place of several.

    read: the numbers, 0 or more, at rising t, (rows, n). t: (n,), so dense that each peak has one of them. Beside each
    peak that may be the largest, the numbers are read at so many places, and beside the largest of these again, rounds
    times.
    """
    values = read(t)
    rows, k = _peaks(values)
    best, at = values[rows, k], t[k]
    low, high = t[np.maximum(k - 1, 0)], t[np.minimum(k + 1, t.size - 1)]
    for _ in range(rounds):
        tried = low[:, None] + (high - low)[:, None] * np.linspace(0, 1, places)
        order = np.argsort(tried, axis=None)
        read_there = np.empty((len(values), tried.size))
        read_there[:, order] = read(tried.reshape(-1)[order])
        peaks = np.arange(k.size)
        beside = read_there.reshape(len(values), k.size, places)[rows, peaks]
        top = np.argmax(beside, axis=1)
        larger = beside[peaks, top] > best
        best, at = np.where(larger, beside[peaks, top], best), np.where(larger, tried[peaks, top], at)
        low, high = tried[peaks, np.maximum(top - 1, 0)], tried[peaks, np.minimum(top + 1, places - 1)]
    largest = np.array([best[rows == row].max() for row in range(len(values))])
    least = (1 - 1e-9) * largest  # a number that rounding alone changes is largest at its begin
    first = [at[(rows == row) & (best >= enough)].min() for row, enough in enumerate(least)]
    reached = values >= least[:, None]
    return largest, np.where(reached.any(axis=1), np.minimum(first, t[np.argmax(reached, axis=1)]), first)


def _peaks(values: Array, most: int = 64) -> tuple[Integers, Integers]:
    """Row and column of each peak of numbers (rows, n) that may be the largest of its row between the columns.

    Between a peak and its neighbours a parabola rises above the peak by at most an eighth of the larger fall to them;
    twice that is allowed for. Of more than so many the highest.
    """
    beside = np.pad(values, ((0, 0), (1, 1)), mode="edge")
    falls = values - np.stack([beside[:, :-2], beside[:, 2:]])
    reach = np.where((falls >= 0).all(axis=0), values + falls.max(axis=0) / 4, -np.inf)
    highest = np.argsort(-reach, axis=1, kind="stable")[:, :most]
    rows, order = np.nonzero(np.take_along_axis(reach, highest, axis=1) >= values.max(axis=1, keepdims=True))
    return rows, highest[rows, order]


# golden section; the steps to the least size between two places, each to 0.618: 4e-9 of the bracket at last, as a
# parabola allows. x10: no section; only time
SECTION, DIP_STEPS = 0.382, 40


def roots_between(f: Callable[[Array], Array], x: Array) -> tuple[Array, Array]:
    """The roots of f between neighbours of rising places x (n,), by bisection, and the places where it is 0.

    Between three places where the size of f has a minimum two roots may lie: it is looked for by golden section.
    """
    value = f(x)
    size, same = np.abs(value), value[1:] * value[:-1] > 0
    dips = 1 + np.flatnonzero((size[1:-1] < size[:-2]) & (size[1:-1] <= size[2:]) & same[:-1] & same[1:])
    lo, hi, sign = x[dips - 1], x[dips + 1], np.sign(value[dips])
    for _ in range(DIP_STEPS if dips.size else 0):
        left, right = lo + SECTION * (hi - lo), hi - SECTION * (hi - lo)
        falls = sign * (f(right) - f(left)) < 0
        lo, hi = np.where(falls, left, lo), np.where(falls, hi, right)
    every = np.unique(np.concatenate([x, (lo + hi) / 2]))
    value = f(every)
    return sign_changes(f, every, value), every[value == 0]
