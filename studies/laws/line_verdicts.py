"""Verdicts on one line of numbers: does it rise or fall along the axis, as a law requires?

*true*: every step goes the right way; a count may stay level between neighbours but must change over the whole axis.
*true as a trend*: Kendall's tau in the direction is at least 0.8; the steps that go the wrong way are listed.
*not decided*: cases have no value or steps cross to another branch of equilibria, and the other steps leave it open.
*false*: none of these.

The verdict on a law, which may also be *true in part*, is made from the verdicts on its lines by `judgement.decide`.

Tau is tau-b: (right pairs - wrong pairs) / sqrt(all pairs x pairs whose values differ).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from solver.problem.errors import InputError, check_known

UNCHANGED = "it does not change"  # why a law with a direction is not true of a constant
HOLDS, TREND, QUALIFIED, UNDECIDED, FAILS = "true", "true as a trend", "true in part", "not decided", "false"
VERDICTS = (HOLDS, TREND, QUALIFIED, UNDECIDED, FAILS)  # best first

Array = NDArray[np.float64]

TREND_TAU = 0.8
FEW = 256  # up to this number of values all pairs are compared at once
NOISE = 1e-9  # times the largest value: a smaller step counts as level; see `DEFAULT_TOLERANCE`


@dataclass(frozen=True)
class Verdict:
    """The verdict on a line; `judge` makes it.

    Attributes
    ----------
    verdict : str
        "true", "true as a trend", "true in part", "not decided" or "false".
    tau : float or None
        Kendall's tau in the direction over the pairs that can be compared; None if all values are equal.
    exceptions : list of (int, int)
        The steps (i, i + 1) that go the wrong way, or the cases (i, i) that disagree.
    reason : str
        Why it is false or not decided, unless the trend alone decides; or that a level line is true because it does not
        change.
    found, numbers : str and dict
        What was measured, in words and by name.
    far : float
        How far it is from the law, to rank lines.

    Examples
    --------
    >>> from studies import judge
    >>> verdict = judge([1.0, 2.0, 1.5, 3.0], "rises")
    >>> verdict.verdict, verdict.exceptions
    ('false', [(1, 2)])
    """

    verdict: str
    tau: float | None = None
    exceptions: list[tuple[int, int]] = field(default_factory=list)
    reason: str = ""
    found: str = ""
    numbers: dict[str, float] = field(default_factory=dict)
    far: float = 0.0


@dataclass(frozen=True)
class _Pairs:
    """Numbers of pairs of values that go the right way, that go the wrong way, and that can be compared."""

    right: int
    wrong: int
    compared: int

    @property
    def tau(self) -> float | None:
        if self.right + self.wrong == 0:
            return None
        return float((self.right - self.wrong) / np.sqrt(float(self.compared) * (self.right + self.wrong)))

    def at_best(self, total: int) -> "_Pairs":
        """The pairs if each of those that cannot be compared went the right way."""
        return _Pairs(self.right + total - self.compared, self.wrong, total)


@dataclass(frozen=True, eq=False)
class Line:
    """The values of an observable in the rising order of an axis, and the numbers that a law compares them with.

    values: (n,), not finite where there is no value. cut: (n - 1,), the steps that cross to another branch. count:
    whether the values are a count. axis: its name. along: its values, (n,). targets: key of the law -> (n,). why: why a
    target has no value, or "". A law with a direction needs none of these four. added: (n,), the cases that a
    refinement added where something changes; default: none. The others lie evenly. undefined: (n,), the solved cases in
    which the observable is not defined; laws that compare each case with a number do not count them; default: none.
    """

    values: Array
    cut: NDArray[np.bool_]
    count: bool
    axis: str = ""
    along: Array = field(default_factory=lambda: np.empty(0))
    targets: Mapping[str, Array] = field(default_factory=dict)
    why: str = ""
    added: NDArray[np.bool_] | None = None
    undefined: NDArray[np.bool_] | None = None

    @property
    def even(self) -> NDArray[np.int64]:
        """The indices of the cases that no refinement added."""
        return np.arange(self.values.size) if self.added is None else np.flatnonzero(~self.added)

    @property
    def noise(self) -> float:
        """The largest step that counts as level."""
        return NOISE * float(np.nanmax(np.abs(self.values), initial=0.0))

    def gap_words(self) -> str:
        """How many cases have no value, in words; "" for none."""
        lost = ~np.isfinite(self.values)
        none = np.logical_or.reduce([~np.isfinite(target) for target in self.targets.values()], axis=0)
        sentences = [without_value(lost)] if lost.any() else []
        if np.any(none):
            sentences.append(f"the formula has no value in {int(np.sum(none))} of {lost.size} cases ({self.why})")
        return "; ".join(sentences)


def without_value(missing: NDArray[np.bool_]) -> str:
    """How many cases have no value, in words: they are unsolved, or what is observed is not defined there."""
    count = int(missing.sum())
    return f"{count} of {missing.size} cases {'have' if count > 1 else 'has'} no value"


@dataclass(frozen=True)
class Direction:
    """A kind of law. judge: the verdict on a line; does, does_not: the words for it; sign: of a right step, or 0."""

    judge: Callable[[Line], Verdict]
    does: str
    does_not: str
    sign: int = 0

    @property
    def instead(self) -> str:
        """The words for a trend in the opposite direction."""
        return "falls instead" if self.sign > 0 else "rises instead"


def judge(values: ArrayLike, direction: str, count: bool | None = None, crossing: ArrayLike | None = None) -> Verdict:
    """The verdict on the values of an observable along an axis.

    Parameters
    ----------
    values : array, (n,)
        Values in the rising order of the axis, NaN where a case is unsolved.
    direction : str
        One of `DIRECTIONS`.
    count : bool, optional
        Whether the values are a count, which may stay level between neighbours; default: whether they are integers.
    crossing : array of bool, (n - 1,), optional
        The steps between equilibria of two branches. A pair of values with such a step between them is not compared.

    Returns
    -------
    Verdict

    Raises
    ------
    InputError
        For an unknown direction, or an array of the wrong shape or type.

    Examples
    --------
    >>> from studies import judge
    >>> judge([8, 7, 6, 6, 5], "falls").verdict
    'true'
    """
    check_known("direction", direction, DIRECTIONS)
    return judge_direction(line_of(values, count, crossing), direction)


def line_of(values: ArrayLike, count: bool | None = None, crossing: ArrayLike | None = None, **compared: Any) -> Line:
    """A line that can be judged. values, count, crossing: as of `judge`; compared: further fields of `Line`."""
    given = np.asarray(values)
    if given.ndim != 1 or given.size == 0 or given.dtype.kind not in "iufb":
        raise InputError(f"a law judges one line of numbers, got an array of shape {given.shape}")
    counts = given.dtype.kind in "iub" if count is None else count
    return Line(given.astype(float), cuts(crossing, given.shape), counts, **compared)


def monotone(line: Line, sign: int, may_stand: bool) -> Verdict:
    """The verdict on a line that must go the way of `sign`; may_stand: whether it may be level over the whole axis.

    No case may go the wrong way. Whether it stands still, and the trend, are those of the even cases, so that they do
    not depend on where a refinement added cases.
    """
    row, cut, noise, even = line.values, line.cut, line.noise, line.even
    pausing = may_stand or line.count
    steps = np.where(cut, np.nan, sign * np.diff(row))
    exceptions = [(int(i), int(i) + 1) for i in np.flatnonzero(steps < -noise)]  # False for NaN
    crossed = np.logical_or.reduceat(cut, even[:-1]) if even.size > 1 else cut[:0]
    if not pausing:
        wrong = np.logical_or.reduceat(steps < -noise, even[:-1]) if even.size > 1 else cut[:0]
        stands = ~wrong & ~crossed & (sign * np.diff(row[even]) <= noise)
        exceptions = sorted([*exceptions, *((int(even[k]), int(even[k + 1])) for k in np.flatnonzero(stands))])
    pairs = _compare(row[even], crossed, sign, noise)
    if row.size == 1 or np.isnan(steps).any():
        return _with_gaps(line, pausing, pairs, exceptions)
    changed = may_stand or sign * (row[-1] - row[0]) > noise
    level = "" if np.ptp(row) > noise else UNCHANGED
    if not exceptions and changed:
        return Verdict(HOLDS, pairs.tau, reason=level)
    if pairs.tau is not None and pairs.tau >= TREND_TAU:
        return Verdict(TREND, pairs.tau, exceptions)
    return Verdict(FAILS, pairs.tau, exceptions, level)


DIRECTIONS: dict[str, Direction] = {
    "rises": Direction(partial(monotone, sign=1, may_stand=False), "rises", "does not rise", 1),
    "falls": Direction(partial(monotone, sign=-1, may_stand=False), "falls", "does not fall", -1),
    "not-falling": Direction(partial(monotone, sign=1, may_stand=True), "does not fall", "falls", 1),
    "not-rising": Direction(partial(monotone, sign=-1, may_stand=True), "does not rise", "rises", -1),
}


def judge_direction(line: Line, direction: str) -> Verdict:
    """The verdict on a line in a direction; an infinite value counts as missing."""
    values = np.where(np.isfinite(line.values), line.values, np.nan)
    return DIRECTIONS[direction].judge(replace(line, values=values))


def keeps_direction(line: Line, rule: Mapping[str, Any]) -> Verdict:
    """The verdict on a line that must go in a direction.

    True in part if it is true only because it may stay level, while the sentence says that it rises or falls.
    """
    direction = rule["direction"]
    verdict, says = judge_direction(line, direction), rule.get("says", direction)
    if verdict.verdict != HOLDS or says == direction:
        return verdict
    meant = judge_direction(line, says)
    return meant if as_good(meant.verdict, TREND) else Verdict(QUALIFIED, verdict.tau, reason=verdict.reason)


def worst(verdicts: Sequence[str]) -> str:
    """The worst of several verdicts."""
    return max(verdicts, key=VERDICTS.index)


def as_good(verdict: str, as_other: str) -> bool:
    """Whether a verdict is as good as another, or better."""
    return VERDICTS.index(verdict) <= VERDICTS.index(as_other)


def cuts(crossing: ArrayLike | None, shape: tuple[int, ...], k: int = 0) -> NDArray[np.bool_]:
    """The steps along axis k that cross branches, with that axis last; none by default. Raises `InputError`."""
    expected = tuple(size - (i == k) for i, size in enumerate(shape))
    cut = np.zeros(expected, dtype=bool) if crossing is None else np.asarray(crossing)
    if cut.shape != expected or cut.dtype.kind != "b":
        raise InputError(
            f"crossing must be bools of shape {expected}, one for each step, got {cut.dtype} of {cut.shape}"
        )
    return np.moveaxis(cut, k, -1)


def branch_changes(branch: ArrayLike) -> NDArray[np.bool_]:
    """The steps along the last axis between which the number of the branch, (..., n), changes, (..., n - 1).

    An unsolved case has none, a negative number: the branch before it is held until the next.
    """
    numbers = np.asarray(branch)
    known = numbers >= 0
    last = np.maximum.accumulate(np.where(known, np.arange(numbers.shape[-1]), 0), axis=-1)
    changes: NDArray[np.bool_] = np.diff(np.take_along_axis(numbers, last, axis=-1), axis=-1) != 0
    return changes & np.logical_or.accumulate(known, axis=-1)[..., :-1]


def _with_gaps(line: Line, pausing: bool, pairs: _Pairs, exceptions: list[tuple[int, int]]) -> Verdict:
    """The verdict on a line with unknown steps: it is false only if the known steps rule out even a trend."""
    row, cut, count = line.values, line.cut, line.even.size
    reasons = []
    if np.isnan(row).any():
        reasons.append(without_value(np.isnan(row)))
    if crossed := int(cut.sum()):
        steps = f"{crossed} of {cut.size} steps {'cross' if crossed > 1 else 'crosses'}"
        reasons.append(f"{steps} to another branch of equilibria")
    reason = "; ".join(reasons) or "a single value has no step"
    wrong = pairs.wrong > 0 or (not pausing and pairs.right < pairs.compared)
    best = pairs.at_best(count * (count - 1) // 2).tau
    if wrong and best is not None and best < TREND_TAU:
        return Verdict(FAILS, pairs.tau, exceptions, f"{reason}; the other steps rule out even a trend")
    return Verdict(UNDECIDED, pairs.tau, exceptions, reason)


def _compare(row: NDArray[np.float64], cut: NDArray[np.bool_], sign: int, noise: float) -> _Pairs:
    """The pairs of a line that can be compared: both cases solved, and no step between them crosses branches."""
    rising = falling = compared = 0
    for piece in np.split(row, np.flatnonzero(cut) + 1):
        known = piece[~np.isnan(piece)]
        up, down = _pairs(known, noise)
        rising, falling, compared = rising + up, falling + down, compared + known.size * (known.size - 1) // 2
    return _Pairs(rising, falling, compared) if sign > 0 else _Pairs(falling, rising, compared)


def _pairs(row: NDArray[np.float64], noise: float) -> tuple[int, int]:
    """Numbers of pairs of a line that rise and that fall by more than the noise; by merging, so that a million values
    take seconds.
    """
    if row.size <= FEW:
        i, j = np.triu_indices(row.size, 1)
        steps = row[j] - row[i]
        return int(np.count_nonzero(steps > noise)), int(np.count_nonzero(steps < -noise))
    left, right = row[: row.size // 2], row[row.size // 2 :]
    ordered = np.sort(left)
    rising = int(np.searchsorted(ordered, right - noise, side="left").sum())
    falling = left.size * right.size - int(np.searchsorted(ordered, right + noise, side="right").sum())
    (rl, fl), (rr, fr) = _pairs(left, noise), _pairs(right, noise)
    return rising + rl + rr, falling + fl + fr
