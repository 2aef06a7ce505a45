"""What every call takes: the tolerance, and whole numbers with their ranges."""

import operator
from typing import Any

from .errors import InputError, show

DEFAULT_TOLERANCE = 1e-8


def check_tolerance(tol: Any) -> float:
    """The tolerance as a float. Raises `InputError` unless it is between 0 and 1."""
    try:
        value = float(tol)
    except (TypeError, ValueError, OverflowError):
        value = -1.0
    if not 0 < value < 1:
        raise InputError(f"tol must be a number between 0 and 1, got {show(tol)}")
    return value


def whole_number(name: str, value: Any, least: int, most: int) -> int:
    """The value as an int. Raises `InputError` unless it is a whole number from `least` to `most`."""
    try:
        number = operator.index(value)
    except TypeError:
        number = least - 1
    if isinstance(value, bool) or not least <= number <= most:
        raise InputError(f"{name} must be a whole number from {least} to {most}, got {show(value)}")
    return number
