"""The pages of the documentation as tests run them."""

import re
from pathlib import Path

BLOCK = re.compile(r"^```sh\n.*?^```$", re.DOTALL | re.MULTILINE)


def read(page: Path, part: str = "") -> str:
    """The text of a part of a page, by its heading; default: of what stands before the first part.

    In its blocks of commands continued lines are joined, and lines of comments left out.
    """

    def as_lines(block: re.Match[str]) -> str:
        return re.sub(r"^#.*\n", "", re.sub(r" *\\\n *", " ", block[0]), flags=re.MULTILINE)

    parts = page.read_text(encoding="utf-8").split("<!-- part -->\n")
    (text,) = [text for text in parts[1:] if text.startswith(f"\n## {part}\n")] if part else parts[:1]
    return BLOCK.sub(as_lines, text)


def printed(python: str) -> list[str]:
    """What the calls of print in a block print, by the comments behind them."""
    return re.findall(r"^(?:print\(.*\)|\))  # (.*)$", python, re.MULTILINE)
