"""Refinement: cells of a lattice are halved where their corners disagree, round by round.

The lattice of a refined study is the coarse grid of its axes and the values between, which come by repeated halving. A
place is a whole number along each axis. Neighbours of the coarse grid are 2^depth places apart, and one halving makes
two equal steps of each step: of equal differences, or of equal ratios where the axis is geometric.

The cells begin as those of the coarse grid. A cell is halved along every axis if the numbers of its corners disagree,
or if those along one of its faces do, as the smaller cells beyond the face show: so a boundary is followed into the
next cell. Along one axis an interval whose ends agree is halved once, too: a number that changes and changes back shows
in its middle, or not at all. Each round halves the largest of these cells, until none is left that is larger than the
tolerance, or until the budget is spent. The rounds follow from the numbers alone.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise, product
from math import ceil, log2

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, Field, model_validator

from solver.problem.errors import choices

from ..grammar.axes import MAX_COUNT, STRICT, Axis, Misplaced, Values

Places = NDArray[np.int64]

EXACT = 1e-6  # of the finest step: how far from a place the value of a case may lie
ROUNDING = 4e-16  # relative, of a value


def product_of(places: Sequence[Places]) -> Places:
    """The places of a grid in its order, (cases, axes), from the places along each axis."""
    return np.stack([row.ravel() for row in np.meshgrid(*places, indexing="ij")], axis=1)


@dataclass(frozen=True, eq=False)
class Lattice:
    """The lattice of a study.

    axes: name -> its coarse values, rising. geometric: the axes whose steps are halved to equal ratios. depth: how
    often each step of the coarse grid can be halved.
    """

    axes: Mapping[str, Values]
    geometric: frozenset[str]
    depth: int

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the coarse grid."""
        return tuple(values.size for values in self.axes.values())

    @property
    def sizes(self) -> tuple[int, ...]:
        """Number of places along each axis: those of the uniform grid of the same resolution."""
        return tuple(((size - 1) << self.depth) + 1 for size in self.shape)

    def coarse(self) -> Places:
        """The places of the coarse grid in its order, (cases, axes)."""
        return product_of([np.arange(size) << self.depth for size in self.shape])

    def values(self, places: Places) -> dict[str, Values]:
        """The values of each axis at places, (cases, axes)."""
        return {name: self.along(name, places[:, k]) for k, name in enumerate(self.axes)}

    def along(self, name: str, places: NDArray[np.generic]) -> Values:
        """The values of one axis at places; a place may be a fraction."""
        coarse = self.axes[name]
        share = np.asarray(places, dtype=float) / 2.0**self.depth
        cell = np.minimum(np.floor(share).astype(np.int64), coarse.size - 2)
        low, high, share = coarse[cell], coarse[cell + 1], share - cell
        between = low * (high / low) ** share if name in self.geometric else low + share * (high - low)
        return np.where(share == 0, low, np.where(share == 1, high, between))

    def places(self, values: Mapping[str, Values]) -> Places:
        """The places of cases, (cases, axes); -1 where a value lies on none."""
        return np.stack([self._places(name, values[name]) for name in self.axes], axis=1)

    def _places(self, name: str, values: Values) -> Places:
        coarse = self.axes[name]
        cell = np.clip(np.searchsorted(coarse, values, side="right") - 1, 0, coarse.size - 2)
        low, high = coarse[cell], coarse[cell + 1]
        with np.errstate(all="ignore"):
            ratio = (
                np.log(values / low) / np.log(high / low) if name in self.geometric else (values - low) / (high - low)
            )
        exact = (cell + ratio) * 2.0**self.depth
        place = np.round(exact)
        on = np.isfinite(exact) & (place >= 0) & (place < (coarse.size - 1) * 2.0**self.depth + 1)
        place = np.where(on, place, 0.0)
        last = (coarse.size - 1) * 2.0**self.depth
        on &= values >= self.along(name, np.maximum(place - EXACT, 0.0)) - ROUNDING * np.abs(values)
        on &= values <= self.along(name, np.minimum(place + EXACT, last)) + ROUNDING * np.abs(values)
        return np.where(on, place, -1).astype(np.int64)

    def levels(self, places: Places) -> Places:
        """The level of each place: 0 on the coarse grid, else the halving that made it, (cases,)."""
        odd = places | (1 << self.depth)  # so that a place of the coarse grid has its lowest bit there
        lowest = np.log2((odd & -odd).astype(float)).astype(np.int64)
        levels: Places = (self.depth - lowest).max(axis=1)
        return levels

    def share(self, level: int) -> float:
        """The largest step of a level, as a share of its axis."""
        return max(map(self._widest, self.axes)) / 2.0**level

    def _widest(self, name: str) -> float:
        values = np.log(np.abs(self.axes[name])) if name in self.geometric else self.axes[name]
        return float(np.abs(np.diff(values)).max() / np.abs(values[-1] - values[0]))


