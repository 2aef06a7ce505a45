"""An observable of a study along one of its axes, and the law that is judged there: asked once, for the panel of it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from studies.laws.line_verdicts import HOLDS, MONOTONE

from .selection import Value
from .stored_study import StoredStudy

Values = NDArray[np.float64]
IDENTITY = 1e-8  # a formula that agrees so well is an identity: its picture is a line on a line
WHICH = ("claim", "kind", "observable", "axis", "rule")  # by these a law is found: the numbers of two such are equal


@dataclass(frozen=True, eq=False)
class TrendLine:
    """An observable on a line of cases along an axis, in its rising order; in the units of the file.

    axis, observable: the stored variables, with their units and names. along, values, solved: of the line, (n,); NaN
    where there is no number. lines: of a grid all its lines, (lines, n); none of rods that stand alone. held: the
    values of the other axes, in words. broken: the places before which a line has a gap, as the branch changes.
    fold: on a followed axis, where it is known. alone: whether each rod was let go by itself. is_count, is_level:
    whether the observable is a whole number, and the same in all cases.
    """

    axis: xr.DataArray
    observable: xr.DataArray
    along: Values
    values: Values
    solved: NDArray[np.bool_]
    lines: Values
    held: str
    broken: NDArray[np.int64]
    fold: float | None
    alone: bool
    is_count: bool
    is_level: bool


@dataclass(frozen=True, eq=False)
class LawLine(TrendLine):
    """A law on the line that decides it.

    row: its verdict, of `law_verdicts.verdicts`. compared: with what it compares the observable, key -> (n,). formulas:
    of the study's expressions, by name. others: the other observables that it names, as stored.
    """

    row: Mapping[str, Any]
    compared: Mapping[str, Values]
    formulas: Mapping[str, str]
    others: Mapping[str, xr.DataArray]

    @property
    def is_trivial(self) -> bool:
        """Whether a picture shows nothing: it is true of a number that is the same in all cases, or an identity."""
        exact = self.row["kind"] == "equals" and (self.row["rule"].get("relative") or 1.0) <= IDENTITY
        return self.row["verdict"] == HOLDS and (exact or self.is_level)


def trend_of(stored: StoredStudy, observable: str, axis: str, at: Mapping[str, Value] | None = None) -> TrendLine:
    """An observable along an axis, on the line at these values of the others. Raises `InputError` as of `places`."""
    return TrendLine(**_trend(stored, observable, axis, stored.places(axis, at)))


def law_of(stored: StoredStudy, row: Mapping[str, Any]) -> LawLine:
    """A law of a study, given as a row of its verdicts. Raises `InputError`."""
    places = stored.places(row["axis"], row["at"])
    compared: Mapping[str, Values] = {}
    if row["kind"] != MONOTONE:
        laws = zip(stored.laws, stored.numbers_of_laws, strict=True)
        compared = next(numbers for law, numbers in laws if all(getattr(law, key) == row[key] for key in WHICH))
    on_line = tuple(np.array([place[name] for place in places]) for name in stored.axes)
    return LawLine(
        **_trend(stored, row["observable"], row["axis"], places),
        row=row,
        compared={key: values[on_line] for key, values in compared.items()},
        formulas=stored.expressions,
        others={also["observable"]: stored[also["observable"]] for also in row["also"]},
    )


def _trend(stored: StoredStudy, observable: str, axis: str, places: list[dict[str, int]]) -> dict[str, Any]:
    """The fields of a `TrendLine` on the line of these places."""
    on = {axis: [place[axis] for place in places]}
    others = {name: i for name, i in places[0].items() if name != axis}
    lines = stored.of_solved(observable).transpose(..., axis).isel(on)
    broken = np.empty(0, dtype=int)
    if "branch" in stored and set(stored["branch"].dims) == set(places[0]):
        broken = np.flatnonzero(np.diff(stored["branch"].isel(others | on).values)) + 1
    is_followed = "fold" in stored and axis == stored.attrs.get("followed") and np.isfinite(stored["fold"])
    return {
        "axis": stored[axis],
        "observable": stored[observable],
        "along": stored[axis].values[on[axis]],
        "values": lines.isel(others).values.astype(float),
        "solved": stored["solved"].transpose(..., axis).isel(on).isel(others).values,
        "lines": lines.values.reshape(-1, len(places))[: 0 if lines.ndim == 1 or stored.stand_alone else None],
        "held": stored.equations(others),
        "broken": np.arange(1, len(places)) if stored.stand_alone else broken,
        "fold": float(stored["fold"]) if is_followed else None,
        "alone": stored.stand_alone,
        "is_count": observable in stored.counts,
        "is_level": stored.is_level(observable),
    }
