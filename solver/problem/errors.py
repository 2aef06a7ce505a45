"""The error that the solver raises for an invalid value, and the wording of its messages."""

from collections.abc import Iterable
from difflib import get_close_matches


class InputError(ValueError):
    """An invalid value; the message names the value and, if there are any, the choices.

    Examples
    --------
    >>> from solver import Cylinder, InputError
    >>> try:
    ...     Cylinder(R=-0.75)
    ... except InputError as error:
    ...     print(error)
    Cylinder.R must be positive and finite, got -0.75
    """


def choices(names: Iterable[object]) -> str:
    """The names as a list in a sentence: ``a, b, c``."""
    return ", ".join(str(name) for name in names)


def no_such(kind: str, name: object, names: Iterable[object]) -> InputError:
    """The error ``no method 'rk5', did you mean 'rk4'; choose from orbit, rk4``."""
    known = list(names)
    return InputError(f"no {kind} {name!r}{near(name, known)}; choose from {choices(known)}")


def near(name: object, known: Iterable[object]) -> str:
    """``, did you mean 'sobol'`` where a known name is close to this one; else nothing."""
    close = get_close_matches(str(name)[:60], [str(one) for one in known], 1)
    return f", did you mean {close[0]!r}" if close else ""
