"""What varies in a study, and how: a grid of axes, one of which may be followed, samples, or a refinement."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import prod

from solver.problem.errors import choices

from ..grammar.axes import SAMPLE, Axis, Dimension, Dimensions
from .refinement import Refine
from .samples import Sample

SOURCES = ("sample", "zip", "table")  # the tables of a study that give fields that vary together


@dataclass(frozen=True, eq=False)
class Variation:
    """What varies in a study, and how: its cases are every sample at every point of its grid.

    axes: field -> values, all that the study states. given: the samples, or how they are drawn when they are first
    needed. refine: of a study whose axes are refined; its cases are samples, those of its coarse grid to begin with.
    """

    axes: Mapping[str, Axis]
    given: Dimension | Sample | None = None
    refine: Refine | None = None

    @property
    def grid(self) -> Mapping[str, Axis]:
        """The axes that are dimensions: all, but those of a refined study."""
        return self.axes if self.refine is None else {}

    @property
    def followed(self) -> str | None:
        """The name of the axis along which equilibria are followed, or None."""
        return next((name for name, axis in self.axes.items() if axis.follow), None)

    @property
    def from_base(self) -> bool:
        """Whether the equilibrium of the base case, a start problem, is followed; its axis is no dimension."""
        return any(axis.from_base for axis in self.axes.values())

    @property
    def sampled(self) -> tuple[str, ...]:
        """The fields of the samples, those of [sample], [zip] or [table], or the refined axes."""
        if self.refine is not None:
            return tuple(self.axes)
        return () if self.given is None else tuple(self.given.fields)

    @property
    def fields(self) -> tuple[str, ...]:
        """The fields that vary: those of the samples, then the axes."""
        return (*self.sampled, *self.grid)

    @property
    def size(self) -> int:
        """Number of cases."""
        samples, axes = (1, self.axes) if self.given is None else (self.given.size, self.grid)
        return samples * prod(axis.size for axis in axes.values())

    @property
    def samples(self) -> Dimension | None:
        """The samples; None if there are none."""
        if isinstance(self.given, Sample):
            return self.given.points
        if self.given is None and self.refine is not None:
            lattice = self.refine.lattice(self.axes)
            return Dimension(SAMPLE, lattice.values(lattice.coarse()))
        return self.given

    @property
    def dimensions(self) -> Dimensions:
        """The samples, and each axis that is not followed from the base case."""
        axes = {name: axis.numbers() for name, axis in self.grid.items() if not axis.from_base}
        return Dimensions.of(axes, self.samples)

    @property
    def words(self) -> str:
        """What varies, in words: ``the axes E, R``, ``samples of E, R``."""
        if self.refine is not None:
            return f"the refined axes {choices(self.axes)}"
        sampled = [f"samples of {choices(self.sampled)}"] if self.sampled else []
        return " and ".join([*sampled, *([f"the axes {choices(self.axes)}"] if self.axes else [])])
