"""Escape untrusted text for terminals, messages, JSON and CSV. Imports nothing heavy."""

import codecs
import csv
import json
import math
import re
from collections.abc import Iterable, Sequence
from io import StringIO
from typing import Any

LONGEST = 4000  # characters of a printed line; the rest is cut
_COMMANDS = re.compile(r"[^\n\t\x20-\x7e]")  # control sequences of terminals are among these


# How a sign is written where a stream has no such letter; any other letter becomes its number, as in JSON and TOML.
_SPELT = {
    "°": "deg", "−": "-", "–": "-", "—": "-", "→": "->", "×": "x", "·": "*", "…": "...", "²": "^2", "³": "^3",
    "≤": "<=", "≥": ">=", "\N{NO-BREAK SPACE}": " ",
}  # fmt: skip


def _spell(error: UnicodeError) -> tuple[str, int]:
    """What takes the place of letters that an encoding lacks, and where to go on: a handler of `codecs`."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    letters = error.object[error.start : error.end]
    return "".join(_SPELT.get(letter) or json.dumps(letter)[1:-1] for letter in letters), error.end


SPELL = "workbench.spell"  # the name of the handler
codecs.register_error(SPELL, _spell)


def lines(text: str) -> str:
    """The text with control characters, direction marks and line separators escaped as by `repr`.

    Line breaks stay; a line beyond `LONGEST` is cut.
    """
    safe = _COMMANDS.sub(lambda match: match[0] if match[0].isprintable() else repr(match[0])[1:-1], text)
    if len(safe) <= LONGEST:
        return safe
    return "\n".join(line if len(line) <= LONGEST else f"{line[:LONGEST]}..." for line in safe.split("\n"))


def line(text: str) -> str:
    """As `lines`, in one line."""
    return lines(text.replace("\n", "\\n").replace("\t", " "))


def is_line(text: str, longest: int) -> bool:
    """Whether it is one line of at most so many printable characters."""
    return len(text) <= longest and text.isprintable()


def show(value: object) -> str:
    """A value from a file as a message may show it: on one line, at most 60 characters."""
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def bytes_in_words(count: int) -> str:
    """``1.2 GB``, ``48.1 MB``, ``9 kB``."""
    unit, size = next((each for each in (("GB", 1e9), ("MB", 1e6)) if count >= each[1]), ("kB", 1e3))
    return f"{count / size:.3g} {unit}"


def in_json(text: str) -> str:
    """JSON text in which unprintable characters are escaped; letters of every language stay."""
    return _COMMANDS.sub(lambda match: match[0] if match[0].isprintable() else json.dumps(match[0])[1:-1], text)


def in_csv(rows: Iterable[Sequence[Any]], end: str = "\r\n") -> str:
    """Rows as CSV; end: of each line."""
    text = StringIO(newline="")
    csv.writer(text, lineterminator=end).writerows(rows)
    return text.getvalue()


def finite(data: Any) -> Any:
    """Plain data as JSON can hold it: NaN and infinity become None, keys become text."""
    if isinstance(data, dict):
        return {str(key): finite(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [finite(value) for value in data]
    if isinstance(data, float) and not math.isfinite(data):
        return None
    return data
