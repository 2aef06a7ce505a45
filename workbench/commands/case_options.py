"""The options for the fields of a case: one table, from which the options of solve, explore and equilibria are made.

Long names and units are those of the table of quantities. The rest is written out, and not derived from the dataclasses
of `solver`, because --help must not import NumPy; `tests/workbench/test_case_options.py` compares it with them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, Annotated, Any

from solver.problem.errors import InputError
from solver.problem.quantities import AT_START, quantity, unit_of

from .options import angle_of, number_or_text_of, option, read_range

if TYPE_CHECKING:
    import numpy as np


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
class GivenOptions:
    """The fields that the command line gives, by name, and the units ("length", "force") that it states.

    A value with a unit is still text, as it is converted where the units of the case are known.
    """

    values: dict[str, float | str]
    units: dict[str, str]


_TWIST = "give one of F1, dgamma, M3"
_SECTION = "give E and nu, or EI and GJ"
_STIFFNESS = "bending stiffness of a solid section (solid), or a quarter of it as printed in the paper (paper)"
_SENSES = " (0: s climbs straight up; 90deg: horizontal; 180deg: s goes straight down)"

WORDS_OF_UNITS = {"length": "length", "force": "force"}


def _of_quantity(name: str, more: str = "", problem: str = "", note: str = "", default: Any = None) -> CaseField:
    """A field that is a quantity, with its long name and unit; more: words behind that name."""
    row = quantity(AT_START.get(name, name))
    return CaseField(name, row.long_name + more, unit_of(row.name, WORDS_OF_UNITS), problem, note, default)


FIELDS: dict[str, CaseField] = {
    field.name: field
    for field in (
        _of_quantity("E", note=_SECTION),
        _of_quantity("nu", note=_SECTION),
        _of_quantity("a"),
        _of_quantity("L"),
        CaseField("stiffness", _STIFFNESS, "", default="solid", choices=("solid", "paper")),
        _of_quantity("inner_radius", ", for a tube"),
        _of_quantity("EI", note=_SECTION),
        _of_quantity("GJ", note=_SECTION),
        _of_quantity("weight", note="default: no weight"),
        _of_quantity("R"),
        CaseField("side", "side of the cylinder on which the rod lies", "", default="outside",
                  choices=("outside", "inside")),
        _of_quantity("inclination", _SENSES, note="only with weight; default: 0"),
        _of_quantity("friction", note="default: no friction"),
        CaseField("sliding", "how a rod with friction moves: along itself, turning in place, or along the axis", "",
                  note="only with friction; default: forward",
                  choices=("forward", "backward", "rotating", "axial-forward", "axial-backward")),
        CaseField("contact", "whether the cylinder holds the rod on (bilateral) or only pushes (unilateral)", "",
                  default="bilateral", choices=("bilateral", "unilateral")),
        _of_quantity("beta", "", "start"),
        _of_quantity("dbeta", "", "start"),
        _of_quantity("F1", "", "start", _TWIST),
        _of_quantity("dgamma", "", "start", _TWIST),
        _of_quantity("F2", "", "start", default=0.0),
        _of_quantity("F3", "", "start", default=0.0),
        _of_quantity("beta0", "", "ends"),
        _of_quantity("betaL", ", full turns included", "ends"),
        _of_quantity("FZ", ", tension positive", "ends", default=0.0),
        _of_quantity("MZ", "", "ends", default=0.0),
        _of_quantity("M3", "", "start or ends", "a start needs one of F1, dgamma, M3; default for ends: 0"),
        _of_quantity("height", ", held", "ends", "in place of FZ"),
        _of_quantity("azimuth", ", held", "ends", "in place of MZ"),
        _of_quantity("rotation", ", held", "ends", "in place of M3"),
        _of_quantity("M10", ", 0 for a hinge", "ends", "in place of beta0"),
        _of_quantity("M1L", ", 0 for a hinge", "ends", "in place of betaL"),
        _of_quantity("radius0", "", "ends", "only with unilateral contact; default: on the wall"),
        _of_quantity("radiusL", "", "ends", "only with unilateral contact; default: on the wall"),
        _of_quantity("tilt0", "", "ends", "only with unilateral contact; default: 0"),
        _of_quantity("tiltL", "", "ends", "only with unilateral contact; default: 0"),
        _of_quantity("M20", ", 0 for a hinge", "ends", "in place of tilt0"),
        _of_quantity("M2L", ", 0 for a hinge", "ends", "in place of tiltL"),
        _of_quantity("alpha", default=0.0),
        _of_quantity("gamma", default=0.0),
    )
}  # fmt: skip
REPLACED = {  # in place of fields: a rod that is wound as a helix, and a pipe in a hole
    field.name: field
    for field in (
        _of_quantity("tension", "", "wound", "with lay it gives the angles and loads of both ends"),
        _of_quantity("lay", "", "wound"),
        _of_quantity("twist", "", "wound", "default: that with which F2 is 0"),
        _of_quantity("hole", "", "well", "in place of inclination"),
        _of_quantity("wob", "", "well", "in place of FZ"),
        _of_quantity("FZ0", ", tension positive; down a hole its upper end", "well", "in place of FZ"),
    )
}
EVERY = (*FIELDS, *REPLACED)
FREE = ("contact", "radius0", "radiusL", "tilt0", "tiltL", "M20", "M2L")  # of rods that may leave the cylinder
HELD = ("height", "azimuth", "rotation", "M10", "M1L")  # what ends hold in place of dead loads and angles
ENDS_FIELDS = tuple(
    name for name, field in FIELDS.items() if field.problem != "start" and name not in ("alpha", "gamma", *HELD, *FREE)
)
AXES = tuple(name for name in (*ENDS_FIELDS, *HELD) if not FIELDS[name].choices)  # what may vary between two ends
MAX_COUNT = 401  # values of an axis over which equilibria are followed
ROD_FIELDS = tuple(
    name for name, field in FIELDS.items() if not field.problem and name not in ("alpha", "gamma", "contact")
)


def of_case(names: Sequence[str]) -> dict[str, Any]:
    """The types of the options of these fields and of the two units."""
    whole = set(names) > set(FIELDS)  # of both problems, so that the help names the problem
    also = "" if whole else "; if a unit is given, no value comes from Table 1"
    types: dict[str, Any] = {
        f"{kind}_unit": Annotated[
            str | None,
            option("UNIT", f"Unit of {kind} of the options below; default: {unit}{also}.", rich_help_panel="Units"),
        ]
        for kind, unit in (("length", "cm"), ("force", "N"))
    }
    return types | {name: _type((FIELDS | REPLACED)[name], whole) for name in names}


def given_of(options: dict[str, Any], names: Sequence[str]) -> GivenOptions:
    """What the options of `of_case` give; they are taken out of `options`."""
    values = {name: options.pop(name) for name in names}
    units = {kind: options.pop(f"{kind}_unit") for kind in ("length", "force")}
    return GivenOptions(*({k: v for k, v in said.items() if v is not None} for said in (values, units)))


def _type(field: CaseField, whole: bool) -> Any:
    help = help_of(field, whole)
    flag, group = f"--{field.name}", {"rich_help_panel": _heading(field, whole)}
    also = [f"--{field.name.replace('_', '-')}"] if "_" in field.name else []
    if field.choices:
        return Annotated[str | None, option("|".join(field.choices), help, flag, **group)]
    if field.unit == "rad":
        return Annotated[float | None, option("ANGLE", help, flag, parser=angle_of(flag), **group)]
    return Annotated[float | None, option("NUMBER", help, flag, *also, parser=number_or_text_of(field.name), **group)]


HEADINGS = {"wound": "Wound as a helix", "well": "In a hole, in the words of drillers"}


def _heading(field: CaseField, whole: bool) -> str:
    """The heading of a field in the help; whole: of both problems."""
    if field.problem in HEADINGS:
        return HEADINGS[field.problem]
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


def parse_axis(text: str, units: Mapping[str, str]) -> "tuple[str, np.ndarray]":
    """``betaL=-90deg:60deg:41`` as a field and the values of such an axis of a study, rising. Raises `InputError`.

    units: of "length" and "force", of the study.
    """
    from studies.grammar.axes import Axis

    name, first, last, count = read_range("--axis", text, units, AXES, "FROM:TO:COUNT")
    if not 2 <= count <= MAX_COUNT or first == last or not (isfinite(first) and isfinite(last)):
        raise InputError(f"--axis needs two different finite ends and a count from 2 to {MAX_COUNT}, got {text!r}")
    axis = Axis.model_validate({"from": min(first, last), "to": max(first, last), "count": count})
    return name, axis.numbers()
