"""Verdicts on one line of numbers: does it rise or fall along the axis, as a law requires?

*holds*: every step goes the right way; a count may stay level between neighbours but must change over the whole axis.
*holds as a trend*: Kendall's tau in the direction is at least 0.8; the steps that go the wrong way are listed.
*not decided*: cases are unsolved or steps cross to another branch of equilibria, and the other steps leave it open.
*fails*: none of these.

The verdict on a law, which may also be *qualified*, is made from the verdicts on its lines by `verdicts.decide`.

Tau is tau-b: (right pairs - wrong pairs) / sqrt(all pairs x pairs whose values differ).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from solver.problem.errors import InputError, no_such

HOLDS, TREND, QUALIFIED, UNDECIDED, FAILS = "holds", "holds as a trend", "qualified", "not decided", "fails"
VERDICTS = (HOLDS, TREND, QUALIFIED, UNDECIDED, FAILS)  # best first

TREND_TAU = 0.8
FEW = 256  # up to this number of values all pairs are compared at once
NOISE = 1e-9  # times the largest value: a smaller step counts as level; see `DEFAULT_TOLERANCE`


@dataclass(frozen=True)
class Verdict:
    """The verdict on a line; `judge` makes it.

    Attributes
    ----------
    verdict : str
        "holds", "holds as a trend", "qualified", "not decided" or "fails".
    tau : float or None
        Kendall's tau in the direction over the pairs that can be compared; None if all values are equal.
    exceptions : list of (int, int)
        The steps (i, i + 1) that go the wrong way, or the cases (i, i) that disagree.
    reason : str
        Why it fails or is not decided, unless the trend alone decides; or that a level line holds because it does not
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
    ('fails', [(1, 2)])
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
    """The values of an observable in the rising order of an axis.

    values: (n,), NaN where a case is unsolved. cut: (n - 1,), the steps that cross to another branch. count: whether
    the values are a count. noise: the largest step that counts as level.
    """

    values: NDArray[np.float64]
    cut: NDArray[np.bool_]
    count: bool
    noise: float


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
    'holds'
    """
    if direction not in DIRECTIONS:
        raise no_such("direction", direction, DIRECTIONS)
    given = np.asarray(values)
    if given.ndim != 1 or given.size == 0 or given.dtype.kind not in "iufb":
        raise InputError(f"a law judges one line of numbers, got an array of shape {given.shape}")
    row = given.astype(float)
    row[~np.isfinite(row)] = np.nan
    noise = NOISE * float(np.nanmax(np.abs(row), initial=0.0))
    counts = given.dtype.kind in "iub" if count is None else count
    return DIRECTIONS[direction].judge(Line(row, _cut(crossing, given.size), counts, noise))


def monotone(line: Line, sign: int, may_stand: bool) -> Verdict:
    """The verdict on a line that must go the way of `sign`; may_stand: whether it may be level over the whole axis."""
    row, cut, noise = line.values, line.cut, line.noise
    pausing = may_stand or line.count
    steps = np.where(cut, np.nan, sign * np.diff(row))
    wrong = steps < -noise if pausing else steps <= noise  # False for NaN
    exceptions = [(int(i), int(i) + 1) for i in np.flatnonzero(wrong)]
    pairs = _compare(row, cut, sign, noise)
    if row.size == 1 or np.isnan(steps).any():
        return _with_gaps(row, cut, pausing, pairs, exceptions)
    changed = may_stand or sign * (row[-1] - row[0]) > noise
    level = "" if np.ptp(row) > noise else "it does not change"
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


def worst(verdicts: Sequence[str]) -> str:
    """The worst of several verdicts."""
    return max(verdicts, key=VERDICTS.index)


def as_good(verdict: str, as_other: str) -> bool:
    """Whether a verdict is as good as another, or better."""
    return VERDICTS.index(verdict) <= VERDICTS.index(as_other)


def _cut(crossing: ArrayLike | None, size: int) -> NDArray[np.bool_]:
    """The steps that cross branches, (size - 1,); none by default. Raises `InputError`."""
    if crossing is None:
        return np.zeros(size - 1, dtype=bool)
    cut = np.asarray(crossing)
    if cut.shape != (size - 1,) or cut.dtype.kind != "b":
        raise InputError(
            f"crossing must be one bool for each of {size - 1} steps, got {cut.dtype} of shape {cut.shape}"
        )
    return cut


def _with_gaps(
    row: NDArray[np.float64], cut: NDArray[np.bool_], pausing: bool, pairs: _Pairs, exceptions: list[tuple[int, int]]
) -> Verdict:
    """The verdict on a line with unknown steps: it fails only if the known steps rule out even a trend."""
    reasons = []
    if unsolved := int(np.isnan(row).sum()):
        reasons.append(f"{unsolved} of {row.size} cases unsolved")
    if crossed := int(cut.sum()):
        steps = f"{crossed} of {cut.size} steps {'cross' if crossed > 1 else 'crosses'}"
        reasons.append(f"{steps} to another branch of equilibria")
    reason = "; ".join(reasons) or "a single value has no step"
    wrong = pairs.wrong > 0 or (not pausing and pairs.right < pairs.compared)
    best = pairs.at_best(row.size * (row.size - 1) // 2).tau
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
