"""Reads an angle written as text: a number in rad, ``30deg``, ``pi/6``, ``-2pi/3``.

Used for the fields of a case in Python, in a study and on the command line. A number without a unit that looks like
degrees is read in rad too, with a notice: `doubt` decides where, for all three.
"""

import math
import re
import sys
import warnings
from collections.abc import Iterator

FORMS = "a number in rad, or a form like 30deg, pi/6 or 2pi/3"

_NUMBER = r"(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_DEGREES = re.compile(rf"([+-]?{_NUMBER})\s*(?:deg|°)")
_PI = re.compile(rf"([+-]?)\s*({_NUMBER})?\s*\*?\s*(?:pi|π)(?:\s*/\s*({_NUMBER}))?")


def angle(text: str) -> float:
    """The angle that a text denotes [rad].

    Raises `ValueError`, whose message names the text and the accepted forms.

    >>> angle("30deg") == angle("pi/6")
    True
    """
    said = text.strip()
    if match := _DEGREES.fullmatch(said):
        return math.radians(float(match[1]))
    if match := _PI.fullmatch(said):
        below = float(match[3] or 1)
        if below:
            size = float(match[2] or 1) * math.pi / below
            return -size if match[1] == "-" else size
    try:
        return float(said.removesuffix("rad"))
    except ValueError:
        raise ValueError(f"{text!r} is not an angle: give {FORMS}") from None


# A number of rad above this size with at most so many decimals may be meant in degrees. Computed angles have more
# decimals, also an angle that was given in degrees and converted.
_DOUBTED = ((math.pi, 1), (13.0, 4))  # a half turn; a little more than two turns
_MOST = 1e6  # nobody writes as many degrees
_OWN = ("solver", "studies", "workbench", "dataclasses")
_MAKERS = (
    "solver.problem.angles",
    "solver.problem.field_values",
    "solver.problem.case",
    "solver.follow",
    "dataclasses",
)


class AngleWarning(UserWarning):
    """A number without a unit is read in rad, but looks like degrees."""


def doubt(name: str, value: object) -> str:
    """The notice about the angle of that name if it may be meant in degrees, else an empty text.

    value: as a user gives it: a number, a text, or a list or an array of these; its largest doubtful number is named.

    >>> doubt("beta0", 5)
    'beta0 = 5 is read as 5 rad = 286.48 degrees; write "5 deg" if degrees are meant, or "5 rad"'
    >>> doubt("beta0", "5 rad"), doubt("beta0", 3), doubt("beta0", 6.283185307179586)
    ('', '', '')
    """
    doubtful = [number for number in _numbers(value) if _looks_like_degrees(number)]
    if not doubtful:
        return ""
    worst = max(doubtful, key=abs)
    said = f"{worst:.10g}"
    return (
        f"{name} = {said} is read as {said} rad = {math.degrees(worst):.2f} degrees; "
        f'write "{said} deg" if degrees are meant, or "{said} rad"'
    )


def _numbers(value: object) -> Iterator[float]:
    """The finite numbers without a unit in a value."""
    value = getattr(value, "tolist", lambda: value)()
    if isinstance(value, (list, tuple)):
        for element in value:
            yield from _numbers(element)
        return
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        return
    if math.isfinite(number):
        yield number


def _looks_like_degrees(number: float) -> bool:
    return abs(number) < _MOST and any(
        abs(number) > size and round(number, decimals) == number for size, decimals in _DOUBTED
    )


def warn(sentence: str) -> None:
    """Issue the notice as a warning at the line of the program that called this package."""
    level = 1
    for name in _callers():
        if name.partition(".")[0] not in _OWN:
            break
        level += 1
    warnings.warn(sentence, AngleWarning, stacklevel=level + 1)


def given_by_a_program() -> bool:
    """Whether a program of the user calls what makes or varies a case, not this package."""
    maker = next((name for name in _callers() if name not in _MAKERS), "")
    return maker.partition(".")[0] not in _OWN


def _callers() -> Iterator[str]:
    """The names of the modules of the calling functions, from the one that called the function that asks."""
    frame = sys._getframe(2)
    while frame is not None:
        yield str(frame.f_globals.get("__name__", ""))
        frame = frame.f_back  # type: ignore[assignment]
