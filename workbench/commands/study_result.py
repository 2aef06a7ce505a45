"""The outcomes and verdicts of a stored study, as run, check, merge and reproduce print them."""

from collections.abc import Mapping, Sequence
from math import floor, log10
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import console, tables
from .present import Result

if TYPE_CHECKING:
    from ..store.study_store import Ran


SENTENCES = ("sampling", "sampling_caution", "refinement", "equilibria", "branches")  # that a study may have


def print_verdicts(verdicts: Sequence[dict[str, Any]], title: str | None = None, alternatives: bool = False) -> None:
    """Print how many laws are true, a table with the verdict on each, and below it the reasons.

    alternatives: with the other observables of each law in the rows below it.
    """
    from studies.laws import law_words

    console.say(law_words.tally_of(list(verdicts)))
    rows, reasons = [], []
    for row in verdicts:
        law, measured = law_words.law_in_words(row), law_words.measure(row)
        rows.append([law_words.plain(row), row["claim"], law, measured])
        if detail := law_words.detail(row):
            reasons.append(f"{row['claim']}, {row['observable']}: {detail}")
        for also in row["also"] if alternatives else ():
            role = f"  {law_words.role(also)}: {also['observable']}"
            rows.append([f"  {law_words.plain(also)}", "", role, law_words.measure(also)])
            if detail := law_words.detail(also):
                reasons.append(f"{row['claim']}, {also['observable']}: {detail}")
    tables.print_table(["verdict", "claim", "law", "measured"], rows, title=title)
    for reason in reasons:
        console.say(reason)


def print_sampling(found: Mapping[str, Any]) -> None:
    """Print where the samples come from, a caution about their number, and what ended a refinement."""
    for name in ("sampling", "refinement"):
        if found.get(name):
            console.say(found[name])
    if found.get("sampling_caution"):
        console.say(f"caution: {found['sampling_caution']}")


def _print_outcomes(outcomes: Mapping[str, int], file: Path) -> None:
    """Print how often each outcome occurs but the plain one; of cases with fewer digits also which is the worst."""
    from solver.choose.selection import INCOMPLETE
    from solver.problem.trajectory import FEWER

    from ..words.outcomes import group

    fewer = 0
    for text, count in sorted(group(outcomes).items()):
        if text == f"solved; {INCOMPLETE}":
            continue
        if FEWER in text:
            fewer += count
        elif text != "solved":
            console.say(f"  {count} x {text}")
    if fewer:
        console.say(f"  {_fewer_digits(fewer, file)}")


def _warnings(outcomes: Mapping[str, int], file: Path) -> list[str]:
    """In how many cases the list of equilibria may be incomplete, and where this is stored."""
    from solver.choose.selection import INCOMPLETE

    count = sum(cases for text, cases in outcomes.items() if INCOMPLETE in text)
    said = (
        f"in {count} of {sum(outcomes.values())} cases the equilibrium was {INCOMPLETE}, so the number of "
        f"equilibria there is a lower bound; the outcome of each of these cases in {file} says so"
    )
    return [said] if count else []


def _fewer_digits(count: int, file: Path) -> str:
    """What cases have lost whose error is above the tolerance, how many digits remain, and which case is the worst."""
    from studies.laws import law_words

    from ..store.file_summary import least_accurate
    from ..words import labels

    worst = least_accurate(file)
    digits = max(floor(-log10(worst["error"])), 0)
    at = f"at {worst['at']}" if worst["at"] else ""
    which = f"the least accurate, {at}, has" if count > 1 else f"{at} it has".strip()
    are, told = "are" if count > 1 else "is", law_words.count_of(digits, "digit")
    grows = labels.number(worst["condition"], 2)
    return (
        f"{law_words.count_of(count, 'case')} {are} solved to fewer digits than the tolerance asks for: {which} "
        f"about {told} (estimated error {worst['error']:.1e}), because a small change of its data grows {grows} times "
        "along the rod"
    )


def result_of(found: dict[str, Any], ran: "Ran | None" = None) -> Result:
    """What a stored study holds, and after a run what the run did; status 1 if a case is unsolved or a law fails."""
    from studies.laws import law_words

    from ..store import law_verdicts
    from ..words import cautions

    outcomes, file = found["outcomes"], Path(found["file"])
    cases, unsolved = sum(outcomes.values()), found["unsolved"]
    status = law_verdicts.status(unsolved, found["laws"])
    caution = cautions.tell(found["cautions"])

    def data() -> dict[str, Any]:
        counts = {"cases": cases, "unsolved": unsolved, "outcomes": sorted(outcomes), "caution": caution}
        run = {} if ran is None else {"solved_now": ran.solved, "seconds": ran.seconds}
        named = {name: found[name] for name in ("study", "reading", "file")}
        named |= {name: found[name] for name in SENTENCES if found.get(name)}
        laws = {"verdicts": law_words.tally(found["laws"]), "laws": found["laws"]}
        return {**named, **counts, **run, **laws, "status": status}

    def show() -> None:
        console.say(f"{found['title']}, {found['reading']}" if found["reading"] else found["title"])
        if found["laws"]:
            print_verdicts(found["laws"], alternatives=True)
        console.say(f"{file}: {law_words.count_of(cases, 'case')}, {unsolved} unsolved")
        _print_outcomes(outcomes, file)
        print_sampling(found)
        for name in ("equilibria", "branches"):
            if found.get(name):
                console.say(found[name])
        if caution:
            console.say(f"caution: {caution}")
        if ran is not None and ran.finished_before:
            console.say("already complete; use --restart to solve again")

    return Result(data, show, status, warnings=_warnings(outcomes, file))
