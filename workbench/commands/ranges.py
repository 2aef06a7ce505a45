"""Ranges of fields as options write them: ``FZ=-50:10``, ``betaL=-90deg:60deg:41``."""

from collections.abc import Sequence
from functools import partial

from .case_options import ENDS_FIELDS, FIELDS
from .options import read_angle

ENDS_NUMBERS = tuple(name for name in ENDS_FIELDS if not FIELDS[name].choices)


def read_range(
    option: str, text: str, names: Sequence[str] = (), form: str = "FROM:TO", example: str = ""
) -> tuple[str, float, float, int]:
    """A field, the ends of its range, angles in rad, and how many values it has; 0 where the form has no count.

    Raises `InputError`.

    Parameters
    ----------
    option, text : str
        The option, for messages, and what was given.
    names : sequence of str
        The fields that it takes; default: any name.
    form : str
        The parts behind ``NAME=``; with a third part, COUNT, the number of values.
    example : str
        An example, for messages.
    """
    from solver import InputError
    from solver.problem.errors import no_such

    name, equals, said = text.partition("=")
    if names and name not in names:
        raise no_such("axis", name, names)
    parts = said.split(":")
    such = f", such as {example}" if example else ""
    if not equals or len(parts) != len(form.split(":")):
        raise InputError(f"{option} takes NAME={form}{such}, got {text!r}")
    is_angle = name in FIELDS and FIELDS[name].unit == "rad"
    try:
        low, high = map(partial(read_angle, f"{option} {name}") if is_angle else float, parts[:2])
        return name, low, high, int(parts[2]) if len(parts) > 2 else 0
    except ValueError:
        raise InputError(f"{option} takes NAME={form} with numbers{such}, got {text!r}") from None
