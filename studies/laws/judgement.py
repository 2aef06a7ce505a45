"""A law of a study, and the verdict on it: does an observable do along an axis what a sentence claims?

The `KINDS` of `law_kinds` judge each line of the grid, by its direction or by numbers; `decide` makes the verdict
on the law: that of the worst line, or of the line nearest to its `at`. A law that is not false is *true in part* if the
numbers support only part of the sentence:

*not contradicted*: the observable stays level, which the law allows, but the sentence says that it rises or falls;
*on part of the grid*: the law is decided on one line of a grid, and another line has a worse verdict;
*depends on the observable*: one of its `alternatives` fails.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, field_validator, model_validator

from solver.observe.observables import is_count
from solver.problem.errors import InputError, choices

from ..grammar.axes import Line, Misplaced, in_rad, is_angle, one_of, read_units
from ..grammar.formulas import FORMULAS, Formula, evaluate, parse
from . import law_words
from .case_rows import CaseRow, Grid
from .law_kinds import KINDS, MONOTONE, STEPS, LawKind, as_given
from .law_verdict import LawVerdict
from .law_words import ON_OBSERVABLE
from .line_verdicts import DIRECTIONS, FAILS, HOLDS, QUALIFIED, TREND, UNDECIDED, VERDICTS, Verdict, as_good, line_of


def _read(value: float | str) -> float | str:
    """A number, or a text that is a formula."""
    if isinstance(value, str):
        parse(value)
    return value


Direction = Annotated[str, one_of("direction", DIRECTIONS)]
Number = Annotated[float | str, AfterValidator(_read)]


class Law(BaseModel):
    """One law of a study: what an observable does along an axis, and the sentence that claims it.

    Numbers are in the units of the study; formula, least, most, passes and x may be formulas.

    Parameters
    ----------
    claim : str
        A short label, "(1)".
    kind : {"monotone", "equals", "bounded", "scales", "boundary"}
        Each kind has its own keys, below.
    observable, axis : str
        What the law is about, and the axis along which it changes.
    source : str
        The sentence that the law comes from.
    at : dict
        On a grid, values of other axes, in rad or as text for angles; the nearest line decides, the others are counted.
    fixed : {"in advance", "after"}, optional
        Whether the rule (observable, kind, numbers, range, line) was fixed before its outcome was known.
    fixed_note : str, optional
        Which part was not, and why.
    turned_back : bool
        Whether values of rods that turn back against both their ends enter; default: they do not.
    direction, says : {"rises", "falls", "not-falling", "not-rising"}
        Of a monotone law; says is the direction in the sentence, if `direction` is weaker.
    alternatives, also : list of str
        Of a monotone law: observables that the sentence may equally mean, so that the law is true in part if one is
        false; and further observables, judged and shown, that decide nothing.
    formula, relative, absolute : float or str
        Of the kind equals: the formula, and the allowed difference.
    least, most : float or str
        Of the kind bounded.
    exponent, within : float
        Of the kind scales.
    passes, x, within : float or str
        Of the kind boundary: the critical value of the observable, where on the axis, and how near.

    Examples
    --------
    >>> from studies import Law
    >>> law = Law(claim="(1)", observable="bends", axis="E", direction="falls", source="Stiffer rods have fewer bends.")
    >>> law.judge("bends", [8, 7, 6, 6, 5]).verdict
    'true'
    """

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)

    claim: Line
    kind: Annotated[str, one_of("kind of law", KINDS)] = MONOTONE
    observable: str
    axis: str
    direction: Direction | None = None
    says: Direction | None = None
    formula: Number | None = None
    relative: float | None = Field(None, gt=0)
    absolute: float | None = Field(None, gt=0)
    least: Number | None = None
    most: Number | None = None
    exponent: float | None = None
    passes: Number | None = None
    x: Number | None = None
    within: float | None = Field(None, gt=0)
    source: Line
    alternatives: list[str] = []
    also: list[str] = []
    at: dict[str, float] = {}
    fixed: Literal["in advance", "after"] | None = None
    fixed_note: Line | None = None
    turned_back: bool = False

    @field_validator("at", mode="before")
    @classmethod
    def _angles(cls, at: Any) -> Any:
        return read_units(at, None)

    @model_validator(mode="before")
    @classmethod
    def _angle_on_axis(cls, law: Any) -> Any:
        """A place on an axis of angles given as text in rad; other texts are formulas."""
        if not isinstance(law, dict) or not isinstance(law.get("x"), str) or not is_angle(str(law.get("axis"))):
            return law
        try:
            return {**law, "x": in_rad(law["x"])}
        except ValueError:
            return law

    @model_validator(mode="after")
    def _fits(self) -> "Law":
        self._check_keys(self._kind)
        if self.says is not None and DIRECTIONS[self.says].sign != DIRECTIONS[self.direction or ""].sign:
            raise ValueError(f"says = {self.says!r} contradicts direction = {self.direction!r}")
        if self.fixed == "after" and self.fixed_note is None:
            raise ValueError(
                "fixed = 'after' needs fixed_note: which part was fixed after the outcome was known, and why"
            )
        return self

    def _check_keys(self, kind: LawKind) -> None:
        """Raise `ValueError` unless the keys are those of the kind of the law."""
        said = self.rule
        for key in said:
            if key not in kind.all_keys:
                its = f"its keys are {choices(kind.all_keys)}" if kind.all_keys else "it needs none"
                raise Misplaced(f"a law of the kind {self.kind!r} has no key {key!r}; {its}", key)
        missing = [key for key in kind.needs if key not in said]
        if missing:
            raise ValueError(f"a law of the kind {self.kind!r} needs the key {missing[0]!r}")
        chosen = [key for key in kind.one_of if key in said]
        if kind.one_of and (not chosen or (kind.exclusive and len(chosen) > 1)):
            how = "exactly one" if kind.exclusive else "at least one"
            raise ValueError(f"a law of the kind {self.kind!r} needs {how} of the keys {choices(kind.one_of)}")

    @property
    def _kind(self) -> LawKind:
        return KINDS[self.kind]

    @property
    def rule(self) -> dict[str, Any]:
        """The keys of its kind that the law gives, with their values."""
        keys = dict.fromkeys(key for kind in KINDS.values() for key in kind.all_keys)
        return {key: value for key in keys if (value := getattr(self, key)) not in (None, [])}

    @property
    def does(self) -> str:
        """What the observable does, in words: ``falls``, ``is at least 0.9``."""
        return self._kind.does(self.rule, as_given)

    @property
    def exception_words(self) -> str:
        """What the exceptions of a verdict are, in words behind their number."""
        if self.relative is not None:
            return f"cases miss the {100 * self.relative:g} %"
        if self.absolute is not None:
            return f"cases miss it by more than {self.absolute:g}"
        return self._kind.exceptions

    @property
    def formulas(self) -> dict[str, Formula]:
        """The formulas of the law by key."""
        return {key: parse(value) for key in FORMULAS if isinstance(value := getattr(self, key), str)}

    @property
    def numbers(self) -> dict[str, float]:
        """The numbers in place of formulas, by key."""
        return {key: value for key in FORMULAS if isinstance(value := getattr(self, key), int | float)}

    @property
    def observables(self) -> list[str]:
        """The observable of the law, its alternatives, and the further ones, in that order."""
        return [self.observable, *self.alternatives, *self.also]

    @property
    def meant(self) -> str:
        """The direction in the sentence; of a kind without direction "" ."""
        return self.says or self.direction or ""

    def judge(self, name: str, values: ArrayLike, crossing: ArrayLike | None = None, count: bool = False) -> Verdict:
        """The verdict on one line of an observable, see `line_verdicts.judge` and `keeps_direction`. count: whether an
        expression is a whole number."""
        if self.direction is None:
            raise InputError(f"a law of the kind {self.kind!r} has no direction")
        return self._kind.judge(line_of(values, count or is_count(name), crossing), self.rule)


# fields of a law copied to its row
TOLD = ("claim", "kind", "axis", "direction", "says", "does", "rule", "source", "fixed", "fixed_note")


def decide(law: Law, observed: Mapping[str, ArrayLike], grid: Grid) -> LawVerdict:
    """The verdict on a law, and on each further observable that it names, as plain data.

    Parameters
    ----------
    law : Law
    observed : mapping of arrays
        Each observable over the grid, NaN where unsolved.
    grid : Grid

    Returns
    -------
    LawVerdict
        A mapping: law, measured and where (in words), the fields `TOLD` of the law and, for the law and each entry of
        "also": verdict (of `VERDICTS`), qualifications (of `QUALIFICATIONS`), reason (a sentence: why it is true in
        part, not decided or false), tau (the smallest), at (where it was decided, empty for the whole grid), lines,
        line_verdicts (verdict -> number of lines), lines_hold, lines_trend, steps (those that decide), exceptions
        (steps the wrong way: from, to, values of the axis; values; at: the other axes; for a case that disagrees, from
        and to are equal), first and last (the range of the observable at the two ends of the axis), found and numbers
        (what was measured, in words and by name; empty for a direction), counted (what the exceptions are), across (the
        other axes); in "also", alternative: whether it is an alternative of the law.

    Raises
    ------
    InputError
        If the observable or the axis is missing.
    """
    missing = [name for name in law.observables if name not in observed]
    if missing:
        raise InputError(f"the law {law.claim} needs the observable {missing[0]!r}; available: {choices(observed)}")
    verdicts = [
        {"observable": name, **_over_lines(law, name, np.asarray(observed[name]), grid)} for name in law.observables
    ]
    row = _row(law, verdicts)
    others = [also for also in row["also"] if also["alternative"] and also["verdict"] == FAILS]
    if others and as_good(row["verdict"], QUALIFIED):
        row["verdict"] = QUALIFIED
        row["qualifications"] = [*row["qualifications"], ON_OBSERVABLE]
        row["reason"] = law_words.join([row["reason"], law_words.of_others(row, law.meant, others)])
    return LawVerdict(row)


def by_line(law: Law, observed: ArrayLike, grid: Grid) -> NDArray[np.str_]:
    """The verdict on the observable of a law on each line of the grid along its axis.

    Parameters
    ----------
    law : Law
    observed : array
        The observable over the grid, NaN where unsolved.
    grid : Grid

    Returns
    -------
    array of str
        Of the shape of the grid without the axis of the law: one of `VERDICTS` for each line.

    Raises
    ------
    InputError
        If the axis is missing.
    """
    judge = _judge(law, law.observable, np.asarray(observed), grid)
    words = [judge(row).verdict for row in grid.rows_along(law.axis)]
    return np.array(words).reshape([np.size(values) for dim, values in grid.axes.items() if dim != law.axis])


def refusal(law: Law, reason: str) -> LawVerdict:
    """The row of a law that could not be tested, in the form of `decide`: not decided, with the reason."""
    counts = {"lines": 0, "line_verdicts": {}, "lines_hold": 0, "lines_trend": 0, "across": []}
    nothing = {"qualifications": [], "reason": reason, "tau": None, "at": {}, **counts, "steps": 0, "exceptions": []}
    nothing |= {"found": "", "numbers": {}, "counted": law.exception_words}
    rows = [
        {"observable": name, "verdict": UNDECIDED, **nothing, "first": None, "last": None} for name in law.observables
    ]
    return LawVerdict(_row(law, rows))


def _row(law: Law, rows: list[dict[str, Any]]) -> dict[str, Any]:
    """The fields of the law and the verdict on its observable; the other observables under "also"."""
    equal = len(law.alternatives)
    also = [{"alternative": i < equal, **row} for i, row in enumerate(rows[1:])]
    return {**{name: getattr(law, name) for name in TOLD}, **rows[0], "also": also}


def targets(law: Law, shape: tuple[int, ...], known: Mapping[str, ArrayLike]) -> dict[str, tuple[Any, Any]]:
    """The numbers with which a law compares its observable: key -> values over the grid, and why any has none.

    known: as of `Grid`. Raises `InputError` for a name that is missing.
    """
    numbers = {key: (np.full(shape, float(value)), np.full(shape, "")) for key, value in law.numbers.items()}
    for key, formula in law.formulas.items():
        missing = [name for name in formula.names if name not in known]
        if missing:
            raise InputError(f"the law {law.claim} needs the number {missing[0]!r}; available: {choices(known)}")
        values, why = evaluate(formula, known)
        numbers[key] = np.broadcast_to(values, shape), np.broadcast_to(why, shape)
    return numbers


def _over_lines(law: Law, name: str, values: NDArray[Any], grid: Grid) -> dict[str, Any]:
    """The verdict over the lines of cases along the axis of the law."""
    rows, judge = grid.rows_along(law.axis), _judge(law, name, values, grid)
    whole = [row.at for row in rows if row.has_case.all()]
    at = {
        dim: float(_nearest(np.array([place[dim] for place in whole]), value))
        for dim, value in law.at.items()
        if dim in grid.axes and dim != law.axis
    }
    every, deciding, exceptions, ends, steps = [], [], [], list[NDArray[Any]](), 0
    for row in rows:
        line, verdict, is_whole = row.take(values.reshape(-1)), judge(row), row.has_case.all()
        if not (is_whole or verdict.exceptions or verdict.verdict == FAILS):
            continue
        every.append(verdict.verdict)
        if any(row.at[dim] != value for dim, value in at.items()):
            continue
        deciding.append(verdict)
        ends += [line[[0, -1]]] * bool(is_whole)
        steps += int(row.has_case.sum()) - (law.exception_words == STEPS)
        exceptions += [
            {"from": float(row.along[i]), "to": float(row.along[j]), "values": line[[i, j]].tolist(), "at": row.at}
            for i, j in verdict.exceptions
        ]
    across = [dim for dim in grid.axes if dim != law.axis]
    return _tell(law, name, every, deciding, at, across, ends) | {
        "counted": law.exception_words,
        "across": across,
        "steps": steps,
        "exceptions": exceptions,
    }


def _judge(law: Law, name: str, values: NDArray[Any], grid: Grid) -> Callable[[CaseRow], Verdict]:
    """What says the verdict on a line of cases."""
    if grid.rows is None and values.shape != grid.shape:
        raise InputError(f"{name} has shape {values.shape}, but its axes are {', '.join(grid.axes)}")
    compared = {
        key: (at.reshape(-1), why.reshape(-1)) for key, (at, why) in targets(law, values.shape, grid.known).items()
    }
    undefined = np.broadcast_to(grid.known.get("solved", False), values.shape).reshape(-1) & ~np.isfinite(
        values.reshape(-1)
    )
    count, rule, kind, flat = name in grid.counts or is_count(name), law.rule, KINDS[law.kind], values.reshape(-1)

    def judge(row: CaseRow) -> Verdict:
        mine = {key: row.take(at) for key, (at, _) in compared.items()}
        texts = (text for _, texts in compared.values() for text in texts[row.cases[row.has_case]].tolist() if text)
        line = line_of(
            row.take(flat),
            count,
            row.cut,
            axis=law.axis,
            along=row.along,
            targets=mine,
            why="; ".join(dict.fromkeys(texts)),
            added=row.added,
            undefined=row.take(undefined).astype(bool) & row.has_case,
        )
        verdict = kind.judge(line, rule)
        return verdict if row.has_case.all() else replace(verdict, reason=law_words.BETWEEN)

    return judge


def _tell(
    law: Law,
    name: str,
    every: list[str],
    deciding: list[Verdict],
    at: Mapping[str, float],
    across: list[str],
    ends: list[NDArray[Any]],
) -> dict[str, Any]:
    """The verdict of the lines that decide, the numbers of lines, and what was measured on the worst of them."""
    taus = [verdict.tau for verdict in deciding if verdict.tau is not None]
    shown = max(deciding, key=lambda verdict: (VERDICTS.index(verdict.verdict), verdict.far))
    first, last = np.array(ends).T
    return {
        **law_words.together(name, law.meant, deciding, every, at, across, _range(first)),
        "tau": min(taus) if taus else None,
        "at": dict(at),
        "lines": len(every),
        "line_verdicts": {verdict: every.count(verdict) for verdict in VERDICTS if verdict in every},
        "lines_hold": every.count(HOLDS),
        "lines_trend": every.count(TREND),
        "first": _range(first),
        "last": _range(last),
        "found": shown.found,
        "numbers": {key: value if np.isfinite(value) else None for key, value in shown.numbers.items()},
    }


def _nearest(values: NDArray[np.float64], value: float) -> float:
    """The value of an axis nearest to the one wanted."""
    return values[np.abs(values - value).argmin()]


def _range(values: NDArray[Any]) -> list[float] | None:
    """Smallest and largest value, or None if a case is unsolved."""
    finite = np.isfinite(values.astype(float))
    return [float(values.min()), float(values.max())] if finite.all() else None
