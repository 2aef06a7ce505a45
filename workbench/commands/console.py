"""What is printed: tables for people, JSON for programs, progress on a terminal only."""

import json
import math
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from ..data import escaping

# A pipe or a file has no width of its own: wide enough that no row of a table is broken.
out = Console(highlight=False, soft_wrap=True, width=None if sys.stdout.isatty() else 200)
err = Console(stderr=True, highlight=False, soft_wrap=True)

COLOURS = {  # verdict -> colour
    "holds": "green", "holds as a trend": "cyan", "qualified": "dark_orange", "not decided": "magenta", "fails": "red",
}  # fmt: skip


def say(text: str) -> None:
    """Lines for people, on stdout; what could command the terminal is escaped, as a file's text may be anyone's."""
    out.print(escaping.lines(text), markup=False)


def warn(sentence: str) -> None:
    """One sentence on stderr, of what does not hold or cannot be done."""
    err.print(f"workbench: {escaping.line(sentence)}", markup=False)


def print_table(columns: Sequence[str], rows: Iterable[Sequence[Any]], title: str | None = None) -> None:
    """A table; cells that begin with a verdict take its colour."""
    table = Table(*columns, title=title, title_justify="left", box=None, pad_edge=False, header_style="bold")
    for row in rows:
        table.add_row(*(_cell(value) for value in row))
    out.print(table, soft_wrap=False)


def _cell(value: Any) -> Any:
    from rich.text import Text

    text = f"{value:.6g}" if isinstance(value, float) else escaping.line(str(value))
    word = next((word for word in sorted(COLOURS, key=len, reverse=True) if text.startswith(word)), None)
    return Text(text, style=COLOURS[word] if word else "")


def print_json(data: Any) -> None:
    """The data as JSON; what is not a finite number is null."""
    print(escaping.in_json(json.dumps(finite(data), indent=2, ensure_ascii=False)))


def finite(data: Any) -> Any:
    if isinstance(data, dict):
        return {str(key): finite(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [finite(value) for value in data]
    if isinstance(data, float) and not math.isfinite(data):
        return None
    return data


@contextmanager
def progress(total: int, lines: bool = False) -> Iterator[Any]:
    """A bar on stderr that counts to `total`; yields step(text), to be called as each piece of work begins.

    Where stderr is no terminal nothing is shown, or with `lines` a line a step: ``3 of 9: elliptic``.
    """
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=err, transient=True, disable=not err.is_terminal) as bar:
        task = bar.add_task("", total=total)
        begun = 0

        def step(text: str) -> None:
            nonlocal begun
            bar.update(task, description=text, advance=1 if begun else 0)
            begun += 1
            if lines and not err.is_terminal:
                print(f"{begun} of {total}: {text}", file=sys.stderr, flush=True)

        yield step


def stopped(error: BaseException, done: str, files: Sequence[Path]) -> None:
    """Say what was kept of work that was cut short: as the interruption's own sentence, or before another error's."""
    kept = f"{done} are stored in {', '.join(map(str, files))}" if files else "nothing was finished yet"
    if isinstance(error, KeyboardInterrupt):
        error.args = (f"interrupted; {kept}",)
    else:
        say_aside(kept)


def say_aside(text: str) -> None:
    """A line on stderr, beside what a program may read."""
    print(f"workbench: {escaping.line(text)}", file=sys.stderr, flush=True)
