"""Laws and their verdicts: does an observable rise or fall along an axis, as a sentence says it must?

*holds*: every step goes the right way; a count may stay the same between neighbours but must change over the
whole axis. *holds as a trend*: Kendall's tau in the direction is at least 0.8; the steps that go the wrong
way are listed. *fails*: neither, or a case is unsolved.

Tau is tau-b: right less wrong pairs over sqrt(all pairs x pairs whose values differ), so a count that pauses
loses a little.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BaseModel, ConfigDict, field_validator

from solver.errors import InputError, choices, no_such

from .axes import Line, in_rad, is_angle

HOLDS, TREND, FAILS = "holds", "holds as a trend", "fails"
VERDICTS = (HOLDS, TREND, FAILS)  # best first

# direction -> (sign of a right step, whether standing still is allowed)
DIRECTIONS = {"rises": (1, False), "falls": (-1, False), "not-falling": (1, True), "not-rising": (-1, True)}

COUNTS = frozenset({"turns", "loops", "overlaps", "index"})  # observables that are whole numbers

TREND_TAU = 0.8
FEW = 256  # values whose pairs are all looked at
NOISE = 1e-9  # of the largest value; a smaller step is none, as the solver's own tolerance is 1e-8


class Law(BaseModel):
    """One law of a study: how an observable goes along an axis, and the sentence that says so.

    claim: a short label, "(1)". also: further observables that the sentence admits, judged in its direction.
    at: on a grid, values of other axes; the line nearest to them decides, the others are counted. Angles in
    rad, or as text.
    """

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)

    claim: Line
    observable: str
    axis: str
    direction: Literal["rises", "falls", "not-falling", "not-rising"]
    source: Line
    also: list[str] = []
    at: dict[str, float] = {}

    @field_validator("at", mode="before")
    @classmethod
    def _angles(cls, at: Any) -> Any:
        return {k: in_rad(v) if is_angle(str(k)) else v for k, v in at.items()} if isinstance(at, dict) else at

    @property
    def observables(self) -> list[str]:
        """The law's observable, then the others it admits."""
        return [self.observable, *self.also]


@dataclass(frozen=True)
class Verdict:
    """holds, holds as a trend, or fails; tau in the law's direction, None where nothing varies.

    exceptions: the steps (i, i + 1) that go the wrong way. reason: why it fails, where it is not the trend; or that a
    law which allows it holds because nothing changes.
    """

    verdict: str
    tau: float | None = None
    exceptions: list[tuple[int, int]] = field(default_factory=list)
    reason: str = ""


def judge(values: ArrayLike, direction: str, count: bool | None = None) -> Verdict:
    """The verdict on values along an axis, in the axis's rising order.

    count: whether the values are a count, which may stay the same between neighbours; by default, whether
    they are integers. Raises `InputError` for an unknown direction or values that are not one row of numbers.
    """
    if direction not in DIRECTIONS:
        raise no_such("direction", direction, DIRECTIONS)
    given = np.asarray(values)
    if given.ndim != 1 or given.size == 0 or given.dtype.kind not in "iufb":
        raise InputError(f"a law judges one row of numbers, got an array of shape {given.shape}")
    row = given.astype(float)
    unsolved = int(np.count_nonzero(~np.isfinite(row)))
    if unsolved:
        return Verdict(FAILS, reason=f"{unsolved} of {row.size} cases unsolved")
    sign, may_stand = DIRECTIONS[direction]
    noise = NOISE * float(np.abs(row).max())
    pausing = may_stand or (given.dtype.kind in "iub" if count is None else count)
    steps = sign * np.diff(row)
    wrong = steps < -noise if pausing else steps <= noise
    exceptions = [(int(i), int(i) + 1) for i in np.flatnonzero(wrong)]
    changed = may_stand or sign * (row[-1] - row[0]) > noise
    tau = _tau(row, sign, noise)
    level = "" if np.ptp(row) > noise else "it does not change"
    if not exceptions and changed:
        return Verdict(HOLDS, tau, reason=level)
    if tau is not None and tau >= TREND_TAU:
        return Verdict(TREND, tau, exceptions)
    return Verdict(FAILS, tau, exceptions, level)


def _tau(row: NDArray[np.float64], sign: int, noise: float) -> float | None:
    """Kendall's tau-b of a row against its order, times the sign; differences within the noise are ties."""
    rising, falling = _pairs(row, noise)
    if rising + falling == 0:
        return None
    pairs = row.size * (row.size - 1) // 2
    return float(sign * (rising - falling) / np.sqrt(float(pairs) * (rising + falling)))


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


