"""Laws and their verdicts: does an observable rise or fall along an axis, as a sentence says it must?

A law is judged line by line (`studies.verdicts`), and its verdict is that of the worst line, or of the line that its
`at` names. Where that verdict does not fail, the law is *qualified* all the same if the numbers do not say all of what
the sentence says:

*not contradicted*: the law allows the observable to stand still, it does, and the sentence says that it rises or falls;
*on part of the grid*: the law is decided on one line of a grid, and another line is not as good;
*depends on the observable*: an observable that the law names as equally plausible fails.
"""

from collections.abc import Mapping
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BaseModel, ConfigDict, field_validator, model_validator

from solver.problem.errors import InputError, choices, no_such

from . import reasons
from .axes import Line, in_rad, is_angle
from .reasons import ON_OBSERVABLE
from .verdicts import (
    DIRECTIONS,
    FAILS,
    HOLDS,
    NOISE,
    QUALIFIED,
    TREND,
    UNDECIDED,
    VERDICTS,
    Verdict,
    as_good,
    judge,
    worst,
)

__all__ = [
    "COUNTS", "DIRECTIONS", "FAILS", "HOLDS", "NOISE", "QUALIFIED", "TREND", "UNDECIDED", "VERDICTS", "Law", "Verdict",
    "decide", "judge", "refused", "worst",
]  # fmt: skip

COUNTS = frozenset({"turns", "loops", "overlaps", "index"})  # observables that are whole numbers
TOLD = ("claim", "axis", "direction", "says", "source", "fixed", "fixed_note")  # fields of a law that its row repeats

Direction = Literal["rises", "falls", "not-falling", "not-rising"]


class Law(BaseModel):
    """One law of a study: how an observable goes along an axis, and the sentence that says so.

    claim: a short label, "(1)". says: the direction that the sentence itself gives, where `direction` asks for less.
    alternatives: observables that the sentence may mean as well as the law's own; one that fails qualifies the law.
    also: further observables, judged and shown, that decide nothing. at: on a grid, values of other axes; the line
    nearest to them decides, the others are counted. Angles in rad, or as text. fixed: whether the rule (observable,
    direction, range, line) was fixed before its outcome was known; fixed_note: what of it was not, and why.
    """

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)

    claim: Line
    observable: str
    axis: str
    direction: Direction
    says: Direction | None = None
    source: Line
    alternatives: list[str] = []
    also: list[str] = []
    at: dict[str, float] = {}
    fixed: Literal["in advance", "after"] | None = None
    fixed_note: Line | None = None

    @field_validator("at", mode="before")
    @classmethod
    def _angles(cls, at: Any) -> Any:
        return {k: in_rad(v) if is_angle(str(k)) else v for k, v in at.items()} if isinstance(at, dict) else at

    @model_validator(mode="after")
    def _fits(self) -> "Law":
        if self.says is not None and DIRECTIONS[self.says][0] != DIRECTIONS[self.direction][0]:
            raise ValueError(f"says = {self.says!r} is the other way than direction = {self.direction!r}")
        if self.fixed == "after" and self.fixed_note is None:
            raise ValueError("fixed = 'after' needs fixed_note: what was fixed after the outcome was known, and why")
        return self

    @property
    def observables(self) -> list[str]:
        """The law's observable, then its alternatives, then the others it admits."""
        return [self.observable, *self.alternatives, *self.also]

    @property
    def meant(self) -> Direction:
        """The direction that the sentence gives."""
        return self.says or self.direction

    def judged(self, name: str, values: ArrayLike, crossing: ArrayLike | None = None) -> Verdict:
        """The verdict on one line of an observable, as of `judge`; qualified where it holds only because it may stand
        still, while the sentence says that it rises or falls."""
        verdict = judge(values, self.direction, name in COUNTS, crossing)
        if verdict.verdict != HOLDS or self.meant == self.direction:
            return verdict
        meant = judge(values, self.meant, name in COUNTS, crossing)
        return meant if as_good(meant.verdict, TREND) else Verdict(QUALIFIED, verdict.tau, reason=verdict.reason)


