"""The types of the options that several commands share; the fields of a case are in `case_options`."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer


def number(text: str) -> float:
    """A number from the command line; the error names the text."""
    try:
        return float(text)
    except ValueError:
        hint = "; write the number without a unit, which --help says" if text[:1].isdigit() else ""
        raise typer.BadParameter(f"{text!r} is not a number{hint}") from None


def read_angle(name: str, text: str) -> float:
    """The angle of an option of that name [rad], with a notice if it looks like degrees. Raises `ValueError`."""
    from solver.problem import angles

    value = angles.angle(text)
    if sentence := angles.doubt(name, text):
        angles.warn(sentence)
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
        "default: the study's, else 1e-08."
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
