"""Console output: sentences for people, JSON for programs, progress bars on a terminal; tables are in `tables`."""

import json
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import cache, partial
from textwrap import wrap
from threading import Timer
from time import monotonic
from typing import TYPE_CHECKING, Any

from ..words import escaping
from ..words.assumptions import assumption, units_sentence

if TYPE_CHECKING:  # --help does not import rich
    from rich.console import Console

    from ..run.run_and_resume import Meter

HELD = "\N{NO-BREAK SPACE}=\N{NO-BREAK SPACE}"
EVERY = 5.0  # seconds between two lines of progress
PATIENCE = 15.0  # seconds before a command that is silent says that it runs
SLOW = "still computing (Ctrl+C ends it); the time grows with the length over the radius and with the loads"
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


def say_units(units: Mapping[str, str], assumed: Mapping[str, Any] | None = None) -> None:
    """Print in which units a command took its numbers, and what it assumed, "unit of length" perhaps among it."""
    assumed = assumed or {}
    chosen = [f"--{kind}-unit" for kind in ("length", "force") if f"unit of {kind}" in assumed]
    say(units_sentence(units, ", angles in rad" + (f" ({', '.join(chosen)} to change that)" if chosen else "")))
    if sentence := assumption(assumed):
        say(sentence)


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


def print_json(data: Any) -> None:
    """Print the data as JSON; NaN and infinity become null. Where stdout lacks letters, all but ASCII is escaped."""
    ascii_alone = not (sys.stdout.encoding or "utf-8").lower().startswith("utf")
    print(escaping.in_json(json.dumps(escaping.finite(data), indent=2, ensure_ascii=ascii_alone)))


@contextmanager
def remark_on_time() -> Iterator[None]:
    """Say on a terminal's stderr that the body still runs, and what may take so long, if it takes `PATIENCE`."""
    timer = Timer(PATIENCE, warn, [SLOW])
    timer.daemon = True
    if sys.stderr.isatty():
        timer.start()
    try:
        yield
    finally:
        timer.cancel()


@contextmanager
def _bar(words: str, total: int, done: int = 0) -> "Iterator[Callable[..., None]]":
    """A progress bar on a terminal, else nothing; yields what updates it. words: beside it, in the form of rich."""
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (BarColumn(), TextColumn(words), TimeElapsedColumn())
    with Progress(*columns, console=err(), transient=True, disable=not err().is_terminal) as bar:
        yield partial(bar.update, bar.add_task("starting", total=total, completed=done))


@contextmanager
def progress(total: int, lines: bool = False) -> Iterator[Any]:
    """Show a progress bar on stderr; yields step(text), to be called when each of `total` pieces of work begins.

    step(text, done, of) says itself how many of how many are done; where `of` changes, the time left is measured anew.

    Without a terminal nothing is shown, or with `lines` a line for a step: ``3 of 9, 0:00:12 left: elliptic``; of steps
    that follow each other quickly, one every `EVERY` seconds.
    """
    from ..run.run_and_resume import Meter

    meter, begun, said = Meter(total, 0), 0, -EVERY
    with _bar("{task.completed} of {task.total}{task.description}", total) as update:

        def step(text: str, done: int | None = None, of: int = total) -> None:
            nonlocal meter, begun, said
            before = begun if done is None else done
            begun = before + (done is None)
            if of != meter.total or before < meter.done:
                meter = Meter(of, before)
            meter.add(before - meter.done, 0)
            update(description=f"{meter.time_left}: {text}", completed=before, total=of)
            if lines and not err().is_terminal and monotonic() - said >= EVERY:
                said = monotonic()
                print(f"{begun} of {of}{meter.time_left}: {text}", file=sys.stderr, flush=True)

        yield step


@contextmanager
def progress_bar(total: int, done: int, as_json: bool = False) -> "Iterator[Meter]":
    """A meter, shown while the body runs; where stderr is no terminal, or as JSON, by a line every 5 s."""
    from ..run.run_and_resume import Meter

    if as_json or not err().is_terminal:
        yield Meter(total, done, _make_lines(as_json))
        return
    with _bar("{task.completed} of {task.total} cases, {task.description}", total, done) as update:
        yield Meter(
            total, done, lambda meter: update(completed=meter.done, total=meter.total, description=meter.text())
        )


def _make_lines(as_json: bool) -> "Callable[[Meter], None]":
    said = 0.0

    def show(meter: "Meter") -> None:
        nonlocal said
        if meter.seconds - said >= EVERY:
            said = meter.seconds
            line = json.dumps(meter.data()) if as_json else f"{meter.done} of {meter.total} cases, {meter.text()}"
            print(line, file=sys.stderr, flush=True)

    return show
