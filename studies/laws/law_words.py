"""The sentences about a law: what it claims, its verdict, what was measured, why it is true in part.

Why a line is not decided is said in `line_verdicts`; what a kind of law claims, and what was measured, in `law_kinds`.

Commands, figures and the report take their words here. How a number or a formula is written is theirs: a `Show`.
"""

import re
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from ..grammar.axes import SAMPLE
from .law_kinds import KINDS, Show
from .line_verdicts import (
    DIRECTIONS,
    FAILS,
    HOLDS,
    QUALIFIED,
    TREND,
    TREND_TAU,
    UNCHANGED,
    UNDECIDED,
    VERDICTS,
    Verdict,
    as_good,
    worst,
)

NOT_CONTRADICTED, ON_PART, ON_OBSERVABLE = QUALIFICATIONS = (
    "not contradicted",
    "on part of the grid",
    "depends on the observable",
)

BETWEEN = "cases that refinement added between the lines of the coarse grid go against it"
PLURAL = {"steps crosses": "steps cross", "cases has": "cases have"}
COUNTED = re.compile(rf"(\d+) of (\d+) ({'|'.join([*PLURAL, *PLURAL.values()])}) (.+)")  # the reason of a line
MOST = 3  # reasons of different lines of a grid that are listed
FORMER = {"holds": HOLDS, "holds as a trend": TREND, "qualified": QUALIFIED, "fails": FAILS}  # in files of 0.2.0
MEANING = {  # verdict -> what it means
    HOLDS: "every step goes the right way (a count may stay the same between neighbours), or every case agrees",
    TREND: "Kendall's tau in the law's direction is at least 0.8, and the steps that go the wrong way are counted",
    QUALIFIED: "one of these, with a reservation: a count is constant where the sentence says that it rises "
    f"({NOT_CONTRADICTED}), the law is true on the line that decides but not as well on another line ({ON_PART}), or "
    f"it is false of an alternative observable ({ON_OBSERVABLE})",
    UNDECIDED: "cases have no value, or steps cross to another branch of equilibria, and the other steps do not "
    "decide; or the reading drops the load of the axis",
    FAILS: "none of these",
}


def measurement(row: Mapping[str, Any], show: Show) -> str:
    """What was measured, of a row of a verdict, and its `detail`; as stored where its numbers do not say it all."""
    measured, several = str(row["found"]), row["found"].count("between") > 1
    if row["numbers"] and None not in row["numbers"].values() and not several:
        finding = KINDS[row["kind"]].finding
        assert finding is not None
        measured = finding(row["numbers"], row["rule"], row["axis"], show)
    return join([measured, detail(row)])


def others(row: Mapping[str, Any], name: Callable[[str], str]) -> str:
    """The verdicts on the other observables of a law: its alternatives, then those that decide nothing."""
    sentences = []
    for intro, equal in (("Alternative observables", True), ("For information only", False)):
        rows = [also for also in row["also"] if also["alternative"] == equal]
        if rows:
            brief = "; ".join(f"{name(also['observable'])} {_brief(also)}" for also in rows)
            sentences.append(f"{intro}: {brief}.")
    return " ".join(sentences)


def role(also: Mapping[str, Any]) -> str:
    """What another observable of a law is to it."""
    return "alternative" if also["alternative"] else "for information"


def _brief(row: Mapping[str, Any]) -> str:
    """The verdict, and how many steps go the wrong way."""
    wrong = len(row["exceptions"])
    return f"{row['verdict']} ({wrong} step{'s' * (wrong > 1)} wrong)" if wrong else str(row["verdict"])


def together(
    name: str,
    meant: str,
    deciding: Sequence[Verdict],
    every: Sequence[str],
    at: Mapping[str, float],
    across: Sequence[str],
    first: list[float] | None,
) -> dict[str, Any]:
    """Verdict, qualifications and reason of an observable, from the lines that decide and the verdicts of all lines.

    meant: the direction in the sentence. at: the values of other axes where the law is decided. across: all other
    axes. first: the range of the observable at the start of the axis.
    """
    verdict = worst([line.verdict for line in deciding])
    kinds: list[str] = []
    if verdict == QUALIFIED:
        kinds.append(NOT_CONTRADICTED)
        reasons = [_level(name, meant, deciding, first)]
    else:
        reasons = _of_all(deciding, meant)
    if as_good(verdict, QUALIFIED) and not as_good(worst(every), verdict):
        kinds.append(ON_PART)
        place = ", ".join(f"{axis} = {value:.4g}" for axis, value in at.items())
        reasons.append(f"{_of_lines(Counter(every), across)} (judged at {place})")
        verdict = QUALIFIED
    return {"verdict": verdict, "qualifications": kinds, "reason": join(reasons)}


