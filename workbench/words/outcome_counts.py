"""Outcomes and branches of many cases in few words: outcomes that differ in their numbers alone are one. Stability."""

import re
from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.problem.errors import InputError
from studies.laws.law_words import count_of

_ONE = r"(?<![A-Za-z\d.])[-+]?\d+(?:\.\d+)?(?:e[+-]?\d+)?"  # not the digit of a name such as F3
_NUMBERS = re.compile(rf"{_ONE} to {_ONE}|{_ONE}|\.\.\.")  # a number, a range, or one that an older file left out
UNKNOWN = "..."
MOST_TOLD = 3  # kinds of outcomes in a message


def kind_of(outcome: str) -> str:
    """An outcome without its numbers, which differ from case to case."""
    return _NUMBERS.sub(UNKNOWN, outcome)


def group(counts: Mapping[str, int]) -> Counter[str]:
    """The outcomes of one kind counted together: ``the limit of 60 steps after 12 to 99.9% of the way``.

    It takes what it has returned, with further outcomes, and does not depend on their order.
    """
    kinds: dict[str, list[str]] = {}
    for text in counts:
        kinds.setdefault(kind_of(text), []).append(text)
    return Counter({_together(texts): sum(counts[text] for text in texts) for texts in kinds.values()})


def check_any_solved(solved: "NDArray[np.bool_]", texts: "NDArray[Any]") -> None:
    """Raise `InputError`, which says why, where no case is solved and there is nothing to draw. texts: the outcomes."""
    if solved.any():
        return
    counts = group(Counter(map(str, texts.ravel().tolist())))
    cases = sum(counts.values())
    if cases == 1:
        raise InputError(f"nothing to draw: {next(iter(counts))}")
    reasons = "; ".join(f"{count} x {text}" for text, count in counts.most_common(MOST_TOLD))
    more = f"; and {len(counts) - MOST_TOLD} other outcomes" if len(counts) > MOST_TOLD else ""
    raise InputError(f"nothing to draw: none of the {cases} cases is solved: {reasons}{more}")


def _together(texts: list[str]) -> str:
    """The texts of one kind as one, with the range of each number."""
    if len(texts) == 1:
        return texts[0]
    ranges = map(_range, zip(*(_NUMBERS.findall(text) for text in texts), strict=True))
    return _NUMBERS.sub(lambda _: next(ranges), texts[0])


def _range(texts: tuple[str, ...]) -> str:
    """The least and the greatest of numbers and ranges, as they are written; the number where all are the same."""
    if UNKNOWN in texts:
        return UNKNOWN
    each = sorted({(float(number), number) for text in texts for number in text.split(" to ")})
    low, high = each[0], each[-1]
    return low[1] if low[0] == high[0] else f"{low[1]} to {high[1]}"


def stability(index: int) -> str:
    """A Morse index in words: ``stable``, ``unstable in 2 ways``."""
    return f"unstable in {count_of(index, 'way')}" if index else "stable"


NO_BRANCH = -1  # the branch of a case without a solution
LEFT = "number of branches left on the way from the straight rod (-1: not solved)"  # the label of such a `branch`


def number_branches(branch: NDArray[np.int64], every: Iterable[int]) -> NDArray[np.int64]:
    """Branches renumbered from 0 in the order of the cases where they begin; every: all the old numbers."""
    order = sorted(set(every) - {NO_BRANCH})
    ranks = np.array([NO_BRANCH, *range(len(order))])
    return ranks[np.searchsorted(np.array([NO_BRANCH, *order]), branch)]


def count_branches(branch: NDArray[Any]) -> dict[int, int]:
    """How many cases each branch has; NaN counts as `NO_BRANCH`."""
    known = np.nan_to_num(np.asarray(branch, dtype=float), nan=NO_BRANCH, posinf=NO_BRANCH, neginf=NO_BRANCH)
    numbers, counts = np.unique(known, return_counts=True)
    return {int(number): int(count) for number, count in zip(numbers, counts, strict=True)}


NO_LAW = "Laws are not judged across a change of branch"


def branch_sentence(counts: Mapping[int, int], left: bool = False, several: bool = False) -> str:
    """One sentence about branches; counts: branch -> how many cases.

    left: whether the numbers count the branches that were left. several: whether the grid has several lines.
    """
    sizes = {branch: count for branch, count in sorted(counts.items()) if branch != NO_BRANCH}
    if not sizes:
        return "no case has an equilibrium"
    if left:
        away, cases = sum(count for branch, count in sizes.items() if branch), sum(sizes.values())
        if not away:
            return "every case continues from the straight rod without leaving its branch of equilibria"
        return (
            f"in {away} of {cases} cases the rod leaves its branch of equilibria on the way from the straight rod: the "
            f"outcome of a case says where. {NO_LAW}"
        )
    if len(sizes) == 1:
        return "all cases lie on one branch of equilibria"
    most = f"{max(sizes.values())} of {sum(sizes.values())} cases on one"
    return f"{'up to ' if several else ''}{len(sizes)} branches of equilibria ({most}). {NO_LAW}"
