"""Every field of a case, declared once: part, name, quantity, range, words, partner, what it needs, and its help.

The classes here are the fields of `Rod`, `Cylinder`, `Start` and `Ends`, in their order; `WELL` and `WOUND` are names
of drillers and of cable makers that stand in place of some of them. Checks, refusals, options of the command line, keys
and schema of study files, labels and stored variables are read from these rows. Needs no NumPy.
"""

from dataclasses import dataclass, field, fields, replace
from math import inf, pi
from typing import Any, Literal, get_args, get_type_hints

Dimension = tuple[int, int] | str  # exponents of length and force; "rad", "rad/length"; "text" of words
NUMBER, LENGTH, FORCE, MOMENT, LINE_LOAD, STRESS, RIGIDITY = (0, 0), (1, 0), (0, 1), (1, 1), (-1, 1), (-2, 1), (2, 1)


@dataclass(frozen=True)
class _Range:
    """Where the values of a field must be: above `low` (if `closed` from it on), and at most `high`. rule: in words."""

    low: float
    rule: str
    closed: bool = False
    high: float = inf

    def excludes(self, value: Any) -> Any:
        """Which numbers, one or an array, are outside."""
        return (value < self.low if self.closed else value <= self.low) | (value > self.high)


@dataclass(frozen=True)
class CaseField:
    """The declaration of a field of a case.

    Attributes
    ----------
    symbol, dimension, long_name
        Of its quantity.
    quantity
        The name of this quantity; "": that of the field.
    estimated
        Whether an answer states it with an error.
    range
        Where its numbers must be; None: any finite number.
    default
        The value of a field that is omitted, if the field that it needs is given and the one that it replaces is not;
        None: it has no default.
    in_place_of
        The field that it replaces; a case has one of the two.
    needs
        The field without which it has no meaning, ``weight``; if that field must be a certain word, the word stands
        before it, ``unilateral contact``.
    varies
        Whether loads vary along the rod with it.
    is_quiet
        Whether its default is not mentioned where the fields of a case are listed.
    more, note
        Words behind the long name in the help, and a rule for the field.
    name, part, omitted, choices
        Read from the class of its part: its name; "rod", "cylinder", "start", "ends", "start or ends", "well" or
        "wound"; its value in a part that is made without it, `dataclasses.MISSING` if it must be given; the words that
        it may be, none for a number.
    """

    symbol: str
    dimension: Dimension
    long_name: str
    range: _Range | None = None
    default: float | str | None = None
    in_place_of: str = ""
    needs: str = ""
    varies: bool = False
    is_quiet: bool = False
    more: str = ""
    note: str = ""
    quantity: str = ""
    estimated: bool = False
    name: str = ""
    part: str = ""
    omitted: Any = None
    choices: tuple[str, ...] = ()

    @property
    def is_angle(self) -> bool:
        """Whether its values may be texts such as "30deg"."""
        return self.dimension == "rad"

    @property
    def rules(self) -> str:
        """What it needs and replaces, its note and its default: ``only with weight; default: 0``."""
        shown = f"{self.default:g}" if isinstance(self.default, float) else self.default
        parts = (
            f"only with {self.needs}" if self.needs else "",
            f"in place of {self.in_place_of}" if self.in_place_of else "",
            self.note,
            "" if shown is None else f"default: {shown}",
        )
        return "; ".join(part for part in parts if part)


def _row(*values: Any, **more: Any) -> dict[str, CaseField]:
    return {"row": CaseField(*values, **more)}


def _field(*values: Any, omitted: Any = None, **more: Any) -> Any:
    """A field with its row, which a part may be made without. values, more: of the row. omitted: what it is then."""
    return field(default=omitted, metadata=_row(*values, **more))


def _word(long_name: str, omitted: str | None, **more: Any) -> Any:
    """A field of words. omitted: the word of a part that is made without it, None for none."""
    return _field("", "text", long_name, omitted=omitted, **more)


_POSITIVE = _Range(0, "positive and finite")
_NOT_NEGATIVE = _Range(0, "at least 0", closed=True)
_INCLINED = _Range(0, "from 0 to pi rad (180 deg)", closed=True, high=pi * (1 + 1e-15))
_TILTED = _Range(-pi / 2, "from -pi/2 to pi/2 rad (90 deg)", closed=True, high=pi / 2)
_SECTION = "give E and nu, or EI and GJ"
_TWIST = "give one of F1, dgamma, M3"
_FREE, _ON_WALL, _FLAT = "unilateral contact", "default: on the wall", "default: 0"
_HINGE = ", 0 for a hinge"
_BETA = _row("β₀", "rad", "angle from the axis at the start", quantity="beta0")
_ALPHA = _row("α₀", "rad", "azimuth of the start", default=0.0, quantity="alpha0")
_GAMMA = _row("γ₀", "rad", "rotation of the section at the start", default=0.0, quantity="gamma0")


