"""Reads an angle written as text: a number in rad, ``30deg``, ``pi/6``, ``-2pi/3``.

Used for the fields of a case in Python, in a study and on the command line.
"""

import math
import re

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
    if found := _DEGREES.fullmatch(said):
        return math.radians(float(found[1]))
    if found := _PI.fullmatch(said):
        below = float(found[3] or 1)
        if below:
            size = float(found[2] or 1) * math.pi / below
            return -size if found[1] == "-" else size
    try:
        return float(said.removesuffix("rad"))
    except ValueError:
        raise ValueError(f"{text!r} is not an angle: give {FORMS}") from None
