"""The tolerance: its default, and its range."""

from typing import Any

from .errors import InputError

DEFAULT_TOLERANCE = 1e-8


def checked_tolerance(tol: Any) -> float:
    """The tolerance as a float. Raises `InputError` unless it is between 0 and 1."""
    try:
        value = float(tol)
    except (TypeError, ValueError):
        value = -1.0
    if not 0 < value < 1:
        raise InputError(f"tol must be a number between 0 and 1, got {tol!r}")
    return value
