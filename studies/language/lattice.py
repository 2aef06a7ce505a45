"""The lattice of a refined study: the coarse grid of its axes and the values between; the lines of its laws, its table.

The values between come by repeated halving. A place is a whole number along each axis. Neighbours of the coarse grid
are 2^depth places apart, and one halving makes two equal steps of each step: of equal differences, or of equal ratios
where the axis is geometric.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, Field, model_validator

from solver.problem.errors import choices

from ..grammar.axes import MAX_COUNT, STRICT, Misplaced

Values = NDArray[np.float64]
Places = NDArray[np.int64]

EXACT = 1e-6  # of the finest step: how far from a place the value of a case may lie
ROUNDING = 4e-16  # relative, of a value


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
        rows = np.meshgrid(*(np.arange(size) << self.depth for size in self.shape), indexing="ij")
        return np.stack([row.ravel() for row in rows], axis=1)

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
class Lines:
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
        if self.points is not None and not 2 <= self.points <= 1 / FINEST:
            raise Misplaced(f"points must be from 2 to {1 / FINEST:.0f}, got {self.points}", "points")
        return self

    @property
    def share(self) -> float:
        """The tolerance as a share of an axis."""
        return self.tolerance if self.tolerance is not None else 1 / ((self.points or 2) - 1)
