"""The pages of the documentation as tests run them."""

import re
from pathlib import Path

BLOCK = re.compile(r"^```sh\n.*?^```$", re.DOTALL | re.MULTILINE)


def read(page: Path) -> str:
    """The text of a page; in its blocks of commands continued lines are joined, and lines of comments left out."""

    def as_lines(block: re.Match[str]) -> str:
        return re.sub(r"^#.*\n", "", re.sub(r" *\\\n *", " ", block[0]), flags=re.MULTILINE)

    return BLOCK.sub(as_lines, page.read_text(encoding="utf-8"))


def printed(python: str) -> list[str]:
    """What the calls of print in a block print, by the comments behind them."""
    return re.findall(r"^(?:print\(.*\)|\))  # (.*)$", python, re.MULTILINE)
