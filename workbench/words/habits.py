"""The units in which engineers of a system of units state a quantity, and numbers without exponents.

In feet, radii are in inches, stresses in psi or ksi, weights and pushes in lbf/ft, and curvatures in deg/100 ft.
"""

import math
from collections.abc import Callable, Iterable, Mapping

from solver.problem.quantities import AT_START, QUANTITIES, unit_of, unit_text
from solver.problem.units import FORCES, LENGTHS, dimension_of, size_in, unit_size

RADII = ("a", "inner_radius", "R", "rho")
POUNDS, KILOPOUNDS, NEWTONS = ("lbf",), ("klbf", "kip"), ("N", "daN", "kN", "MN", "kgf")
REACHES = {"m": "30 m", "km": "30 m", "ft": "100 ft", "in": "100 ft", "mm": "m", "cm": "m", "dm": "m"}  # of a dogleg
STRESS, LINE_LOAD, CURVATURE = (-2, 1), (-1, 1), (-1, 0)
LARGEST = 1e10  # that is printed without an exponent
SMALLEST = 1e-4
IN_TABLES, FINEST = 5, 10  # digits


def dogleg_unit(units: Mapping[str, str]) -> str:
    """The unit of a curvature along a pipe: ``deg/100 ft``."""
    return f"deg/{REACHES.get(units['length'], units['length'])}"


def habitual_unit(dimension: tuple[int, int], units: Mapping[str, str]) -> str:
    """The unit of these exponents of length and force: ``psi`` where lengths are in feet and forces in lbf."""
    length, force = units["length"], units["force"]
    if dimension == STRESS and length in ("ft", "in"):
        for forces, unit in (POUNDS, "psi"), (KILOPOUNDS, "ksi"):
            if force in forces:
                return unit
    if dimension == STRESS and (length in ("m", "km") or (length == "mm" and force == "N")) and force in NEWTONS:
        return "MPa"
    if dimension == LINE_LOAD and length in ("ft", "in") and force in KILOPOUNDS:
        return f"lbf/{length}"
    return unit_text(dimension, units)


def unit_shown(name: str, units: Mapping[str, str]) -> str:
    """The unit in which a quantity or field is stated; "1" for a plain number, "rad" for an angle."""
    row = QUANTITIES[AT_START.get(name, name)]
    if units["length"] == "ft" and name in RADII:
        return "in"
    if units["length"] == "ft" and row.dimension in ("rad/length", CURVATURE):
        return dogleg_unit(units)
    return unit_of(row.name, units) if isinstance(row.dimension, str) else habitual_unit(row.dimension, units)


def size_shown(name: str, units: Mapping[str, str]) -> float:
    """How many of the unit in which a quantity is stated are one of its unit in the case."""
    unit = unit_shown(name, units)
    return 1.0 if unit in ("1", "", unit_of(AT_START.get(name, name), units)) else size(unit, dimension_of(name), units)


def size(unit: str, dimension: tuple[int, ...], units: Mapping[str, str]) -> float:
    """How many of a unit are one of the unit of these exponents in a system of units."""
    return size_in(dimension, units) / unit_size(unit)[0]


def value_with_unit(name: str, value: float, units: Mapping[str, str], digits: int = 4) -> str:
    """A value of a quantity or field in the unit in which it is stated, with it: ``4.25 in``."""
    return f"{plain(value * size_shown(name, units), digits)} {unit_shown(name, units)}"


def megapascals(units: Mapping[str, str]) -> float:
    """How many MPa are one of the unit of stress."""
    return FORCES[units["force"]] / LENGTHS[units["length"]] ** 2 / 1e6


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


def within(value: float, error: float, digits: int = 4) -> str:
    """A number as `plain`, without the digits in which its error is more than one; one digit stays.

    >>> within(78.567, 0.27), within(-110930.0, 541.0), within(2.4, 30.0), within(2.4, 0.0)
    ('79', '-111000', '2', '2.4')
    """
    if not (0 < error < math.inf and math.isfinite(value)):
        return plain(value, digits)
    rounded = round(value, -math.ceil(math.log10(error)))
    return plain(rounded, digits) if rounded else plain(value, 1)
