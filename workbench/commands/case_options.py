"""The options for the fields of a case, which are made of their declarations without NumPy, so that --help is quick."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, Annotated, Any

from solver.problem.declared_fields import ALL_FIELDS, AT_START, CHOICES, FIELDS, OFF_WALL, PAIRS, PARTS, CaseField
from solver.problem.errors import InputError
from solver.problem.quantities import unit_of

from .options import angle_of, number_or_text_of, option, read_range

if TYPE_CHECKING:
    import numpy as np


@dataclass(frozen=True)
class GivenOptions:
    """The fields that the command line gives, by name, and the units ("length", "force") that it states.

    A value with a unit is still text, as it is converted where the units of the case are known.
    """

    values: dict[str, float | str]
    units: dict[str, str]


FREE = ("contact", *OFF_WALL)  # of rods that may leave the cylinder
HELD = tuple(held for _, held in PAIRS)  # what ends hold in place of dead loads and angles
ENDS_FIELDS = tuple(
    name for name, field in FIELDS.items() if field.part != "start" and name not in (*AT_START, *HELD, *FREE)
)
AXES = tuple(name for name in (*ENDS_FIELDS, *HELD) if name not in CHOICES)  # what may vary between two ends
WORDS_OF_UNITS = {"length": "length", "force": "force"}
MAX_COUNT = 401  # values of an axis over which equilibria are followed
ROD_FIELDS = tuple(name for part in ("rod", "cylinder") for name in PARTS[part] if name not in FREE)


def of_case(names: Sequence[str]) -> dict[str, Any]:
    """The types of the options of these fields and of the two units."""
    whole = set(names) > set(FIELDS)  # of both problems, so that the help names the problem
    types: dict[str, Any] = {
        f"{kind}_unit": Annotated[
            str | None,
            option("UNIT", f"Unit of {kind} of the options below; default: {unit}.", rich_help_panel="Units"),
        ]
        for kind, unit in (("length", "cm"), ("force", "N"))
    }
    return types | {name: _type(ALL_FIELDS[name], whole) for name in names}


def case_given_by(options: dict[str, Any], names: Sequence[str]) -> GivenOptions:
    """What the options of `of_case` give; they are taken out of `options`."""
    values = {name: options.pop(name) for name in names}
    units = {kind: options.pop(f"{kind}_unit") for kind in ("length", "force")}
    return GivenOptions(*({k: v for k, v in said.items() if v is not None} for said in (values, units)))


def _type(field: CaseField, whole: bool) -> Any:
    help = help_of(field, whole)
    flag, group = f"--{field.name}", {"rich_help_panel": _help_title(field, whole)}
    also = [f"--{field.name.replace('_', '-')}"] if "_" in field.name else []
    if field.choices:
        return Annotated[str | None, option("|".join(field.choices), help, flag, **group)]
    if field.is_angle:
        return Annotated[float | None, option("ANGLE", help, flag, parser=angle_of(flag), **group)]
    return Annotated[float | None, option("NUMBER", help, flag, *also, parser=number_or_text_of(field.name), **group)]


HEADINGS = {
    "rod": "Rod and cylinder",
    "cylinder": "Rod and cylinder",
    "wound": "Wound as a helix",
    "well": "In a hole, in the words of drillers",
}


def _help_title(field: CaseField, whole: bool) -> str:
    """The heading of a field in the help; whole: of both problems."""
    return HEADINGS.get(field.part) or f"{field.part.capitalize() if whole else 'Ends'} problem"


def help_of(field: CaseField, whole: bool) -> str:
    """The help of a field's option: ``Rate of the angle at the start [rad/length].`` whole: with its rules."""
    unit = "" if field.choices else unit_of(field.quantity, WORDS_OF_UNITS)
    words = field.long_name + field.more + ("" if unit in ("", "1") else f" [{unit}]")
    said = "; ".join([words, *([field.rules] if whole and field.rules else [])])
    return f"{said[0].upper()}{said[1:]}."


def parse_axis(text: str, units: Mapping[str, str]) -> "tuple[str, np.ndarray]":
    """``betaL=-90deg:60deg:41`` as a field and the values of such an axis of a study, rising. Raises `InputError`.

    units: of "length" and "force", of the study.
    """
    from pydantic import ValidationError

    from studies.grammar.axes import Axis
    from studies.language.loader import sentence_of

    name, first, last, count = read_range("--axis", text, units, AXES, "FROM:TO:COUNT")
    if not 2 <= count <= MAX_COUNT or first == last or not (isfinite(first) and isfinite(last)):
        raise InputError(f"--axis needs two different finite ends and a count from 2 to {MAX_COUNT}, got {text!r}")
    try:
        axis = Axis.model_validate({"from": min(first, last), "to": max(first, last), "count": count})
    except ValidationError as error:
        raise InputError(f"--axis {text}: {sentence_of(error)[1]}") from None
    return name, axis.numbers()
