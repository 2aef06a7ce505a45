"""Many cases solved a block at a time and kept as one answer: what is worked on at once stays small.

A method that solves all its cases together needs several times the room of its answer. Here that is bound to the
cases of one block; their rows are moved into the whole answer before the next block is solved.
"""

from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np

from ..numerics.arrays import Array
from ..orbit.marched_orbit import MarchedOrbit
from ..orbit.periodic_orbit import Orbit
from ..problem.reduced import Reduced
from ..problem.trajectory import Trajectory
from .base import Method

BLOCK = 2048  # cases: 512 take `orbit` 1.4 times as long; a study's own blocks (`workbench.run.plan`) are no larger
BLOCK_VALUES = 2**20  # stations of all cases of a block, at most: 8 MB an array
_MORE = 1 / 8  # by how much a table grows that turns out too short


def block_size(stations: int) -> int:
    """Cases solved together, each at so many stations."""
    return max(1, min(BLOCK, BLOCK_VALUES // stations))


def run_in_blocks(method: Method, problem: Reduced, t: Array, tol: float, **knobs: Any) -> Trajectory:
    """The answer of a method to B start problems at t (B, n); each block is solved as if it were alone."""
    size, B = block_size(t.shape[1]), problem.size
    if size >= B:
        return method.run(problem, t, tol, **knobs)
    whole, orbits, swirls = _Rows(B / size), _Orbits(B / size), _Rows(B / size)
    for block in (slice(k, k + size) for k in range(0, B, size)):
        told = method.run(problem.take(block), t[block], tol, **knobs)
        if told.orbit is None:
            swirls.add(told.swirl())
        else:
            orbits.add(told.orbit)
        whole.add(replace(told, swirl=None, orbit=None))  # type: ignore[arg-type]
        del told
    answer: Trajectory = whole.joined()
    orbit = orbits.joined()
    if orbit is None:
        swirl = swirls.joined()
        return replace(answer, swirl=lambda: swirl)
    shown = np.isfinite(answer.beta)
    return replace(answer, orbit=orbit, swirl=lambda: np.where(shown, orbit.swirl(t), np.nan))


class _Orbits:
    """The orbits of blocks, gathered as one: an `Orbit`, a `MarchedOrbit`, or None where the method knows none."""

    def __init__(self, share: float) -> None:
        self.cases, self.panels, self.share = 0, 0, share
        self.rows = _Rows(share)
        self.rest: _Orbits | None = None

    def add(self, orbit: Any) -> None:
        """The orbits of the next block."""
        if isinstance(orbit, MarchedOrbit):
            if orbit.rest is not None:
                self.rest = self.rest or _Orbits(self.share)
                self.rest.add(orbit.rest)
            orbit = replace(orbit, rest=None)
        else:
            cases, panels = orbit.problem.size, orbit.panels.arc.size
            orbit = _moved(orbit, self.cases, self.panels)
            self.cases, self.panels = self.cases + cases, self.panels + panels
        self.rows.add(orbit)

    def joined(self) -> Any:
        orbit = self.rows.joined()
        return orbit if self.rest is None else replace(orbit, rest=self.rest.joined())


def _moved(orbit: Orbit, cases: int, panels: int) -> Orbit:
    """The orbits as they are counted after so many cases, with so many panels, before them."""
    way, own = orbit.arcs, orbit.panels
    return replace(
        orbit,
        arcs=replace(way, pieces=replace(way.pieces, arc=way.pieces.arc + 2 * cases)),
        panels=replace(own, arc=own.arc + 2 * cases),
        first=orbit.first + panels,
    )


class _Rows:
    """Dataclasses and tuples of arrays, gathered as one: each array one table that grows in place.

    Concatenating would hold all blocks and their union at once. share: how many blocks there will be, about.
    """

    def __init__(self, share: float) -> None:
        self.share, self.used = share, 0
        self.last: Any = None
        self.table: Any = None
        self.inner: dict[Any, _Rows] = {}

    def add(self, value: Any) -> None:
        """The next block."""
        self.last = value
        if isinstance(value, np.ndarray):
            self.last = None
            self._append(value)
        for name, part in _parts(value):
            self.inner.setdefault(name, _Rows(self.share)).add(part)

    def _append(self, values: Array) -> None:
        if self.table is None:
            self.table = np.empty((int(np.ceil(len(values) * self.share)), *values.shape[1:]), values.dtype)
        end = self.used + len(values)
        if end > len(self.table):  # nobody else refers to the table yet
            self.table.resize((int(end * (1 + _MORE)), *values.shape[1:]), refcheck=False)
        self.table[self.used : end] = values
        self.used = end

    def joined(self) -> Any:
        """All blocks as one; what is no array is that of the last block."""
        if self.table is not None:
            self.table.resize((self.used, *self.table.shape[1:]), refcheck=False)
            return self.table
        parts = {name: rows.joined() for name, rows in self.inner.items()}
        if isinstance(self.last, tuple):
            return tuple(parts.values())
        return type(self.last)(**parts) if parts else self.last


def _parts(value: Any) -> list[tuple[Any, Any]]:
    """What a dataclass or a tuple holds, by name."""
    if is_dataclass(value):
        return [(f.name, getattr(value, f.name)) for f in fields(value)]
    return list(enumerate(value)) if isinstance(value, tuple) else []
