"""Outcomes of many cases in few words: those that differ in their numbers alone are one, with the range of each number.

Imports nothing heavy.
"""

import re
from collections import Counter
from collections.abc import Mapping
from typing import TYPE_CHECKING

from solver.problem.errors import InputError

if TYPE_CHECKING:
    import xarray as xr

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


def check_any_solved(ds: "xr.Dataset") -> None:
    """Raise `InputError`, which says why, where no case of a dataset is solved and there is nothing to draw."""
    if ds["solved"].values.any():
        return
    counts = group(Counter(map(str, ds["outcome"].values.ravel().tolist())))
    cases = sum(counts.values())
    if cases == 1:
        raise InputError(f"nothing to draw: {next(iter(counts))}")
    told = "; ".join(f"{count} x {text}" for text, count in counts.most_common(MOST_TOLD))
    more = f"; and {len(counts) - MOST_TOLD} other outcomes" if len(counts) > MOST_TOLD else ""
    raise InputError(f"nothing to draw: none of the {cases} cases is solved: {told}{more}")


def _together(texts: list[str]) -> str:
    """The texts of one kind as one, with the range of each number."""
    if len(texts) == 1:
        return texts[0]
    ranges = map(_range, zip(*(_NUMBERS.findall(text) for text in texts), strict=True))
    return _NUMBERS.sub(lambda _: next(ranges), texts[0])


def _range(found: tuple[str, ...]) -> str:
    """The least and the greatest of numbers and ranges, as they are written; the number where all are the same."""
    if UNKNOWN in found:
        return UNKNOWN
    each = sorted({(float(number), number) for text in found for number in text.split(" to ")})
    low, high = each[0], each[-1]
    return low[1] if low[0] == high[0] else f"{low[1]} to {high[1]}"
