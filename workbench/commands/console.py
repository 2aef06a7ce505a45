"""Console output: tables for people, JSON for programs, progress bars on a terminal."""

import json
import re
import sys
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

from ..data import escaping

if TYPE_CHECKING:  # --help does not import rich
    from rich.console import Console

COLOURS = {  # verdict -> colour
    "holds": "green", "holds as a trend": "cyan", "qualified": "dark_orange", "not decided": "magenta", "fails": "red",
}  # fmt: skip
HELD = "\N{NO-BREAK SPACE}=\N{NO-BREAK SPACE}"
WHOLE: dict[str, Any] = {"break_long_words": False, "break_on_hyphens": False}


@cache
def out() -> "Console":
    """The console of stdout."""
    from rich.console import Console

    # A pipe or a file has no width of its own: the width is large enough that no row of a table is broken.
    return Console(highlight=False, soft_wrap=True, width=None if sys.stdout.isatty() else 200)


@cache
def err() -> "Console":
    """The console of stderr."""
    from rich.console import Console

    return Console(stderr=True, highlight=False, soft_wrap=True)


def say(text: str) -> None:
    """Print lines on stdout; control characters are escaped, because text from a file may contain terminal commands."""
    out().print(at_words(escaping.lines(text), out()), markup=False)


def warn(sentence: str) -> None:
    """Print one sentence on stderr, behind the name of the program."""
    err().print(at_words(f"workbench: {escaping.line(sentence)}", err()), markup=False)


def say_units(units: Mapping[str, str], assumed: Collection[str] = ()) -> None:
    """Print in which units a command took its numbers. assumed: what it assumed, "unit of length" perhaps among it."""
    chosen = [f"--{kind}-unit" for kind in ("length", "force") if f"unit of {kind}" in assumed]
    hint = f"; {' and '.join(chosen)} would change that" if chosen else ""
    say(f"units: lengths in {units['length']}, forces in {units['force']}, angles in rad{hint}")


def at_words(text: str, console: "Console") -> str:
    """The text with lines that break between words where they are longer than the terminal is wide.

    Names, numbers and paths stay whole. A pipe or a file gets each line as it is.
    """
    if not console.is_terminal:
        return text
    lines = []
    for line in text.split("\n"):
        indent = " " * (len(line) - len(line.lstrip()))
        held = line.replace(" = ", HELD)  # a name stays beside its value
        lines += wrap(held, console.width, subsequent_indent=indent, **WHOLE) or [""]
    return "\n".join(lines).replace(HELD, " = ")


def print_table(columns: Sequence[str], rows: Iterable[Sequence[Any]], title: str | None = None) -> None:
    """Print a table; a cell that begins with a verdict has the verdict's colour."""
    from rich.table import Table

    cells = [[_cell(value) for value in row] for row in rows]
    table = Table(title=title, title_justify="left", box=None, pad_edge=False, header_style="bold")
    for i, column in enumerate(columns):
        texts = [row[i].plain for row in cells]
        whole = not any(" " in text for text in texts)  # names or numbers
        table.add_column(
            column,
            justify="right" if any(texts) and all(map(_is_number, texts)) else "left",
            min_width=max(map(len, (column, *texts))) if whole else None,
        )
    for row in cells:
        table.add_row(*row)
    out().print(table, soft_wrap=False)


def _is_number(text: str) -> bool:
    """Whether a cell is a number, or empty, or a dash in the place of one."""
    return text in ("", "-") or bool(re.fullmatch(r"[-+\u2212]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?|nan|inf", text))


def _cell(value: Any) -> Any:
    from rich.text import Text

    text = f"{value:.6g}" if isinstance(value, float) else "\n".join(map(escaping.line, str(value).split("\n")))
    word = next((word for word in sorted(COLOURS, key=len, reverse=True) if text.startswith(word)), None)
    return Text(text, style=COLOURS[word] if word else "")


def print_json(data: Any) -> None:
    """Print the data as JSON; NaN and infinity become null."""
    print(escaping.in_json(json.dumps(escaping.finite(data), indent=2, ensure_ascii=False)))


@contextmanager
def progress(total: int, lines: bool = False) -> Iterator[Any]:
    """Show a progress bar on stderr; yields step(text), to be called when each of `total` pieces of work begins.

    Without a terminal nothing is shown, or with `lines` one line for each step: ``3 of 9: elliptic``.
    """
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=err(), transient=True, disable=not err().is_terminal) as bar:
        task = bar.add_task("", total=total)
        begun = 0

        def step(text: str) -> None:
            nonlocal begun
            bar.update(task, description=text, advance=1 if begun else 0)
            begun += 1
            if lines and not err().is_terminal:
                print(f"{begun} of {total}: {text}", file=sys.stderr, flush=True)

        yield step


def stopped(error: BaseException, done: str, files: Sequence[Path]) -> None:
    """Say what an interrupted or failed command has stored: in the message of an interruption, else on stderr.

    done: what is finished, such as ``3 of 9 cases``. files: where it is stored.
    """
    kept = f"{done} are stored in {', '.join(map(str, files))}" if files else "nothing was finished yet"
    if isinstance(error, KeyboardInterrupt):
        error.args = (f"interrupted; {kept}",)
    else:
        warn(kept)
