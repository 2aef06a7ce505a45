"""Options as checked values: texts as names, numbers, ranges and axes; the file to write; the sheet of a picture."""

from collections.abc import Sequence
from functools import partial
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .case_options import ENDS_FIELDS, FIELDS, HELD
from .options import read_angle

if TYPE_CHECKING:
    import numpy as np
    import xarray as xr

    from studies.grammar.axes import Which

    from ..figures.sheet import Sheet

ENDS_NUMBERS = tuple(name for name in ENDS_FIELDS if not FIELDS[name].choices)
MAX_COUNT = 401  # values of an axis over which equilibria are followed


def check(path: Path, suffixes: tuple[str, ...], force: bool) -> Path:
    """The path; raises `InputError` for another suffix, a folder, or without `force` an existing file."""
    from solver.problem.errors import InputError, choices

    from ..store import writing

    if path.suffix.lower() not in suffixes:
        raise InputError(f"cannot write {path.name!r}: choose a name that ends in {choices(suffixes)}")
    if path.is_dir():
        raise InputError(f"{path} is a folder; give the name of a file")
    writing.check_parent(path)
    if path.exists() and not force:
        raise InputError(f"{path} exists; give --force to replace it")
    return path


def names(texts: Sequence[str] | None) -> list[str]:
    """The names in the values of a repeated option, each with one or more names separated by commas."""
    return [name.strip() for text in texts or () for name in text.split(",") if name.strip()]


def pairs(option: str, texts: Sequence[str]) -> dict[str, str]:
    """``["height=10", "wraps=2"]`` by name. Raises `InputError` for another form or a name that is given twice."""
    from solver.problem.errors import InputError

    found: dict[str, str] = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals and value):
            raise InputError(f"{option} takes NAME=VALUE, got {text!r}")
        if name in found:
            raise InputError(f"{option} {text}: {name} is given twice")
        found[name] = value
    return found


def numbers(option: str, texts: Sequence[str]) -> dict[str, float]:
    """The pairs with their values as numbers, angles in rad also from forms like 30deg. Raises `InputError`."""
    return {name: _number(f"{option} {name}", name, value) for name, value in pairs(option, texts).items()}


def _number(what: str, name: str, text: str) -> float:
    from solver.problem.errors import InputError
    from studies.grammar.axes import is_angle, number_of

    value = number_of(name, text)
    if not isfinite(value):
        forms = "a number in rad, or a form like 30deg" if is_angle(name) else "a finite number"
        raise InputError(f"{what} must be {forms}, got {text!r}")
    return value


def axis_values(ds: "xr.Dataset", at: Sequence[str]) -> dict[str, float]:
    """The stored value that each text of --at means, by the name of its axis. Raises `InputError` where it has none."""
    from solver.problem.errors import InputError

    from ..store import selection

    found: dict[str, float] = {}
    for name, value in pairs("--at", at).items():
        try:
            axis = selection.axis_of(ds, name)
            stored = float(ds[axis].values[selection.index(ds, axis, value)])
        except InputError as error:
            raise InputError(f"--at {name}={value}: {error}") from None
        if axis in found:
            raise InputError(f"--at {name}={value}: {axis} is given twice")
        found[axis] = stored
    return found


def ranges(option: str, texts: Sequence[str], example: str = "") -> dict[str, tuple[float, float]]:
    """``["FZ=-50:10"]`` as name -> (low, high), angles in rad. Raises `InputError`."""
    each = (f"{name}={ends}" for name, ends in pairs(option, texts).items())
    read = [read_range(option, text, form="LOW:HIGH", example=example) for text in each]
    return {name: (low, high) for name, low, high, _ in read}


def read_range(
    option: str, text: str, known: Sequence[str] = (), form: str = "FROM:TO", example: str = ""
) -> tuple[str, float, float, int]:
    """A field, the ends of its range, angles in rad, and how many values it has; 0 where the form has no count.

    Raises `InputError`.

    Parameters
    ----------
    option, text : str
        The option, for messages, and what was given: ``FZ=-50:10``, ``betaL=-90deg:60deg:41``.
    known : sequence of str
        The fields that it takes; default: any name.
    form : str
        The parts behind ``NAME=``; with a third part, COUNT, the number of values.
    example : str
        An example, for messages.
    """
    from solver.problem.errors import InputError, no_such
    from studies.grammar.axes import is_angle

    name, equals, said = text.partition("=")
    if known and name not in known:
        raise no_such("axis", name, known)
    parts = said.split(":")
    such = f", such as {example}" if example else ""
    if not equals or len(parts) != len(form.split(":")):
        raise InputError(f"{option} takes NAME={form}{such}, got {text!r}")
    try:
        low, high = map(partial(read_angle, f"{option} {name}") if is_angle(name) else float, parts[:2])
        return name, low, high, int(parts[2]) if len(parts) > 2 else 0
    except ValueError:
        raise InputError(f"{option} takes NAME={form} with numbers{such}, got {text!r}") from None


def parse_axis(text: str) -> "tuple[str, np.ndarray]":
    """``betaL=-90deg:60deg:41`` as a field and the values of such an axis of a study, rising. Raises `InputError`."""
    from solver import InputError
    from studies.grammar.axes import Axis

    name, first, last, count = read_range("--axis", text, (*ENDS_NUMBERS, *HELD), "FROM:TO:COUNT")
    if not 2 <= count <= MAX_COUNT or first == last or not (isfinite(first) and isfinite(last)):
        raise InputError(f"--axis needs two different finite ends and a count from 2 to {MAX_COUNT}, got {text!r}")
    axis = Axis.model_validate({"from": min(first, last), "to": max(first, last), "count": count})
    return name, axis.numbers()


def parse_choose(text: str, given: Any = None) -> "Which":
    """``nearest``, ``lowest`` or a Morse index as the [equilibrium] table of a study.

    given: the start or the ends of the case. Raises `InputError`, also for a start, which has one solution.
    """
    from solver import InputError, Start
    from solver.choose.selection import check
    from studies.grammar.axes import Which

    try:
        rule = check(int(text) if text.isdecimal() else text)
    except InputError:
        raise InputError(f"--choose must be nearest, lowest or a Morse index (0, 1, 2, ...), got {text!r}") from None
    if isinstance(given, Start):
        raise InputError("--choose selects among the equilibria of an ends problem; a start problem has one solution")
    return Which(index=rule) if isinstance(rule, int) else Which.model_validate({"choose": rule})


def page(picture: Path | None, style: str, width: float | None, no_title: bool) -> "Sheet | None":
    """The sheet of the options; None where none of them is given.

    Raises `InputError` for an invalid option, and where there is no picture.
    """
    from solver.problem.errors import InputError

    from ..figures.sheet import SCREEN, sheet

    given = {"--style": style != SCREEN.style, "--width": width is not None, "--no-title": no_title}
    named = [name for name, is_given in given.items() if is_given]
    if not named:
        return None
    if picture is None:
        raise InputError(f"{named[0]} is an option of the picture: give also --plot FILE")
    return sheet(style, width, not no_title)
