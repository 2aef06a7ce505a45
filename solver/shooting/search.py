"""Equilibria of one rod with weight that a search finds: never all of them, as nothing proves a list complete."""

from dataclasses import dataclass, replace

import numpy as np

from ..core.varying_loads import march
from ..numerics.arrays import Array, Booleans
from .branch import branch_from_straight, straight_shape
from .descent import index_at, on_nodes, weakest_modes
from .loaded_rod import ALPHA, BETA, MU, PHI, SPEED, LoadedRod, Q
from .newton import Shape, correct, is_same

LONGEST = 10.0  # radii: a longer rod is not scanned, as its far end depends too much on its start
CELLS = 120, 80  # of the scan, over beta_t(0) or beta(0) and over q(0)
ROUNDS, AMPLITUDES = 3, (0.1, 0.3, 1.0)  # of the search along the weakest modes
WIDE = 5  # times the largest load: the range of a reaction
STRAIGHT, MODES, SCAN = "the branch of the straight rod", "weakest modes", "scan of the start"


@dataclass(frozen=True, eq=False)
class Found:
    """shapes: different ones. index, how: of each. scanned: ranges of the scan in units of rho, None without one."""

    shapes: list[Shape]
    index: list[int]
    how: list[str]
    scanned: tuple[tuple[float, float], tuple[float, float]] | None

    def add(self, shape: Shape | None, how: str) -> None:
        """Take a shape that is not there yet."""
        if shape is None or any(is_same(shape, one) for one in self.shapes):
            return
        self.shapes.append(shape)
        self.index.append(index_at(shape))
        self.how.append(how)


def search(rod: LoadedRod) -> Found:
    """The equilibria that are found from the straight rod, along weakest modes, and of a short rod by a scan."""
    t = rod.nodes()
    scanned = ranges(rod) if rod.span <= LONGEST else None
    found = Found([], [], [], scanned)
    if rod.straight:
        found.add(straight_shape(rod, t), STRAIGHT)
    begun = branch_from_straight(rod)
    if begun.shape is not None:
        found.add(on_nodes(begun.shape, t), STRAIGHT)
    if scanned is not None:
        for y in starts(rod, t, *scanned):
            found.add(correct(Shape(rod, t, y), reach=1.0, most=15), SCAN)
    done = 0
    for _ in range(ROUNDS):
        known, done = found.shapes[done:], len(found.shapes)
        for shape in known:
            for mode in weakest_modes(shape, 2):
                for size in AMPLITUDES:
                    for sign in (1, -1):
                        guess = replace(shape, y=shape.y + sign * size * mode)
                        found.add(correct(guess, reach=1.0, most=15), MODES)
    return found


def ranges(rod: LoadedRod) -> tuple[tuple[float, float], tuple[float, float]]:
    """The ranges of beta_t(0), or beta(0) where a hinge leaves it open, and of q(0)."""
    size = float(rod.rate(np.array([0.0, rod.span])).max())
    known = 0.0 if "azimuth" in rod.held else float(rod.far[1] - rod.far[3])
    wide = WIDE * size**2 if "azimuth" in rod.held else 0.05 + abs(rod.across) * rod.span
    if "beta0" in rod.held:
        first = -4 * size - np.pi, 4 * size + np.pi
    elif "betaL" in rod.held:
        first = float(rod.far[0]) - 2 * np.pi, float(rod.far[0]) + 2 * np.pi
    else:
        first = -np.pi, np.pi
    return first, (known - wide, known + wide)


def starts(rod: LoadedRod, t: Array, first: tuple[float, float], second: tuple[float, float]) -> list[Array]:
    """States at the nodes (N, 8) of rods marched from the cells of the scan whose degree is not 0."""
    a, b = (np.linspace(*ends, n + 1) for ends, n in zip((first, second), CELLS, strict=True))
    begin = _begin(rod, *(grid.reshape(-1) for grid in np.meshgrid(a, b, indexing="ij")))
    end = march(rod.numbers, rod.scale, begin, np.full(len(begin), rod.span)).end
    _, _, rows, values = rod.conditions()
    open_ = (end @ rows[:2].T - values[:2]).reshape(a.size, b.size, 2)
    i, j = np.nonzero(_wound(open_ / rod.scale[[BETA, ALPHA]]))
    middle = _begin(rod, (a[i] + a[i + 1]) / 2, (b[j] + b[j + 1]) / 2)
    count = t.size
    read = march(
        rod.numbers, rod.scale, middle, np.full(i.size, rod.span),
        first=count * np.arange(i.size + 1), stations=np.tile(t, i.size),
    )  # fmt: skip
    return [y for y in read.out.reshape(i.size, count, -1) if np.isfinite(y).all()]


def _begin(rod: LoadedRod, first: Array, q: Array) -> Array:
    y = np.zeros((first.size, rod.scale.size))
    y[:, BETA], y[:, SPEED] = (rod.near[0], first) if "beta0" in rod.held else (first, rod.near[0])
    y[:, ALPHA], y[:, Q], y[:, MU] = rod.near[1], q, rod.far[3]
    y[:, PHI] = rod.far[2] - rod.along * rod.span
    return y


def _wound(open_: Array) -> Booleans:
    """The cells round whose corners the two numbers turn about 0."""
    angle = np.arctan2(open_[..., 0], open_[..., 1])
    corners = np.stack([angle[:-1, :-1], angle[1:, :-1], angle[1:, 1:], angle[:-1, 1:]])
    turns = np.roll(corners, -1, axis=0) - corners
    turns -= 2 * np.pi * np.round(turns / (2 * np.pi))
    return np.asarray(np.abs(turns.sum(axis=0)) > 1)
