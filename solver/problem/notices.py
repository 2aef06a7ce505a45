"""Notices: warnings of values that may be meant otherwise, at the line of the program that gives them."""

import sys
import warnings
from collections.abc import Iterator

_OWN = ("solver", "studies", "workbench", "dataclasses")


class UnitWarning(UserWarning):
    """A number without a unit looks as if it is meant in another unit than that in which it is read."""


class AngleWarning(UnitWarning):
    """A number without a unit is read in rad, but looks like degrees."""


class RenamedWarning(FutureWarning):
    """A quantity is given by its former name."""


def kind_of(sentence: str) -> type[UnitWarning]:
    """The warning that a notice is: of an angle, or of another quantity."""
    return AngleWarning if " degrees; " in sentence else UnitWarning


def warn(sentence: str, kind: type[Warning] = AngleWarning) -> None:
    """Issue the notice as a warning at the line of the program that called this package."""
    level = 1
    for name in _callers():
        if name.partition(".")[0] not in (*_OWN, "numpy", "xarray", "functools"):  # which call it between
            break
        level += 1
    warnings.warn(sentence, kind, stacklevel=level + 1)


def is_called_by_a_program() -> bool:
    """Whether a program of the user calls what makes or varies a case, not this package."""
    makers = {f"solver.{name}" for name in ("problem.notices", "problem.field_values", "problem.case", "follow")}
    maker = next((name for name in _callers() if name not in makers | {"dataclasses"}), "")
    return maker.partition(".")[0] not in _OWN


def _callers() -> Iterator[str]:
    """The names of the modules of the calling functions, from the one that called the function that asks."""
    frame = sys._getframe(2)
    while frame is not None:
        yield str(frame.f_globals.get("__name__", ""))
        frame = frame.f_back  # type: ignore[assignment]
