"""Branches along the lines of a lattice in the plane of two numbers z, in any system whose equilibria can be followed.

Equilibria that are known at a point of the lattice are followed along both lines through it. Those that are met at
other points of the lattice, and those that split off, are followed in turn, until no new one is met.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, Protocol, TypeVar

import numpy as np

from ..numerics.arclength import FOLD
from ..numerics.arrays import Array
from .whole_curve import WholeCurve, lies_on

MOST_BRANCHES = 150  # that are followed
Node = tuple[int, int]
Equilibrium = TypeVar("Equilibrium")


@dataclass(frozen=True, eq=False)
class Stage(Generic[Equilibrium]):
    """A point of a branch over a number x. index: -1 where it is not known. kind: of special point, else ""."""

    x: float
    equilibrium: Equilibrium
    index: int
    kind: str = ""


@dataclass(frozen=True, eq=False)
class Meeting(Generic[Equilibrium]):
    """A special point of a branch along number `axis` of z. stages: the points before, at and after it."""

    z: Array
    axis: int
    stages: tuple[Stage[Equilibrium], Stage[Equilibrium], Stage[Equilibrium]]


class PlaneSystem(Protocol[Equilibrium]):
    """Equilibria over a plane of two numbers z, 0 <= z <= 1, and the ways from one to others."""

    def signature(self, equilibrium: Equilibrium) -> Array:
        """Numbers of about 1 that tell it from others."""
        ...

    def are_same(self, one: Equilibrium, other: Equilibrium) -> bool:
        """Whether two equilibria at one z are one."""
        ...

    def branch(
        self, z: Array, axis: int, equilibrium: Equilibrium, wanted: Array
    ) -> tuple[list[Stage[Equilibrium]], bool] | None:
        """The branch along number `axis` of an equilibrium at z, with points at the wanted values, and whether it is
        whole; None where the equilibrium cannot be followed."""
        ...

    def splits(self, z: Array, axis: int, stage: Stage[Equilibrium]) -> list[tuple[float, Equilibrium]]:
        """Equilibria on the branches that cross one, along number `axis` through z, at a special point: values of that
        number and equilibria there."""
        ...

    def curves(self, meeting: Meeting[Equilibrium], is_known: Callable[[Array, Any], bool]) -> list[WholeCurve] | None:
        """The curves through a special point; None where it should have one and has none.

        is_known: whether z and an equilibrium there lie on a known curve of the same kind.
        """
        ...


@dataclass(frozen=True, eq=False)
class Branches(Generic[Equilibrium]):
    """What is met: different equilibria at the points of the lattice with their index, and special points.

    count, stopped: branches that were followed, and those of them that could not be followed to the border. whole:
    whether every equilibrium was followed.
    """

    known: dict[Node, list[tuple[Equilibrium, int]]]
    meetings: list[Meeting[Equilibrium]]
    count: int
    stopped: int
    whole: bool


def branches_on(
    system: PlaneSystem[Equilibrium], ticks: Array, begin: dict[Node, list[tuple[Equilibrium, int]]]
) -> Branches[Equilibrium]:
    """The branches along the lines z = ticks of a lattice from 0 to 1 that hang together with known equilibria.

    begin: equilibria at points of the lattice, with their indices.
    """
    known: dict[Node, list[tuple[Equilibrium, int]]] = {
        (i, j): [] for i in range(ticks.size) for j in range(ticks.size)
    }
    waiting: list[tuple[Node, int, float, Equilibrium]] = []
    on_lines: dict[tuple[int, int], list[Array]] = {}
    meetings: list[Meeting[Equilibrium]] = []
    wanted, count, stopped = np.concatenate([[0.0], ticks, [1.0]]), 0, 0

    def take(node: Node, equilibrium: Equilibrium, index: int) -> None:
        if not any(system.are_same(other, equilibrium) for other, _ in known[node]):
            known[node].append((equilibrium, index))
            waiting.extend((node, axis, float(ticks[node[axis]]), equilibrium) for axis in (0, 1))

    for node, equilibria in begin.items():
        for equilibrium, index in equilibria:
            take(node, equilibrium, index)
    while waiting and count < MOST_BRANCHES:
        node, axis, x, equilibrium = waiting.pop(0)
        passed = on_lines.setdefault((axis, node[1 - axis]), [])
        if any(lies_on(points, np.append(x, system.signature(equilibrium))) for points in passed):
            continue
        z, count = place_on(ticks[list(node)], axis, x), count + 1
        followed = system.branch(z, axis, equilibrium, wanted)
        if followed is None:
            stopped += 1
            continue
        stages, whole = followed
        stopped += not whole
        passed.append(np.array([np.append(stage.x, system.signature(stage.equilibrium)) for stage in stages]))
        for i, stage in enumerate(stages):
            if stage.kind and 0 < i < len(stages) - 1:
                meetings.append(Meeting(place_on(z, axis, stage.x), axis, (stages[i - 1], stage, stages[i + 1])))
                if stage.kind != FOLD:
                    waiting.extend((node, axis, *split) for split in system.splits(z, axis, stage))
            elif stage.x in ticks:
                k = int(np.flatnonzero(ticks == stage.x)[0])
                take((k, node[1]) if axis == 0 else (node[0], k), stage.equilibrium, stage.index)
    return Branches(known, meetings, count, stopped, not waiting)


def place_on(z: Array, axis: int, x: float) -> Array:
    """A point with another value of one number."""
    there = z.copy()
    there[axis] = x
    return there
