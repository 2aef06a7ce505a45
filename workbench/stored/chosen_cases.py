"""Which value of an axis a user means, as a number or as written; and some of several cases, evenly chosen.

A number means the stored value that agrees with it to nine digits. A text such as ``10910`` or ``30deg`` means the one
stored value that it abbreviates: the one that, rounded to the digits written, is that text.
"""

import math
from decimal import Decimal, InvalidOperation
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from solver.problem.errors import InputError, choices
from solver.problem.units import size_of_unit, split, unit_size
from studies.grammar.axes import SAMPLE, in_rad, is_angle

if TYPE_CHECKING:
    import xarray as xr

SAME = 1e-9  # share by which a number may differ from the stored value that it means
LISTED = 12  # values of an axis that a message lists
WRITTEN = 4  # digits of a value in a diagram
LOOSEST = 0.001  # share of a value by which a text of one or two digits may differ from it

Array = NDArray[np.float64]
Value = float | str


def spread(places: list[dict[str, int]], count: int) -> list[dict[str, int]]:
    """At most so many of them, evenly chosen, both ends among them."""
    if len(places) <= count:
        return places
    return [places[i] for i in np.linspace(0, len(places) - 1, count).round().astype(int)]


def index(values: "xr.DataArray", value: Value) -> int:
    """The index of the value of an axis that is meant. Raises `InputError` with the stored values."""
    name, axis = str(values.name), np.asarray(values.values, dtype=float)
    value = _without_unit(values, value)
    number = real(name, value)
    away = np.abs(axis - number)
    nearest = int(away.argmin())
    if away[nearest] <= _tolerance(axis, number):
        return nearest
    for half in (_half_digit(value), _half_digit(value, zeros=False)) if isinstance(value, str) else ():
        close = np.flatnonzero(away <= min(half, LOOSEST * abs(number)))
        if close.size == 1:
            return int(close[0])
        if close.size:
            break
    shown = value if isinstance(value, str) else write(name, number, 10)
    raise InputError(f"{name} = {shown} is not on the axis; {_list(axis, name, number)}")


def indices(values: "xr.DataArray", value: Any) -> Any:
    """The index of a value, those of a list of values, or those of the values in a slice. Raises `InputError`."""
    if isinstance(value, slice):
        return _between(values, value)
    if isinstance(value, list | tuple | np.ndarray):
        return [index(values, each) for each in value]
    return index(values, value)


def _without_unit(values: "xr.DataArray", value: Value) -> Value:
    """A text with a unit as its number in the unit of the axis; any other value as it is. Raises `InputError`."""
    name, unit_of_axis = str(values.name), str(values.attrs.get("units", "1"))
    if not isinstance(value, str) or is_angle(name) or unit_of_axis == "1":
        return value
    try:
        number, unit = split(value)
    except InputError:  # no number, which `real` says
        return value
    return number * size_of_unit(name, unit) / unit_size(unit_of_axis)[0] if unit else value


def real(name: str, value: Any) -> float:
    """The value of a field as a finite number, an angle's also from text as `30deg`; or `InputError`."""
    try:
        number = in_rad(value) if is_angle(name) else value
    except ValueError as error:
        raise InputError(f"{name}: {error}") from None
    try:
        number = float(number)
    except (TypeError, ValueError, OverflowError):
        number = np.nan
    if not np.isfinite(number):
        raise InputError(f"{name} must be a finite number, got {value!r}")
    return number


def write(name: str, value: float, digits: int = 6) -> str:
    """A value of an axis as a user writes it: ``10905``, and ``30deg`` for an angle; a number of a sample in full."""
    if name == SAMPLE and value.is_integer():
        return str(int(value))
    return f"{math.degrees(value):.{digits}g}deg" if is_angle(name) else f"{value:.{digits}g}"


def _tolerance(axis: Array, value: float) -> float:
    """How far a stored value may be from the one given: for rounding in its size, and in the steps of the axis."""
    steps = np.diff(np.sort(axis))
    return SAME * max(abs(value), float(steps.min()) if steps.size else 0.0)


def _half_digit(text: str, zeros: bool = True) -> float:
    """Half a unit in the last digit of a number as it is written, in rad where degrees are; 0 for pi/6.

    zeros: whether those at its end count as digits; otherwise at least `WRITTEN` others are needed, as a diagram writes
    10910 for 10905.
    """
    number = text.strip().removesuffix("deg")
    try:
        decimal = Decimal(number.strip())
        exact = decimal.normalize().as_tuple()
        exponent = decimal.as_tuple().exponent if zeros or len(exact.digits) < WRITTEN else exact.exponent
    except InvalidOperation:
        return 0.0
    half = 0.5 * 10.0**exponent if isinstance(exponent, int) else 0.0
    return math.radians(half) if number != text.strip() else half


def _between(values: "xr.DataArray", bounds: slice) -> NDArray[np.intp]:
    name, axis = str(values.name), np.asarray(values.values, dtype=float)
    if bounds.step is not None:
        raise InputError(f"{name} takes a slice without a step, got {bounds}")
    low = -np.inf if bounds.start is None else real(name, bounds.start)
    high = np.inf if bounds.stop is None else real(name, bounds.stop)
    inside = (axis >= low - _tolerance(axis, low)) & (axis <= high + _tolerance(axis, high))
    if not inside.any():
        near = low if np.isfinite(low) else high
        ends = f"from {write(name, low, 10)} to {write(name, high, 10)}"
        raise InputError(f"{name} has no values {ends}; {_list(axis, name, near)}")
    return np.flatnonzero(inside)


def _list(axis: Array, name: str, near: float) -> str:
    if axis.size <= LISTED:
        return f"its values are {choices(write(name, v, 10) for v in axis)}"
    nearest = np.sort(axis[np.argsort(np.abs(axis - near))[:2]])
    ends = f"from {write(name, axis.min(), 10)} to {write(name, axis.max(), 10)}"
    return f"its {axis.size} values go {ends}, the nearest are {choices(write(name, v, 10) for v in nearest)}"


def known_cases(array: "xr.DataArray") -> str:
    """The cases that have a number, in words: ``all cases``, or ``the 10 of 16 cases that have a number``."""
    known = int(np.isfinite(np.asarray(array.values, dtype=float)).sum())
    return "all cases" if known == array.size else f"the {known} of {array.size} cases that have a number"
