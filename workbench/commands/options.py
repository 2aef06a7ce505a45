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


def numbered(help: str, *names: str) -> Any:
    """An option whose value is a number."""
    return typer.Option(*names, help=help, parser=number, metavar="NUMBER")


File = Annotated[
    Path,
    typer.Argument(
        metavar="FILE", help="Stored study, as the commands run and reproduce write it.", show_default=False
    ),
]
CaseFile = Annotated[
    Path | None, typer.Argument(metavar="FILE", help="TOML study without axes; options replace its fields.")
]
Reading = Annotated[
    str | None,
    typer.Option(
        metavar="WORDS",
        help="How to read Table 1: words of force-first|twist-first|shear, tension|compression, paper|solid, "
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
    typer.Option(
        "--fidelity",
        metavar="LEVEL",
        help="draft, standard, fine or exact: sets the tolerance, the stations and what is computed. --tol overrides "
        "its tolerance; default: the study's settings, else standard.",
    ),
]
Method = Annotated[
    str | None, typer.Option(metavar="NAME", help="Solver method, or auto; default: the study's, else auto.")
]
Choose = Annotated[
    str | None,
    typer.Option(
        metavar="RULE",
        help="Which equilibrium of an ends problem: nearest, lowest, or a Morse index (0, 1, 2, ...); default: "
        "nearest.",
    ),
]
At = Annotated[
    list[str] | None,
    typer.Option(
        metavar="AXIS=VALUE",
        help="Value of an axis, such as E=10905 or beta=30deg, to as many digits as identify it; repeatable.",
    ),
]
PixelError = Annotated[float, numbered("Largest error of the drawn surface [pixels].")]
ForcePicture = Annotated[bool, typer.Option("--force", help="Replace existing pictures.")]
ForceStudy = Annotated[bool, typer.Option("--force", help="Replace a file that does not hold this study.")]
Json = Annotated[bool, typer.Option("--json", help="Print JSON.")]
