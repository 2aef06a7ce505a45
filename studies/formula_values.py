"""The values of formulas, and why a case has none."""

import ast
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .formulas import BINARY, COMPARED, CONSTANTS, FUNCTIONS, Formula, is_not


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
        parts = [self.of(one) for one in node.args]
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
