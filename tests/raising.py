"""Functions of the solver that raise for one of three rods, which lie at the distance 1 from the axis."""

import pkgutil
from typing import Any

import numpy as np
import pytest

from solver import Case

LENGTHS = np.array([5.0, 6.0, 7.0])
RAISING = 6.0  # the length of the rod for which they raise


def lengths_in(value: Any) -> list[float]:
    """The lengths of the rods in an argument of a function."""
    case = getattr(value, "case", value)
    if isinstance(case, Case):
        return np.ravel(case.rod.L).tolist()
    return np.ravel(getattr(getattr(value, "rod", value), "span", ())).tolist()


def make_raise(function: str, error: BaseException, monkeypatch: pytest.MonkeyPatch) -> None:
    """Make a function, by its full name, raise where it takes the rod of the length `RAISING`."""
    owner, _, name = function.rpartition(".")
    place: Any = pkgutil.resolve_name(owner)
    working = getattr(place, name)

    def raising(*args: Any, **more: Any) -> Any:
        if any(np.isclose(length, RAISING) for value in args for length in lengths_in(value)):
            raise error
        return working(*args, **more)

    monkeypatch.setattr(place, name, raising)
