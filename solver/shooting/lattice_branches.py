"""Branches of rods whose loads vary along them, along the lines of a lattice in the plane of two numbers z.

Equilibria that are known at a point of the lattice are followed along both lines through it. Those that are met at
other points of the lattice, and those that split off, are followed in turn, until no new one is met.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..folds.fold_search import lies_on
from ..numerics.arclength import CLOSED, END, FOLD
from ..numerics.arrays import Array
from .curve import Curve, Point
from .descent import index_at, weakest_modes
from .following import Stage, both_ways
from .further_shapes import angles_of
from .loaded_rod import LoadedRod
from .newton import Shape, is_same

MOST_POINTS, MOST_BRANCHES = 150, 150  # of a branch in each sense; that are followed
NARROW = 0.01  # of a step: how closely a branch point is enclosed, before its curve is solved for
SPLIT = 0.05  # of the angles, in their scales: how far from a branch those that cross it are entered
Node = tuple[int, int]


@dataclass(frozen=True, eq=False)
class Known:
    """An equilibrium at a point of a lattice."""

    shape: Shape
    index: int


@dataclass(frozen=True, eq=False)
class Meeting:
    """A special point of a branch along number `axis` of z. stages: the points before, at and after it."""

    z: Array
    axis: int
    stages: tuple[Stage, Stage, Stage]


@dataclass(frozen=True, eq=False)
class Branches:
    """What is met: different equilibria at the points of the lattice, and special points.

    count, stopped: branches that were followed, and those of them that could not be followed to the border. whole:
    whether every equilibrium was followed.
    """

    known: dict[Node, list[Known]]
    meetings: list[Meeting]
    count: int
    stopped: int
    whole: bool


def branches_on(
    rod_at: Callable[[Array], LoadedRod], ticks: Array, scale: Array, begin: dict[Node, list[Shape]]
) -> Branches:
    """The branches along the lines z = ticks of a lattice from 0 to 1 that hang together with known equilibria.

    begin: equilibria at points of the lattice, on nodes of equal shares of the spans. scale: (8,), of all states.
    """
    known: dict[Node, list[Known]] = {(i, j): [] for i in range(ticks.size) for j in range(ticks.size)}
    waiting: list[tuple[Node, int, float, Shape]] = []
    on_lines: dict[tuple[int, int], list[Array]] = {}
    meetings: list[Meeting] = []
    wanted, count, stopped = np.concatenate([[0.0], ticks, [1.0]]), 0, 0

    def take(node: Node, shape: Shape, index: int) -> None:
        if not any(is_same(one.shape, shape) for one in known[node]):
            known[node].append(Known(shape, index))
            waiting.extend((node, axis, float(ticks[node[axis]]), shape) for axis in (0, 1))

    for node, shapes in begin.items():
        for shape in shapes:
            take(node, shape, index_at(shape))
    while waiting and count < MOST_BRANCHES:
        node, axis, x, shape = waiting.pop(0)
        passed = on_lines.setdefault((axis, node[1 - axis]), [])
        if any(lies_on(points, np.append(x, angles_of(shape))) for points in passed):
            continue
        z, count = ticks[list(node)], count + 1
        curve = line(rod_at, z, axis, scale)
        found = both_ways(curve, shape, x, 0.0, 1.0, wanted, MOST_POINTS, NARROW)
        if found is None:
            stopped += 1
            continue
        stages, _, *why = found
        stopped += any(one not in (END, CLOSED) for one in why)
        passed.append(np.array([np.append(stage.x, angles_of(stage.point.shape)) for stage in stages]))
        for i, stage in enumerate(stages):
            if stage.kind and 0 < i < len(stages) - 1:
                meetings.append(Meeting(at(z, axis, stage.x), axis, (stages[i - 1], stage, stages[i + 1])))
                if stage.kind != FOLD:
                    waiting.extend((node, axis, split.x, split.shape) for split in split_points(curve, stage))
            elif stage.x in ticks:
                k = int(np.flatnonzero(ticks == stage.x)[0])
                take((k, node[1]) if axis == 0 else (node[0], k), stage.point.shape, stage.index)
    return Branches(known, meetings, count, stopped, not waiting)


def split_points(curve: Curve, stage: Stage) -> list[Point]:
    """Points on the branches that cross a branch at a place where it loses stability along a mode."""
    shape, x = stage.point.shape, stage.x
    mode = weakest_modes(shape)[0]
    across = curve.direction(mode, 0.0)
    found = (curve.correct(replace(shape, y=shape.y + sign * SPLIT * mode), x, across) for sign in (1, -1))
    return [one for one in found if one is not None and 0 < one.x < 1]


def line(rod_at: Callable[[Array], LoadedRod], z: Array, axis: int, scale: Array) -> Curve:
    """The equilibria along number `axis` of z through a point."""
    return Curve(lambda x: rod_at(at(z, axis, x)), 1.0, scale)


def at(z: Array, axis: int, x: float) -> Array:
    """A point with another value of one number."""
    there = z.copy()
    there[axis] = x
    return there
