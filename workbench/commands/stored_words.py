"""What commands print of a stored study: the verdicts on its laws, and sentences on its samples and its cases."""

from collections.abc import Mapping, Sequence
from typing import Any

from . import console, tables

SAMPLING = ("sampling", "refinement", "sampling_caution")  # where samples come from, and what ended a refinement
JUDGED = ("equilibria", "branches", "caution")  # which equilibria the cases have, and what no real rod can do


def print_verdicts(verdicts: Sequence[dict[str, Any]], title: str | None = None, alternatives: bool = False) -> None:
    """Print how many laws are true, a table with the verdict on each, and below it the reasons.

    alternatives: with the other observables of each law in the rows below it.
    """
    from studies.laws import law_words

    console.say(law_words.tally_of(list(verdicts)))
    rows, reasons = [], []
    for row in verdicts:
        law, measured = law_words.law_in_words(row), law_words.measure(row)
        rows.append([row["verdict"], row["claim"], law, measured])
        if detail := law_words.detail(row):
            reasons.append(f"{row['claim']}, {row['observable']}: {detail}")
        for also in row["also"] if alternatives else ():
            role = f"  {law_words.role(also)}: {also['observable']}"
            rows.append([f"  {also['verdict']}", "", role, law_words.measure(also)])
            if detail := law_words.detail(also):
                reasons.append(f"{row['claim']}, {also['observable']}: {detail}")
    tables.print_table(["verdict", "claim", "law", "measured"], rows, title=title)
    for reason in reasons:
        console.say(reason)


def print_sentences(found: Mapping[str, Any], names: Sequence[str]) -> None:
    """Print those of these sentences on a study that it has."""
    for name in names:
        if found.get(name):
            console.say(f"caution: {found[name]}" if name.endswith("caution") else found[name])
