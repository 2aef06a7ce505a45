"""The dimensions of a study's cases: an axis has the values of one field, the samples have those of several.

The cases are all combinations: every sample at every point of the grid of the axes. They are counted along the
dimensions, the last fastest.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]

SAMPLE = "sample"  # the name of the dimension of the samples, whose coordinate is their number


@dataclass(frozen=True, eq=False)
class Dimension:
    """One dimension.

    name: that of its field, or `SAMPLE`. fields: field -> its values, (size,). numbers: of the samples, where they are
    some of others; default: 0, 1, 2, ...
    """

    name: str
    fields: Mapping[str, Values]
    numbers: NDArray[np.int64] | None = None

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, Dimension)
            and (self.name, *self.fields) == (other.name, *other.fields)
            and all(np.array_equal(values, other.fields[name]) for name, values in self.fields.items())
        )

    @property
    def size(self) -> int:
        """Number of values."""
        return next(iter(self.fields.values())).size

    @property
    def coordinate(self) -> NDArray[np.float64] | NDArray[np.int64]:
        """The values of its field; of the samples their numbers."""
        if self.name != SAMPLE:
            return self.fields[self.name]
        return np.arange(self.size) if self.numbers is None else self.numbers

    def only(self, places: NDArray[np.int64]) -> "Dimension":
        """The dimension with the values at these places alone; samples keep their numbers."""
        fields = {name: values[places] for name, values in self.fields.items()}
        return Dimension(self.name, fields, np.arange(self.size)[places] if self.name == SAMPLE else None)


@dataclass(frozen=True, eq=False)
class Dimensions:
    """All dimensions of a study, in order."""

    each: tuple[Dimension, ...] = ()

    @classmethod
    def of(cls, axes: Mapping[str, Values], samples: Dimension | None = None) -> "Dimensions":
        """The dimensions of axes, field -> values; before them the samples, if there are any."""
        first = () if samples is None else (samples,)
        return cls((*first, *(Dimension(name, {name: values}) for name, values in axes.items())))

    @property
    def names(self) -> tuple[str, ...]:
        """The name of each dimension."""
        return tuple(dimension.name for dimension in self.each)

    @property
    def shape(self) -> tuple[int, ...]:
        """The size of each dimension."""
        return tuple(dimension.size for dimension in self.each)

    @property
    def size(self) -> int:
        """Number of cases."""
        return math.prod(self.shape)

    @property
    def fields(self) -> dict[str, Values]:
        """Every field that varies, with its values along its own dimension."""
        return {name: values for dimension in self.each for name, values in dimension.fields.items()}

    @property
    def sampled(self) -> tuple[str, ...]:
        """The fields of the samples."""
        return tuple(name for dimension in self.each if dimension.name == SAMPLE for name in dimension.fields)

    def at(self, flat: NDArray[np.int64]) -> dict[str, Values]:
        """The fields of the cases of these flat indices, (cases,) each."""
        if not self.each:
            return {}
        places = zip(self.each, np.unravel_index(flat, self.shape), strict=True)
        return {name: values[i] for dimension, i in places for name, values in dimension.fields.items()}

    def open(self) -> dict[str, Values]:
        """Every field along its own dimension: together they broadcast to the shape of the grid."""
        rank = len(self.each)
        return {
            name: values.reshape([-1 if i == k else 1 for k in range(rank)])
            for i, dimension in enumerate(self.each)
            for name, values in dimension.fields.items()
        }
