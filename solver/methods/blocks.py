"""Solves many cases a block at a time, to limit memory, and joins the blocks to one answer.

A method that solves all its cases together needs several times the memory of its answer. Here it needs that for one
block only: the rows of a block are moved into the whole answer before the next block is solved.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from ..numerics.arrays import Array
from ..orbit.joined_orbits import JoinedOrbits, Rows
from ..problem.reduced import StartProblem
from ..problem.trajectory import Trajectory, where_shown
from .base import StartMethod

BLOCK = 2048  # cases: 512 take `orbit` 1.4 times as long; a study's own blocks (`workbench.store.plan`) are no larger
BLOCK_VALUES = 2**20  # stations of all cases of a block, at most: 8 MB an array


def block_size(stations: int) -> int:
    """Number of cases solved together, for a number of stations."""
    return max(1, min(BLOCK, BLOCK_VALUES // stations))


def run_in_blocks(method: StartMethod, problem: StartProblem, t: Array, tol: float) -> Trajectory:
    """The answer of a method to B start problems at t (B, n), solved in blocks."""
    size, B = block_size(t.shape[1]), problem.size
    if size >= B or not method.blockwise:
        return method.run(problem, t, tol)
    whole, orbits, swirls = Rows(B / size), JoinedOrbits(B / size), Rows(B / size)
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
