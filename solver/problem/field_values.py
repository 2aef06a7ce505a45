"""The values of the fields of a case: numbers and arrays, validated when a part of the case is made."""

from collections.abc import Callable
from dataclasses import MISSING, dataclass, fields
from functools import wraps
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .angles import FORMS, angle, doubt, given_by_a_program, warn
from .errors import InputError, choices, near, show

T = TypeVar("T")

# the fields that may be text, read by `angles.angle`
ANGLES = ("beta", "beta0", "betaL", "alpha", "gamma", "azimuth", "rotation", "inclination")


@dataclass(frozen=True)
class Range:
    """Where the values of a field must be: above `low`, or from it on if it is `closed`, to `high`. rule: in words."""

    low: float
    rule: str
    closed: bool = False
    high: float = float("inf")

    def excludes(self, value: ArrayLike) -> Any:
        """Which values are outside."""
        below = np.less(value, self.low) if self.closed else np.less_equal(value, self.low)
        return below | np.greater(value, self.high)


POSITIVE = ("E", "EI", "GJ", "a", "L", "R")
_NOT_NEGATIVE = Range(0, "at least 0", closed=True)
RANGES = {
    **dict.fromkeys(POSITIVE, Range(0, "positive and finite")),
    "nu": Range(-1, "in (-1, 0.5]", high=0.5),
    "inner_radius": Range(0, "at least 0 and less than Rod.a", closed=True),
    "weight": _NOT_NEGATIVE,
    "friction": _NOT_NEGATIVE,
    "inclination": Range(0, "from 0 to pi rad (180 deg)", closed=True, high=np.pi * (1 + 1e-15)),
}


def refuse_outside(part: Any, *names: str) -> None:
    """Raise `InputError` for the first of these fields, of those that are given, that is outside its `RANGES`."""
    for name in names:
        value = getattr(part, name)
        if value is not None:
            refuse(type(part).__name__, name, value, RANGES[name].excludes(value), RANGES[name].rule)


def check_field_names(kind: type[T]) -> type[T]:
    """Decorate a dataclass: an unknown, a missing and a surplus argument raise `InputError` with the choices."""
    known = {field.name: field.default is MISSING for field in fields(kind)}  # type: ignore[arg-type]
    make: Callable[..., None] = kind.__init__

    @wraps(make)
    def init(self: T, *values: Any, **named: Any) -> None:
        given = [*list(known)[: len(values)], *named]
        for name in named:
            if name not in known:
                hint = f"{near(name, known)}; choose from {choices(known)}"
                raise InputError(f"no field {name!r} in {kind.__name__}{hint}")
        if len(values) > len(known) or len(set(given)) < len(given):
            raise InputError(f"{kind.__name__} takes each of {choices(known)} once, got {choices(given)}")
        if missing := [name for name, needed in known.items() if needed and name not in given]:
            raise InputError(f"{kind.__name__} needs {choices(missing)}; got {choices(given) or 'nothing'}")
        make(self, *values, **named)

    kind.__init__ = init  # type: ignore[assignment, method-assign]
    return kind


def _numbers(owner: str, field: str, value: Any) -> NDArray[np.float64] | float:
    """The value as a float or a read-only float array, angles in rad; `InputError` for other and non-finite values."""
    try:
        array = np.asarray(value)
        if field in ANGLES and array.dtype.kind in "UO":
            array = in_rad(np.array(value, dtype=object))
        if not _only_numbers(array):
            raise TypeError
        with np.errstate(over="ignore"):  # a number beyond the floats is refused as infinite
            array = np.array(array, dtype=float)
    except OverflowError:
        raise InputError(f"{owner}.{field} must be a number that a float can hold, got {show(value)}") from None
    except (TypeError, ValueError):
        form = f"{FORMS}; or an array of these" if field in ANGLES else "a number or an array of numbers"
        raise InputError(f"{owner}.{field} must be {form}, got {show(value)}") from None
    if array.size == 0:
        raise InputError(f"{owner}.{field} is empty; give at least one value")
    refuse(owner, field, array, ~np.isfinite(array), "finite")
    if array.ndim == 0:
        return float(array)
    array.setflags(write=False)
    return array


def in_rad(values: NDArray[Any]) -> NDArray[Any]:
    """An array of objects with each text replaced by its angle. Raises `ValueError`."""
    read = [angle(element) if isinstance(element, str) else element for element in values.flat]
    return np.array(read, dtype=object).reshape(values.shape)


def _only_numbers(array: NDArray[Any]) -> bool:
    """Whether each element is a real number; text is not a number, even "5"."""
    if array.dtype.kind == "O":
        return not any(element is None or isinstance(element, (str, bytes)) for element in array.flat)
    return array.dtype.kind in "biuf"


def refuse(owner: str, field: str, value: ArrayLike, bad: ArrayLike, rule: str) -> None:
    """Raise `InputError` with the first bad value, if there is any."""
    bad = np.atleast_1d(bad)
    if bad.any():
        worst = np.atleast_1d(np.asarray(value))[bad].flat[0]
        where = f" (the first of {int(bad.sum())} invalid values among {bad.size})" if bad.size > 1 else ""
        raise InputError(f"{owner}.{field} must be {rule}, got {worst!s}{where}")


def check_numbers(self: Any, skip: tuple[str, ...] = ()) -> None:
    """Turn each numeric field of a frozen dataclass into floats or read-only arrays."""
    for field in fields(self):
        value = getattr(self, field.name)
        optional = field.default is None
        if field.name not in skip and not (optional and value is None):
            read = _numbers(type(self).__name__, field.name, value)
            object.__setattr__(self, field.name, read)
            if field.name in ANGLES:
                _notice(field.name, value, read)


def write_fields(self: Any, skip: tuple[str, ...] = ()) -> str:
    """A part of a case as it would be made: ``Cylinder(R=0.75, side='inside')``, without fields that are None."""
    values = ((field.name, getattr(self, field.name)) for field in fields(self) if field.name not in skip)
    return f"{type(self).__name__}({choices(f'{name}={value!r}' for name, value in values if value is not None)})"


def _notice(field: str, value: Any, read: NDArray[np.float64] | float) -> None:
    """Warn of an angle that a program gives without a unit if it may be meant in degrees."""
    large = np.abs(read) > np.pi
    if np.any(large) and given_by_a_program():
        numbers = value[large] if isinstance(value, np.ndarray) and value.dtype.kind in "if" else value
        if sentence := doubt(field, numbers):
            warn(sentence)
