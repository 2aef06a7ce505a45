"""Formulas: arithmetic on named numbers with units, in the grammar of Python, read as a tree and never run as code.

A formula has numbers, names, ``+ - * / **``, comparisons, ``and or not``, and the functions of `FUNCTIONS`.
`parse` reads it, `evaluate` computes its values, `units.dimension` its unit.
"""

import ast
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.problem.errors import InputError, choices, near

MOST_TEXT = 500  # characters of a formula
MOST_DEPTH = 60  # levels of a formula

BINARY: dict[type, tuple[str, Callable[..., Any]]] = {
    ast.Add: ("+", np.add),
    ast.Sub: ("-", np.subtract),
    ast.Mult: ("*", np.multiply),
    ast.Div: ("/", np.divide),
    ast.Pow: ("**", np.power),
}
COMPARED: dict[type, tuple[str, Callable[..., Any]]] = {
    ast.Lt: ("<", np.less),
    ast.LtE: ("<=", np.less_equal),
    ast.Gt: (">", np.greater),
    ast.GtE: (">=", np.greater_equal),
    ast.Eq: ("==", np.equal),
    ast.NotEq: ("!=", np.not_equal),
}
FUNCTIONS: dict[str, Callable[..., Any]] = {
    "sqrt": np.sqrt,
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
    "exp": np.exp,
    "log": np.log,
    "abs": np.abs,
    "min": np.minimum,
    "max": np.maximum,
}
CONSTANTS = {"pi": float(np.pi)}
IN = " in "  # between the formula of an expression and the unit of its value
OF_SEVERAL = ("min", "max")  # functions of two or more values


@dataclass(frozen=True)
class Formula:
    """A formula that was read.

    text: as given. tree: its nodes, all of the allowed kinds. names: those of quantities, in order, without functions
    and constants. whole: whether its values are 0 and 1, for false and true. unit: the unit behind `IN` in which an
    expression states its value; "" where it has none.
    """

    text: str
    tree: ast.expr
    names: tuple[str, ...]
    whole: bool
    unit: str = ""


@cache
def parse(text: str) -> Formula:
    """The formula of a text, whose names are checked by `formula_units.dimension`. Raises `InputError`."""
    if len(text) > MOST_TEXT:
        raise InputError(f"the formula has {len(text)} characters; the limit is {MOST_TEXT}")
    expression, _, unit = text.partition(IN)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tree = ast.parse(expression.strip(), mode="eval").body
    except SyntaxError as error:
        raise InputError(f"{text!r} is not a formula: {_why(error, expression.strip())}") from None
    except (ValueError, RecursionError, MemoryError):
        raise InputError(f"{text[:60]!r} is not a formula") from None
    names = dict.fromkeys(_names(tree, text, 1))
    whole = isinstance(tree, ast.Compare | ast.BoolOp) or (isinstance(tree, ast.UnaryOp) and is_not(tree))
    return Formula(text, tree, tuple(name for name in names if name not in CONSTANTS), whole, unit.strip())


def _why(error: SyntaxError, text: str) -> str:
    """What is wrong with the text by Python, and the place."""
    said = error.msg.partition(".")[0]
    if not error.offset or error.offset > len(text):
        return f"{said} at the end, where a number, a name or a function is missing"
    return f"{said} at character {error.offset}, {text[error.offset - 1 :][:20]!r}"


def _names(node: ast.AST, text: str, depth: int) -> Iterator[str]:
    """The names of a tree, each node checked against what a formula may hold. Raises `InputError`."""
    if depth > MOST_DEPTH:
        raise InputError(f"the formula {text[:60]!r} has more than {MOST_DEPTH} levels")
    if isinstance(node, ast.Name):
        if node.id in FUNCTIONS:
            raise InputError(f"{node.id} in {text!r} is a function: write {node.id}(...)")
        yield node.id
    for child in _parts(node, text):
        yield from _names(child, text, depth + 1)


def _parts(node: ast.AST, text: str) -> list[Any]:
    """The nodes below an allowed node. Raises `InputError` for any other node."""
    match node:
        case ast.BinOp() if type(node.op) in BINARY:
            return [node.left, node.right]
        case ast.BinOp() if isinstance(node.op, ast.BitXor):
            raise InputError(f"{text!r}: a power is written with **, not ^")
        case ast.UnaryOp() if isinstance(node.op, ast.UAdd | ast.USub | ast.Not):
            return [node.operand]
        case ast.BoolOp():
            return list(node.values)
        case ast.Compare() if all(type(op) in COMPARED for op in node.ops):
            return [node.left, *node.comparators]
        case ast.Call(func=ast.Name(id=name), keywords=[]):
            return _arguments(name, list(node.args), text)
        case ast.Constant() if _is_finite(node.value):
            return []
        case ast.Name():
            return []
    parts = "numbers, names, + - * / **, < <= > >= == !=, and or not, pi"
    shown = ast.unparse(node)[:60]
    raise InputError(f"a formula cannot hold {shown!r}; it has {parts} and the functions {choices(FUNCTIONS)}")


def _arguments(name: str, given: list[Any], text: str) -> list[Any]:
    if name not in FUNCTIONS:
        raise InputError(
            f"no function {name[:60]!r} in a formula{near(name[:60], FUNCTIONS)}; choose from {choices(FUNCTIONS)}"
        )
    several = name in OF_SEVERAL
    if len(given) < 1 + several or (len(given) > 1 and not several):
        need = "two values or more" if several else "one value"
        raise InputError(f"{name} in {text!r} needs {need}, got {len(given)}")
    return given


def _is_finite(value: object) -> bool:
    if not isinstance(value, int | float) or isinstance(value, bool):
        return False
    try:
        return bool(np.isfinite(float(value)))
    except OverflowError:
        return False


def is_not(node: ast.UnaryOp) -> bool:
    return isinstance(node.op, ast.Not)


def evaluate(formula: Formula, values: Mapping[str, Any]) -> tuple[NDArray[np.float64], NDArray[np.str_]]:
    """The values of a formula, and for each NaN the reason, "" elsewhere.

    values: name -> array of numbers; all broadcast to one shape, which both results have.
    """
    run = _Run(values)
    with np.errstate(all="ignore"):
        numbers = np.array(run.of(formula.tree), dtype=float)
    shape = np.broadcast_shapes(numbers.shape, *(np.shape(values[name]) for name in formula.names))
    result = np.array(np.broadcast_to(numbers, shape))
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
                truth = parts[0] != 0
                for part in parts[1:]:
                    truth = rule(truth, part != 0)
                return _truth(truth, *parts)
            case ast.Compare():
                parts = [self.of(node.left), *map(self.of, node.comparators)]
                truth = np.True_
                for op, left, right in zip(node.ops, parts, parts[1:], strict=False):
                    truth = truth & COMPARED[type(op)][1](left, right)
                return _truth(truth, *parts)
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
        value = FUNCTIONS[node.func.id](*parts[:2])
        for part in parts[2:]:
            value = FUNCTIONS[node.func.id](value, part)
        return value

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


def _truth(truth: Any, *parts: Any) -> Any:
    """1 and 0 for true and false, NaN where a part is NaN."""
    unknown = np.False_
    for part in parts:
        unknown = unknown | np.isnan(part)
    return np.where(unknown, np.nan, np.where(truth, 1.0, 0.0))
