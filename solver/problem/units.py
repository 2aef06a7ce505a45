"""Units: their sizes, the units that a text names, and a number with its unit, as in ``2.5in`` or ``19.5 lb/ft``.

A study counts lengths and forces in the two units that it names; `number_in` converts what carries another one. A unit
is a product, as in ``kN m``, a quotient, as in ``deg/100 ft``, or a power, as in ``N/mm^2``, of the units of `UNITS`.
"""

import math
import re
from collections.abc import Iterable, Mapping
from functools import cache
from typing import Any

from .errors import InputError, choices, near, show
from .quantities import AT_START, QUANTITIES

Dimension = tuple[int, int, int]  # exponents of length, force and angle

# in metres
LENGTHS = {"nm": 1e-9, "um": 1e-6, "mm": 1e-3, "cm": 1e-2, "dm": 0.1, "m": 1.0, "km": 1e3, "in": 0.0254, "ft": 0.3048}
_POUND = 4.4482216152605
FORCES = {  # in newtons
    "pN": 1e-12, "nN": 1e-9, "uN": 1e-6, "mN": 1e-3, "N": 1.0, "daN": 10.0, "kN": 1e3, "MN": 1e6, "dyn": 1e-5,
    "gf": 9.80665e-3, "kgf": 9.80665, "lbf": _POUND, "klbf": 1e3 * _POUND, "kip": 1e3 * _POUND,
}  # fmt: skip
STRESSES = {  # in newtons per square metre
    "Pa": 1.0,
    "kPa": 1e3,
    "MPa": 1e6,
    "GPa": 1e9,
    "bar": 1e5,
    "psi": _POUND / 0.0254**2,
    "ksi": 1e3 * _POUND / 0.0254**2,
    "Mpsi": 1e6 * _POUND / 0.0254**2,
}

_TABLES: tuple[tuple[Mapping[str, float], Dimension], ...] = (
    (LENGTHS, (1, 0, 0)),
    (FORCES, (0, 1, 0)),
    (STRESSES, (-2, 1, 0)),
    ({"J": 1.0, "kJ": 1e3}, (1, 1, 0)),
    ({"ppg": _POUND / (231 * 0.0254**3)}, (-3, 1, 0)),  # a gallon has 231 cubic inches
    ({"deg": math.pi / 180, "rad": 1.0, "turn": 2 * math.pi}, (0, 0, 1)),
    ({"percent": 0.01}, (0, 0, 0)),
)
UNITS: dict[str, tuple[float, Dimension]] = {
    name: (size, dimension) for table, dimension in _TABLES for name, size in table.items()
}
SYNONYMS = {
    "lb": "lbf", "lbs": "lbf", "klb": "klbf", "klbs": "klbf", "kips": "kip", "inch": "in", "inches": "in", "foot": "ft",
    "feet": "ft", "\N{DEGREE SIGN}": "deg", "degrees": "deg", "turns": "turn", "\N{MICRO SIGN}m": "um",
    "\N{MICRO SIGN}N": "uN",
}  # fmt: skip
_KINDS: dict[Dimension, tuple[str, Iterable[str]]] = {  # what has such a dimension, and units of it
    (1, 0, 0): ("a length", LENGTHS),
    (0, 1, 0): ("a force", FORCES),
    (-2, 1, 0): ("a stress", STRESSES),
    (1, 1, 0): ("a moment", ("N m", "kN m", "lbf ft", "lbf in", "J", "kJ")),
    (-1, 1, 0): ("a force per length", ("N/m", "kN/m", "N/mm", "lb/ft", "lb/in", "klbf/ft")),
    (2, 1, 0): ("a stiffness", ("N m^2", "N mm^2", "lbf ft^2", "lbf in^2")),
    (-3, 1, 0): ("a weight per volume", ("N/m^3", "ppg")),
    (-1, 0, 0): ("a curvature", ("1/m", "1/ft")),
    (0, 0, 1): ("an angle", ("deg", "rad", "turn")),
    (-1, 0, 1): ("an angle per length", ("rad/m", "deg/m", "deg/30 m", "deg/100 ft")),
    (0, 0, 0): ("a plain number", ()),
}

