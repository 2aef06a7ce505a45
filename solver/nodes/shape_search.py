"""Equilibria of one rod with weight that a search finds: never all of them, as nothing proves a list complete."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any

import numpy as np

from ..branches.branch_events import Bounds
from ..core.weight_friction import march
from ..numerics.arclength import FEW_POINTS
from ..numerics.arrays import Array, Booleans, whole_turns
from .banded_newton import change_of_marks, correct, deflate, is_same, marks_of, within_a_turn
from .buckling import shares_of_buckling, straight_shape
from .loaded_rod import ALPHA, BETA, SHORT, SPEED, LoadedRod, Q
from .node_branch import SPLIT, NodeCurve, trace_shapes
from .shape_index import index_at, on_nodes
from .straight_branch import branch_from_straight
from .varying_shapes import Shape
from .vertical_scan import begin_at, every_start, states_from
from .weak_modes import weakest_modes


@dataclass(frozen=True)
class _Grid:
    """The starts of a scan: of rods of at most `longest` radii, over so many cells of beta_t(0) or beta(0) and of q(0),
    whose range is so many times as wide as the largest load."""

    longest: float
    cells: tuple[int, int]
    wide: int


@dataclass(frozen=True)
class _Attempts:
    """A search by deflation, which ends after so many tries in a row that find none; few of a long rod.

    reach: the longest step of the angles, in their scales. waves: in a start; amplitudes: the powers of ten between
    which theirs lie; around: their azimuths over their angles. from_known: share of starts from known shapes.
    """

    tries: int
    few: int
    reach: float
    waves: int
    amplitudes: tuple[float, float]
    around: float
    from_known: float


GRID = _Grid(
    longest=25.0,  # beyond, the far end depends too much on the start. x10: cells whose far ends are noise
    # the seconds grow with their product. Beyond 10 radii these find 231 of the 296 equilibria of ten rods that four
    # times as many find. x10: a hundred times the time
    cells=(120, 80),
    wide=5,  # x10: coarser cells, which miss equilibria
)
_ATTEMPTS = _Attempts(
    tries=60,  # x10: no more equilibria of a rod of 3 radii with weight, in three times the time
    few=10,  # of a long rod. x10: only time
    reach=1.0,  # x10: a step leaps out of the range where shapes are
    waves=4,  # x10: waves too short for low equilibria
    amplitudes=(-1.0, 0.9),  # x10: none is near a shape
    around=0.3,  # x10: azimuths beyond those of the loads
    from_known=0.7,  # x10: no start from the straight rod
)
HEAVIEST = 2.0  # times the weight: how far a branch is followed from no weight, as some turn back on the way. x10: time
MOST_NODES = 100  # of a rod that is followed from no weight. x10: only time
MOST_MODES = 8  # of the straight rod, whose branches are followed. x10: time, for unstable shapes of many waves
STRAIGHT, DEFLATION, SCAN = "the branch of the straight rod", "deflation", "scan of the start"


@dataclass(frozen=True, eq=False)
class FoundShapes:
    """shapes: different ones. index, how: of each. scanned: ranges of the scan in units of rho, None without one."""

    shapes: list[Shape]
    index: list[int]
    how: list[str]
    scanned: tuple[tuple[float, float], tuple[float, float]] | None

    def add(self, shape: Shape | None, how: str) -> None:
        """Take a shape that is not there yet."""
        if shape is None or any(is_same(shape, known) for known in self.shapes):
            return
        self.shapes.append(within_a_turn(shape))
        self.index.append(index_at(shape))
        self.how.append(how)


def scan_one_unknown(rod: LoadedRod) -> tuple[FoundShapes, bool]:
    """The equilibria of a vertical rod by a scan of the one number of its start, and whether they are all.

    They are where the scan resolves the far end, each of its starts leads to another shape, and (-1)^index adds up to
    1, or between two hinges, where the starts lie on a circle, to 0.
    """
    t = rod.nodes()
    result = FoundShapes([], [], [], None)
    if rod.straight:
        result.add(straight_shape(rod, t), STRAIGHT)
    begin, resolved = every_start(rod)
    for y in _states_at(rod, t, begin):
        result.add(correct(Shape(rod, t, y), most=15), SCAN)
    degree = sum((-1) ** index for index in result.index)
    return result, resolved and len(result.shapes) == len(begin) and degree == (0 if rod.turns_freely else 1)


def search_shapes(rod: LoadedRod, light: Sequence[Any] = (), known: FoundShapes | None = None) -> FoundShapes:
    """The equilibria found from the straight rod, from those without weight, by a scan and by deflation.

    light: solutions of the rod without weight. known: what is found already. A long rod is not scanned.
    """
    t = rod.nodes()
    scanned = ranges(rod) if rod.span <= GRID.longest and known is None else None
    result = FoundShapes([], [], [], scanned) if known is None else known
    if rod.straight:
        result.add(straight_shape(rod, t), STRAIGHT)
    begun = branch_from_straight(rod)
    if begun.shape is not None:
        result.add(on_nodes(begun.shape, t), STRAIGHT)
    for shape in shapes_of_buckling(rod, t):
        result.add(shape, "a buckling load of the straight rod")
    for shape in shapes_from_no_weight(rod, t, light):
        result.add(shape, "growth of the weight")
    if scanned is not None:
        for y in starts(rod, t, *scanned):
            result.add(correct(Shape(rod, t, y), most=15), SCAN)
    for shape in further_shapes(rod, t, result.shapes, _ATTEMPTS.tries if t.size <= MOST_NODES else _ATTEMPTS.few):
        result.add(shape, DEFLATION)
    return result


def shapes_from_no_weight(rod: LoadedRod, t: Array, light: Sequence[Any]) -> Iterator[Shape]:
    """The shapes at the weight of a rod on the branches of its equilibria without weight, at nodes t."""
    curve = NodeCurve(rod.with_weight, 1.0, rod.scale)
    seen: list[Shape] = []  # other ends of branches that come back to no weight
    for solution in light:
        first = curve.begin(light_shape(rod, t, solution), 0.0)
        if first is None or any(is_same(first.shape, known) for known in seen):
            continue
        places, _ = trace_shapes(curve, first, True, Bounds(0.0, HEAVIEST, (1.0,), FEW_POINTS))
        seen += [place.path for place in places if place.p == 0]
        yield from (replace(place.path, rod=rod) for place in places if place.p == 1)


def light_shape(rod: LoadedRod, t: Array, solution: Any) -> Shape:
    """A solution of the rod without weight, at nodes t."""
    y, rho, at = rod.with_weight(0.0).straight_states(t), solution.case.rho, solution.s / solution.case.rho
    y[:, Q] = rod.far[1] - rod.far[3]
    for column, values in ((BETA, solution.beta), (SPEED, solution.dbeta * rho), (ALPHA, solution.alpha)):
        y[:, column] = np.interp(t, at, values)
    y[:, ALPHA] += rod.near[1] - y[0, ALPHA]
    y[:, SHORT] = t - np.interp(t, at, solution.z / rho)
    return Shape(rod.with_weight(0.0), t, y)


def shapes_of_buckling(rod: LoadedRod, t: Array) -> Iterator[Shape]:
    """The shapes on the branches that leave the straight rod at its lowest buckling loads, and their mirror images."""
    if not rod.straight:
        return
    straight = straight_shape(rod, t)
    curve = NodeCurve(rod.share, 1.0, rod.scale)
    for share, count in islice(shares_of_buckling(rod, t), MOST_MODES):
        at_load = straight_shape(rod.share(share), t)
        for mode in weakest_modes(at_load, count):
            for point in curve.split_off(at_load, mode, (SPLIT,), share):
                rises = point.rises >= 0
                places, _ = trace_shapes(curve, point, rises, Bounds(0.0, 1.0, (), FEW_POINTS))
                for shape in (replace(place.path, rod=rod) for place in places if place.p == 1):
                    yield shape
                    mirror = correct(replace(shape, y=2 * straight.y - shape.y), most=15)
                    if mirror is not None:
                        yield mirror


def ranges(rod: LoadedRod) -> tuple[tuple[float, float], tuple[float, float]]:
    """The ranges of beta_t(0), or beta(0) where a hinge leaves it open, and of q(0)."""
    size = float(rod.rate(np.array([0.0, rod.span])).max())
    known = 0.0 if "azimuth" in rod.held else float(rod.far[1] - rod.far[3])
    wide = GRID.wide * size**2 if "azimuth" in rod.held else 0.05 + abs(rod.across) * rod.span
    if "beta0" in rod.held:
        first = -4 * size - np.pi, 4 * size + np.pi
    elif "betaL" in rod.held:
        first = float(rod.far[0]) - 2 * np.pi, float(rod.far[0]) + 2 * np.pi
    else:
        first = -np.pi, np.pi
    return first, (known - wide, known + wide)


def starts(rod: LoadedRod, t: Array, first: tuple[float, float], second: tuple[float, float]) -> list[Array]:
    """States at the nodes (N, 8) of rods marched from the cells of the scan whose degree is not 0."""
    a, b = (np.linspace(*ends, n + 1) for ends, n in zip((first, second), GRID.cells, strict=True))
    begin = begin_at(rod, *(grid.reshape(-1) for grid in np.meshgrid(a, b, indexing="ij")))
    end = march(rod.numbers, rod.scale, begin, np.full(len(begin), rod.span)).end
    _, _, rows, values = rod.conditions()
    open_ = (end @ rows[:2].T - values[:2]).reshape(a.size, b.size, 2)
    i, j = np.nonzero(_wound(open_ / rod.scale[[BETA, ALPHA]]))
    return _states_at(rod, t, begin_at(rod, (a[i] + a[i + 1]) / 2, (b[j] + b[j + 1]) / 2))


def _states_at(rod: LoadedRod, t: Array, begin: Array) -> list[Array]:
    """The states at the nodes t of rods that begin with these, (N, 8); those that stay finite."""
    return [y for y in states_from(rod, begin, t) if np.isfinite(y).all()]


def _wound(open_: Array) -> Booleans:
    """The cells round whose corners the two numbers turn about 0."""
    angle = np.arctan2(open_[..., 0], open_[..., 1])
    corners = np.stack([angle[:-1, :-1], angle[1:, :-1], angle[1:, 1:], angle[:-1, 1:]])
    turns = np.roll(corners, -1, axis=0) - corners
    turns -= whole_turns(turns)
    return np.asarray(np.abs(turns.sum(axis=0)) > 1)


def another_shape(start: Shape, known: list[Shape]) -> Shape | None:
    """An equilibrium that is none of the known ones; None where the steps from a shape lead to none."""
    shape = deflate(start, [marks_of(other) for other in known], marks_of, change_of_marks, _ATTEMPTS.reach)
    return None if shape is None or any(is_same(shape, other) for other in known) else shape


def further_shapes(rod: LoadedRod, t: Array, known: list[Shape], tries: int) -> Iterator[Shape]:
    """Further equilibria on nodes t, until so many tries in a row find none.

    known: grows by what the caller takes of them.
    """
    rng, fruitless = np.random.default_rng(0), 0
    waves = _ATTEMPTS.waves
    wave = np.pi * np.outer(t / rod.span, np.arange(1, waves + 1))
    while fruitless < tries:
        from_known = known and rng.random() < _ATTEMPTS.from_known
        y = known[rng.integers(len(known))].y.copy() if from_known else rod.straight_states(t)
        size = 10 ** rng.uniform(*_ATTEMPTS.amplitudes)
        turned, moved = rng.normal(size=(2, waves)) / np.arange(1, waves + 1)
        y[:, BETA] += size * rod.scale[BETA] * (np.sin(wave + rng.uniform(0, np.pi, waves)) @ turned)
        y[:, ALPHA] += _ATTEMPTS.around * size * (np.sin(wave) @ moved)
        shape = another_shape(Shape(rod, t, y), known)
        fruitless = fruitless + 1 if shape is None else 0
        if shape is not None:
            yield shape
