"""Units: of formulas (angles and counts are plain numbers), of a study, and products that an expression may state."""

import ast
import re
from collections.abc import Mapping
from fractions import Fraction
from math import isfinite, pi

import numpy as np

from solver.problem.errors import InputError, choices, near
from solver.problem.quantities import unit_text

from .formulas import BINARY, COMPARED, CONSTANTS, OF_SEVERAL, Formula, evaluate, is_not, parse, run

MOST_POWER = 12  # of a quantity with a unit, and the largest denominator
KEEP_UNIT = ("abs", *OF_SEVERAL)  # functions whose result has the unit of their values

Dimension = tuple[Fraction, Fraction]  # exponents of length and force
PLAIN: Dimension = (Fraction(0), Fraction(0))


def dimension(formula: Formula, known: Mapping[str, Dimension], units: Mapping[str, str]) -> Dimension:
    """The dimension of a formula over names with these dimensions. Raises `InputError`.

    known: name -> dimension. units: of length and force, for messages.
    """
    for name in formula.names:
        if name not in known:
            meant = near(name, known)
            raise InputError(f"no name {name[:60]!r} in a formula{meant}; choose from {choices([*known, *CONSTANTS])}")
    return _Units(known, units).of(formula.tree) or PLAIN


def is_zero(formula: Formula) -> bool:
    """Whether a formula is the number 0, which fits every unit."""
    return not formula.names and _Units({}, {}).of(formula.tree) is None


def unit_words(dimension: Dimension, units: Mapping[str, str]) -> str:
    """``a plain number``, ``in N/cm^2``."""
    return "a plain number" if dimension == PLAIN else f"in {unit_text(dimension, units)}"


class _Units:
    """The dimensions of the nodes of a formula; None for the number 0, which fits every unit."""

    def __init__(self, known: Mapping[str, Dimension], units: Mapping[str, str]) -> None:
        self.known, self.units = known, units

    def of(self, node: ast.expr) -> Dimension | None:
        match node:
            case ast.Constant():
                return None if node.value == 0 else PLAIN
            case ast.Name():
                return PLAIN if node.id in CONSTANTS else self.known[node.id]
            case ast.UnaryOp():
                return self._plain(node.operand, "not") if is_not(node) else self.of(node.operand)
            case ast.BoolOp():
                for value in node.values:
                    self._plain(value, "and" if isinstance(node.op, ast.And) else "or")
                return PLAIN
            case ast.Compare():
                self._equal([node.left, *node.comparators], COMPARED[type(node.ops[0])][0])
                return PLAIN
            case ast.Call():
                return self._call(node)
            case ast.BinOp(op=ast.Add() | ast.Sub()):
                return self._equal([node.left, node.right], BINARY[type(node.op)][0])
            case ast.BinOp(op=ast.Pow()):
                return self._power(node)
            case ast.BinOp():
                a, b = self.of(node.left) or PLAIN, self.of(node.right) or PLAIN
                sign = 1 if isinstance(node.op, ast.Mult) else -1
                return a[0] + sign * b[0], a[1] + sign * b[1]
        raise AssertionError(node)

    def _call(self, node: ast.Call) -> Dimension | None:
        assert isinstance(node.func, ast.Name)
        name = node.func.id
        if name in KEEP_UNIT:
            return self._equal(node.args, name)
        if name != "sqrt":
            return self._plain(node.args[0], name)
        length, force = self.of(node.args[0]) or PLAIN
        return length / 2, force / 2

    def _power(self, node: ast.BinOp) -> Dimension | None:
        base = self.of(node.left) or PLAIN
        self._plain(node.right, "the exponent of **")
        if base == PLAIN:
            return PLAIN
        if any(isinstance(part, ast.Name) and part.id not in CONSTANTS for part in ast.walk(node.right)):
            raise InputError(f"{self._tell(node.left)}: its exponent must be a number, got {ast.unparse(node.right)!r}")
        exponent = float(run({}, node.right))
        share = Fraction(exponent).limit_denominator(MOST_POWER) if isfinite(exponent) else Fraction(0)
        if abs(exponent) > MOST_POWER or abs(float(share) - exponent) > 1e-12:
            raise InputError(
                f"{self._tell(node.left)}: its exponent must be a fraction of at most {MOST_POWER}, got {exponent:g}"
            )
        return base[0] * share, base[1] * share

    def _plain(self, node: ast.expr, user: str) -> Dimension:
        if (self.of(node) or PLAIN) != PLAIN:
            raise InputError(f"{self._tell(node)}, but {user} needs a plain number")
        return PLAIN

    def _equal(self, nodes: list[ast.expr], user: str) -> Dimension | None:
        """The one dimension of the nodes. Raises `InputError` where they differ."""
        pairs = [(node, self.of(node)) for node in nodes]
        sized = [(node, dim) for node, dim in pairs if dim is not None]
        for node, dim in sized:
            if dim != sized[0][1]:
                raise InputError(f"{self._tell(sized[0][0])} and {self._tell(node)}, but {user} needs equal units")
        return sized[0][1] if sized else None

    def _tell(self, node: ast.expr) -> str:
        return f"{ast.unparse(node)[:60]!r} is {unit_words(self.of(node) or PLAIN, self.units)}"


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
        dim, sizes_of = dimension(formula, known, units), {name: np.asarray(sizes[name]) for name in formula.names}
    except InputError as error:
        raise InputError(f"unit {text!r}: {error}") from None
    value = float(evaluate(formula, sizes_of)[0])
    if not value > 0:
        raise InputError(f"unit {text!r} is not a product of units, such as MPa or deg/(30 m)")
    return value, dim
