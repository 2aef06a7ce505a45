"""Options of the command line for the fields of a case, as types of arguments; solve and explore share them."""

from typing import Annotated, Any

import typer


def number(text: str) -> float:
    """A number from the command line; the refusal names what was given."""
    try:
        return float(text)
    except ValueError:
        raise typer.BadParameter(f"{text!r} is not a number") from None


def angle(text: str) -> float:
    """An angle from the command line, in rad; the refusal names what was given and the forms."""
    from solver.problem.angles import angle as read

    try:
        return read(text)
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None


def numbered(help: str, *names: str) -> Any:
    """An option that is a number."""
    return typer.Option(*names, help=help, parser=number, metavar="NUMBER")


def angled(help: str, *names: str) -> Any:
    """An option that is an angle."""
    return typer.Option(*names, help=help, parser=angle, metavar="ANGLE")


LengthUnit = Annotated[str | None, typer.Option(help="Of every length given; cm where left out.")]
ForceUnit = Annotated[str | None, typer.Option(help="Of every force given; N where left out.")]
E = Annotated[float | None, numbered("Young's modulus [force/length^2].", "--E")]
nu = Annotated[float | None, numbered("Poisson ratio.")]
a = Annotated[float | None, numbered("Radius of the rod [length].", "--a")]
L = Annotated[float | None, numbered("Length of the rod [length].", "--L")]
stiffness = Annotated[str | None, typer.Option(help="solid or paper; solid where left out.")]
R = Annotated[float | None, numbered("Radius of the cylinder [length].", "--R")]
side = Annotated[str | None, typer.Option(help="outside or inside; outside where left out.")]
beta = Annotated[float | None, angled("Start: angle from the axis.")]
dbeta = Annotated[float | None, numbered("Start: its rate [rad/length].")]
F1 = Annotated[float | None, numbered("Start: normal force, which fixes the twist.", "--F1")]
dgamma = Annotated[float | None, numbered("Start: rotation rate of the section [rad/length].")]
M3 = Annotated[float | None, numbered("Start or ends: twisting moment [force length].", "--M3")]
F2 = Annotated[float | None, numbered("Start: in-surface shear; 0 where left out.", "--F2")]
F3 = Annotated[float | None, numbered("Start: tangential force, tension positive; 0.", "--F3")]
beta0 = Annotated[float | None, angled("Ends: angle from the axis at s = 0.", "--beta0")]
betaL = Annotated[float | None, angled("Ends: angle at s = L, whole turns counted.", "--betaL")]
FZ = Annotated[float | None, numbered("Ends: axial force, tension positive; 0.", "--FZ")]
MZ = Annotated[float | None, numbered("Ends: axial moment [force length]; 0.", "--MZ")]
alpha = Annotated[float | None, angled("Azimuth at s = 0; 0 where left out.")]
gamma = Annotated[float | None, angled("Rotation of the section at s = 0; 0 where left out.")]
