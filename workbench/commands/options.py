"""The types of the options that several commands share; the fields of a case are in `case_options`."""

from pathlib import Path
from typing import Annotated, Any

import typer


def number(text: str) -> float:
    """A number from the command line; the error names the text."""
    try:
        return float(text)
    except ValueError:
        raise typer.BadParameter(f"{text!r} is not a number") from None


def angle(text: str) -> float:
    """An angle [rad] from the command line; the error names the text and the accepted forms."""
    from studies.angles import angle as read

    try:
        return read(text)
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None


def option(metavar: str, help: str, *names: str, **settings: Any) -> Any:
    """An option with a value; names: default: that of the parameter. settings: as of `typer.Option`."""
    return typer.Option(*names, metavar=metavar, help=help, **settings)


def numbered(help: str, *names: str) -> Any:
    """An option whose value is a number."""
    return option("NUMBER", help, *names, parser=number)


def flag(help: str, name: str) -> Any:
    """An option without a value."""
    return typer.Option(name, help=help)


def argument(metavar: str, help: str) -> Any:
    """A positional argument."""
    return typer.Argument(metavar=metavar, help=help, show_default=False)


File = Annotated[Path, argument("FILE", "Stored study, as the commands run and reproduce write it.")]
CaseFile = Annotated[Path | None, argument("FILE", "TOML study without axes; options replace its fields.")]
Reading = Annotated[
    str | None,
    option(
        "WORDS",
        "How to read Table 1: words of force-first|twist-first|shear, tension|compression, paper|solid, "
        "separated by /. An omitted word keeps the choice of the study.",
    ),
]
Tol = Annotated[
    float | None,
    numbered(
        "Tolerance: the error allowed, as a multiple of max(1, condition number); default: the study's, else 1e-08."
    ),
]
Fidelity = Annotated[
    str | None,
    option(
        "LEVEL",
        "draft, standard, fine or exact: sets the tolerance, the stations and what is computed. --tol "
        "overrides its tolerance; default: the study's settings, else standard.",
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
At = Annotated[
    list[str] | None,
    option(
        "AXIS=VALUE", "Value of an axis, such as E=10905 or beta=30deg, to as many digits as identify it; repeatable."
    ),
]
PixelError = Annotated[float, numbered("Largest error of the drawn surface [pixels].")]
ForcePicture = Annotated[bool, flag("Replace existing pictures.", "--force")]
ForceStudy = Annotated[bool, flag("Replace a file that does not hold this study.", "--force")]
Json = Annotated[bool, flag("Print JSON.", "--json")]
