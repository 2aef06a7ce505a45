"""The verdict on a law as a user reads it: by attribute or by key, and of several laws selected by words."""

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, SupportsIndex, overload

from solver.problem.errors import InputError, choices, near

from . import law_words
from .line_verdicts import FAILS


class LawVerdict(dict[str, Any]):
    """The verdict on a law; each of its keys (`studies.laws.judgement.decide`) is an attribute, too.

    Attributes
    ----------
    claim : str
        The label of the law, "(1)".
    law : str
        What it claims: "bends falls along E".
    verdict : str
        "true", "true as a trend", "true in part", "not decided" or "false".
    measured : str
        What was measured: "8 → 5", of a direction the values at the two ends of the axis.
    where : str
        Where the law was judged, and where it is false: "at R = 0.75; false from E = 10000 to 15000"; "everywhere".
    reason : str
        Why it is true in part, not decided or false; of a false law without another reason, what was measured.

    Examples
    --------
    >>> from studies import load
    >>> law = load("fig7_1_modulus").run().verdicts["(1)"]
    >>> law.law, law.verdict, law.measured, law.where
    ('bends falls along E', 'true', '8 → 5', 'everywhere')
    """

    claim: str
    law: str
    verdict: str
    measured: str
    where: str
    reason: str
    kind: str
    axis: str
    direction: str | None
    says: str
    does: str
    rule: dict[str, Any]
    source: str
    fixed: str
    fixed_note: str
    observable: str
    qualifications: list[str]
    tau: float | None
    at: dict[str, float]
    lines: int
    line_verdicts: dict[str, int]
    lines_hold: int
    lines_trend: int
    steps: int
    exceptions: list[dict[str, Any]]
    first: list[float] | None
    last: list[float] | None
    found: str
    numbers: dict[str, float | None]
    counted: str
    across: list[str]
    also: list[dict[str, Any]]

    def __init__(self, row: Mapping[str, Any]) -> None:
        measured, where = law_words.measure(row), law_words.where(row)
        first = {"claim": row["claim"], "law": law_words.law_in_words(row), "verdict": row["verdict"]}
        reason = row["reason"] or (law_words.detail(row) or measured) * (row["verdict"] == FAILS)
        super().__init__({**row, **first, "measured": measured, "where": where, "reason": reason})

    if not TYPE_CHECKING:  # which knows the attributes above, and no others

        def __getattr__(self, name: str) -> Any:
            try:
                return self[name]
            except KeyError:
                raise AttributeError(f"a verdict has no {name!r}{near(name, self)}; it has {choices(self)}") from None

    def __dir__(self) -> list[str]:
        return [*self, *dict.__dir__(self)]

    def __repr__(self) -> str:
        return f"{self.claim} {self.law}: {law_words.sentence(self)}; measured {self.measured}"


class LawVerdicts(list[LawVerdict]):
    """The verdicts on the laws of a study, in its order; a text selects one by its claim, or by words of the law."""

    def __init__(self, rows: Iterable[Mapping[str, Any]] = ()) -> None:
        super().__init__(row if isinstance(row, LawVerdict) else LawVerdict(row) for row in rows)

    @overload
    def __getitem__(self, key: SupportsIndex | str) -> LawVerdict: ...

    @overload
    def __getitem__(self, key: slice) -> list[LawVerdict]: ...

    def __getitem__(self, key: Any) -> Any:
        """The i-th verdict; or the one of these words. Raises `InputError` unless the words are those of one law."""
        if not isinstance(key, str):
            return super().__getitem__(key)
        selected = [row for row in self if row.claim == key] or [row for row in self if _has(row, key)]
        if len(selected) == 1:
            return selected[0]
        listed = "; ".join(f"{row.claim} {row.law}" for row in selected or self) or "none"
        many = f"{len(selected)} laws are" if selected else "no law is"
        raise InputError(f"{many} {key!r}; {'choose one' if selected else 'there are'}: {listed}")

    def __repr__(self) -> str:
        return "\n".join(map(repr, self))


def _has(row: LawVerdict, words: str) -> bool:
    """Whether a law has all these words, in its claim, in what it says, or in its source."""
    said = f"{row.claim} {row.law} {row.source}".lower()
    return bool(words.strip()) and all(word in said for word in words.lower().split())