def worst(verdicts: Sequence[str]) -> str:
    """The worst of some verdicts."""
    return max(verdicts, key=VERDICTS.index)


def decide(law: Law, observed: Mapping[str, ArrayLike], axes: Mapping[str, ArrayLike]) -> dict[str, Any]:
    """The law's verdict and those of the other observables it admits, as plain data.

    observed: name -> array over the grid, one dimension an axis, in the order of `axes`, NaN where unsolved;
    axes: name -> values. On a grid of several axes every line along the law's axis is judged; the worst
    verdict is the law's, or that of the line that the law's `at` names.

    Returns the law's own fields and, for it and each entry of "also": verdict, tau (the smallest), at (where
    it was decided, empty for everywhere), lines, lines_hold, lines_trend (of all lines), exceptions (from,
    to: values of the axis; values; at: the other axes), reason, first and last (the range of the observable
    at the two ends of the axis). Raises `InputError` where the observable or the axis is missing.
    """
    missing = [name for name in law.observables if name not in observed]
    if missing:
        raise InputError(f"the law {law.claim} needs {missing[0]!r}; there are {choices(observed)}")
    if law.axis not in axes:
        raise no_such("axis", law.axis, axes)
    rows = [
        {"observable": name, **_over_lines(law, name, np.asarray(observed[name]), axes)} for name in law.observables
    ]
    told = {name: getattr(law, name) for name in ("claim", "axis", "direction", "source")}
    return {**told, **rows[0], "also": rows[1:]}


def refused(law: Law, reason: str) -> dict[str, Any]:
    """The row of a law that could not be put to the test, as `decide` gives it: it fails, for a reason."""
    nothing = {"lines": 0, "lines_hold": 0, "lines_trend": 0, "exceptions": [], "first": None, "last": None}
    rows = [
        {"observable": name, "verdict": FAILS, "tau": None, "at": {}, **nothing, "reason": reason}
        for name in law.observables
    ]
    return {**_told(law), **rows[0], "also": rows[1:]}


def _told(law: Law) -> dict[str, Any]:
    return {name: getattr(law, name) for name in ("claim", "axis", "direction", "source")}


def _over_lines(law: Law, name: str, grid: NDArray[Any], axes: Mapping[str, ArrayLike]) -> dict[str, Any]:
    """The verdict over the lines of the grid along the law's axis."""
    dims = list(axes)
    if grid.shape != tuple(np.size(axes[dim]) for dim in dims):
        raise InputError(f"{name} has shape {grid.shape}, but its axes are {', '.join(dims)}")
    along = np.asarray(axes[law.axis], dtype=float)
    order = np.argsort(along, kind="stable")
    along = along[order]
    lines = np.moveaxis(grid, dims.index(law.axis), -1)[..., order]
    others = {dim: np.asarray(axes[dim], dtype=float) for dim in dims if dim != law.axis}
    at = {dim: float(_nearest(values, law.at[dim])) for dim, values in others.items() if dim in law.at}
    every, deciding, exceptions, ends = [], [], [], []
    for where in np.ndindex(lines.shape[:-1]):
        line = lines[where]
        verdict = judge(line, law.direction, count=name in COUNTS)
        every.append(verdict.verdict)
        here = {dim: float(values[i]) for (dim, values), i in zip(others.items(), where, strict=True)}
        if any(here[dim] != value for dim, value in at.items()):
            continue
        deciding.append(verdict)
        ends.append(line[[0, -1]])
        exceptions += [
            {"from": float(along[i]), "to": float(along[j]), "values": line[[i, j]].tolist(), "at": here}
            for i, j in verdict.exceptions
        ]
    taus = [verdict.tau for verdict in deciding if verdict.tau is not None]
    first, last = np.array(ends).T
    return {
        "verdict": worst([verdict.verdict for verdict in deciding]),
        "tau": min(taus) if taus else None,
        "at": at,
        "lines": len(every),
        "lines_hold": every.count(HOLDS),
        "lines_trend": every.count(TREND),
        "exceptions": exceptions,
        "reason": "; ".join(sorted({verdict.reason for verdict in deciding if verdict.reason})),
        "first": _range(first),
        "last": _range(last),
    }


def _nearest(values: NDArray[np.float64], wanted: float) -> float:
    return values[np.abs(values - wanted).argmin()]


def _range(values: NDArray[Any]) -> list[float] | None:
    """Smallest and largest, or None where a case is unsolved."""
    finite = np.isfinite(values.astype(float))
    return [float(values.min()), float(values.max())] if finite.all() else None
