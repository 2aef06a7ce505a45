"""Formulas within sentences: no line ends inside ``F₃ = 10``, ``8 → 5``, ``κ a > 1``, ``0.5 rad`` or ``eq. (47)``."""

import re
from typing import Any

HARD = "\u00a0"  # a space at which no line ends
SIGNS = "[=<>≤≥→]"
SPACES = re.compile(
    rf"(?<=\S) (?={SIGNS} )|(?<={SIGNS}) (?=\S)|(?<=\b\w) (?=\w {SIGNS} )"
    r"|(?<=\d) (?=(?:rad|cm|N|m|mm)\b)|(?<=\beq\.) (?=\()|(?<=\btau) (?=[−\d])"
)


def with_hard_spaces(value: Any) -> Any:
    """A plain text with hard spaces in its formulas; markup and what is no text as they are."""
    return SPACES.sub(HARD, value) if type(value) is str else value
