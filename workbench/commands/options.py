"""Options: the types of those that several commands share, and their texts as checked values.

The fields of a case are in `case_options`.
"""

from collections.abc import Callable, Mapping, Sequence
from math import isfinite, isnan
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from solver.problem.errors import InputError, no_such

if TYPE_CHECKING:
    from studies.grammar.axes import Which

    from ..stored.stored_study import StoredStudy


def number(text: str) -> float:
    """A number from the command line; the error names the text."""
    try:
        return float(text)
    except ValueError:
        hint = "; write it without a unit, which --help says" if text[:1].isdigit() else ""
        raise typer.BadParameter(f"{text!r} is not a number{hint}") from None


def number_or_text_of(name: str) -> Callable[[str], float | str]:
    """The parser of the option of a field: a number, or a text with a unit of that field, which is kept as it is."""

    def read(text: str) -> float | str:
        from solver.problem.units import size_of_unit, split

        try:
            value, unit = split(text)
            if unit:
                size_of_unit(name, unit)
        except InputError as error:
            raise typer.BadParameter(str(error)) from None
        return text if unit else value

    return read


def read_angle(name: str, text: str) -> float:
    """The angle of an option of that name [rad], with a notice if it looks like degrees. Raises `ValueError`."""
    from solver.problem.field_values import angle, doubt
    from solver.problem.notices import warn

    value = angle(text)
    if sentence := doubt(name, text):
        warn(sentence)
    return value


def angle_of(name: str) -> Callable[[str], float]:
    """The parser of an option of that name; its error names the text and the accepted forms."""

    def angle(text: str) -> float:
        try:
            return read_angle(name, text)
        except ValueError as error:
            raise typer.BadParameter(str(error)) from None

    return angle


def option(metavar: str, help: str, *names: str, **settings: Any) -> Any:
    """An option with a value; names: default: that of the parameter. settings: as of `typer.Option`."""
    return typer.Option(*names, metavar=metavar, help=help, **settings)


def number_option(help: str, *names: str, **settings: Any) -> Any:
    """An option whose value is a number; settings: as of `typer.Option`."""
    return option("NUMBER", help, *names, parser=number, **settings)


def flag(help: str, name: str, **settings: Any) -> Any:
    """An option without a value; settings: as of `typer.Option`."""
    return typer.Option(name, help=help, **settings)


def argument(metavar: str, help: str) -> Any:
    """A positional argument."""
    return typer.Argument(metavar=metavar, help=help, show_default=False)


File = Annotated[Path, argument("FILE", "Stored study: a file that run, reproduce or merge wrote.")]
CaseFile = Annotated[Path | None, argument("FILE", "TOML study without axes; options replace its fields.")]
Reading = Annotated[
    str | None,
    option(
        "WORDS",
        "Reading of Table 1: one to three words joined by /, at most one of force-first|twist-first|shear, one of "
        "tension|compression and one of paper|solid; default for an omitted word: the study's.",
    ),
]
Tol = Annotated[
    float | None,
    number_option(
        "Tolerance: a case is solved if its estimated error is at most this number times max(1, condition number); "
        "default: the study's, else 1e-08; of a rod that may leave the cylinder the error is that of a place over the "
        "length, 0.0001 by default, and 8192 edges of its mesh bound it."
    ),
]
Fidelity = Annotated[
    str | None,
    option(
        "LEVEL",
        "draft, standard, fine or exact: sets the tolerance, the stations and what is computed; --tol replaces "
        "that tolerance. Default: the study's settings, else standard.",
        "--fidelity",
    ),
]
Method = Annotated[str | None, option("NAME", "Solver method, or auto; default: the study's, else auto.")]
Choose = Annotated[
    str | None,
    option(
        "RULE",
        "Which equilibrium of an ends problem: nearest, lowest, or a Morse index (0, 1, 2, ...); default: nearest.",
    ),
]
AT = (
    "Stored value of an axis, such as E=10905 or beta=30deg. It may be rounded if only one stored value rounds to it. "
    "Give --at once for each axis."
)
At = Annotated[list[str] | None, option("AXIS=VALUE", AT)]
Style = Annotated[str, option("STYLE", "screen, or paper: letters of 8 points, 183 mm wide.", rich_help_panel="Print")]
Width = Annotated[
    float | None,
    number_option("Width of the picture [mm], such as 89 or 183; letters keep their size.", rich_help_panel="Print"),
]
NoTitle = Annotated[
    bool,
    flag("Leave out the title and what a caption tells; the command prints it.", "--no-title", rich_help_panel="Print"),
]
Dpi = Annotated[int, option("DPI", "Resolution of a .png [pixels/inch].", min=50, max=1200)]
Table1 = Annotated[bool, flag("Take the rod of Table 1; options replace its fields.", "--table1")]
OneCase = Annotated[Path | None, argument("FILE|STUDY", "TOML file or name of a study of one case; default: Table 1.")]
PixelError = Annotated[float, number_option("Largest error of the drawn surface [pixels].")]
ForceOutput = Annotated[bool, flag("Replace output files that exist.", "--force")]
ForceStudy = Annotated[bool, flag("Replace the file of --out even if it is not this study.", "--force")]
Json = Annotated[bool, flag("Print JSON.", "--json")]


def check_file(path: Path, suffixes: tuple[str, ...], force: bool) -> Path:
    """The path; raises `InputError` for another suffix, and as of `writing.check_new`."""
    from ..run import atomic, writing

    writing.check_new(atomic.check_name(path, suffixes), force)
    return path