NUMBER = r"(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_TOKEN = re.compile(
    rf"\s*(?:(?P<number>{NUMBER})|(?P<name>[A-Za-z\N{{MICRO SIGN}}\N{{DEGREE SIGN}}]+)"
    r"|(?P<sign>\*\*|[-*/^().\N{MIDDLE DOT}]))"
)
# letters of a unit, and its largest exponent: beyond those of units in use. x10: factors may overflow
MOST_TEXT, MOST_POWER = 60, 12


class UnknownUnit(InputError):
    """A text that is no unit. reason: why, without the choices."""

    def __init__(self, reason: str, known: Iterable[str] = ()) -> None:
        super().__init__(f"{reason}; choose from {choices(known)}" if known else reason)
        self.reason = reason


@cache
def unit_size(text: str) -> tuple[float, Dimension]:
    """The size of a unit, in metres, newtons and rad, and its dimension. Raises `UnknownUnit`.

    >>> unit_size("kN m"), unit_size("N/cm^2")
    ((1000.0, (1, 1, 0)), (10000.0, (-2, 1, 0)))
    """
    tokens, at = [], 0
    while at < len(text.rstrip()) <= MOST_TEXT:
        match = _TOKEN.match(text, at)
        if match is None:
            break
        tokens.append((str(match.lastgroup), match[str(match.lastgroup)]))
        at = match.end()
    if not tokens or at < len(text.rstrip()):
        raise _no_product(text)
    parts = _Parts(text, tokens)
    size, dimension = parts.product()
    if parts.tokens or not 0 < size < math.inf:
        raise _no_product(text)
    return size, dimension


def is_angle_unit(name: str) -> bool:
    """Whether a name is that of a unit of angles."""
    return SYNONYMS.get(name, name) in _KINDS[0, 0, 1][1]


def _no_product(text: str) -> UnknownUnit:
    return UnknownUnit(f"no product of units, such as MPa, lb/ft or deg/(30 m), in {text[:MOST_TEXT]!r}")


class _Parts:
    """The tokens of a unit, taken from the front."""

    def __init__(self, text: str, tokens: list[tuple[str, str]]) -> None:
        self.text, self.tokens = text, tokens

    def product(self) -> tuple[float, Dimension]:
        """Factors, each multiplied or divided by what is before it."""
        size, dimension = (1.0, (0, 0, 0)) if self.tokens[0][1] == "/" else self.factor()
        while self.tokens and self.tokens[0][1] != ")":
            sign = self.tokens.pop(0)[1] if self.tokens[0][0] == "sign" and self.tokens[0][1] != "(" else "*"
            if sign in ("^", "**"):
                raise _no_product(self.text)
            other, exponents = self.factor()
            power = -1 if sign == "/" else 1
            size, dimension = size * other**power, _sum(dimension, exponents, power)
        return size, dimension

    def factor(self) -> tuple[float, Dimension]:
        """A unit with its power, a number with the unit behind it, or a product in parentheses."""
        if not self.tokens:
            raise _no_product(self.text)
        kind, said = self.tokens.pop(0)
        if kind == "number":
            if self.tokens and self.tokens[0][0] == "name":  # deg/100 ft: for each 100 ft
                size, dimension = self.factor()
                return float(said) * size, dimension
            return float(said), (0, 0, 0)
        if said == "(":
            size, dimension = self.product() if self.tokens else (0.0, (0, 0, 0))
            if not self.tokens or self.tokens.pop(0)[1] != ")":
                raise _no_product(self.text)
        elif kind == "name":
            size, dimension = _known_unit(said)
        else:
            raise _no_product(self.text)
        power = self.power()
        return size**power, _sum((0, 0, 0), dimension, power)

    def power(self) -> int:
        """The integer behind a unit, ``^2``, ``**2`` or ``2``; 1 where there is none."""
        sign = ""
        if self.tokens and self.tokens[0][1] in ("^", "**"):
            self.tokens.pop(0)
            if self.tokens and self.tokens[0][1] == "-":
                sign = self.tokens.pop(0)[1]
            if not self.tokens:
                raise _no_product(self.text)
        elif not (self.tokens and self.tokens[0][0] == "number"):
            return 1
        kind, said = self.tokens.pop(0)
        if kind != "number" or not said.isdigit() or not 0 < int(said) <= MOST_POWER:
            raise _no_product(self.text)
        return int(sign + said)


def _known_unit(name: str) -> tuple[float, Dimension]:
    known = SYNONYMS.get(name, name)
    if known not in UNITS:
        raise UnknownUnit(f"no unit {name!r}{near(name, (*UNITS, *SYNONYMS))}", UNITS)
    return UNITS[known]


