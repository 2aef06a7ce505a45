"""How far a run is: what is done, how fast, and how long it will take. Who shows it is up to the caller."""

import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Any


class Meter:
    """Counts cases: `done` of `total` are finished. show: called with the meter whenever the count has changed."""

    def __init__(self, total: int, done: int, show: "Callable[[Meter], None]" = lambda meter: None) -> None:
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


Progress = Callable[[int, int], AbstractContextManager[Meter]]  # takes total and done


@contextmanager
def unshown(total: int, done: int) -> Iterator[Meter]:
    """A meter that nobody sees."""
    yield Meter(total, done)


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes // 60}:{minutes % 60:02d}:{rest:02d}"
