"""Units: those of length and force that a study may have, and any product of units that an expression may state."""

import re
from collections.abc import Mapping
from fractions import Fraction
from math import pi

import numpy as np

from solver.problem.errors import InputError, choices, near

from .formula_units import PLAIN, Dimension, dimension, evaluate
from .formulas import parse

# in metres
LENGTHS = {"nm": 1e-9, "um": 1e-6, "mm": 1e-3, "cm": 1e-2, "dm": 0.1, "m": 1.0, "km": 1e3, "in": 0.0254, "ft": 0.3048}
_POUND = 4.4482216152605
FORCES = {  # in newtons
    "pN": 1e-12, "nN": 1e-9, "uN": 1e-6, "mN": 1e-3, "N": 1.0, "daN": 10.0, "kN": 1e3, "MN": 1e6, "dyn": 1e-5,
    "gf": 9.80665e-3, "kgf": 9.80665, "lbf": _POUND,
}  # fmt: skip
STRESSES = {  # in newtons per square metre
    "Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "bar": 1e5,
    "psi": _POUND / 0.0254**2, "ksi": 1e3 * _POUND / 0.0254**2,
}  # fmt: skip
ENERGIES = {"J": 1.0, "kJ": 1e3}  # in newton metres
NUMBERS = {"deg": pi / 180, "rad": 1.0, "turn": 2 * pi, "percent": 0.01}

_DIMENSIONS: tuple[tuple[Mapping[str, float], Dimension], ...] = (
    (LENGTHS, (Fraction(1), Fraction(0))),
    (FORCES, (Fraction(0), Fraction(1))),
    (STRESSES, (Fraction(-2), Fraction(1))),
    (ENERGIES, (Fraction(1), Fraction(1))),
    (NUMBERS, PLAIN),
)
NAMED = ("Pa", "kPa", "MPa", "GPa", "ksi", "deg")  # at the end of a name they claim to be its unit


def size_of(text: str, units: Mapping[str, str]) -> tuple[float, Dimension]:
    """The size of a unit such as ``MPa``, ``deg/(30 m)`` or ``kN m`` in the units of a study, and its dimension.

    Raises `InputError` for a text that is no product of known units.
    """
    sizes, known = {}, {}
    for table, (length, force) in _DIMENSIONS:
        for name, size in table.items():
            in_study = size / (LENGTHS[units["length"]] ** float(length) * FORCES[units["force"]] ** float(force))
            sizes["inch" if name == "in" else name], known["inch" if name == "in" else name] = in_study, (length, force)
    product = re.sub(r"(?<=[\w)])\s+(?=[\w(])", "*", re.sub(r"\bin\b", "inch", text.strip().replace("^", "**")))
    try:
        formula = parse(product)
        if unknown := [name for name in formula.names if name not in known]:
            raise InputError(f"no unit {unknown[0]!r}{near(unknown[0], known)}; choose from {choices(known)}")
        found, sizes_of = dimension(formula, known, units), {name: np.asarray(sizes[name]) for name in formula.names}
    except InputError as error:
        raise InputError(f"unit {text!r}: {error}") from None
    value = float(evaluate(formula, sizes_of)[0])
    if not value > 0:
        raise InputError(f"unit {text!r} is not a product of units, such as MPa or deg/(30 m)")
    return value, found
