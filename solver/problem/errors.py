"""The error that the solver raises for an invalid value, and the wording of its messages."""

from collections.abc import Iterable


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
    """The error ``no method 'rk5'; choose from orbit, verlet``."""
    return InputError(f"no {kind} {name!r}; choose from {choices(names)}")
