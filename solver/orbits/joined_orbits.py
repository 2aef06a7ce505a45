"""Answers joined to one with their orbits, and any dataclasses of arrays: rows of blocks, or of single problems."""

from collections.abc import Iterable, Sequence
from dataclasses import fields, is_dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from ..numerics.arrays import Array
from ..problem.trajectory import Trajectory, where_shown
from .periodic_orbit import Orbit

# a full table grows by this share, and one of panels begins with as much more than its first block promises; without it
# such a table is copied at its last block, and held twice. x10: memory that nothing fills
_MORE = 1 / 8


def join_answers(parts: Iterable[Trajectory], t: Array, share: float) -> Trajectory:
    """The answers to blocks of problems as one, at t (B, n); share: the expected number of blocks.

    A block is moved into the whole answer before the next one is asked for, so that no two are held at once.
    """
    whole, orbits, swirls, cases, panels = Rows(share), Rows(share * (1 + _MORE)), Rows(share), 0, 0
    for part in parts:
        if part.orbit is None:
            swirls.add(part.swirl())
        else:
            orbits.add(_move(part.orbit, cases, panels))
            cases, panels = cases + part.orbit.problem.size, panels + part.orbit.panels.arc.size
        whole.add(replace(part, swirl=None, orbit=None))  # type: ignore[arg-type]
        del part
    answer: Trajectory = whole.join()
    orbit = orbits.join()
    if orbit is None:
        return replace(answer, swirl=partial(np.asarray, swirls.join()))
    shown = np.isfinite(answer.beta)
    return replace(answer, orbit=orbit, swirl=partial(where_shown, shown, orbit.swirl, t))


def alike(orbits: Sequence[Orbit]) -> list[Orbit]:
    """Orbits without those of the fields known of equilibria alone that one of them lacks."""
    names = ("paths", "lengthens", "response")
    unknown: dict[str, Any] = {name: None for name in names if any(getattr(o, name) is None for o in orbits)}
    return [replace(orbit, **unknown) for orbit in orbits]


def _move(orbit: Orbit, cases: int, panels: int) -> Orbit:
    """The orbits renumbered to follow so many cases with so many panels."""
    mesh = replace(orbit.panels, arc=orbit.panels.arc + 2 * cases)
    return replace(orbit, panels=mesh, first=orbit.first + panels)


class Rows:
    """Dataclasses and tuples of arrays, joined to one: each array is a table that grows in place.

    Concatenation would hold all blocks and their union at once. share: the expected number of blocks.
    """

    def __init__(self, share: float) -> None:
        self.share, self.used = share, 0
        self.last: Any = None
        self.table: Any = None
        self.inner: dict[Any, Rows] = {}

    def add(self, value: Any) -> None:
        """Add the next block."""
        self.last = value
        if isinstance(value, np.ndarray):
            self.last = None
            self._append(value)
        for name, part in _parts(value):
            self.inner.setdefault(name, Rows(self.share)).add(part)

    def _append(self, values: Array) -> None:
        if self.table is None:
            self.table = np.empty((int(np.ceil(len(values) * self.share)), *values.shape[1:]), values.dtype)
        end = self.used + len(values)
        if end > len(self.table):  # no other reference to the table exists yet
            self.table.resize((int(end * (1 + _MORE)), *values.shape[1:]), refcheck=False)
        self.table[self.used : end] = values
        self.used = end

    def join(self) -> Any:
        """All blocks as one; a value that is not an array is taken from the last block."""
        if self.table is not None:
            self.table.resize((self.used, *self.table.shape[1:]), refcheck=False)
            return self.table
        parts = {name: rows.join() for name, rows in self.inner.items()}
        if isinstance(self.last, tuple):
            return tuple(parts.values())
        return type(self.last)(**parts) if parts else self.last


def _parts(value: Any) -> list[tuple[Any, Any]]:
    """The parts of a dataclass or a tuple, by name."""
    if is_dataclass(value):
        return [(f.name, getattr(value, f.name)) for f in fields(value)]
    return list(enumerate(value)) if isinstance(value, tuple) else []
