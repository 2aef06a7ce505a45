"""Orbits joined to one, and any dataclasses of arrays: rows of blocks, or of single problems."""

from collections.abc import Sequence
from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np

from ..numerics.arrays import Array
from .periodic_orbit import Orbit

_MORE = 1 / 8  # a full table grows by this share


class JoinedOrbits:
    """The orbits of blocks, joined to one; None if there are none. share: the expected number of blocks."""

    def __init__(self, share: float) -> None:
        self.cases, self.panels = 0, 0
        self.rows = Rows(share)

    def add(self, orbit: Orbit) -> None:
        """Add the orbits of the next block."""
        cases, panels = orbit.problem.size, orbit.panels.arc.size
        self.rows.add(_move(orbit, self.cases, self.panels))
        self.cases, self.panels = self.cases + cases, self.panels + panels

    def join(self) -> Any:
        return self.rows.join()


def join_orbits(orbits: Sequence[Orbit]) -> Orbit:
    """Orbits as one, without paths; of what is known of equilibria alone it has what all of them have."""
    names = ("lengthens", "response", "passed")
    unknown: dict[str, Any] = {name: None for name in names if any(getattr(o, name) is None for o in orbits)}
    joined = JoinedOrbits(len(orbits))
    for orbit in orbits:
        joined.add(replace(orbit, path=None, **unknown))
    whole: Orbit = joined.join()
    return whole


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
