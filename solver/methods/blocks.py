"""Solves many cases a block at a time, to limit memory, and joins the blocks to one answer.

A method that solves all its cases together needs several times the memory of its answer. Here it needs that for one
block only: the rows of a block are moved into the whole answer before the next block is solved.
"""

from dataclasses import fields, is_dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from ..numerics.arrays import Array
from ..orbit.periodic_orbit import Orbit
from ..problem.reduced import StartProblem
from ..problem.trajectory import Trajectory, where_shown
from .base import StartMethod

BLOCK = 2048  # cases: 512 take `orbit` 1.4 times as long; a study's own blocks (`workbench.store.plan`) are no larger
BLOCK_VALUES = 2**20  # stations of all cases of a block, at most: 8 MB an array
_MORE = 1 / 8  # a full table grows by this share


def block_size(stations: int) -> int:
    """Number of cases solved together, for a number of stations."""
    return max(1, min(BLOCK, BLOCK_VALUES // stations))


def run_in_blocks(method: StartMethod, problem: StartProblem, t: Array, tol: float) -> Trajectory:
    """The answer of a method to B start problems at t (B, n), solved in blocks."""
    size, B = block_size(t.shape[1]), problem.size
    if size >= B or not method.blockwise:
        return method.run(problem, t, tol)
    whole, orbits, swirls = _Rows(B / size), _Orbits(B / size), _Rows(B / size)
    for block in (slice(k, k + size) for k in range(0, B, size)):
        part = method.run(problem.take(block), t[block], tol)
        if part.orbit is None:
            swirls.add(part.swirl())
        else:
            orbits.add(part.orbit)
        whole.add(replace(part, swirl=None, orbit=None))  # type: ignore[arg-type]
        del part
    answer: Trajectory = whole.join()
    orbit = orbits.join()
    if orbit is None:
        swirl = swirls.join()
        return replace(answer, swirl=partial(np.asarray, swirl))
    shown = np.isfinite(answer.beta)
    return replace(answer, orbit=orbit, swirl=partial(where_shown, shown, orbit.swirl, t))


class _Orbits:
    """The orbits of blocks, joined to one; None if the method knows none."""

    def __init__(self, share: float) -> None:
        self.cases, self.panels = 0, 0
        self.rows = _Rows(share)

    def add(self, orbit: Orbit) -> None:
        """Add the orbits of the next block."""
        cases, panels = orbit.problem.size, orbit.panels.arc.size
        self.rows.add(_move(orbit, self.cases, self.panels))
        self.cases, self.panels = self.cases + cases, self.panels + panels

    def join(self) -> Any:
        return self.rows.join()


def _move(orbit: Orbit, cases: int, panels: int) -> Orbit:
    """The orbits renumbered to follow so many cases with so many panels."""
    way, mesh = orbit.arcs, orbit.panels
    return replace(
        orbit,
        arcs=replace(way, pieces=replace(way.pieces, arc=way.pieces.arc + 2 * cases)),
        panels=replace(mesh, arc=mesh.arc + 2 * cases),
        first=orbit.first + panels,
    )


class _Rows:
    """Dataclasses and tuples of arrays, joined to one: each array is a table that grows in place.

    Concatenation would hold all blocks and their union at once. share: the expected number of blocks.
    """

    def __init__(self, share: float) -> None:
        self.share, self.used = share, 0
        self.last: Any = None
        self.table: Any = None
        self.inner: dict[Any, _Rows] = {}

    def add(self, value: Any) -> None:
        """Add the next block."""
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
