"""What a file of results can hold: bounds of the fields of its cases, of their numbers and of their texts.

The writer asks before it solves (`check_study`) and before it stores (`unfit`, `fit_text`), the reader of what it finds
(`checks`): so whatever is written is read. Needs no xarray.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver import Case
from solver.observe.observables import OBSERVABLES
from solver.observe.observables import is_count as is_counted
from solver.problem.errors import InputError
from solver.problem.field_values import POSITIVE, RANGES
from studies import Study
from studies.grammar.axes import Dimensions

from . import schema
from .schema import CURVES, JUDGED, LABEL, LOADS, Columns

Mask = NDArray[np.bool_]

# Of fields in their own units, and of dimensionless loads and lengths: beyond, squares and fourth powers overflow.
SMALLEST, LARGEST, MOST = 1e-50, 1e50, 1e30
MOST_ANGLE = 1e12  # rad: beyond, a float cannot hold the direction to 1e-4
SAME = 1e-9  # relative, between a stored number and what it follows from
STRAIGHT = 1e-6  # share of the arc by which its chord may exceed it: rounding and the error of the method
COUNTED = ("held_index", "branch")  # whole numbers of each case that are no observables
FIELDS = (*POSITIVE, "rho", *RANGES)  # that have a range
CUT = "; ..."  # ends a text that is longer than a file holds


def wrong_axis(values: Any) -> str:
    """What is wrong with the values of an axis; "" where nothing is."""
    if not (np.abs(values) <= LARGEST).all():
        return f"holds values that are not finite, or beyond {LARGEST:g}"
    return "holds a value twice" if np.unique(values).size < np.size(values) else ""


def wrong_field(name: str, values: Any) -> str:
    """What is wrong with the values of one of `FIELDS`; "" where nothing is."""
    values = np.asarray(values, dtype=float)
    if not np.isfinite(values).all():
        return f"must be finite, got {_worst(values, np.isfinite(values))}"
    allowed = RANGES.get(name, RANGES["R"])  # rho is positive, as R is
    low, high = allowed.low if allowed.low or allowed.closed else SMALLEST, min(allowed.high, LARGEST)
    good = ~allowed.excludes(values) & (values >= low) & (values <= high)
    return "" if good.all() else f"must be from {low:g} to {high:g}, got {_worst(values, good)}"


def _worst(values: NDArray[Any], good: Mask) -> str:
    return f"{values[~good].flat[0]:g}"


def is_too_long(L: Any, rho: Any) -> bool:
    """Whether a rod is too long for its cylinder."""
    with np.errstate(all="ignore"):
        return not bool(np.all(L / rho < MOST))


def check_study(study: Study, dimensions: Dimensions) -> None:
    """Raise `InputError` for a study with a case that a file cannot hold, before anything is solved."""
    for name, values in dimensions.fields.items():
        if why := wrong_axis(np.unique(values)):
            raise InputError(f"the axis {name} {why}: no file holds that")
    case = study.case_of(dimensions.open())
    numbers = schema.numbers_of_case(case)
    for name in (name for name in FIELDS if name in numbers):
        if why := wrong_field(name, numbers[name]):
            raise InputError(f"{name} of a study that is stored {why}")
    if is_too_long(np.max(case.rod.L), np.min(case.rho)):
        raise InputError(f"L of a study that is stored must be at most {MOST:g} times rho")


def bad_numbers(name: str, values: Any, counted: bool, L: Any = np.inf) -> Mask:
    """Which solved cases cannot have their number (B,); NaN says that it is not known. L: lengths of the rods."""
    row = OBSERVABLES.get(name)
    least = 0.0 if counted or name.endswith("_error") else -np.inf if row is None else row.least
    most: Any = np.inf if row is None else row.most
    most = np.asarray(L) * (1 + STRAIGHT) if most == "L" else most
    with np.errstate(invalid="ignore"):
        bad: Mask = (values < least) | (np.abs(values) > most * (1 + SAME))
        bad |= counted & (values != np.round(values)) & ~np.isnan(values)
        return bad | (~(values >= 0) if name in JUDGED else False)


def bad_loads(name: str, values: Any, A: Any, rho: Any) -> Mask:
    """Which solved cases have a load FZ, MZ or M3 (B,) that is not finite, or far too large for their rods."""
    with np.errstate(all="ignore"):
        bad: Mask = ~(np.abs(values) * rho ** (2 if name == "FZ" else 1) / A < MOST)
    return bad


def most_along(key: str) -> float:
    """The bound of an array along the rod, by its name in the file."""
    return MOST_ANGLE if CURVES[key] in ("beta", "alpha", "gamma") else MOST


def bad_curves(key: str, values: Any) -> Mask:
    """Which solved cases have an array along the rod (B, n, ...) that is not finite, or beyond its bound."""
    inside = np.abs(values) < most_along(key)
    return ~np.asarray(inside.all(axis=tuple(range(1, inside.ndim))))


def unfit(study: Study, case: Case, row: Columns) -> Iterator[tuple[str, Mask]]:
    """Why a file cannot hold the numbers of solved cases, and which cases (B,) these are."""

    def each(value: Any) -> NDArray[np.float64]:
        return np.broadcast_to(np.asarray(value, dtype=float), case.shape).reshape(-1)

    counts = {name: is_counted(name) or name in COUNTED for name in row}
    L, rho, A = each(case.rod.L), each(case.rho), each(case.rod.bending_stiffness)
    for name, values in row.items():
        if name in CURVES:
            yield f"{name} is not finite, or beyond {most_along(name):g}", row["solved"] & bad_curves(name, values)
        elif values.dtype.kind in "iuf":
            yield f"{name} has no such value", row["solved"] & bad_numbers(name, values, counts[name], L)
        if name in LOADS:
            words = f"{name} is not finite, or far too large for its rod"
            yield words, row["solved"] & bad_loads(name, values, A, rho)


def fit_lines(text: str) -> str:
    """A text of many lines as a file holds it: the control characters of its comments are blanks."""
    return "".join(" " if is_control(letter) else letter for letter in text)


def is_control(letter: str) -> bool:
    """Whether a letter of a text of many lines is a control character."""
    return (letter < " " and letter not in "\n\r\t") or "\x7f" <= letter <= "\x9f"


def fit_text(text: str) -> str:
    """A text of a case as a file holds it: at most `LABEL` printable characters, cut behind one of its parts."""
    text = text if text.isprintable() else "".join(letter if letter.isprintable() else " " for letter in text)
    if len(text) <= LABEL:
        return text
    kept = text[: LABEL - len(CUT)]
    return (kept.rpartition("; ")[0] or kept) + CUT
