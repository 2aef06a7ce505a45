"""The nearest known name, for messages about an unknown one."""

from collections.abc import Iterable
from difflib import get_close_matches


def near(name: object, known: Iterable[object]) -> str:
    """``, did you mean 'sobol'`` where a known name is close to this one; else nothing."""
    close = get_close_matches(str(name)[:60], [str(one) for one in known], 1)
    return f", did you mean {close[0]!r}" if close else ""
