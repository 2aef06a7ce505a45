"""Fold and pitchfork curves that hang together with known equilibria, by the branches along the lines of a lattice.

Equilibria that are known at a point of the lattice in the plane of two numbers z are followed along both lines through
it, in any system whose equilibria can be followed. Those that are met at other points of the lattice, and those that
split off, are followed in turn, until no new one is met. Where a branch is steep, it may pass two folds closely, on a
curve that no line of the lattice crosses; so it is followed across its line there too.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Protocol

import numpy as np

from ..numerics.arclength import CLOSED, END, FOLD, PITCHFORK
from ..numerics.arrays import ALIKE, Array
from ..orbits.level_search import Census
from .branch_events import Place, Stop
from .fold_curves import FoldCurves, curves_of, said_of_stopped
from .fold_lattice import Searched, lattice_edges
from .parameter_plane import ParameterPlane
from .whole_curve import WholeCurve, lies_on

ASKEW = 0.013  # of a gap: lines of the lattice stay off lines of symmetry, on which folds lie. x10: as good
MOST_BRANCHES = 150  # that are followed. x10: a search that goes on and on takes minutes
# times the median of a branch; places of a branch from which it is followed across. x10: equilibria between lines are
# missed; more places take time
STEEP, MOST_STEEP = 3.0, 2
LatticePoint = tuple[int, int]
Known = dict[LatticePoint, list[Place]]  # equilibria at points of the lattice
IsKnown = Callable[[Array, Array], bool]  # of a z and the signature of an equilibrium there


@dataclass(frozen=True, eq=False)
class Meeting:
    """A special point of a branch along number `axis` of z. places: those before, at and after it."""

    z: Array
    axis: int
    places: tuple[Place, Place, Place]


class PlaneSystem(Protocol):
    """Equilibria over a plane of two numbers z, 0 <= z <= 1, and the ways from one to others."""

    def signature(self, place: Place) -> Array:
        """Numbers of about 1 that tell an equilibrium from others."""
        ...

    def branch(self, z: Array, axis: int, place: Place, wanted: Array) -> tuple[list[Place], int, Stop, Stop] | str:
        """The branch along number `axis`, its parameter, of an equilibrium at z, with places at the wanted values, as
        of `both_ways`; or why it cannot be followed."""
        ...

    def splits(self, z: Array, axis: int, place: Place) -> list[Place]:
        """Equilibria on the branches that cross one, along number `axis` through z, at a special point."""
        ...

    def curves(self, meeting: Meeting, is_known: IsKnown) -> list[WholeCurve] | None:
        """The curves through a special point; None where it should have one and has none.

        is_known: whether an equilibrium lies on a known curve of the same kind.
        """
        ...


@dataclass(frozen=True, eq=False)
class _Branches:
    """What is met: different equilibria at the points of the lattice, and special points.

    known: with their signatures. count, stopped: branches that were followed, and those of them that could not be
    followed to the border. whole: whether every equilibrium was followed.
    """

    known: dict[LatticePoint, list[tuple[Array, Place]]]
    meetings: list[Meeting]
    count: int
    stopped: int
    whole: bool


def lattice_ticks(lattice: int) -> Array:
    """The values of z along both numbers at which the lines of a lattice lie."""
    return np.linspace(0, 1, lattice + 2)[1:-1] + ASKEW / lattice


def search_linked(plane: ParameterPlane, system: PlaneSystem, ticks: Array, begin: Known) -> FoldCurves:
    """The curves that branches along the lines z = ticks of a lattice meet, from known equilibria on."""
    branches, searched, failed = branches_on(system, ticks, begin), Searched(plane), 0
    for meeting in branches.meetings:
        place = meeting.places[1]
        is_known = partial(searched.holds, FOLD if place.kind == FOLD else PITCHFORK)
        if is_known(meeting.z, system.signature(place)):
            continue
        through = system.curves(meeting, is_known)
        failed += through is None
        searched.add(through or [])
    for (i, j), known in branches.known.items():
        index = np.array([-1 if place.index is None else place.index for _, place in known], dtype=np.int64)
        unknown = np.full(index.size, np.nan)
        searched.counted[float(ticks[i]), float(ticks[j])] = Census(unknown, index, unknown, unknown, unknown, False)
    return curves_of(searched, remark_of(searched, branches, failed, ticks))


def branches_on(system: PlaneSystem, ticks: Array, begin: Known) -> _Branches:
    """The branches along the lines z = ticks of a lattice from 0 to 1 that hang together with known equilibria."""
    known: dict[LatticePoint, list[tuple[Array, Place]]] = {
        (i, j): [] for i in range(ticks.size) for j in range(ticks.size)
    }
    at_tick = {float(tick): i for i, tick in enumerate(ticks)}
    waiting: list[tuple[Array, int, Place, Array]] = []
    on_lines: dict[tuple[int, float], list[Array]] = {}
    meetings: list[Meeting] = []
    halts, count, stopped = np.concatenate([[0.0], ticks, [1.0]]), 0, 0

    def take(z: Array, place: Place, mark: Array) -> None:
        node = at_tick[float(z[0])], at_tick[float(z[1])]
        if all(np.linalg.norm(other - mark) > ALIKE for other, _ in known[node]):
            known[node].append((mark, place))
            waiting.extend((z, axis, replace(place, p=float(z[axis])), mark) for axis in (0, 1))

    for node, places in begin.items():
        for place in places:
            take(ticks[list(node)], place, system.signature(place))
    while waiting and count < MOST_BRANCHES:
        z, axis, begun, mark = waiting.pop(0)
        passed = on_lines.setdefault((axis, float(z[1 - axis])), [])
        if any(lies_on(points, np.append(begun.p, mark)) for points in passed):
            continue
        z, count = place_on(z, axis, begun.p), count + 1
        followed = system.branch(z, axis, begun, halts)
        if isinstance(followed, str):
            stopped += 1
            continue
        places, _, *stops = followed
        stopped += any(stop.reason not in (END, CLOSED) for stop in stops)
        marks = [system.signature(place) for place in places]
        passed.append(np.column_stack([[place.p for place in places], marks]))
        on_lattice = float(z[1 - axis]) in at_tick
        for i, (place, mark) in enumerate(zip(places, marks, strict=True)):
            z_of_place = place_on(z, axis, place.p)
            if place.kind and 0 < i < len(places) - 1:
                meetings.append(Meeting(z_of_place, axis, (places[i - 1], place, places[i + 1])))
                if place.kind != FOLD:
                    splits = system.splits(z, axis, place)
                    waiting.extend((z, axis, split, system.signature(split)) for split in splits)
            elif on_lattice and float(place.p) in at_tick:
                take(z_of_place, place, mark)
        for i in steep_places(places, marks) if on_lattice else ():
            steep = place_on(z, axis, places[i].p)
            waiting.append((steep, 1 - axis, replace(places[i], p=float(steep[1 - axis])), marks[i]))
    return _Branches(known, meetings, count, stopped, not waiting)


def steep_places(places: Sequence[Place], marks: Sequence[Array]) -> list[int]:
    """The numbers of the places where a branch is steepest: its equilibria change the most by its parameter, though it
    does not turn back nearby."""
    p, plain = np.array([place.p for place in places]), [not place.kind for place in places]
    with np.errstate(divide="ignore", invalid="ignore"):
        rates = np.linalg.norm(np.diff(marks, axis=0), axis=1) / np.abs(np.diff(p))
    inside = [
        i
        for i in range(1, rates.size - 1)
        if all(plain[i - 1 : i + 3]) and np.argmax(rates[i - 1 : i + 2]) == 1 and rates[i] > STEEP * np.median(rates)
    ]
    return sorted(inside, key=lambda i: -float(rates[i]))[:MOST_STEEP]


def place_on(z: Array, axis: int, x: float) -> Array:
    """A point with another value of one number."""
    place = z.copy()
    place[axis] = x
    return place


def remark_of(searched: Searched, branches: _Branches, failed: int, ticks: Array) -> str:
    """What is known of the search, which nothing proves complete."""
    said = [f"not proved complete: {branches.count} branches along {2 * ticks.size} lines were followed"]
    if branches.stopped:
        said.append(f"{branches.stopped} of them could not be followed to the border")
    if not branches.whole:
        said.append("more were met and not followed")
    said += said_of_stopped(searched)
    if failed:
        said.append(f"of {failed} points where branches meet no curve was found")
    edges = lattice_edges(ticks, ticks)
    unlike = sum(bool(searched.change_beyond(*edge)) for edge in edges)
    if unlike:
        said.append(f"on {unlike} of {len(edges)} pieces of these lines the equilibria do not fit the curves")
    return "; ".join(said)
