"""An observable of a study along one of its axes, and the law that is judged there, for the panel of it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver.observe.observables import OBSERVABLES
from studies.laws.law_kinds import MONOTONE
from studies.laws.line_verdicts import HOLDS

Values = NDArray[np.float64]
SEEN = 0.02  # of the range of the values with their errors, beyond which the errors are drawn
PLAIN = (MONOTONE, "scales")  # kinds of laws that are seen on the curve of the observable alone
IDENTITY = 1e-8  # a formula that agrees so well is an identity: its picture is a line on a line


@dataclass(frozen=True, eq=False)
class TrendLine:
    """An observable on a line of cases along an axis, in its rising order; in the units of the file.

    axis, observable: the stored variables, with their units and names. along, values, solved: of the line, (n,); NaN
    where there is no number. unbent: where the number is left out, as `StoredCases.unbent`, (n,). errors: of the
    values, estimated, (n,); 0 where none is known. lines: of a grid all its lines, (lines, n); none of rods that stand
    alone. held: the values of the other axes, in words. names: of the lines, ``w = 0 N/m``; elsewhere: ``other F₃``,
    in which the lines differ. broken: the places before which a line has a gap, as one of its states changes. states:
    the branch and the comparisons that do so. fold: on a followed axis, where it is known. alone: whether each rod was
    let go by itself. is_count, is_level: whether the observable is a whole number, and the same in all cases.
    is_logarithmic: whether the scale of the axis is.
    """

    axis: xr.DataArray
    observable: xr.DataArray
    along: Values
    values: Values
    errors: Values
    unbent: NDArray[np.bool_]
    solved: NDArray[np.bool_]
    lines: Values
    held: str
    names: Sequence[str]
    elsewhere: str
    broken: NDArray[np.int64]
    states: tuple[str, ...]
    fold: float | None
    alone: bool
    is_count: bool
    is_level: bool
    is_logarithmic: bool

    @property
    def is_joined(self) -> bool:
        """Whether a line joins the cases in a picture, and not that of a law which is drawn over them."""
        return True

    @property
    def within(self) -> tuple[Values, Values]:
        """Between what each value is, by its estimated error and the bounds of the observable."""
        row = OBSERVABLES.get(str(self.observable.name))
        least = -np.inf if row is None else row.least
        return np.maximum(self.values - self.errors, np.minimum(least, self.values)), self.values + self.errors

    @property
    def is_uncertain(self) -> bool:
        """Whether the errors are as large as is seen beside the values."""
        low, high = (ends[np.isfinite(self.values)] for ends in self.within)
        return bool(low.size and not self.is_level and (high - low).max() > SEEN * (high.max() - low.min()))


@dataclass(frozen=True, eq=False)
class LawLine(TrendLine):
    """A law on the line that decides it.

    row: its verdict, of `stored_verdicts.verdicts`. compared: with what it compares the observable, key -> (n,).
    formulas: of the study's expressions, by name. others: the other observables that it names, as stored.
    """

    row: Mapping[str, Any]
    compared: Mapping[str, Values]
    formulas: Mapping[str, str]
    others: Mapping[str, xr.DataArray]

    @property
    def is_joined(self) -> bool:
        return not (self.row["kind"] == "equals" or (self.row["kind"] == "scales" and bool(self.row["numbers"])))

    @property
    def is_trivial(self) -> bool:
        """Whether a picture shows nothing: it is true of a number that is the same in all cases, or an identity."""
        exact = self.row["kind"] == "equals" and (self.row["rule"].get("relative") or 1.0) <= IDENTITY
        return self.row["verdict"] == HOLDS and (exact or self.is_level)

    def repeats(self, other: "LawLine") -> bool:
        """Whether its picture is that of another law, with no line of its own: it is true of a direction or a power,
        and the other law has numbers of its own."""
        return (
            self.row["verdict"] == HOLDS
            and self.row["kind"] in PLAIN
            and other.row["kind"] not in PLAIN
            and not other.is_trivial
            and self.observable.name == other.observable.name
            and self.axis.name == other.axis.name
            and np.array_equal(self.values, other.values, equal_nan=True)
        )
