"""Text from files and from anyone, as a terminal and as a line of a message may have it. Imports nothing heavy."""

import json
import re

LONGEST = 4000  # characters of a line that is printed; what is longer is cut
_COMMANDS = re.compile(r"[^\n\t\x20-\x7e]")  # what may command a terminal is among these


def lines(text: str) -> str:
    """The text with its lines, without what would command a terminal: that is written as Python writes it.

    Control characters, marks of direction and line separators are `repr`'s escapes; a line beyond `LONGEST` is cut.
    """
    safe = _COMMANDS.sub(lambda found: found[0] if found[0].isprintable() else repr(found[0])[1:-1], text)
    if len(safe) <= LONGEST:
        return safe
    return "\n".join(line if len(line) <= LONGEST else f"{line[:LONGEST]}..." for line in safe.split("\n"))


def line(text: str) -> str:
    """As `lines`, all in one line."""
    return lines(text.replace("\n", "\\n").replace("\t", " "))


def is_line(text: str, longest: int) -> bool:
    """Whether it can be shown as it stands: printable characters of one line, at most so many."""
    return len(text) <= longest and text.isprintable()


def in_json(text: str) -> str:
    """JSON in which strings keep the letters of every language, but what would command a terminal is escaped."""
    return _COMMANDS.sub(lambda found: found[0] if found[0].isprintable() else json.dumps(found[0])[1:-1], text)