@dataclass(eq=False)
class RefinedLines:
    """The complete lines of the coarse grid along one axis, for a law that is judged on each.

    along: the axis of the lines. column: of the number that is judged. judge: from its values on lines, (lines, cases),
    to the verdict on each. at: the places of the lines on the other axis, rising. verdicts: of the lines known so far.
    """

    along: int
    column: int
    judge: Callable[[Values], NDArray[np.str_]]
    at: Places = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    verdicts: dict[int, str] = field(default_factory=dict)

    def gaps(self) -> tuple[Places, Places]:
        """The places of neighbouring lines that have another verdict: of the lower, and of the upper."""
        changes = [self.verdicts[a] != self.verdicts[b] for a, b in pairwise(self.at.tolist())]
        where = np.flatnonzero(changes)
        return self.at[where], self.at[where + 1]


OUTCOME = "outcome"  # watched: whether a case is solved
FINEST = 1e-9  # least tolerance


class Refine(BaseModel):
    """The refinement of a study whose axes are the coarse grid.

    watch: observables, expressions and "outcome". laws: claims of laws whose verdict is watched from line to line.
    steps: of those watched that are real numbers, the change that counts. tolerance: the largest step, as a share of
    its axis, to which a boundary is located; or points: as by so many evenly spaced values of an axis. budget: the most
    cases, those of the coarse grid among them.
    """

    model_config = STRICT

    watch: list[str] = []
    laws: list[str] = []
    steps: dict[str, float] = {}
    tolerance: float | None = None
    points: int | None = None
    budget: int = Field(10_000, le=MAX_COUNT)

    @model_validator(mode="after")
    def _complete(self) -> "Refine":
        if not (self.watch or self.laws):
            raise Misplaced(f"watch is empty: name at least one observable, or {OUTCOME!r}", "watch")
        for key, names in (("watch", self.watch), ("laws", self.laws)):
            if twice := [name for name in names if names.count(name) > 1]:
                raise Misplaced(f"{twice[0]!r} is watched twice", key)
        for name, step in self.steps.items():
            if name not in self.watch:
                raise Misplaced(f"{name!r} is not watched; watch names {choices(self.watch)}", "steps", name)
            if not step > 0:
                raise Misplaced(f"the step of {name} must be positive, got {step:g}", "steps", name)
        if (self.tolerance is None) == (self.points is None):
            ending = "" if self.points is None else ", and gives both"
            raise ValueError(f"refine needs one of the two keys tolerance and points{ending}")
        if self.tolerance is not None and not FINEST <= self.tolerance < 1:
            why = f"tolerance is a share of the axis from {FINEST:g} to below 1, got {self.tolerance:g}"
            raise Misplaced(why, "tolerance")
        most = round(1 / FINEST)
        if self.points is not None and not 2 <= self.points <= most:
            raise Misplaced(f"points must be from 2 to {most}, got {self.points}", "points")
        return self

    @property
    def changes(self) -> dict[str, float]:
        """Of each of those watched the change that counts: 0 where no step is given."""
        return {name: self.steps.get(name, 0) for name in self.watch}

    @property
    def share(self) -> float:
        """The tolerance as a share of an axis."""
        return self.tolerance if self.tolerance is not None else 1 / ((self.points or 2) - 1)

    def lattice(self, axes: Mapping[str, Axis]) -> Lattice:
        """The lattice of a study: its axes in rising order, halved until their steps are within the tolerance."""
        values = {name: np.sort(axis.numbers()) for name, axis in axes.items()}
        geometric = frozenset(name for name, axis in axes.items() if axis.spacing == "geometric")
        halvings = log2(Lattice(values, geometric, 0).share(0) / self.share)
        return Lattice(values, geometric, max(0, ceil(halvings - 1e-9)))  # rounding makes no further halving


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
    lines: tuple[RefinedLines, ...] = ()
    places: Places = field(init=False)
    numbers: Values = field(init=False)
    cells: list[Places] = field(init=False)
    ended: str = ""
    rounds: int = 0

    def __post_init__(self) -> None:
        self.places = self.lattice.coarse()
        self.numbers = np.empty((0, self.steps.size))
        first = product_of([np.arange(size - 1) << self.lattice.depth for size in self.lattice.shape])
        for line in self.lines:
            line.at = np.arange(self.lattice.shape[1 - line.along]) << self.lattice.depth
        self.cells = [first, *(first[:0] for _ in range(self.lattice.depth))]

    @property
    def next_count(self) -> int:
        """How many cases are to be solved next; 0 at the end."""
        return len(self.places) - len(self.numbers)

    def take(self, numbers: Values) -> None:
        """Take the watched numbers of the wanted cases, (cases, watched), and find the cases of the next round."""
        assert len(numbers) == self.next_count
        self.numbers = np.concatenate([self.numbers, numbers])
        self._judge()
        while not self.ended and not self.next_count:
            self._halve()

    def corners(self, level: int) -> Places:
        """The indices of the cases at the corners of the cells of a level, (cells, corners)."""
        return self._cases(self.cells[level][:, None, :] + self._offsets() * self.size(level))

    def size(self, level: int) -> int:
        """Places from corner to corner of a cell of a level."""
        return 1 << (self.lattice.depth - level)

    def open_cells(self) -> list[int]:
        """How many cells of each level are still to be halved."""
        return [int(mask.sum()) for mask in self._mark()]

    def widest(self) -> float:
        """The size of the largest cells, as a share of an axis."""
        return self.lattice.share(next(level for level, cells in enumerate(self.cells) if len(cells)))

    def open_lines(self) -> int:
        """How many gaps between lines of different verdicts are wider than the tolerance."""
        return sum(int((upper - lower > 1).sum()) for line in self.lines for lower, upper in [line.gaps()])

    def edges(self) -> tuple[Places, Places]:
        """Pairs of neighbouring cases: their indices, (pairs, 2), the lower first, and the axis of each, (pairs,)."""
        offsets = self._offsets()
        parts: list[Places] = []
        for axis in range(offsets.shape[1]):
            low = np.flatnonzero(offsets[:, axis] == 0)
            high = [
                int(np.flatnonzero((offsets == offsets[k] + np.eye(offsets.shape[1], dtype=int)[axis]).all(1))[0])
                for k in low
            ]
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
        return product_of([np.arange(2)] * len(self.lattice.shape))

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
                marked[level] |= disagree(numbers, self.steps) | self._intervals_to_test(level)
            for axis, side in product(range(offsets.shape[1]), (0, 1)):
                across = cells[disagree(numbers[:, offsets[:, axis] == side], self.steps)].copy()
                across[:, axis] += self.size(level) if side else -self.size(level)
                self._mark_larger(across, level, marked)
        return marked

    def _intervals_to_test(self, level: int) -> Mask:
        """The intervals of a level in which no case was solved to see whether a number changes and changes back: along
        one axis all but those that were halved from an interval whose ends agreed with its middle."""
        cells = self.cells[level]
        if len(self.lattice.shape) > 1 or level == 0:
            return np.full(len(cells), len(self.lattice.shape) == 1)
        whole, half = cells & -self.size(level - 1), self.size(level)
        return disagree(self.numbers[self._cases(whole[:, None, :] + np.arange(3)[:, None] * half)], self.steps)

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

    def _line(self, line: RefinedLines, at: Places) -> Places:
        """The places of the cases of lines, (lines, cases, 2)."""
        along = np.arange(self.lattice.shape[line.along]) << self.lattice.depth
        pair = np.broadcast_arrays(along[None, :], at[:, None])
        return np.stack(pair if line.along == 0 else pair[::-1], axis=-1)

    def _between(self, level: int) -> list[tuple[RefinedLines, Places]]:
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
        thirds = product_of([np.arange(3)] * cells.shape[1])
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
        if not self.next_count:
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
