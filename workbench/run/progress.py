"""How far a run is: a bar on a terminal, a line now and then elsewhere, a line of JSON where a program reads."""

import json
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from rich.progress import BarColumn, Progress, TextColumn

from ..commands import console

EVERY = 30.0  # seconds between two lines where stderr is no terminal


class Meter:
    """Counts cases; `done` of `total` were there before this run. `show` is called whenever the count has moved."""

    def __init__(self, total: int, done: int, show: "Callable[[Meter], None]") -> None:
        self.total, self.done, self.unsolved = total, done, 0
        self._before, self._began, self._show = done, time.monotonic(), show

    def add(self, cases: int, unsolved: int) -> None:
        """So many more cases are done, of which so many were not solved."""
        self.done += cases
        self.unsolved += unsolved
        self._show(self)

    @property
    def seconds(self) -> float:
        """Since the run began."""
        return time.monotonic() - self._began

    @property
    def rate(self) -> float:
        """Cases a second."""
        return (self.done - self._before) / max(self.seconds, 1e-9)

    @property
    def left(self) -> float | None:
        """Seconds left; None while nothing tells."""
        return (self.total - self.done) / self.rate if self.done > self._before else None

    def text(self) -> str:
        """``310 a second, 0:12:05 left, 2 unsolved``."""
        left = "" if self.left is None else f", {_clock(self.left)} left"
        return f"{self.rate:.3g} a second{left}" + (f", {self.unsolved} unsolved" if self.unsolved else "")

    def data(self) -> dict[str, Any]:
        """The same for programs."""
        told = {"done": self.done, "cases": self.total, "unsolved": self.unsolved}
        return {**told, "per_second": round(self.rate, 1), "seconds_left": self.left and round(self.left, 1)}


@contextmanager
def metered(total: int, done: int, as_json: bool, quiet: bool = False) -> Iterator[Meter]:
    """A meter, shown while it runs; where stderr is no terminal, or for a program, by a line every 30 s.

    quiet: it counts, and nothing is shown.
    """
    if quiet:
        yield Meter(total, done, lambda meter: None)
        return
    if as_json or not console.err().is_terminal:
        yield Meter(total, done, _make_lines(as_json))
        return
    columns = (BarColumn(), TextColumn("{task.completed} of {task.total} cases, {task.description}"))
    with Progress(*columns, console=console.err(), transient=True) as bar:
        task = bar.add_task("starting", total=total, completed=done)
        yield Meter(total, done, lambda meter: bar.update(task, completed=meter.done, description=meter.text()))


def _make_lines(as_json: bool) -> Callable[[Meter], None]:
    said = 0.0

    def show(meter: Meter) -> None:
        nonlocal said
        if meter.seconds - said >= EVERY:
            said = meter.seconds
            line = json.dumps(meter.data()) if as_json else f"{meter.done} of {meter.total} cases, {meter.text()}"
            print(line, file=sys.stderr, flush=True)

    return show


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes // 60}:{minutes % 60:02d}:{rest:02d}"
