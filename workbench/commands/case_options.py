"""The options for the fields of a case: one table, from which the options of solve, explore and equilibria are made.

The table is written out, and not derived from the dataclasses of `solver`, because --help must not import NumPy.
`tests/workbench/test_case_options.py` compares it with those dataclasses and with the table of quantities.
"""

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import wraps
from typing import Annotated, Any, TypeVar

from .options import angle_of, number_option, option

T = TypeVar("T")  # what a command returns


@dataclass(frozen=True)
class CaseField:
    """A field of a case.

    Attributes
    ----------
    name, words
        The field, and a phrase that begins with the long name of its quantity.
    unit
        In terms of "length" and "force"; "rad" for an angle, "1" for a ratio; empty if the value is a word.
    problem
        "start", "ends" or "start or ends", if the problems differ in it; else empty.
    note
        A rule for the field.
    default
        The value of an omitted field; None: the field, or another one in its place, is required.
    choices
        The words that the field takes; empty for a number.
    """

    name: str
    words: str
    unit: str
    problem: str = ""
    note: str = ""
    default: float | str | None = None
    choices: tuple[str, ...] = ()


@dataclass(frozen=True)
class Given:
    """The fields that the command line gives, by name, and the units ("length", "force") that it states."""

    values: dict[str, float | str]
    units: dict[str, str]


_TWIST = "give one of F1, dgamma, M3"
_SECTION = "give E and nu, or EI and GJ"
_STIFFNESS = "bending stiffness of a solid section (solid), or a quarter of it as printed in the paper (paper)"

FIELDS: dict[str, CaseField] = {
    field.name: field
    for field in (
        CaseField("E", "Young's modulus", "force/length^2", note=_SECTION),
        CaseField("nu", "Poisson ratio", "1", note=_SECTION),
        CaseField("a", "radius of the rod", "length"),
        CaseField("L", "length of the rod", "length"),
        CaseField("stiffness", _STIFFNESS, "", default="solid", choices=("solid", "paper")),
        CaseField("inner_radius", "inner radius of the rod, for a tube", "length"),
        CaseField("EI", "bending stiffness, given", "force length^2", note=_SECTION),
        CaseField("GJ", "torsional stiffness, given", "force length^2", note=_SECTION),
        CaseField("weight", "weight per length in the fluid", "force/length", note="default: no weight"),
        CaseField("R", "radius of the cylinder", "length"),
        CaseField("side", "side of the cylinder on which the rod lies", "", default="outside",
                  choices=("outside", "inside")),
        CaseField("inclination", "angle of the axis to the upward vertical, 90deg: it lies", "rad",
                  note="only with weight; default: 0"),
        CaseField("friction", "coefficient of sliding friction", "1", note="default: no friction"),
        CaseField("sliding", "how a rod with friction moves: along itself, turning in place, or along the axis", "",
                  note="only with friction; default: forward",
                  choices=("forward", "backward", "rotating", "axial-forward", "axial-backward")),
        CaseField("beta", "angle from the axis at the start", "rad", "start"),
        CaseField("dbeta", "rate of the angle at the start", "rad/length", "start"),
        CaseField("F1", "internal force along the inward normal", "force", "start", _TWIST),
        CaseField("dgamma", "rate of rotation of the section at the start", "rad/length", "start", _TWIST),
        CaseField("F2", "internal force in the surface, across the rod", "force", "start", default=0.0),
        CaseField("F3", "internal force along the tangent, tension positive", "force", "start", default=0.0),
        CaseField("beta0", "angle from the axis at the start", "rad", "ends"),
        CaseField("betaL", "angle from the axis at the far end, full turns included", "rad", "ends"),
        CaseField("FZ", "axial force, tension positive", "force", "ends", default=0.0),
        CaseField("MZ", "axial moment", "force length", "ends", default=0.0),
        CaseField("M3", "twisting moment", "force length", "start or ends",
                  "a start needs one of F1, dgamma, M3; default for ends: 0"),
        CaseField("height", "axial distance of the far end, held", "length", "ends", "in place of FZ"),
        CaseField("azimuth", "azimuth from the start to the far end, held", "rad", "ends", "in place of MZ"),
        CaseField("rotation", "rotation of the section from the start to the far end, held", "rad", "ends",
                  "in place of M3"),
        CaseField("M10", "bending moment at the start, 0 for a hinge", "force length", "ends", "in place of beta0"),
        CaseField("M1L", "bending moment at the far end, 0 for a hinge", "force length", "ends", "in place of betaL"),
        CaseField("alpha", "azimuth of the start", "rad", default=0.0),
        CaseField("gamma", "rotation of the section at the start", "rad", default=0.0),
    )
}  # fmt: skip
WINDING = {
    field.name: field
    for field in (
        CaseField("tension", "force along a rod that is wound as a uniform helix", "force", "wound",
                  "with lay it gives the angles and loads of both ends"),
        CaseField("lay", "angle of this helix from the axis", "rad", "wound"),
        CaseField("twist", "twist of its section per length, M3/GJ", "rad/length", "wound",
                  "default: that with which F2 is 0"),
    )
}  # fmt: skip
HELD = ("height", "azimuth", "rotation", "M10", "M1L")  # what ends hold in place of dead loads and angles
ENDS_FIELDS = tuple(
    name for name, field in FIELDS.items() if field.problem != "start" and name not in ("alpha", "gamma", *HELD)
)
ROD_FIELDS = tuple(name for name, field in FIELDS.items() if not field.problem and name not in ("alpha", "gamma"))


