"""Verdicts on one row of numbers: does it rise or fall as it must?

*holds*: every step goes the right way; a count may stay the same between neighbours but must change over the whole
axis. *holds as a trend*: Kendall's tau in the direction is at least 0.8; the steps that go the wrong way are listed.
*not decided*: cases are unsolved or steps cross to another branch of equilibria, and the other steps leave it open.
*fails*: none of these. (*qualified* is a verdict on a law, see `studies.laws`.)

Tau is tau-b: right less wrong pairs over sqrt(all pairs x pairs whose values differ), so a count that pauses
loses a little.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from solver.problem.errors import InputError, no_such

HOLDS, TREND, QUALIFIED, UNDECIDED, FAILS = "holds", "holds as a trend", "qualified", "not decided", "fails"
VERDICTS = (HOLDS, TREND, QUALIFIED, UNDECIDED, FAILS)  # best first

# direction -> (sign of a right step, whether standing still is allowed)
DIRECTIONS = {"rises": (1, False), "falls": (-1, False), "not-falling": (1, True), "not-rising": (-1, True)}

TREND_TAU = 0.8
FEW = 256  # values whose pairs are all looked at
NOISE = 1e-9  # of the largest value; a smaller step is none, as the solver's own tolerance is 1e-8


@dataclass(frozen=True)
class Verdict:
    """One of `VERDICTS`; tau in the direction over the pairs that can be compared, None where nothing varies.

    exceptions: the steps (i, i + 1) that go the wrong way. reason: why it fails or is not decided, where it is not the
    trend; or that what may stand still holds because nothing changes.
    """

    verdict: str
    tau: float | None = None
    exceptions: list[tuple[int, int]] = field(default_factory=list)
    reason: str = ""


@dataclass(frozen=True)
class _Pairs:
    """How many pairs of values go the right way and the wrong way, of how many that can be compared."""

    right: int
    wrong: int
    compared: int

    @property
    def tau(self) -> float | None:
        if self.right + self.wrong == 0:
            return None
        return float((self.right - self.wrong) / np.sqrt(float(self.compared) * (self.right + self.wrong)))

    def at_best(self, total: int) -> "_Pairs":
        """As if every pair that cannot be compared went the right way."""
        return _Pairs(self.right + total - self.compared, self.wrong, total)


def judge(values: ArrayLike, direction: str, count: bool | None = None, crossing: ArrayLike | None = None) -> Verdict:
    """The verdict on values along an axis, in the axis's rising order.

    values: (n,), NaN where a case is unsolved. count: whether the values are a count, which may stay the same between
    neighbours; by default, whether they are integers. crossing: (n - 1,) of bool, the steps between equilibria of two
    branches: no pair of values with such a step between them is evidence. Raises `InputError` for an unknown direction,
    or arrays of other shapes or kinds.
    """
    if direction not in DIRECTIONS:
        raise no_such("direction", direction, DIRECTIONS)
    given = np.asarray(values)
    if given.ndim != 1 or given.size == 0 or given.dtype.kind not in "iufb":
        raise InputError(f"a law judges one row of numbers, got an array of shape {given.shape}")
    cut = _cut(crossing, given.size)
    row = given.astype(float)
    row[~np.isfinite(row)] = np.nan
    sign, may_stand = DIRECTIONS[direction]
    noise = NOISE * float(np.nanmax(np.abs(row), initial=0.0))
    pausing = may_stand or (given.dtype.kind in "iub" if count is None else count)
    steps = np.where(cut, np.nan, sign * np.diff(row))
    wrong = steps < -noise if pausing else steps <= noise  # False for NaN
    exceptions = [(int(i), int(i) + 1) for i in np.flatnonzero(wrong)]
    pairs = _compared(row, cut, sign, noise)
    if row.size == 1 or np.isnan(steps).any():
        return _with_gaps(row, cut, pausing, pairs, exceptions)
    changed = may_stand or sign * (row[-1] - row[0]) > noise
    level = "" if np.ptp(row) > noise else "it does not change"
    if not exceptions and changed:
        return Verdict(HOLDS, pairs.tau, reason=level)
    if pairs.tau is not None and pairs.tau >= TREND_TAU:
        return Verdict(TREND, pairs.tau, exceptions)
    return Verdict(FAILS, pairs.tau, exceptions, level)


def worst(verdicts: Sequence[str]) -> str:
    """The worst of some verdicts."""
    return max(verdicts, key=VERDICTS.index)


def as_good(verdict: str, as_other: str) -> bool:
    """Whether a verdict is as good as another, or better."""
    return VERDICTS.index(verdict) <= VERDICTS.index(as_other)


def _cut(crossing: ArrayLike | None, size: int) -> NDArray[np.bool_]:
    if crossing is None:
        return np.zeros(size - 1, dtype=bool)
    cut = np.asarray(crossing)
    if cut.shape != (size - 1,) or cut.dtype.kind != "b":
        raise InputError(f"crossing is one bool for each of {size - 1} steps, got {cut.dtype} of shape {cut.shape}")
    return cut


def _with_gaps(
    row: NDArray[np.float64], cut: NDArray[np.bool_], pausing: bool, pairs: _Pairs, exceptions: list[tuple[int, int]]
) -> Verdict:
    """The verdict on a row of which not every step is known: it fails only where the others rule out even a trend."""
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


def _compared(row: NDArray[np.float64], cut: NDArray[np.bool_], sign: int, noise: float) -> _Pairs:
    """The pairs of a row that can be compared: both solved, and no step between them that crosses branches."""
    rising = falling = compared = 0
    for piece in np.split(row, np.flatnonzero(cut) + 1):
        known = piece[~np.isnan(piece)]
        up, down = _pairs(known, noise)
        rising, falling, compared = rising + up, falling + down, compared + known.size * (known.size - 1) // 2
    return _Pairs(rising, falling, compared) if sign > 0 else _Pairs(falling, rising, compared)


def _pairs(row: NDArray[np.float64], noise: float) -> tuple[int, int]:
    """How many pairs of a row rise, and how many fall, by more than the noise; halves are sorted, so that a row may be
    a million long.
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
