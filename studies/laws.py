"""Laws and their verdicts: does an observable rise or fall along an axis, as a sentence claims?

`line_verdicts.judge` judges each line of the grid; `decide` makes the verdict on the law: that of the worst line, or of
the line nearest to its `at`. A law that does not fail is *qualified* if the numbers support only part of the sentence:

*not contradicted*: the observable stays level, which the law allows, but the sentence says that it rises or falls;
*on part of the grid*: the law is decided on one line of a grid, and another line has a worse verdict;
*depends on the observable*: one of its `alternatives` fails.
"""

from collections.abc import Mapping
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import AfterValidator, BaseModel, ConfigDict, field_validator, model_validator

from solver.observe.observables import is_count
from solver.problem.errors import InputError, choices, no_such

from . import reasons
from .axes import Line, in_rad, is_angle
from .line_verdicts import (
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
from .reasons import ON_OBSERVABLE

__all__ = [
    "DIRECTIONS", "FAILS", "HOLDS", "NOISE", "QUALIFIED", "TREND", "UNDECIDED", "VERDICTS", "Law", "Verdict",
    "by_line", "decide", "judge", "refused", "worst",
]  # fmt: skip

TOLD = ("claim", "axis", "direction", "says", "source", "fixed", "fixed_note")  # fields of a law copied to its row


def _known(direction: str) -> str:
    if direction not in DIRECTIONS:
        raise no_such("direction", direction, DIRECTIONS)
    return direction


Direction = Annotated[str, AfterValidator(_known)]


class Law(BaseModel):
    """One law of a study: the direction of an observable along an axis, and the sentence that claims it.

    claim: a short label, "(1)". direction: one of `DIRECTIONS`. says: the direction in the sentence, if `direction` is
    weaker. source: the sentence. alternatives: observables that the sentence may equally mean; if one fails, the law is
    qualified. also: further observables, judged and shown, that decide nothing. at: on a grid, values of other axes, in
    rad or as text for angles; the nearest line decides, the others are counted. fixed: whether the rule (observable,
    direction, range, line) was fixed before its outcome was known; fixed_note: which part was not, and why.
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
        if self.says is not None and DIRECTIONS[self.says].sign != DIRECTIONS[self.direction].sign:
            raise ValueError(f"says = {self.says!r} contradicts direction = {self.direction!r}")
        if self.fixed == "after" and self.fixed_note is None:
            raise ValueError(
                "fixed = 'after' needs fixed_note: which part was fixed after the outcome was known, and why"
            )
        return self

    @property
    def observables(self) -> list[str]:
        """The observable of the law, its alternatives, and the further ones, in that order."""
        return [self.observable, *self.alternatives, *self.also]

    @property
    def meant(self) -> Direction:
        """The direction in the sentence."""
        return self.says or self.direction

    def judged(self, name: str, values: ArrayLike, crossing: ArrayLike | None = None) -> Verdict:
        """The verdict on one line of an observable, see `judge`; qualified if it holds only because it may stay level,
        while the sentence says that it rises or falls."""
        verdict = judge(values, self.direction, is_count(name), crossing)
        if verdict.verdict != HOLDS or self.meant == self.direction:
            return verdict
        meant = judge(values, self.meant, is_count(name), crossing)
        return meant if as_good(meant.verdict, TREND) else Verdict(QUALIFIED, verdict.tau, reason=verdict.reason)


def decide(
    law: Law,
    observed: Mapping[str, ArrayLike],
    axes: Mapping[str, ArrayLike],
    crossing: ArrayLike | None = None,
) -> dict[str, Any]:
    """The verdict on a law, and on each further observable that it names, as plain data.

    Parameters
    ----------
    law : Law
    observed : mapping of arrays
        Each observable over the grid, one dimension an axis in the order of `axes`, NaN where unsolved.
    axes : mapping of arrays
        The values of each axis.
    crossing : array of bool, optional
        Over the grid, but one fewer along the axis of the law: the steps, in the rising order of that axis, to an
        equilibrium of another branch. Such a step is not evidence.

    Returns
    -------
    dict
        The fields `TOLD` of the law and, for the law and each entry of "also": verdict (of `VERDICTS`), qualifications
        (of `QUALIFICATIONS`), reason (a sentence: why it is qualified, not decided or fails), tau (the smallest), at
        (where it was decided, empty for the whole grid), lines, line_verdicts (verdict -> number of lines), lines_hold,
        lines_trend, steps (those that decide), exceptions (steps the wrong way: from, to, values of the axis; values;
        at: the other axes), first and last (the range of the observable at the two ends of the axis); in "also",
        alternative: whether it is an alternative of the law.

    Raises
    ------
    InputError
        If the observable or the axis is missing.
    """
    missing = [name for name in law.observables if name not in observed]
    if missing:
        raise InputError(f"the law {law.claim} needs the observable {missing[0]!r}; available: {choices(observed)}")
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


def by_line(
    law: Law, observed: ArrayLike, axes: Mapping[str, ArrayLike], crossing: ArrayLike | None = None
) -> NDArray[np.str_]:
    """The verdict on the observable of a law on each line of the grid along its axis.

    Parameters
    ----------
    law : Law
    observed : array
        The observable over the grid, one dimension an axis in the order of `axes`, NaN where unsolved.
    axes : mapping of arrays
        The values of each axis.
    crossing : array of bool, optional
        As of `decide`.

    Returns
    -------
    array of str
        Of the shape of the grid without the axis of the law: one of `VERDICTS` for each line.

    Raises
    ------
    InputError
        If the axis is missing.
    """
    if law.axis not in axes:
        raise no_such("axis", law.axis, axes)
    _, lines, cut = _lines(law, law.observable, np.asarray(observed), axes, crossing)
    words = [law.judged(law.observable, lines[where], cut[where]).verdict for where in np.ndindex(lines.shape[:-1])]
    return np.array(words).reshape(lines.shape[:-1])


def refused(law: Law, reason: str) -> dict[str, Any]:
    """The row of a law that could not be tested, in the form of `decide`: not decided, with the reason."""
    counts = {"lines": 0, "line_verdicts": {}, "lines_hold": 0, "lines_trend": 0}
    nothing = {"qualifications": [], "reason": reason, "tau": None, "at": {}, **counts, "steps": 0, "exceptions": []}
    rows = [
        {"observable": name, "verdict": UNDECIDED, **nothing, "first": None, "last": None} for name in law.observables
    ]
    return _row(law, rows)


def _row(law: Law, rows: list[dict[str, Any]]) -> dict[str, Any]:
    """The fields of the law and the verdict on its observable; the other observables under "also"."""
    equal = len(law.alternatives)
    also = [{"alternative": i < equal, **row} for i, row in enumerate(rows[1:])]
    return {**{name: getattr(law, name) for name in TOLD}, **rows[0], "also": also}


def _over_lines(
    law: Law, name: str, grid: NDArray[Any], axes: Mapping[str, ArrayLike], crossing: ArrayLike | None
) -> dict[str, Any]:
    """The verdict over the lines of the grid along the axis of the law."""
    along, lines, cut = _lines(law, name, grid, axes, crossing)
    others = {dim: np.asarray(values, dtype=float) for dim, values in axes.items() if dim != law.axis}
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


def _lines(
    law: Law, name: str, grid: NDArray[Any], axes: Mapping[str, ArrayLike], crossing: ArrayLike | None
) -> tuple[NDArray[np.float64], NDArray[Any], NDArray[np.bool_]]:
    """The axis of the law in rising order, the observable with that axis last, and the steps that cross branches."""
    dims = list(axes)
    if grid.shape != tuple(np.size(axes[dim]) for dim in dims):
        raise InputError(f"{name} has shape {grid.shape}, but its axes are {', '.join(dims)}")
    along = np.asarray(axes[law.axis], dtype=float)
    order = np.argsort(along, kind="stable")
    k = dims.index(law.axis)
    return along[order], np.moveaxis(grid, k, -1)[..., order], _cuts(crossing, grid.shape, k)


def _cuts(crossing: ArrayLike | None, shape: tuple[int, ...], k: int) -> NDArray[np.bool_]:
    """The steps that cross branches, with the axis of the law last; none by default."""
    expected = tuple(size - (i == k) for i, size in enumerate(shape))
    cut = np.zeros(expected, dtype=bool) if crossing is None else np.asarray(crossing)
    if cut.shape != expected or cut.dtype.kind != "b":
        raise InputError(
            f"crossing must be bools of shape {expected}, one for each step, got {cut.dtype} of {cut.shape}"
        )
    return np.moveaxis(cut, k, -1)


def _nearest(values: NDArray[np.float64], wanted: float) -> float:
    """The value of an axis nearest to the one wanted."""
    return values[np.abs(values - wanted).argmin()]


def _range(values: NDArray[Any]) -> list[float] | None:
    """Smallest and largest value, or None if a case is unsolved."""
    finite = np.isfinite(values.astype(float))
    return [float(values.min()), float(values.max())] if finite.all() else None
