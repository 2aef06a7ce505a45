"""Print the outcomes and verdicts of a stored study, for run, check, merge and reproduce."""

from collections.abc import Mapping, Sequence
from math import floor, log10
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import console

if TYPE_CHECKING:
    from ..store.study_store import Ran


TOLD = ("sampling", "sampling_caution", "refinement", "equilibria", "branches")  # sentences that a study may have


def print_verdicts(verdicts: Sequence[dict[str, Any]], title: str | None = None, alternatives: bool = False) -> None:
    """Print how many laws are true, a table with the verdict on each, and below it the reasons.

    alternatives: with the other observables of each law in the rows below it.
    """
    from studies.laws import verdict_words

    console.say(verdict_words.tally_of(list(verdicts)))
    rows, reasons = [], []
    for row in verdicts:
        law, measured = verdict_words.law_in_words(row), verdict_words.measure(row)
        rows.append([verdict_words.plain(row), row["claim"], law, measured])
        if detail := verdict_words.detail(row):
            reasons.append(f"{row['claim']}, {row['observable']}: {detail}")
        for also in row["also"] if alternatives else ():
            role = "alternative" if also["alternative"] else "for information"
            rows.append([f"  {verdict_words.plain(also)}", "", f"  {role}: {also['observable']}",
                         verdict_words.measure(also)])  # fmt: skip
            if detail := verdict_words.detail(also):
                reasons.append(f"{row['claim']}, {also['observable']}: {detail}")
    console.print_table(["verdict", "claim", "law", "measured"], rows, title=title)
    for reason in reasons:
        console.say(reason)


def print_sampling(found: Mapping[str, Any]) -> None:
    """Print where the samples come from, a caution about their number, and what ended a refinement."""
    for name in ("sampling", "refinement"):
        if found.get(name):
            console.say(found[name])
    if found.get("sampling_caution"):
        console.say(f"caution: {found['sampling_caution']}")


def print_outcomes(outcomes: Mapping[str, int], file: Path) -> None:
    """Print how often each outcome occurs but the plain one; of cases with fewer digits also which is the worst.

    How many cases were selected from a list that may be incomplete is said on stderr.
    """
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
    warn_of_incomplete(outcomes, file)


def warn_of_incomplete(outcomes: Mapping[str, int], file: Path) -> None:
    """Say on stderr in how many cases the list of equilibria may be incomplete, and where this is stored."""
    from solver.choose.selection import INCOMPLETE

    count = sum(cases for text, cases in outcomes.items() if INCOMPLETE in text)
    if count:
        console.warn(
            f"in {count} of {sum(outcomes.values())} cases the equilibrium was {INCOMPLETE}, so the number of "
            f"equilibria there is a lower bound; the outcome of each of these cases in {file} says so"
        )


def _fewer_digits(count: int, file: Path) -> str:
    """What cases have lost whose error is above the tolerance, how many digits remain, and which case is the worst."""
    from studies.laws import verdict_words

    from ..store.file_summary import least_accurate
    from ..words import labels

    worst = least_accurate(file)
    digits = max(floor(-log10(worst["error"])), 0)
    at = f"at {worst['at']}" if worst["at"] else ""
    which = f"the least accurate, {at}, has" if count > 1 else f"{at} it has".strip()
    are, told = "are" if count > 1 else "is", verdict_words.count_of(digits, "digit")
    grows = labels.number(worst["condition"], 2)
    return (
        f"{verdict_words.count_of(count, 'case')} {are} solved to fewer digits than the tolerance asks for: {which} "
        f"about {told} (estimated error {worst['error']:.1e}), because a small change of its data grows {grows} times "
        "along the rod"
    )


def print_result(found: dict[str, Any], as_json: bool, ran: "Ran | None" = None) -> int:
    """Print what a stored study holds, and after a run what the run did.

    Returns the exit status of the command check: 0, or 1 if a case is unsolved or a law does not hold.
    """
    from studies.laws import verdict_words

    from ..store import law_verdicts
    from ..words import cautions

    outcomes, cases, unsolved = found["outcomes"], sum(found["outcomes"].values()), found["unsolved"]
    status = law_verdicts.status(unsolved, found["laws"])
    caution = cautions.tell(found["cautions"])
    if as_json:
        counts = {"cases": cases, "unsolved": unsolved, "outcomes": sorted(outcomes), "caution": caution}
        run = {} if ran is None else {"solved_now": ran.solved, "seconds": ran.seconds}
        named = {name: found[name] for name in ("study", "reading", "file")}
        named |= {name: found[name] for name in TOLD if found.get(name)}
        laws = {"verdicts": verdict_words.tally(found["laws"]), "laws": found["laws"]}
        console.print_json({**named, **counts, **run, **laws, "status": status})
        warn_of_incomplete(outcomes, Path(found["file"]))
        return status
    console.say(f"{found['title']}, {found['reading']}" if found["reading"] else found["title"])
    if found["laws"]:
        print_verdicts(found["laws"], alternatives=True)
    console.say(f"{found['file']}: {verdict_words.count_of(cases, 'case')}, {unsolved} unsolved")
    print_outcomes(outcomes, Path(found["file"]))
    print_sampling(found)
    for name in ("equilibria", "branches"):
        if found.get(name):
            console.say(found[name])
    if caution:
        console.say(f"caution: {caution}")
    if ran is not None and ran.finished_before:
        console.say("already complete; use --restart to solve again")
    return status
