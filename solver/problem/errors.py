"""The errors a user of the solver meets."""

from collections.abc import Iterable


class InputError(ValueError):
    """A value was refused at the door; the message names the value and, where there are any, the choices."""


def choices(names: Iterable[object]) -> str:
    """The names as a sentence lists them: ``a, b, c``."""
    return ", ".join(str(name) for name in names)


def no_such(kind: str, name: object, names: Iterable[object]) -> InputError:
    """``no method 'rk5'; choose from orbit, verlet`` as an error to raise."""
    return InputError(f"no {kind} {name!r}; choose from {choices(names)}")