def _of_all(lines: Sequence[Verdict], meant: str) -> list[str]:
    """The reasons of lines: one that all have as it is, others with the number of their lines, those that go the other
    way among them; counts of steps and of cases are added over those lines that have them: ``on 9 of 15 lines 14 of 18
    steps cross ... and 9 of 27 cases have no value``. meant: the direction in the sentence."""
    given = any(line.reason for line in lines)
    reasons = [line.reason or _instead(line.tau, meant) for line in lines if given]
    if len(set(reasons)) < 2:
        return reasons[:1]
    sums, texts, counted = dict[tuple[str, str], list[int]](), Counter[str](), 0
    for reason in reasons:
        matches = {part: COUNTED.fullmatch(part) for part in reason.split("; ")}
        counted += any(matches.values())
        for part, match in matches.items():
            if match is None:
                texts[part] += bool(part)
            else:
                each = sums.setdefault((PLURAL.get(match[3], match[3]), match[4]), [0, 0])
                each[:] = each[0] + int(match[1]), each[1] + int(match[2])
    single = {plural: text for text, plural in PLURAL.items()}
    facts = [f"{n} of {of} {single[does] if n == 1 else does} {what}" for (does, what), (n, of) in sums.items()]
    counts = [f"on {counted} of {len(lines)} lines {' and '.join(facts)}"] if facts else []
    others = [f"{text} on {n} of {len(lines)} lines" for text, n in texts.items() if n]
    return [*counts, *others[:MOST], *(["and so on"] if len(others) > MOST else [])]


def _instead(tau: float | None, meant: str) -> str:
    """What an observable does that has a trend in the opposite direction; else nothing."""
    reverse = meant and tau is not None and tau <= -TREND_TAU
    return f"it {DIRECTIONS[meant].instead}" if reverse else ""


def of_others(row: Mapping[str, Any], meant: str, others: Sequence[Mapping[str, Any]]) -> str:
    """What the observable of the law does, and what its failing alternatives do. row, others: their rows.

    Of a grid also in how many of its rows an alternative is false: the law may be true there by its observable alone.
    """
    trend = f" as a trend, with {_wrong(row)} the wrong way" if row["exceptions"] else ""
    clauses = []
    for other in others:
        reverse = other["tau"] is not None and other["tau"] <= -TREND_TAU
        does = DIRECTIONS[meant].instead if reverse else DIRECTIONS[meant].does_not
        rows = f"{other['line_verdicts'].get(FAILS, 0)} of {other['lines']} {_lines(other.get('across', []))}"
        wrong = f" at {_wrong(other)}" if other["exceptions"] else ""
        clauses.append(f"{other['observable']} {does}{wrong}{f' (false for {rows})' * (other['lines'] > 1)}")
    return f"{row['observable']} {DIRECTIONS[row['direction']].does}{trend}, but {' and '.join(clauses)}"


def count(counts: Mapping[str, int]) -> str:
    """The number of each verdict, best first: ``6 true, 3 true as a trend``."""
    return ", ".join(f"{counts[verdict]} {verdict}" for verdict in VERDICTS if counts.get(verdict))


def join(texts: Sequence[str]) -> str:
    """The non-empty texts as one sentence."""
    return "; ".join(text for text in texts if text)


def _level(name: str, meant: str, deciding: Sequence[Verdict], first: list[float] | None) -> str:
    """How the observable stays level on the lines that decide."""
    if len(deciding) > 1:
        standing = sum(line.verdict == QUALIFIED for line in deciding)
        how = f"stays level on {standing} of {len(deciding)} lines"
    elif deciding[0].reason and first:  # it does not change at all
        how = f"stays at {first[0]:.4g}"
    else:
        how = "stays level at some steps"
    return f"{name} {how}, where the sentence says that it {DIRECTIONS[meant].does}"


def _wrong(row: Mapping[str, Any]) -> str:
    """The number of steps the wrong way: ``2 of 8 steps``."""
    return f"{len(row['exceptions'])} of {row['steps']} steps"


def count_of(count: int, word: str) -> str:
    """``1 case``, ``9 cases``."""
    return f"{count} {word}{'s' * (count != 1)}"


def tally(rows: Sequence[Mapping[str, Any]]) -> dict[str, int]:
    """How many laws have each verdict, those of no law included."""
    verdicts = [row["verdict"] for row in rows]
    return {verdict: verdicts.count(verdict) for verdict in VERDICTS}


def tally_of(rows: Sequence[Mapping[str, Any]], noun: str = "law") -> str:
    """The tally in words: ``7 laws: 3 true, 4 true in part``."""
    return f"{count_of(len(rows), noun)}: {count(tally(rows))}"


