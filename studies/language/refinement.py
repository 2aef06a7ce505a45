"""Refinement: cells of a lattice are halved where their corners disagree, round by round.

The cells begin as those of the coarse grid. A cell is halved along every axis if the numbers of its corners disagree,
or if those along one of its faces do, as the smaller cells beyond the face show: so a boundary is followed into the
next cell. Each round halves the largest of these cells, until none is left that is larger than the tolerance, or until
the budget is spent. The rounds follow from the numbers alone.
"""

from dataclasses import dataclass, field
from itertools import product

import numpy as np
from numpy.typing import NDArray

from .lattice import Lattice, Lines, Places, Values

TOLERANCE, BUDGET = "tolerance", "budget"  # what ends a refinement

Mask = NDArray[np.bool_]


def disagree(numbers: Values, steps: Values) -> Mask:
    """Whether numbers, (cells, corners, watched), differ by more than the step of any; NaN agrees with all."""
    spread = np.fmax.reduce(numbers, axis=1) - np.fmin.reduce(numbers, axis=1)
    differ: Mask = (spread > steps).any(axis=-1)
    return differ


@dataclass(eq=False)
class Refinement:
    """The cases of a refined study so far, and its cells.

    steps: of each watched number, the change from which its cases disagree, (watched,). budget: the most cases. lines:
    of the laws that are watched. places: of all cases in the order in which they are solved, (cases, axes). numbers: of
    those that are solved, (cases, watched). cells: level -> the lowest places of its cells, (cells, axes). ended: ""
    while it goes on, then `TOLERANCE` or `BUDGET`.
    """

    lattice: Lattice
    steps: Values
    budget: int
    lines: tuple[Lines, ...] = ()
    places: Places = field(init=False)
    numbers: Values = field(init=False)
    cells: list[Places] = field(init=False)
    ended: str = ""
    rounds: int = 0

    def __post_init__(self) -> None:
        self.places = self.lattice.coarse()
        self.numbers = np.empty((0, self.steps.size))
        below = np.meshgrid(*(np.arange(size - 1) << self.lattice.depth for size in self.lattice.shape), indexing="ij")
        first = np.stack([row.ravel() for row in below], axis=1)
        for line in self.lines:
            line.at = np.arange(self.lattice.shape[1 - line.along]) << self.lattice.depth
        self.cells = [first, *(first[:0] for _ in range(self.lattice.depth))]

    @property
    def wanted(self) -> int:
        """How many cases are to be solved next; 0 at the end."""
        return len(self.places) - len(self.numbers)

    def take(self, numbers: Values) -> None:
        """Take the watched numbers of the wanted cases, (cases, watched), and find the cases of the next round."""
        assert len(numbers) == self.wanted
        self.numbers = np.concatenate([self.numbers, numbers])
        self._judge()
        while not self.ended and not self.wanted:
            self._halve()

    def corners(self, level: int, cells: Places | None = None) -> Places:
        """The indices of the cases at the corners of the cells of a level, (cells, corners)."""
        lowest = self.cells[level] if cells is None else cells
        return self._cases(lowest[:, None, :] + self._offsets() * self.size(level))

    def size(self, level: int) -> int:
        """Places from corner to corner of a cell of a level."""
        return 1 << (self.lattice.depth - level)

    def open_cells(self) -> list[int]:
        """How many cells of each level are still to be halved."""
        return [int(mask.sum()) for mask in self._mark()]

    def open_lines(self) -> int:
        """How many gaps between lines of different verdicts are wider than the tolerance."""
        return sum(int((upper - lower > 1).sum()) for line in self.lines for lower, upper in [line.gaps()])

    def edges(self) -> tuple[Places, Places]:
        """Pairs of neighbouring cases: their indices, (pairs, 2), the lower first, and the axis of each, (pairs,)."""
        offsets = self._offsets()
        parts: list[Places] = []
        for axis in range(offsets.shape[1]):
            low = np.flatnonzero(offsets[:, axis] == 0)
            high = [int(np.flatnonzero((offsets == offsets[k] + np.eye(offsets.shape[1], dtype=int)[axis]).all(1))[0])
                    for k in low]  # fmt: skip
            for level in range(self.lattice.depth + 1):
                pairs = self.corners(level)[:, np.stack([low, high], axis=1)].reshape(-1, 2)
                if level < self.lattice.depth:  # a case between the two is a nearer neighbour of both
                    middle = self.places[pairs].sum(axis=1) // 2
                    pairs = pairs[self._cases(middle) < 0]
                parts.append(np.column_stack([pairs, np.full(len(pairs), axis)]))
        every = np.unique(np.concatenate(parts), axis=0)
        return every[:, :2], every[:, 2]

    def _offsets(self) -> Places:
        """The corners of a cell of size 1, (corners, axes)."""
        return np.array(list(product((0, 1), repeat=len(self.lattice.shape))), dtype=np.int64)

    def _keys(self, places: Places) -> Places:
        """One number for each place; negative outside of the lattice."""
        keys = places[..., 0]
        for k, size in enumerate(self.lattice.sizes[1:], 1):
            keys = keys * size + places[..., k]
        return np.where((places >= 0).all(axis=-1) & (places < self.lattice.sizes).all(axis=-1), keys, -1)

    def _cases(self, places: Places) -> Places:
        """The index of the case at each place, -1 where there is none."""
        known = self._keys(self.places)
        order = np.argsort(known)
        keys = self._keys(places)
        at = order[np.minimum(np.searchsorted(known[order], keys), order.size - 1)]
        return np.where(known[at] == keys, at, -1)

    def _mark(self) -> list[Mask]:
        """Of each level the cells that are to be halved; none at the deepest."""
        depth, offsets = self.lattice.depth, self._offsets()
        marked = [np.zeros(len(cells), dtype=bool) for cells in self.cells]
        for level in range(depth + 1):
            cells = self.cells[level]
            if not len(cells):
                continue
            numbers = self.numbers[self.corners(level)]
            if level < depth:
                marked[level] |= disagree(numbers, self.steps)
            for axis, side in product(range(offsets.shape[1]), (0, 1)):
                across = cells[disagree(numbers[:, offsets[:, axis] == side], self.steps)].copy()
                across[:, axis] += self.size(level) if side else -self.size(level)
                self._mark_larger(across, level, marked)
        return marked

    def _mark_larger(self, across: Places, level: int, marked: list[Mask]) -> None:
        """Mark the cells that hold these places and are larger than those of a level."""
        for larger in range(level):
            if len(self.cells[larger]):
                lowest = across & -self.size(larger)
                marked[larger] |= np.isin(self._keys(self.cells[larger]), self._keys(lowest)[(across >= 0).all(axis=1)])

    def _judge(self) -> None:
        """The verdicts of the lines that have become complete."""
        for line in self.lines:
            new = np.array([place for place in line.at.tolist() if place not in line.verdicts], dtype=np.int64)
            if new.size:
                cases = self._cases(self._line(line, new).reshape(-1, 2)).reshape(new.size, -1)
                line.verdicts |= dict(
                    zip(new.tolist(), line.judge(self.numbers[cases, line.column]).tolist(), strict=True)
                )

    def _line(self, line: Lines, at: Places) -> Places:
        """The places of the cases of lines, (lines, cases, 2)."""
        along = np.arange(self.lattice.shape[line.along]) << self.lattice.depth
        pair = np.broadcast_arrays(along[None, :], at[:, None])
        return np.stack(pair if line.along == 0 else pair[::-1], axis=-1)

    def _between(self, level: int) -> list[tuple[Lines, Places]]:
        """For each law the places of new lines, half-way between lines of a level with different verdicts."""
        halves = []
        for line in self.lines:
            lower, upper = line.gaps()
            wide = upper - lower == self.size(level)
            halves.append((line, (lower[wide] + upper[wide]) // 2))
        return halves

    def _halve(self) -> None:
        """Halve the largest of the cells and gaps that are to be halved; end where there are none, or with the budget.

        A law has a new line in each gap.
        """
        marked = self._mark()
        level = next(
            (k for k, mask in enumerate(marked[:-1]) if mask.any() or any(at.size for _, at in self._between(k))), None
        )
        if level is None:
            self.ended = TOLERANCE
            return
        cells, half = self.cells[level][marked[level]], self.size(level + 1)
        thirds = np.array(list(product((0, 1, 2), repeat=cells.shape[1])), dtype=np.int64)
        groups = [*(cells[:, None, :] + thirds * half)]
        between = self._between(level)
        groups += [line for law_line, at in between for line in self._line(law_line, at)]
        fits = self._add(groups)
        if fits < len(groups):
            self.ended = BUDGET
        halved = np.flatnonzero(marked[level])[:fits]
        children = (cells[:fits, None, :] + self._offsets() * half).reshape(-1, cells.shape[1])
        self.cells[level] = np.delete(self.cells[level], halved, axis=0)
        self.cells[level + 1] = np.concatenate([self.cells[level + 1], children])
        left = max(fits - len(cells), 0)
        for law_line, at in between:
            law_line.at = np.sort(np.concatenate([law_line.at, at[:left]]))
            left = max(left - at.size, 0)
        if not self.wanted:
            self._judge()

    def _add(self, groups: list[Places]) -> int:
        """Add the cases of groups of places that fit into the budget, a group as a whole; the number of groups."""
        nodes = np.concatenate(groups)
        group = np.repeat(np.arange(len(groups)), [len(places) for places in groups])
        keys = self._keys(nodes)
        first = np.zeros(keys.size, dtype=bool)
        first[np.unique(keys, return_index=True)[1]] = True
        first &= self._cases(nodes) < 0
        needed = np.cumsum(np.bincount(group[first], minlength=len(groups)))
        fits = int(np.searchsorted(needed, self.budget - len(self.places), side="right"))
        new = nodes[first & (group < fits)]
        self.places = np.concatenate([self.places, new])
        self.rounds += bool(len(new))
        return fits


def refinement_of(lattice: Lattice, places: Places, numbers: Values, steps: Values, most: int) -> Refinement:
    """The refinement of stored cases, with its cells as far as the level `most`: a halved cell has a case inside it.

    places: of the cases, (cases, axes). numbers: (cases, watched).
    """
    refinement = Refinement(lattice, steps, len(places))
    refinement.places, refinement.numbers, refinement.ended = places, numbers, BUDGET
    for level in range(min(most, lattice.depth)):
        cells, half = refinement.cells[level], refinement.size(level + 1)
        halved = refinement._cases(cells + half) >= 0
        children = cells[halved][:, None, :] + refinement._offsets() * half
        refinement.cells[level] = cells[~halved]
        refinement.cells[level + 1] = children.reshape(-1, cells.shape[1])
    return refinement
