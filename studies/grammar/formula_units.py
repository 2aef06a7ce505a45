"""The units of formulas (lengths and forces are dimensions, angles and counts plain numbers), and their values."""

import ast
from collections.abc import Mapping
from difflib import get_close_matches
from fractions import Fraction
from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.problem.errors import InputError, choices
from solver.problem.quantities import unit_text

from .formulas import BINARY, COMPARED, CONSTANTS, FUNCTIONS, OF_SEVERAL, Formula, is_not

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
            close = get_close_matches(name[:60], list(known), 1)
            near = f", did you mean {close[0]!r}" if close else ""
            raise InputError(f"no name {name[:60]!r} in a formula{near}; choose from {choices([*known, *CONSTANTS])}")
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
        if any(isinstance(one, ast.Name) and one.id not in CONSTANTS for one in ast.walk(node.right)):
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
        found = [(node, self.of(node)) for node in nodes]
        sized = [(node, one) for node, one in found if one is not None]
        for node, one in sized:
            if one != sized[0][1]:
                raise InputError(f"{self._tell(sized[0][0])} and {self._tell(node)}, but {user} needs equal units")
        return sized[0][1] if sized else None

    def _tell(self, node: ast.expr) -> str:
        return f"{ast.unparse(node)[:60]!r} is {unit_words(self.of(node) or PLAIN, self.units)}"


def evaluate(formula: Formula, values: Mapping[str, Any]) -> tuple[NDArray[np.float64], NDArray[np.str_]]:
    """The values of a formula, and for each NaN the reason, "" elsewhere.

    values: name -> array of numbers; all broadcast to one shape, which both results have.
    """
    run = _Run(values)
    with np.errstate(all="ignore"):
        found = np.array(run.of(formula.tree), dtype=float)
    shape = np.broadcast_shapes(found.shape, *(np.shape(values[name]) for name in formula.names))
    result = np.array(np.broadcast_to(found, shape))
    why = np.full(shape, "", dtype=object)
    bad = ~np.isfinite(result)
    for mask, reason in run.faults:  # the first fault of a case is the cause, whatever became of it
        mine = np.broadcast_to(mask, shape)
        why[mine & (why == "")] = reason
        bad |= mine
    why[bad & (why == "")] = "its value is too large for a number"
    result[bad] = np.nan
    return result, why.astype(str)


def run(values: Mapping[str, Any], node: ast.expr) -> Any:
    """The values of a node of a formula."""
    with np.errstate(all="ignore"):
        return _Run(values).of(node)


class _Run:
    """The values of the nodes of a formula. faults: where and why a value is not finite."""

    def __init__(self, values: Mapping[str, Any]) -> None:
        self.values = values
        self.faults: list[tuple[Any, str]] = []

    def of(self, node: ast.expr) -> Any:
        match node:
            case ast.Constant():
                assert isinstance(node.value, int | float)
                return np.float64(node.value)
            case ast.Name():
                return self._name(node.id)
            case ast.UnaryOp():
                value = self.of(node.operand)
                return _truth(value == 0, value) if is_not(node) else -value if isinstance(node.op, ast.USub) else value
            case ast.BoolOp():
                parts = [self.of(value) for value in node.values]
                rule = np.logical_and if isinstance(node.op, ast.And) else np.logical_or
                found = parts[0] != 0
                for part in parts[1:]:
                    found = rule(found, part != 0)
                return _truth(found, *parts)
            case ast.Compare():
                parts = [self.of(node.left), *map(self.of, node.comparators)]
                found = np.True_
                for op, left, right in zip(node.ops, parts, parts[1:], strict=False):
                    found = found & COMPARED[type(op)][1](left, right)
                return _truth(found, *parts)
            case ast.Call():
                return self._call(node)
            case ast.BinOp():
                return self._compute(node)
        raise AssertionError(node)

    def _name(self, name: str) -> Any:
        if name in CONSTANTS:
            return np.float64(CONSTANTS[name])
        value = np.asarray(self.values[name], dtype=float)
        self._fault(~np.isfinite(value), f"{name} has no value")
        return value

    def _call(self, node: ast.Call) -> Any:
        assert isinstance(node.func, ast.Name)
        parts = [self.of(arg) for arg in node.args]
        if node.func.id == "sqrt":
            self._fault(parts[0] < 0, f"sqrt of a negative number in {ast.unparse(node)!r}")
        if node.func.id == "log":
            self._fault(parts[0] <= 0, f"log of a number that is not positive in {ast.unparse(node)!r}")
        found = FUNCTIONS[node.func.id](*parts[:2])
        for part in parts[2:]:
            found = FUNCTIONS[node.func.id](found, part)
        return found

    def _compute(self, node: ast.BinOp) -> Any:
        a, b = self.of(node.left), self.of(node.right)
        if isinstance(node.op, ast.Div):
            self._fault(b == 0, f"division by zero: {ast.unparse(node.right)!r} is 0")
        if isinstance(node.op, ast.Pow):
            self._fault((a == 0) & (b < 0), f"division by zero: {ast.unparse(node.left)!r} is 0")
            self._fault((a < 0) & (b != np.round(b)), f"power of a negative number in {ast.unparse(node)!r}")
        return BINARY[type(node.op)][1](a, b)

    def _fault(self, mask: Any, reason: str) -> None:
        if np.any(mask):
            self.faults.append((mask, reason))


def _truth(found: Any, *parts: Any) -> Any:
    """1 and 0 for true and false, NaN where a part is NaN."""
    unknown = np.False_
    for part in parts:
        unknown = unknown | np.isnan(part)
    return np.where(unknown, np.nan, np.where(found, 1.0, 0.0))
