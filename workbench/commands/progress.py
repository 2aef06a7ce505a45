"""The progress of a run: a bar on a terminal, a line every 30 s elsewhere, a line of JSON for a program."""

import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from . import console

if TYPE_CHECKING:
    from ..run.progress import Meter

EVERY = 30.0  # seconds between two lines where stderr is no terminal


@contextmanager
def progress_bar(total: int, done: int, as_json: bool = False) -> "Iterator[Meter]":
    """A meter, shown while the body runs; where stderr is no terminal, or as JSON, by a line every 30 s."""
    from rich.progress import BarColumn, Progress, TextColumn

    from ..run.progress import Meter

    if as_json or not console.err().is_terminal:
        yield Meter(total, done, _make_lines(as_json))
        return
    columns = (BarColumn(), TextColumn("{task.completed} of {task.total} cases, {task.description}"))
    with Progress(*columns, console=console.err(), transient=True) as bar:
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
        if meter.seconds - said >= EVERY:
            said = meter.seconds
            line = json.dumps(meter.data()) if as_json else f"{meter.done} of {meter.total} cases, {meter.text()}"
            print(line, file=sys.stderr, flush=True)

    return show