def names(texts: Sequence[str] | None) -> list[str]:
    """The names in the values of a repeated option, each with one or more names separated by commas."""
    return [name.strip() for text in texts or () for name in text.split(",") if name.strip()]


def pairs(option: str, texts: Sequence[str] | None) -> dict[str, str]:
    """``["height=10", "pitch=2"]`` by name. Raises `InputError` for another form or a name that is given twice."""
    values: dict[str, str] = {}
    for text in texts or ():
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals and value):
            raise InputError(f"{option} takes NAME=VALUE, got {text!r}")
        if name in values:
            raise InputError(f"{option} {text}: {name} is given twice")
        values[name] = value
    return values


def numbers(option: str, texts: Sequence[str] | None, units: Mapping[str, str]) -> dict[str, float]:
    """The pairs with their values as numbers in these units, angles in rad. Raises `InputError`."""
    from studies.grammar.axes import is_angle

    values = {}
    for name, text in pairs(option, texts).items():
        values[name] = field_number(f"{option} {name}", name.partition("@")[0], text, units)
        if not isfinite(values[name]):
            forms = "a number in rad, or a form like 30deg" if is_angle(name) else "a finite number"
            raise InputError(f"{option} {name} must be {forms}, got {text!r}")
    return values


def field_number(option: str, name: str, text: str, units: Mapping[str, str]) -> float:
    """The number of a text for a field or observable, in these units; NaN of an unreadable one without a unit.

    Raises `InputError` for a unit that is unknown or of another quantity.
    """
    from solver.problem.quantities import AT_START, QUANTITIES
    from solver.problem.units import number_in, split
    from studies.grammar.axes import is_angle, number_of

    if is_angle(name) or AT_START.get(name, name) not in QUANTITIES:
        return number_of(name, text)
    try:
        unit = split(text)[1]
    except InputError:
        return float("nan")
    if not unit:
        return number_of(name, text)
    return number_in(name, text, units, option)


def axis_values(stored: "StoredStudy", at: Sequence[str] | None) -> dict[str, float]:
    """The stored value that each text of --at means, by the name of its axis. Raises `InputError` where it has none."""
    values: dict[str, float] = {}
    for name, value in pairs("--at", at).items():
        try:
            axis = stored.axis(name)
            number = stored.value(axis, value)
        except InputError as error:
            raise InputError(f"--at {name}={value}: {error}") from None
        if axis in values:
            raise InputError(f"--at {name}={value}: {axis} is given twice")
        values[axis] = number
    return values


def ranges(
    option: str, texts: Sequence[str] | None, units: Mapping[str, str], example: str = ""
) -> dict[str, tuple[float, float]]:
    """``["FZ=-50:10"]`` as name -> (low, high) in these units, angles in rad. Raises `InputError`."""
    each = (f"{name}={ends}" for name, ends in pairs(option, texts).items())
    read = [read_range(option, text, units, form="LOW:HIGH", example=example) for text in each]
    return {name: (low, high) for name, low, high, _ in read}


def read_range(
    option: str,
    text: str,
    units: Mapping[str, str],
    known: Sequence[str] = (),
    form: str = "FROM:TO",
    example: str = "",
) -> tuple[str, float, float, int]:
    """A field, the ends of its range, angles in rad, and how many values it has; 0 where the form has no count.

    Raises `InputError`.

    Parameters
    ----------
    option, text : str
        The option, for messages, and what was given: ``FZ=-50:10``, ``betaL=-90deg:60deg:41``, ``R=2in:4in``.
    units : dict
        The units of "length" and "force" of the numbers.
    known : sequence of str
        The fields that it takes; default: any name.
    form : str
        The parts behind ``NAME=``; with a third part, COUNT, the number of values.
    example : str
        An example, for messages.
    """
    from studies.grammar.axes import is_angle

    name, equals, said = text.partition("=")
    if known and name not in known:
        raise no_such("axis", name, known)
    parts = said.split(":")
    such = f", such as {example}" if example else ""
    if not equals or len(parts) != len(form.split(":")):
        raise InputError(f"{option} takes NAME={form}{such}, got {text!r}")
    try:
        if is_angle(name):
            low, high = (read_angle(f"{option} {name}", part) for part in parts[:2])
        else:
            low, high = (field_number(f"{option} {name}", name, part, units) for part in parts[:2])
        if isnan(low) or isnan(high):
            raise ValueError
        return name, low, high, int(parts[2]) if len(parts) > 2 else 0
    except InputError:
        raise
    except ValueError:
        raise InputError(f"{option} takes NAME={form} with numbers{such}, got {text!r}") from None


def parse_choose(text: str, given: Any = None) -> "Which":
    """``nearest``, ``lowest`` or a Morse index as the [equilibrium] table of a study.

    given: the start or the ends of the case. Raises `InputError`, also for a start, which has one solution.
    """
    from solver import Start
    from solver.held.equilibrium_choice import check
    from studies.grammar.axes import Which

    try:
        rule = check(int(text) if text.isdecimal() else text)
    except InputError:
        raise InputError(f"--choose must be nearest, lowest or a Morse index (0, 1, 2, ...), got {text!r}") from None
    if isinstance(given, Start):
        raise InputError("--choose selects among the equilibria of an ends problem; a start problem has one solution")
    return Which(index=rule) if isinstance(rule, int) else Which.model_validate({"choose": rule})