@dataclass(frozen=True, eq=False, repr=False)
class RodFields:
    """The fields of a rod."""

    E: Any = _field("E", STRESS, "Young's modulus", _POSITIVE, note=_SECTION)
    nu: Any = _field("ν", NUMBER, "Poisson ratio", _Range(-1, "in (-1, 0.5]", high=0.5), note=_SECTION)
    a: Any = _field("a", LENGTH, "radius of the rod", _POSITIVE)
    L: Any = _field("L", LENGTH, "length of the rod", _POSITIVE)
    stiffness: Literal["solid", "paper"] = _word(
        "bending stiffness of a solid section (solid), or a quarter of it as printed in the paper (paper)",
        "solid",
        default="solid",
        needs="E",
    )
    inner_radius: Any = _field(
        "aᵢ",
        LENGTH,
        "inner radius of the rod",
        _Range(0, "at least 0 and less than Rod.a", closed=True),
        more=", for a tube",
    )
    EI: Any = _field("EI", RIGIDITY, "bending stiffness, given", _POSITIVE, note=_SECTION)
    GJ: Any = _field("GJ", RIGIDITY, "torsional stiffness, given", _POSITIVE, note=_SECTION)
    weight: Any = _field(
        "w", LINE_LOAD, "weight per length in the fluid", _NOT_NEGATIVE, varies=True, note="default: no weight"
    )


@dataclass(frozen=True, eq=False, repr=False)
class CylinderFields:
    """The fields of a cylinder."""

    R: Any = field(metadata=_row("R", LENGTH, "radius of the cylinder", _POSITIVE))
    side: Literal["outside", "inside"] = _word(
        "side of the cylinder on which the rod lies", "outside", default="outside"
    )
    inclination: Any = _field(
        "θ",
        "rad",
        "angle of the axis to the upward vertical",
        _INCLINED,
        default=0.0,
        needs="weight",
        more=" (0: s climbs straight up; 90deg: horizontal; 180deg: s goes straight down)",
    )
    friction: Any = _field(
        "μ", NUMBER, "coefficient of sliding friction", _NOT_NEGATIVE, varies=True, note="default: no friction"
    )
    sliding: Literal["forward", "backward", "rotating", "axial-forward", "axial-backward"] | None = _word(
        "how a rod with friction moves: along itself, turning in place, or along the axis",
        None,
        default="forward",
        needs="friction",
    )
    contact: Literal["bilateral", "unilateral"] = _word(
        "whether the cylinder holds the rod on (bilateral) or only pushes (unilateral)",
        "bilateral",
        default="bilateral",
        is_quiet=True,
    )


@dataclass(frozen=True, eq=False, repr=False)
class StartFields:
    """The fields of the start."""

    beta: Any = field(metadata=_BETA)
    dbeta: Any = field(metadata=_row("β₀′", "rad/length", "rate of the angle at the start", quantity="dbeta0"))
    F1: Any = _field("F₁", FORCE, "internal force along the inward normal", note=_TWIST)
    F2: Any = _field("F₂", FORCE, "internal force in the surface, across the rod", default=0.0, omitted=0.0)
    F3: Any = _field("F₃", FORCE, "internal force along the tangent, tension positive", default=0.0, omitted=0.0)
    dgamma: Any = _field("γ₀′", "rad/length", "rate of rotation of the section at the start", note=_TWIST)
    alpha: Any = field(default=0.0, metadata=_ALPHA)
    gamma: Any = field(default=0.0, metadata=_GAMMA)
    M3: Any = _field(
        "M₃", MOMENT, "twisting moment", note="a start needs one of F1, dgamma, M3; default for ends: 0", estimated=True
    )


@dataclass(frozen=True, eq=False, repr=False)
class EndsFields:
    """The fields of both ends."""

    beta0: Any = field(default=None, metadata=_BETA)
    betaL: Any = _field("β(L)", "rad", "angle from the axis at the far end", more=", full turns included")
    FZ: Any = _field("FZ", FORCE, "axial force", more=", tension positive", default=0.0, estimated=True)
    MZ: Any = _field("MZ", MOMENT, "axial moment", default=0.0, estimated=True)
    M3: Any = _field("M₃", MOMENT, "twisting moment", default=0.0, estimated=True)
    alpha: Any = field(default=0.0, metadata=_ALPHA)
    gamma: Any = field(default=0.0, metadata=_GAMMA)
    height: Any = _field(
        "z(L)", LENGTH, "axial position of the far end", in_place_of="FZ", more=", held", estimated=True
    )
    azimuth: Any = _field("Δα", "rad", "azimuth from the start to the far end", in_place_of="MZ", more=", held")
    rotation: Any = _field(
        "Δγ", "rad", "rotation of the section from the start to the far end", in_place_of="M3", more=", held"
    )
    M10: Any = _field("M₁(0)", MOMENT, "bending moment at the start", in_place_of="beta0", more=_HINGE, estimated=True)
    M1L: Any = _field(
        "M₁(L)", MOMENT, "bending moment at the far end", in_place_of="betaL", more=_HINGE, estimated=True
    )
    radius0: Any = _field(
        "r(0)", LENGTH, "distance of the start from the axis", _NOT_NEGATIVE, needs=_FREE, note=_ON_WALL
    )
    radiusL: Any = _field(
        "r(L)", LENGTH, "distance of the far end from the axis", _NOT_NEGATIVE, needs=_FREE, note=_ON_WALL
    )
    tilt0: Any = _field(
        "τ(0)", "rad", "tilt of the tangent out of the wall at the start, outwards", _TILTED, needs=_FREE, note=_FLAT
    )
    tiltL: Any = _field(
        "τ(L)", "rad", "tilt of the tangent out of the wall at the far end, outwards", _TILTED, needs=_FREE, note=_FLAT
    )
    M20: Any = _field(
        "M₂(0)", MOMENT, "bending moment across the wall at the start", needs=_FREE, in_place_of="tilt0", more=_HINGE
    )
    M2L: Any = _field(
        "M₂(L)", MOMENT, "bending moment across the wall at the far end", needs=_FREE, in_place_of="tiltL", more=_HINGE
    )


