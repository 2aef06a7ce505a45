"""A law of a study: what an observable does along an axis, and the sentence that claims it."""

from typing import Annotated, Any, Literal

from numpy.typing import ArrayLike
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, field_validator, model_validator

from solver.observe.observables import is_count
from solver.problem.errors import InputError, choices

from ..grammar.axes import Line, Misplaced, in_rad, is_angle, one_of, read_angles
from ..grammar.formulas import Formula, parse
from . import law_words
from .law_kinds import FORMULAS, KINDS, MONOTONE, Kind, NumberLine
from .line_verdicts import DIRECTIONS, HOLDS, QUALIFIED, TREND, Verdict, as_good, judge


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
    direction, says : {"rises", "falls", "not-falling", "not-rising"}
        Of a monotone law; says is the direction in the sentence, if `direction` is weaker.
    alternatives, also : list of str
        Of a monotone law: observables that the sentence may equally mean, so that the law is qualified if one fails;
        and further observables, judged and shown, that decide nothing.
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
    >>> law = Law(claim="(1)", observable="turns", axis="E", direction="falls", source="Stiffer rods have fewer bends.")
    >>> law.judge("turns", [8, 7, 6, 6, 5]).verdict
    'holds'
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

    @field_validator("at", mode="before")
    @classmethod
    def _angles(cls, at: Any) -> Any:
        return read_angles(at)

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

    def _check_keys(self, kind: Kind) -> None:
        """Raise `ValueError` unless the keys are those of the kind of the law."""
        said = self.rule
        every = dict.fromkeys(key for other in KINDS.values() for key in other.all_keys)
        for key in every:
            if key in said and key not in kind.all_keys:
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
    def _kind(self) -> Kind:
        return KINDS[self.kind]

    @property
    def rule(self) -> dict[str, Any]:
        """The keys of its kind that the law gives, with their values."""
        keys = dict.fromkeys(key for kind in KINDS.values() for key in kind.all_keys)
        return {key: value for key in keys if (value := getattr(self, key)) not in (None, [])}

    @property
    def does(self) -> str:
        """What the observable does, in words: ``falls``, ``is at least 0.9``."""
        return law_words.does(self.kind, self.rule)

    @property
    def counted(self) -> str:
        """What the exceptions of a verdict are."""
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
        """The verdict on one line of an observable, see `judge`; qualified if it holds only because it may stay level,
        while the sentence says that it rises or falls. count: whether an expression is a whole number."""
        if self.direction is None:
            raise InputError(f"a law of the kind {self.kind!r} has no direction")
        whole = count or is_count(name)
        verdict = judge(values, self.direction, whole, crossing)
        if verdict.verdict != HOLDS or self.meant == self.direction:
            return verdict
        meant = judge(values, self.meant, whole, crossing)
        return meant if as_good(meant.verdict, TREND) else Verdict(QUALIFIED, verdict.tau, reason=verdict.reason)

    def compare(self, line: NumberLine) -> Verdict:
        """The verdict on one line of a law of another kind than monotone."""
        assert self._kind.judge is not None
        return self._kind.judge(line, self.rule)
