"""Console output: tables for people, JSON for programs, progress bars on a terminal."""

import json
import re
import sys
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from textwrap import wrap
from time import monotonic
from typing import TYPE_CHECKING, Any

from ..words import escaping

if TYPE_CHECKING:  # --help does not import rich
    from rich.console import Console

    from ..store.tally import Meter


COLOURS = {  # verdict -> colour
    "true": "green", "true as a trend": "cyan", "true in part": "yellow", "not decided": "magenta", "false": "red",
}  # fmt: skip
HELD = "\N{NO-BREAK SPACE}=\N{NO-BREAK SPACE}"
EVERY = 5.0  # seconds between two lines of progress
GAP = 2  # characters between the columns of a table
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
    """Print a table; a cell that begins with a verdict has the verdict's colour.

    Where the terminal is too narrow, headings and texts break between words, and columns that still do not fit follow
    below, behind the first column again; no cell is cut.
    """
    cells = [[_cell(value) for value in row] for row in rows]
    texts = [[head, *(row[i].plain for row in cells)] for i, head in enumerate(columns)]
    low = [_narrowest(column) for column in texts]
    high = [max(len(line) for text in column for line in text.split("\n")) or 1 for column in texts]
    for k, block in enumerate(_blocks(low, out().width)):
        if k:
            say("")
        widths = _widths([low[i] for i in block], [high[i] for i in block], out().width)
        _print_block([columns[i] for i in block], [[row[i] for i in block] for row in cells], widths, title)
        title = None


def heading(name: str, unit: str) -> str:
    """The heading of a column with its unit, which stays on one line."""
    return f"{name} ({unit.replace(' ', chr(0xA0))})" if unit else name


def _narrowest(texts: Sequence[str]) -> int:
    """The smallest width of a column with this heading and these cells: a column of numbers or names stays whole."""
    head, *cells = texts
    whole = not any(" " in text for text in cells)
    each = [*head.split(" "), *(cells if whole else " ".join(cells).split())]
    return max(map(len, each), default=0) or 1


def _blocks(low: Sequence[int], width: int) -> list[list[int]]:
    """The columns in as many blocks as it takes to fit into the width, each with the first column."""
    blocks, used = [[0]], low[0]
    for i in range(1, len(low)):
        if used + GAP + low[i] > width and len(blocks[-1]) > 1:
            blocks.append([0])
            used = low[0]
        blocks[-1].append(i)
        used += GAP + low[i]
    return blocks


def _widths(low: Sequence[int], high: Sequence[int], width: int) -> list[int]:
    """The width of each column, from its smallest to its largest: the widest give way first."""
    room, limit = width - GAP * (len(low) - 1), max(high)
    while limit > 0 and sum(max(least, min(most, limit)) for least, most in zip(low, high, strict=True)) > room:
        limit -= 1
    return [max(least, min(most, limit)) for least, most in zip(low, high, strict=True)]


def _print_block(columns: Sequence[str], cells: Sequence[Any], widths: Sequence[int], title: str | None) -> None:
    from rich.table import Table

    table = Table(title=title, title_justify="left", box=None, padding=(0, GAP, 0, 0), pad_edge=False,
                  header_style="bold")  # fmt: skip
    for i, (column, width) in enumerate(zip(columns, widths, strict=True)):
        texts = [row[i].plain for row in cells]
        right = any(texts) and all(map(_is_number, texts))
        head = "\n".join(wrap(column, width, **WHOLE)).replace("\N{NO-BREAK SPACE}", " ")
        table.add_column(head, justify="right" if right else "left", width=width)
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

    Without a terminal nothing is shown, or with `lines` a line for a step: ``3 of 9: elliptic``; of steps that follow
    each other quickly, one every `EVERY` seconds.
    """
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=err(), transient=True, disable=not err().is_terminal) as bar:
        task = bar.add_task("", total=total)
        begun, said = 0, -EVERY

        def step(text: str) -> None:
            nonlocal begun, said
            bar.update(task, description=text, advance=1 if begun else 0)
            begun += 1
            if lines and not err().is_terminal and monotonic() - said >= EVERY:
                said = monotonic()
                print(f"{begun} of {total}: {text}", file=sys.stderr, flush=True)

        yield step


def stop(error: BaseException, done: str, files: Sequence[Path]) -> None:
    """Say what an interrupted or failed command has stored: in the message of an interruption, else on stderr.

    done: what is finished, such as ``3 of 9 cases``. files: where it is stored.
    """
    kept = f"{done} are stored in {', '.join(map(str, files))}" if files else "nothing was finished yet"
    if isinstance(error, KeyboardInterrupt):
        error.args = (f"interrupted; {kept}",)
    else:
        warn(kept)


LINE_EVERY = 30.0  # seconds between two lines where stderr is no terminal


@contextmanager
def progress_bar(total: int, done: int, as_json: bool = False) -> "Iterator[Meter]":
    """A meter, shown while the body runs; where stderr is no terminal, or as JSON, by a line every 30 s."""
    from rich.progress import BarColumn, Progress, TextColumn

    from ..store.tally import Meter

    if as_json or not err().is_terminal:
        yield Meter(total, done, _make_lines(as_json))
        return
    columns = (BarColumn(), TextColumn("{task.completed} of {task.total} cases, {task.description}"))
    with Progress(*columns, console=err(), transient=True) as bar:
        task = bar.add_task("starting", total=total, completed=done)
        yield Meter(
            total,
            done,
            lambda meter: bar.update(task, completed=meter.done, total=meter.total, description=meter.text()),
        )


def _make_lines(as_json: bool) -> "Callable[[Meter], None]":
    said = 0.0

    def show(meter: "Meter") -> None:
        nonlocal said
        if meter.seconds - said >= LINE_EVERY:
            said = meter.seconds
            line = json.dumps(meter.data()) if as_json else f"{meter.done} of {meter.total} cases, {meter.text()}"
            print(line, file=sys.stderr, flush=True)

    return show