def _read(kind: type, part: str) -> dict[str, CaseField]:
    """The rows of a class, with their names, parts and choices."""
    hints = get_type_hints(kind)
    return {
        each.name: replace(
            each.metadata["row"],
            name=each.name,
            part=part,
            omitted=each.default,
            quantity=each.metadata["row"].quantity or each.name,
            choices=_choices(hints[each.name]),
        )
        for each in fields(kind)
    }


def _choices(hint: Any) -> tuple[str, ...]:
    """The words of a type of literals; none of another type."""
    return tuple(word for part in get_args(hint) for word in ((part,) if isinstance(part, str) else _choices(part)))


def _in_place(part: str, **rows: CaseField) -> dict[str, CaseField]:
    return {name: replace(row, name=name, part=part, quantity=name) for name, row in rows.items()}


PARTS = {  # part -> its fields
    part: _read(kind, part)
    for part, kind in {"rod": RodFields, "cylinder": CylinderFields, "start": StartFields, "ends": EndsFields}.items()
}
FIELDS: dict[str, CaseField] = {  # every field of a case, those of start and ends as they are of a start
    **{name: row for rows in PARTS.values() for name, row in rows.items()},
    **{
        name: replace(row, part="start or ends") if name in PARTS["ends"] else row
        for name, row in PARTS["start"].items()
    },
}
WELL = _in_place(
    "well",
    hole=CaseField(
        "hole",
        "rad",
        "inclination of a hole that s runs down, 0: vertical, 90deg: horizontal",
        _INCLINED,
        in_place_of="inclination",
    ),
    wob=CaseField("WOB", FORCE, "weight on bit, the push at s = L", in_place_of="FZ"),
    FZ0=CaseField(
        "FZ(0)",
        FORCE,
        "axial force at the start",
        in_place_of="FZ",
        estimated=True,
        more=", tension positive; in a hole the hook",
    ),
)
WOUND = _in_place(
    "wound",
    tension=CaseField(
        "T",
        FORCE,
        "force along a rod that is wound as a uniform helix",
        note="with lay it gives the angles and loads of both ends",
    ),
    lay=CaseField("lay", "rad", "angle of this helix from the axis"),
    twist=CaseField(
        "twist",
        "rad/length",
        "twist of the section of this helix per length, M3/GJ",
        note="default: that with which F2 is 0",
    ),
)
REPLACED = {**WOUND, **WELL}  # in place of fields of a case, which `studies.language.wells_and_cables` makes of them
ALL_FIELDS = {**FIELDS, **REPLACED}

CHOICES = {name: row.choices for name, row in FIELDS.items() if row.choices}  # of the fields that are text
ANGLES = tuple(name for name, row in ALL_FIELDS.items() if row.is_angle)  # fields that may be text, such as 30deg
RANGES = {name: row.range for name, row in FIELDS.items() if row.range is not None}
POSITIVE = tuple(name for name, allowed in RANGES.items() if allowed == _POSITIVE)
VARY_LOADS = tuple(name for name, row in FIELDS.items() if row.varies)  # with which loads vary along the rod
OFF_WALL = tuple(name for name, row in FIELDS.items() if row.needs == _FREE)  # of ends that may leave the cylinder
_PARTNERS = {row.in_place_of: name for name, row in FIELDS.items() if row.in_place_of}
# fields of Ends: one of each pair is given, the other one is then unknown
PAIRS = tuple((name, _PARTNERS[name]) for name in PARTS["ends"] if name in _PARTNERS and name not in OFF_WALL)
DEAD_LOADS = tuple(name for name, _ in PAIRS[2:])
TILTS = tuple((name, _PARTNERS[name]) for name in OFF_WALL if name in _PARTNERS)  # of a rod that may leave the cylinder
AT_START = {name: row.quantity for name, row in FIELDS.items() if row.quantity != name}  # values of others at s = 0


def rivals(name: str) -> tuple[str, ...]:
    """The fields beside which a field in place of another one is not given: that one, and others in its place."""
    replaced = ALL_FIELDS[name].in_place_of
    others = (other for other, row in ALL_FIELDS.items() if row.in_place_of == replaced and other != name)
    return (replaced, *others) if replaced else ()
