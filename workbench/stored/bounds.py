"""What a file of results can hold: bounds of the fields of its cases, of their numbers and of their texts.

The writer asks before it solves (`check_study`) and before it stores (`unfit`, `fit_text`), the reader of what it finds
(`checks`): so whatever is written is read. Needs no xarray.
"""

import re
from collections.abc import Collection, Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.observe.observables import OBSERVABLES
from solver.problem.declared_fields import POSITIVE, RANGES
from solver.problem.errors import InputError
from studies import Study
from studies.grammar.axes import LONGEST_LINE, Dimensions

from . import quantity_variables
from .quantity_variables import CURVES, JUDGED, LOADS

Mask = NDArray[np.bool_]

# Of fields in their own units, and of dimensionless loads and lengths: beyond, squares and fourth powers overflow.
SMALLEST, LARGEST, MOST = 1e-50, 1e50, 1e30
MOST_ANGLE = 1e12  # rad: beyond, a float cannot hold the direction to 1e-4
MOST_DRAWN = 1e200  # of a number of a case: beyond, the ticks of a logarithmic axis overflow
SAME = 1e-9  # share by which a number may be beyond its range, or a station beside its place
STRAIGHT = 1e-6  # share of its length by which a rod may reach farther: rounding and the error of the method
COUNTED = ("held_index", "branch")  # whole numbers of each case that are no observables
FIELDS = (*POSITIVE, "rho", "shape_rho", *RANGES)  # that have a range; shape_rho: of each shape of branches
CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ud800-\udfff]")  # of a text of many lines; no UTF-8
LINE, LABEL = LONGEST_LINE, 1000  # characters of an attribute of a file, and of a variable or a text of a case
CUT = "; ..."  # ends a text that is longer than a file holds


def wrong_axis(values: Any) -> str:
    """What is wrong with the values of an axis; "" where nothing is."""
    values = np.asarray(values)
    if values.dtype.kind not in "iuf" or not (np.abs(values.astype(float)) <= LARGEST).all():
        return f"holds values that are not finite, or beyond {LARGEST:g}"
    return "holds a value twice" if np.unique(values).size < np.size(values) else ""


def unfit_fields(number: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """What is wrong with fields and the stations u and s: a name, and why, in words. number: values by their names."""
    for name in (name for name in FIELDS if name in number):
        values = np.asarray(number[name], dtype=float)
        allowed = RANGES.get(name, RANGES["R"])  # rho is positive, as R is
        low, high = allowed.low if allowed.low or allowed.closed else SMALLEST, min(allowed.high, LARGEST)
        good = np.isfinite(values) & ~allowed.excludes(values) & (values >= low) & (values <= high)
        if not good.all():
            got = values[~good].flat[0]
            yield name, f"must be {f'from {low:g} to {high:g}' if np.isfinite(got) else 'finite'}, got {got:g}"
    if {"L", "rho"} <= {*number} and np.max(number["L"] / number["rho"]) >= MOST:
        yield "L", f"must be at most {MOST:g} times rho"
    u = number.get("u", 0.0)
    if not (np.all((u >= 0) & (u <= 1)) and np.all(np.diff(np.ravel(u)) > 0)):
        yield "u", "must rise from 0 to 1"
    elif {"u", "s", "L"} <= {*number} and not np.all(abs(number["s"] - u * number["L"]) <= SAME * number["L"]):
        yield "s", "must be u L"


def check_study(study: Study, dimensions: Dimensions) -> None:
    """Raise `InputError` for a study with a case that a file cannot hold, before anything is solved."""
    for name, values in dimensions.fields.items():
        if why := wrong_axis(np.unique(values)):
            raise InputError(f"the axis {name} {why}: no file holds that")
    for name, why in unfit_fields(quantity_variables.numbers_of_case(study.case_of(dimensions.open()))):
        raise InputError(f"{name} of a study that is stored {why}")


def unfit(
    columns: Mapping[str, NDArray[Any]], counted: Collection[str], rod: Mapping[str, Any]
) -> Iterator[tuple[str, str, Mask]]:
    """What numbers of solved cases cannot be: a name, what is wrong in words, and in which cases (B,).

    columns: name in the file -> (B, ...); NaN says that a number is not known. counted: those that are whole numbers.
    rod: of each case L, rho and A, the bending stiffness; without them loads and lengths have no bounds.
    """
    L, rho, A = (rod.get(name) for name in ("L", "rho", "A"))
    for name, values in columns.items():
        if name in LOADS and rho is not None and A is not None:
            with np.errstate(all="ignore"):
                fits = np.abs(values) * rho ** (2 if name == "FZ" else 1) / A < MOST
            yield name, "is not finite, or far too large for its rod", ~np.asarray(fits)
        if name in CURVES:
            most = MOST_ANGLE if CURVES[name] in ("beta", "alpha", "gamma") else MOST
            with np.errstate(all="ignore"):  # of numbers that are stored in half precision
                far = np.abs(values).max(axis=tuple(range(1, values.ndim))).astype(float)
            yield name, f"is not finite, or beyond {most:g}", ~np.asarray(far < most)
            if CURVES[name] == "z" and L is not None:
                yield name, "is longer than the rod", np.asarray(far > L * (1 + STRAIGHT))
            if CURVES[name] == "alpha" and L is not None and rho is not None and "radius" not in columns:
                yield name, "goes round more than the rod is long", np.ptp(values, axis=-1) * rho > L * (1 + STRAIGHT)
        elif values.dtype.kind in "iuf":
            yield name, "is out of its range", _outside(name, values, name in counted, np.inf if L is None else L)


def _outside(name: str, values: NDArray[Any], is_counted: bool, L: Any) -> Mask:
    """Which numbers are outside the range of their observable, not whole, or not known where they must be."""
    row = OBSERVABLES.get(name)
    least = 0.0 if is_counted or name.endswith("_error") else -np.inf if row is None else row.least
    most: Any = np.inf if row is None else row.most
    most = np.asarray(L) * (1 + STRAIGHT) if most == "L" else most
    drawn = np.inf if name in JUDGED or name.endswith("_error") else MOST_DRAWN
    with np.errstate(all="ignore"):  # of NaN, and of numbers that are stored in single precision
        bad: Mask = (values < least) | (np.abs(values) > most * (1 + SAME))
        bad |= np.abs(values) > drawn
        bad |= is_counted & (values != np.round(values)) & ~np.isnan(values)
        return bad | (~(values >= 0) if name in JUDGED else False)


def fit_lines(text: str) -> str:
    """A text of many lines as a file holds it: the control characters of its comments are blanks."""
    return CONTROL.sub(" ", text)


def fit_text(text: str, most: int = LABEL) -> str:
    """A text of one line as a file holds it: at most so many printable characters, cut behind one of its parts."""
    text = text if text.isprintable() else "".join(letter if letter.isprintable() else " " for letter in text)
    if len(text) <= most:
        return text
    kept = text[: most - len(CUT)]
    return (kept.rpartition("; ")[0] or kept) + CUT