def takes_case(names: Sequence[str] = (*FIELDS, *WINDING)) -> Callable[[Callable[..., T]], Callable[..., T]]:
    """Decorate a command: its keyword `given` becomes the options of these fields and of the two units."""
    whole = set(names) > set(FIELDS)

    def decorate(command: Callable[..., T]) -> Callable[..., T]:
        @wraps(command)
        def parse(**options: Any) -> T:
            values = {name: options.pop(name) for name in names}
            units = {kind: options.pop(f"{kind}_unit") for kind in ("length", "force")}
            given = Given(*({k: v for k, v in said.items() if v is not None} for said in (values, units)))
            return command(**options, given=given)

        signature = inspect.signature(command)
        parameters = []
        for name, parameter in signature.parameters.items():
            parameters += _options(names, whole) if name == "given" else [parameter]
        parse.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
        return parse

    return decorate


def _options(names: Sequence[str], whole: bool) -> list[inspect.Parameter]:
    """The parameters of the units and the fields; whole: of both problems, so that the help names the problem."""
    also = "" if whole else "; if a unit is given, no value comes from Table 1"
    notes = [f"default: {unit}{also}" for unit in ("cm", "N")]
    types: dict[str, Any] = {
        f"{kind}_unit": Annotated[
            str | None, option("UNIT", f"Unit of {kind} of the options below; {note}.", rich_help_panel="Units")
        ]
        for kind, note in zip(("length", "force"), notes, strict=True)
    }
    types |= {name: _type({**FIELDS, **WINDING}[name], whole) for name in names}
    return [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=kind)
        for name, kind in types.items()
    ]


def _type(field: CaseField, whole: bool) -> Any:
    help = help_of(field, whole)
    flag, group = f"--{field.name}", {"rich_help_panel": _heading(field, whole)}
    also = [f"--{field.name.replace('_', '-')}"] if "_" in field.name else []
    if field.choices:
        return Annotated[str | None, option("|".join(field.choices), help, flag, **group)]
    if field.unit == "rad":
        return Annotated[float | None, option("ANGLE", help, flag, parser=angle_of(flag), **group)]
    return Annotated[float | None, number_option(help, flag, *also, **group)]


def _heading(field: CaseField, whole: bool) -> str:
    """The heading of a field in the help; whole: of both problems."""
    if field.problem == "wound":
        return "Wound as a helix"
    if field.problem:
        return f"{field.problem.capitalize() if whole else 'Ends'} problem"
    return "Rod and cylinder" if field.name not in ("alpha", "gamma") else "Place of the start"


def help_of(field: CaseField, whole: bool) -> str:
    """The help of a field's option: ``Rate of the angle at the start [rad/length].``"""
    unit = "" if field.unit in ("", "1") else f" [{field.unit}]"
    default = f"default: {field.default:g}" if isinstance(field.default, float) else f"default: {field.default}"
    parts = [field.words + unit, field.note if whole else "", default if whole and field.default is not None else ""]
    said = "; ".join(part for part in parts if part)
    return f"{said[0].upper()}{said[1:]}."
