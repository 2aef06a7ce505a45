"""Formulas: arithmetic on named numbers with units, in the grammar of Python, read as a tree and never run as code.

A formula has numbers, names, ``+ - * / **``, comparisons, ``and or not``, and the functions of `FUNCTIONS`.
`formula_units` computes its unit, `formula_values` its values.
"""

import ast
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache
from typing import Any

import numpy as np

from solver.problem.errors import InputError, choices

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
    own, _, unit = text.partition(IN)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tree = ast.parse(own.strip(), mode="eval").body
    except SyntaxError as error:
        raise InputError(f"{text!r} is not a formula: {_why(error, own.strip())}") from None
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
        close = get_close_matches(name[:60], list(FUNCTIONS), 1)
        near = f", did you mean {close[0]!r}" if close else ""
        raise InputError(f"no function {name[:60]!r} in a formula{near}; choose from {choices(FUNCTIONS)}")
    several = name in OF_SEVERAL
    if len(given) < 1 + several or (len(given) > 1 and not several):
        wanted = "two values or more" if several else "one value"
        raise InputError(f"{name} in {text!r} needs {wanted}, got {len(given)}")
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
