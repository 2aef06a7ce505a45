"""Array types, dataclasses of arrays, and the rounding of their numbers."""

from collections.abc import Sequence
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]  # of floats, unless the text says otherwise
Integers = NDArray[np.int64]
Booleans = NDArray[np.bool_]

EPS = 2.0**-52
# relative: what a few operations round off, as those that make a case dimensionless. x10: as good for them; a real
# difference so small is lost
ROUNDED = 4 * EPS

# What counts as nothing, as a share of the size of what is compared

# a force, a gap or a correction that is smaller is what sums along a rod round off. x10: no digit that is promised
FAINT = 1e-12
# a number that may be rounding: a smaller one has no sign, and a condition missed by less is met. x10: of weak forces
# no sign is said
DOUBTFUL = 10 * FAINT
NEGLIGIBLE = 1e-9  # a length, a load or an angle [rad] that is smaller is none: nobody means it. x10: as good
# half the digits of a float: what is smaller is rounding once it is squared. x10: two digits too early
SQUARE_LOST = 1e-8
# equilibria, places and energies that differ by less are one: far above the errors of both. x10: close pairs beside a
# fold are one
ALIKE = 1e-6
ROUGHLY = 1e-3  # guesses and minima that are no more exact differ by less where they are one. x10: neighbours are lost
# rad: with a larger error the shape is another one, whatever the condition number allows. x10: it would be answered
SHAPELESS = 0.1
ASIDE = 1e-3  # how far beside a point its surroundings are read. x10: where a curve bends, those of another part


def whole_turns(angles: Any) -> Any:
    """The whole turns next to angles [rad]."""
    return 2 * np.pi * np.round(angles / (2 * np.pi))


def integral(values: Array, t: Array) -> Array:
    """The integral of values from the first of places t on, by trapezoids, (n,)."""
    return np.concatenate([[0.0], np.cumsum((values[1:] + values[:-1]) / 2 * np.diff(t))])


class Columns:
    """A dataclass whose arrays have a row for each of many: of problems, levels, panels. Other fields are of all."""

    def take(self, index: Any) -> Self:
        """The rows that an index array, a mask or a slice selects."""
        rows = {
            k: v[index] if isinstance(v, np.ndarray) else v.take(index) if isinstance(v, Columns) else v
            for k, v in vars(self).items()
        }
        return type(self)(**rows)

    @classmethod
    def join(cls, parts: Sequence[Self]) -> Self:
        """Rows one after the other, of dataclasses that hold nothing but arrays and such dataclasses."""
        columns = {name: [vars(part)[name] for part in parts] for name in vars(parts[0])}
        return cls(**{k: v[0].join(v) if isinstance(v[0], Columns) else np.concatenate(v) for k, v in columns.items()})