def law_in_words(row: Mapping[str, Any], noun: str = "", axis: str = "", show: Show | None = None) -> str:
    """The law in words: ``bends falls along E``; with names of its observable and axis ``the pitch falls with E``.

    show: of the numbers and formulas of a law with numbers; default: as they are stored.
    """
    claim = row["does"] if show is None else KINDS[row["kind"]].does(row["rule"], show)
    words = f"{noun or row['observable']} {claim}"
    if not axis:
        return f"{words} along {row['axis']}"
    if row["direction"]:
        return f"{words} with {axis}"
    return words if f" {axis} = " in words else f"{words}, along {axis}"


def measure(row: Mapping[str, Any]) -> str:
    """What was measured: ``exponent 2 ± 0.001``; of a direction the values at the two ends of the axis, ``8 → 5``, or
    their ranges over the lines of a grid."""
    if row["found"]:
        return str(row["found"])
    return f"{_span(row['first'])} → {_span(row['last'])}"


def sentence(row: Mapping[str, Any]) -> str:
    """The verdict and why: ``true in part: true for 6 of 9 values of R (judged at R = 0.75)``."""
    notes = detail(row)
    return f"{row['verdict']}: {notes}" if notes else str(row["verdict"])


def where(row: Mapping[str, Any]) -> str:
    """Where a law was judged, and where it is false: ``at R = 0.75; false from E = 10000 to 15000``."""
    if not row["lines"]:
        return "nowhere"
    notes = [f"at {', '.join(f'{name} = {value:.4g}' for name, value in row['at'].items())}"] if row["at"] else []
    notes += [_rows(row)] if row["lines"] > 1 else []
    wrong = [_step(row["axis"], step, shown=not row["at"]) for step in row["exceptions"]]
    more = f" and {len(wrong) - MOST} more" if len(wrong) > MOST else ""
    notes += [f"false {', '.join(wrong[:MOST])}{more}"] if wrong else []
    return "; ".join(notes) or ("false everywhere" if row["verdict"] == FAILS else "everywhere")


def _step(axis: str, step: Mapping[str, Any], shown: bool) -> str:
    """The place of a step the wrong way, or of a case that disagrees. shown: whether its other axes are told."""
    begin, end = f"{axis} = {step['from']:.6g}", f"{step['to']:.6g}"
    others = [f"{name} = {value:.4g}" for name, value in step["at"].items()] if shown else []
    along = f"at {begin}" if step["from"] == step["to"] else f"from {begin} to {end}"
    return ", ".join([along, *others])


def in_words_of_today(text: str) -> str:
    """A verdict that 0.2.0 stored, as ``qualified: not contradicted``, by its name of today; another as it is."""
    verdict, colon, more = text.partition(":")
    return f"{FORMER.get(verdict, verdict)}{colon}{more}"


def detail(row: Mapping[str, Any]) -> str:
    """What qualifies a verdict: the reason, the line that decides, lines of a grid, exceptions; or nothing."""
    reason, notes = row["reason"], list[str]()
    if ON_PART not in row["qualifications"]:  # whose reason says the next two
        if row["at"]:
            notes.append(f"at {', '.join(f'{name} = {value:.4g}' for name, value in row['at'].items())}")
        if row["lines"] > 1:
            notes.append(_rows(row))
    is_told = row["verdict"] == QUALIFIED or reason == UNCHANGED
    if row["exceptions"] and not is_told:
        notes.append(f"{len(row['exceptions'])} of {row['steps']} {row['counted']}")
    if row["tau"] is not None and row["verdict"] != HOLDS and not is_told:
        notes.append(f"tau {row['tau']:.2f}")
    return join([reason if reason != row["found"] else "", *(note for note in notes if note not in reason)])


def _rows(row: Mapping[str, Any]) -> str:
    return _of_lines(row["line_verdicts"], row.get("across", []))


def _of_lines(verdicts: Mapping[str, int], across: Sequence[str]) -> str:
    """For how many values of the other axis, or pairs of values of two, a law is true: ``true for 1 of 9 values of R``.

    Where it is neither true nor false for some, each verdict is counted: ``..., 3 true as a trend, 1 false``.
    """
    others = {verdict: n for verdict, n in verdicts.items() if verdict != HOLDS}
    said = f"true for {verdicts.get(HOLDS, 0)} of {sum(verdicts.values())} {_lines(across)}"
    return f"{said}, {count(others)}" if others.keys() - {FAILS} else said


def _lines(across: Sequence[str]) -> str:
    """What the lines of a grid are, along which a law is judged. across: its other axes."""
    if [*across] == [SAMPLE]:
        return "samples"
    each = {1: "values", 2: "pairs"}.get(len(across))
    return f"{each} of {' and '.join(across)}" if each else "rows"


def _span(ends: list[float] | None) -> str:
    if ends is None:
        return "?"
    low, high = ends
    return f"{low:.4g}" if low == high else f"{low:.4g}..{high:.4g}"