def decide(
    law: Law,
    observed: Mapping[str, ArrayLike],
    axes: Mapping[str, ArrayLike],
    crossing: ArrayLike | None = None,
) -> dict[str, Any]:
    """The law's verdict and those of the other observables it names, as plain data.

    observed: name -> array over the grid, one dimension an axis, in the order of `axes`, NaN where unsolved;
    axes: name -> values. crossing: bools over the grid, but one fewer along the law's axis: the steps, in the rising
    order of that axis, from an equilibrium of one branch to one of another; they are never evidence.

    Returns the law's own fields (`TOLD`) and, for it and each entry of "also": verdict (of `VERDICTS`), qualifications
    (of `QUALIFICATIONS`), reason (a sentence: why it is qualified, not decided or fails), tau (the smallest), at
    (where it was decided, empty for everywhere), lines, line_verdicts (verdict -> how many of all lines), lines_hold,
    lines_trend, steps (how many decide), exceptions (those the wrong way: from, to, values of the axis; values; at: the
    other axes), first and last (the range of the observable at the two ends of the axis); in "also", alternative:
    whether it is one of the law's. Raises `InputError` where the observable or the axis is missing.
    """
    missing = [name for name in law.observables if name not in observed]
    if missing:
        raise InputError(f"the law {law.claim} needs {missing[0]!r}; there are {choices(observed)}")
    if law.axis not in axes:
        raise no_such("axis", law.axis, axes)
    rows = [
        {"observable": name, **_over_lines(law, name, np.asarray(observed[name]), axes, crossing)}
        for name in law.observables
    ]
    row = _row(law, rows)
    others = [also for also in row["also"] if also["alternative"] and also["verdict"] == FAILS]
    if others and as_good(row["verdict"], QUALIFIED):
        row["verdict"] = QUALIFIED
        row["qualifications"] = [*row["qualifications"], ON_OBSERVABLE]
        row["reason"] = reasons.joined([row["reason"], reasons.of_others(row, law.meant, others)])
    return row


def refused(law: Law, reason: str) -> dict[str, Any]:
    """The row of a law that could not be put to the test, as `decide` gives it: not decided, for a reason."""
    counts = {"lines": 0, "line_verdicts": {}, "lines_hold": 0, "lines_trend": 0}
    nothing = {"qualifications": [], "reason": reason, "tau": None, "at": {}, **counts, "steps": 0, "exceptions": []}
    rows = [
        {"observable": name, "verdict": UNDECIDED, **nothing, "first": None, "last": None} for name in law.observables
    ]
    return _row(law, rows)


def _row(law: Law, rows: list[dict[str, Any]]) -> dict[str, Any]:
    """The law's own fields, its own observable's verdict, and those of the others below."""
    equal = len(law.alternatives)
    also = [{"alternative": i < equal, **row} for i, row in enumerate(rows[1:])]
    return {**{name: getattr(law, name) for name in TOLD}, **rows[0], "also": also}


def _over_lines(
    law: Law, name: str, grid: NDArray[Any], axes: Mapping[str, ArrayLike], crossing: ArrayLike | None
) -> dict[str, Any]:
    """The verdict over the lines of the grid along the law's axis."""
    dims = list(axes)
    if grid.shape != tuple(np.size(axes[dim]) for dim in dims):
        raise InputError(f"{name} has shape {grid.shape}, but its axes are {', '.join(dims)}")
    along = np.asarray(axes[law.axis], dtype=float)
    order = np.argsort(along, kind="stable")
    along = along[order]
    lines = np.moveaxis(grid, dims.index(law.axis), -1)[..., order]
    cut = _cuts(crossing, grid.shape, dims.index(law.axis))
    others = {dim: np.asarray(axes[dim], dtype=float) for dim in dims if dim != law.axis}
    at = {dim: float(_nearest(values, law.at[dim])) for dim, values in others.items() if dim in law.at}
    every, deciding, exceptions, ends = [], [], [], []
    for where in np.ndindex(lines.shape[:-1]):
        line = lines[where]
        verdict = law.judged(name, line, cut[where])
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
        **reasons.together(name, law.meant, deciding, every, at, _range(first)),
        "tau": min(taus) if taus else None,
        "at": at,
        "lines": len(every),
        "line_verdicts": {verdict: every.count(verdict) for verdict in VERDICTS if verdict in every},
        "lines_hold": every.count(HOLDS),
        "lines_trend": every.count(TREND),
        "steps": len(deciding) * (along.size - 1),
        "exceptions": exceptions,
        "first": _range(first),
        "last": _range(last),
    }


def _cuts(crossing: ArrayLike | None, shape: tuple[int, ...], k: int) -> NDArray[np.bool_]:
    """The steps that cross branches, the law's axis last; none where none is given."""
    expected = tuple(size - (i == k) for i, size in enumerate(shape))
    cut = np.zeros(expected, dtype=bool) if crossing is None else np.asarray(crossing)
    if cut.shape != expected or cut.dtype.kind != "b":
        raise InputError(f"crossing is bools of shape {expected}, one for each step, got {cut.dtype} of {cut.shape}")
    return np.moveaxis(cut, k, -1)


def _nearest(values: NDArray[np.float64], wanted: float) -> float:
    return values[np.abs(values - wanted).argmin()]


def _range(values: NDArray[Any]) -> list[float] | None:
    """Smallest and largest, or None where a case is unsolved."""
    finite = np.isfinite(values.astype(float))
    return [float(values.min()), float(values.max())] if finite.all() else None
