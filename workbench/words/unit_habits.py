"""The units in which engineers of a system of units state a quantity, and numbers without exponents.

In feet, radii are in inches, stresses in psi or ksi, weights and pushes in lbf/ft, and curvatures in deg/100 ft.
"""

import math
import re
from collections.abc import Callable, Iterable, Mapping
from functools import cache

from solver.problem.quantities import AT_START, unit_of
from solver.problem.units import UnknownUnit, size_in, unit_size

# exponents of length, force and angle
LENGTH, STRESS, LINE_LOAD, CURVATURES = (1, 0, 0), (-2, 1, 0), (-1, 1, 0), ((-1, 0, 0), (-1, 0, 1))
KILOPOUNDS, NEWTONS = ("klbf", "kip"), ("N", "daN", "kN", "MN", "kgf")
# what is stated in which unit: a dimension, where lengths and forces are in one of these units, for these names
HABITS = (
    (LENGTH, ("ft",), (), ("a", "inner_radius", "R", "rho"), "in"),
    (STRESS, ("ft", "in"), ("lbf",), (), "psi"),
    (STRESS, ("ft", "in"), KILOPOUNDS, (), "ksi"),
    (STRESS, ("m", "km"), NEWTONS, (), "MPa"),
    (STRESS, ("mm",), ("N",), (), "MPa"),
    (LINE_LOAD, ("ft",), KILOPOUNDS, (), "lbf/ft"),
    (LINE_LOAD, ("in",), KILOPOUNDS, (), "lbf/in"),
    *((curvature, ("ft",), (), (), "deg/100 ft") for curvature in CURVATURES),
)
REACHES = {"m": "30 m", "km": "30 m", "ft": "100 ft", "in": "100 ft", "mm": "m", "cm": "m", "dm": "m"}  # of a dogleg
LARGEST = 1e10  # that is printed without an exponent
SMALLEST = 1e-4
IN_TABLES, FINEST = 5, 10  # digits


def dogleg_unit(units: Mapping[str, str]) -> str:
    """The unit of a curvature along a pipe: ``deg/100 ft``."""
    return f"deg/{REACHES.get(units['length'], units['length'])}"


@cache
def unit_and_size(text: str, name: str = "") -> tuple[str, float]:
    """The unit in which what is counted in the unit `text` is stated, and how many of it are one of that unit.

    Every place that prints a quantity asks here; pages read the same table. name: of the quantity or field.

    >>> unit_and_size("klbf/ft^2")[0], unit_and_size("ft", "R"), unit_and_size("N/cm^2")
    ('ksi', ('in', 12.0), ('N/cm^2', 1.0))
    """
    try:
        size, dimension = unit_size(text)
    except UnknownUnit:  # an expression may have a fraction as an exponent
        return text, 1.0
    counted = {*re.findall(r"[A-Za-z]+", text)}
    for of, lengths, forces, names, unit in HABITS:
        known = counted & {*lengths} and (not forces or counted & {*forces}) and (not names or name in names)
        if of == dimension and known:
            return unit, size / unit_size(unit)[0]
    return text, 1.0


def unit_shown(name: str, units: Mapping[str, str]) -> str:
    """The unit in which a quantity or field is stated; "1" for a plain number, "rad" for an angle."""
    return _unit_and_size(name, units)[0]


def size_shown(name: str, units: Mapping[str, str]) -> float:
    """How many of the unit in which a quantity is stated are one of its unit in the case."""
    return _unit_and_size(name, units)[1]


def _unit_and_size(name: str, units: Mapping[str, str]) -> tuple[str, float]:
    return unit_and_size(unit_of(AT_START.get(name, name), units), name)


def size(unit: str, dimension: tuple[int, ...], units: Mapping[str, str]) -> float:
    """How many of a unit are one of the unit of these exponents in a system of units."""
    return size_in(dimension, units) / unit_size(unit)[0]


def value_with_unit(name: str, value: float, units: Mapping[str, str], digits: int = 4) -> str:
    """A value of a quantity or field in the unit in which it is stated, with it: ``4.25 in``."""
    return f"{plain(value * size_shown(name, units), digits)} {unit_shown(name, units)}"


def margin_words(bend: Mapping[str, float], name: str, units: Mapping[str, str]) -> str:
    """By how much a quantity of that name is more than its least one; "" where none is asked for.

    bend: has its least value, and the margin as a share of that.
    """
    if not bend["least"]:
        return ""
    least = value_with_unit(name, bend["least"], units)
    return f"{plain(100 * abs(bend['margin']), 3)} % {'less' if bend['margin'] < 0 else 'more'} than the least, {least}"


def distinct_texts(values: Iterable[float], text: Callable[[float, int], str], least: int) -> list[str]:
    """The text of each value, with as many digits as tell apart those that differ in their first `FINEST` ones.

    text: of a value with so many digits. least: digits.

    >>> distinct_texts([0.027499515, 0.02750022, -1.0], plain, 4)
    ['0.0274995', '0.0275002', '-1']
    """
    numbers = [float(value) for value in values]
    finest = [text(number, FINEST) for number in numbers]
    for digits in range(least, FINEST):
        texts = [text(number, digits) for number in numbers]
        if len(set(texts)) == len(set(finest)):
            return texts
    return finest


def plain(value: float, digits: int = 4) -> str:
    """A number with so many digits, with five from 10000 on, and no exponent unless it is very large or small.

    >>> plain(12345.678), plain(30000000.0), plain(-0.04012), plain(2.5e-7)
    ('12346', '30000000', '-0.04012', '2.5e-07')
    """
    size_ = abs(value)
    if not (math.isfinite(value) and SMALLEST <= size_ < LARGEST):
        return f"{value:.{digits}g}"
    kept = max(digits, 5) if size_ >= 1e4 else digits
    rounded = float(f"{value:.{kept}g}")
    places = max(kept - 1 - math.floor(math.log10(size_)), 0)
    text = f"{rounded:.{places}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def intervals(each: Iterable[tuple[str, str]], unit: str) -> str:
    """Where intervals along a rod begin and end, in words; one of no length is a point.

    >>> intervals([("0", "12.5"), ("300", "300")], "m")
    'at s = 0 to 12.5, 300 m'
    """
    return "at s = " + ", ".join(low if low == high else f"{low} to {high}" for low, high in each) + f" {unit}"


def within(value: float, error: float, digits: int = 4) -> str:
    """A number as `plain`, without the digits in which its error is more than one; one digit stays, and of a number of
    at least ten errors two.

    >>> within(78.567, 0.27), within(-110930.0, 541.0), within(2.4, 30.0), within(2.4, 0.0), within(2.53, 0.14)
    ('79', '-111000', '2', '2.4', '2.5')
    """
    if not (0 < error < math.inf and math.isfinite(value)):
        return plain(value, digits)
    places = -math.ceil(math.log10(error))
    rounded = round(value, max(places, 1 - math.floor(math.log10(abs(value)))) if abs(value) >= 10 * error else places)
    return plain(rounded, digits) if rounded else plain(value, 1)