def _sum(first: Dimension, second: Dimension, times: int) -> Dimension:
    length, force, angle = (a + times * b for a, b in zip(first, second, strict=True))
    return length, force, angle


def base_unit(kind: str, text: str) -> str:
    """The first unit of "length" or "force" in a unit, of psi and ksi that of their force; empty where it has none."""
    known = LENGTHS if kind == "length" else FORCES
    names = [SYNONYMS.get(name, name) for _, name, _ in _TOKEN.findall(text)]
    inside = {"psi": ("in", "lbf"), "ksi": ("in", "klbf"), "Mpsi": ("in", "klbf")}
    return next((part for name in names for part in (name, *inside.get(name, ())) if part in known), "")


def dimension_of(name: str) -> Dimension:
    """The dimension of a quantity or of a field of a case, with the exponent of its angle."""
    exponents = QUANTITIES[AT_START.get(name, name)].dimension
    if isinstance(exponents, str):
        return {"rad": (0, 0, 1), "rad/length": (-1, 0, 1)}.get(exponents, (0, 0, 0))
    return exponents[0], exponents[1], 0


def size_in(dimension: tuple[Any, ...], units: Mapping[str, str]) -> float:
    """The unit of a dimension in a system of units, in metres, newtons and rad."""
    return float(LENGTHS[units["length"]] ** float(dimension[0]) * FORCES[units["force"]] ** float(dimension[1]))


def split(text: str) -> tuple[float, str]:
    """The number and the unit of a text such as ``2.5in``; the unit is empty where there is none.

    Raises `InputError`, which says of a unit alone that it has no number.
    """
    said = text.strip()
    try:
        return float(said), ""
    except ValueError:
        match = re.fullmatch(rf"([-+\N{{MINUS SIGN}}]?{NUMBER})\s*(.*)", said, re.DOTALL)
    if match is not None:
        return float(match[1].replace("\N{MINUS SIGN}", "-")), match[2]
    try:
        unit_size(said)
    except UnknownUnit:
        raise InputError(f"{show(text)} is not a number, alone or with its unit, such as 2.5in") from None
    raise InputError(f"{text!r} is a unit without a number: write the number before it, such as 5 {said}")


def size_of_unit(name: str, unit: str, called: str = "") -> float:
    """The size of a unit of a quantity or field, in metres, newtons and rad. Raises `InputError` if it does not fit.

    called: what the message calls it; default: name.
    """
    called, field_dimension = called or name, dimension_of(name)
    kind, units = _KINDS.get(field_dimension, ("a quantity of another unit", ()))
    ending = f"choose from {choices(units)}" if units else "write it without a unit"
    try:
        size, dimension = unit_size(unit)
    except UnknownUnit as error:
        raise InputError(f"{called} is {kind}, and there is {error.reason}: {ending}") from None
    curvatures = (-1, 0, 0), (-1, 0, 1)  # deg/30 m is a unit of both, as 1/m is
    if dimension != field_dimension and not (dimension in curvatures and field_dimension in curvatures):
        other = _KINDS.get(dimension, ("of another quantity",))[0].partition(" ")[2]
        raise InputError(f"{called} is {kind}, and {unit} is a unit of {other}: {ending}")
    return size


def number_in(name: str, text: str, units: Mapping[str, str], called: str = "") -> float:
    """The number of a text for a quantity or a field, in a system of units; a number alone is in these already.

    Parameters
    ----------
    name, text : str
        The quantity or field, and a text such as ``30e6 psi``.
    units : dict
        The units of "length" and "force" of the study. Angles are in rad.
    called : str
        As of `size_of_unit`.

    Raises
    ------
    InputError
        For a text that is no number, and for a unit that is unknown or of another quantity.

    >>> number_in("L", "2 ft", {"length": "in", "force": "lbf"})
    24.0
    """
    value, unit = split(text)
    if not unit:
        return value
    given, in_study = size_of_unit(name, unit, called), size_in(dimension_of(name), units)
    more, less = given / in_study, in_study / given
    return value / _whole(less) if less > more else value * _whole(more)


def _whole(factor: float) -> float:
    """The factor without the rounding of a whole one, as of inches in a foot."""
    return round(factor) if math.isclose(factor, round(factor), rel_tol=1e-12) else factor
